// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// What the operating system beneath this build gives the host. Whatever needs more is refused where it is asked for,
/// in the config or when a session is made, with features.name in the text.
struct PlatformFeatures {
  const char* name;     ///< the folder beside this file
  bool libraries;       ///< plugins are loaded from files; otherwise those alone that are linked in
  bool processes;       ///< a plugin may run in a process of its own (isolation: process)
  bool threads;         ///< a session may have a thread (ODO_RUN_LIVE)
  char path_separator;  ///< of a list of folders
};

extern const PlatformFeatures kPlatform;

}  // namespace odograph
