/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
extern "C" {
struct ALooper;
enum { ALOOPER_PREPARE_ALLOW_NON_CALLBACKS = 1 };
typedef int (*ALooper_callbackFunc)(int fd, int events, void* data);
ALooper* ALooper_prepare(int options);
int ALooper_pollOnce(int timeout_ms, int* fd, int* events, void** data);
}
