// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace odograph {

/// What the plugin's process has of its keeper.
struct Kept {
  int gate;           // for ask_for_threads
  std::string lacks;  // the namespaces that this system does not allow, and why; or empty
};

/// Splits this process in two. The child, in which this returns, is the plugin's: in a user and a process namespace of
/// its own where the system allows that, so that no process outside can be named; its standard input is empty, its
/// standard output and error are pipes, of its other descriptors it keeps those below `first_closed`. This process
/// becomes its keeper: it passes the output on, answers for its threads (thread_gate.hpp), ends the child as soon as
/// the host that started it is gone or it is itself ended, and ends as the child did. It runs nothing of the plugin's.
/// One thread so far. Exits where no process can be made.
Kept keep(int first_closed);

}  // namespace odograph
