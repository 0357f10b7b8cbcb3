// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Permanently restricts this process and all its threads to the system calls that a plugin needs for computing;
/// call_filter.cpp lists them with a reason for each group. Others fail with EPERM, or with ENOSYS for numbers from
/// Linux 5.1 on, so that a newer C library falls back to the older call. Requires no_new_privs. False, with errno, if
/// system or processor are not supported.
bool filter_calls();

}  // namespace odograph
