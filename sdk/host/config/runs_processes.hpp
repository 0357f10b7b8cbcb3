// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/config/pipeline_config.hpp"

namespace odograph {

/// Whether any plugin, or its fallback, runs in a process of its own.
inline bool runs_processes(const PipelineConfig& config) {
  bool any = false;
  config.visit_plugins([&](const PluginChoice& chosen) {
    for (const PluginChoice* choice = &chosen; choice; choice = choice->fallback.get())
      any = any || choice->isolation.kind == Isolation::Kind::process;
  });
  return any;
}

}  // namespace odograph
