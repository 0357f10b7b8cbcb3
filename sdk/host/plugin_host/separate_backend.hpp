// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/host/plugin_host/backend.hpp"

namespace odograph {

/// What a backend has whose plugin may end before it: on a thread or in a process of its own. Once ended() says why,
/// every call is ODO_E_ERROR, and a new backend is to be made.
class SeparateBackend : public PluginBackend {
 public:
  const KindTypes& types() const final { return types_; }
  void quarantine() final { quarantined_ = true; }
  bool quarantined() const final { return quarantined_; }
  std::string ended() const final { return ended_; }

 protected:
  KindTypes types_;
  std::string ended_;

 private:
  bool quarantined_ = false;
};

}  // namespace odograph
