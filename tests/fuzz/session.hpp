// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <odograph/odograph.h>

namespace fuzz {

/// A replay session over the plugins of this build; null and an end of the program where the build is not whole.
inline odo_session* open(const std::string& pipeline) {
  const std::string yaml = "odograph: 1\nplugins: {verify_hash: false}\n" + pipeline;  // a hash takes longer than a run
  static const std::string folders = ODOGRAPH_FUZZ_PLUGINS;
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY;
  options.config_text = {yaml.data(), yaml.size()};
  options.plugin_path = {folders.data(), folders.size()};
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) == ODO_OK) return session;
  std::fprintf(stderr, "%s\n", error.message);
  std::abort();
}

}  // namespace fuzz
