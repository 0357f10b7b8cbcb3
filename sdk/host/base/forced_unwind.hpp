// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#if defined(__GLIBCXX__)
#include <cxxabi.h>
#endif

namespace odograph {

/// What passes through the handlers of a thread that ends itself (pthread_exit). Whoever catches everything catches
/// this before, and throws it on. Only GNU's run-time library has it.
#if defined(__GLIBCXX__)
using ForcedUnwind = abi::__forced_unwind;
#else
struct ForcedUnwind {};
#endif

}  // namespace odograph
