// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Leaves this process, all its threads and for good, the system calls that a plugin computes with, and none else: the
/// list, with a reason for each group, is call_filter.cpp. What is not on it fails with EPERM; with ENOSYS from Linux
/// 5.1's numbers on, so that a newer C library takes the older call. Needs no_new_privs. False, with errno, where the
/// system or the processor is not known to it.
bool filter_calls();

}  // namespace odograph
