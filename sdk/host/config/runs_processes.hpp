// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/config/pipeline_config.hpp"

namespace odograph {

/// Whether any plugin, or its fallback, runs in a process of its own.
inline bool runs_processes(const PipelineConfig& config) {
  for (const auto* plugins :
       {&config.attitudes, &config.step_estimators, &config.vo_frontends, &config.scale_sources, &config.fixers})
    for (const PluginChoice& chosen : *plugins)
      for (const PluginChoice* choice = &chosen; choice; choice = choice->fallback.get())
        if (choice->isolation.kind == Isolation::Kind::process) return true;
  return false;
}

}  // namespace odograph
