// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "sdk/host/core/plugin_roster.hpp"

namespace odograph {

/// Finds plugins of the config that change nothing, and says once of each what to change ("unused_source", a note that
/// changes no state): scale sources behind a front-end in metres, and plugins whose input never comes.
class SourceWatch {
 public:
  struct Parameters {
    /// s of input after which a plugin without input is named: a receiver's first position and a walker's first steps
    /// come earlier; judgement.
    double judged_s = 10;
  };

  SourceWatch(const PluginRoster& roster, HostServices& host) : roster_(roster), host_(host) {}

  /// A message that came to the plugins, an input or an event.
  void came(const odo_header& message);
  /// A scale of this source met a motion that is in metres already.
  void on_pointless_scale(uint32_t source);
  /// Names the plugins that have given nothing and whose input does not come, once enough has come.
  void judge();

 private:
  std::string without_input(const PluginInstance& plugin) const;
  void report(const PluginInstance& plugin, const std::string& text);

  Parameters p_;
  const PluginRoster& roster_;
  HostServices& host_;
  TypeSet came_;
  std::set<uint32_t> gave_, pointless_;  // numbers of plugins
  std::optional<int64_t> first_ns_;
  int64_t now_ns_ = 0;
  bool judged_ = false;
};

}  // namespace odograph
