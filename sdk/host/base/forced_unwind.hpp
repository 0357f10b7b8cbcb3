// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#if defined(__GLIBCXX__)
#include <cxxabi.h>
#endif

namespace odograph {

/// The exception that unwinds a thread which calls pthread_exit. A handler that catches everything must catch this
/// first and rethrow it. Only GNU's run-time library has it.
#if defined(__GLIBCXX__)
using ForcedUnwind = abi::__forced_unwind;
#else
struct ForcedUnwind {};
#endif

}  // namespace odograph
