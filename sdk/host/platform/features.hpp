// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Features of the operating system available to the host. A feature that is missing is refused where it is requested,
/// in the config or when a session is created, with features.name in the text.
struct PlatformFeatures {
  const char* name;     ///< name of the platform folder beside this file
  bool libraries;       ///< plugins are loaded from files; otherwise only linked-in plugins exist
  bool processes;       ///< a plugin may run in a process of its own (isolation: process)
  bool threads;         ///< a session may have a thread (ODO_RUN_LIVE)
  char path_separator;  ///< in lists of folders
};

extern const PlatformFeatures kPlatform;

}  // namespace odograph
