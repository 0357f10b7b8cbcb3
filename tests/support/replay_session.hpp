// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

#include <odograph/odograph.h>

namespace odograph {

/// A replay by a config's text, with plugins of these folders; both texts must live as long as the options.
inline odo_session_options replay_options(const std::string& yaml, const std::string& plugins) {
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY;
  options.config_text = {yaml.data(), yaml.size()};
  options.plugin_path = {plugins.data(), plugins.size()};
  return options;
}

/// Null if there is none; the reason is printed.
inline odo_session* open_session(const odo_session_options& options) {
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) < 0) std::printf("FAILED: %s\n", error.message);
  return session;
}

}  // namespace odograph
