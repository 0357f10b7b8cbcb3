/* SPDX-License-Identifier: Apache-2.0
 *
 * glibc's flag that the process has a single thread, which the C++ runtime reads before it counts shared pointers.
 * Archives that were not built for shared libraries read it at an address within the library itself. This definition
 * provides it; its value, "may have more threads", is always safe. */
extern char __libc_single_threaded;
__attribute__((visibility("hidden"))) char __libc_single_threaded = 0;
