// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace odograph {

/// What the plugin's process receives from its supervisor.
struct ChildContext {
  int gate;             // for require_thread_approval
  std::string missing;  // the namespaces that this system does not allow, and why; or empty
};

/// Forks this process. The child, in which this returns, becomes the plugin's process: in its own user and process
/// namespaces if the system allows, so that it cannot address outside processes; with empty standard input, pipes as
/// standard output and error, and otherwise only descriptors below `first_closed`. This process becomes its supervisor:
/// it forwards the output, approves its threads (thread_gate.hpp), ends the child when the host that started it is gone
/// or the supervisor itself is terminated, and exits as the child did. It runs no plugin code. Must be called while
/// single-threaded. Exits if no process can be created.
ChildContext fork_supervised(int first_closed);

}  // namespace odograph
