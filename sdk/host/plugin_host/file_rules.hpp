// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Permanently restricts this thread and the threads that it starts. Allowed: reading below the root folder, except
/// other processes (/proc), devices, terminals and run-time state (/dev, /sys, /run); of these, /proc/self, the
/// processor's description and random numbers remain readable. Denied: changes of any file, TCP, abstract sockets, and
/// signals to outside processes. Limited to what this kernel's Landlock supports. Requires no_new_privs. False, with
/// errno, without Landlock.
bool restrict_files();

}  // namespace odograph
