/* SPDX-License-Identifier: Apache-2.0
 *
 * Whether the process has one thread, as the C++ runtime asks glibc before it counts shared pointers. Archives that
 * were not built for shared libraries ask by an address in the library itself: here it is, and the answer is "it may
 * have more", which is always right. */
extern char __libc_single_threaded;
__attribute__((visibility("hidden"))) char __libc_single_threaded = 0;
