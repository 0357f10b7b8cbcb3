// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <string>

#include "sdk/host/plugin_host/wire.hpp"

namespace hostile {

/// The memory shared with the host in a separate process; null in the app's.
inline volatile odograph::wire::Control* control() {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find("odograph-control") != std::string::npos)
      return reinterpret_cast<odograph::wire::Control*>(std::stoull(line, nullptr, 16));
  return nullptr;
}

}  // namespace hostile
