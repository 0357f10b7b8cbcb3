// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Leaves this thread, and those that it will start, for good: reading what lies below the root folder, but nothing of
/// other processes (/proc), no device, no terminal, no run-time state (/dev, /sys, /run), with what follows left of
/// these: /proc/self, the processor's description and random numbers; no change of any file, no TCP, no abstract socket
/// and no signal to a process outside. As much of it as this kernel's Landlock knows. Needs no_new_privs. False, with
/// errno, where there is none.
bool restrict_files();

}  // namespace odograph
