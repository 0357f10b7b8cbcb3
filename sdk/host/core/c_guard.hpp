// SPDX-License-Identifier: Apache-2.0
//
// Common to every function of the C API: no exception escapes, each failure has a text, and the caller's floating-point
// rounding mode does not affect the host.
#pragma once

#include <algorithm>
#include <new>

#include <odograph/messages.h>

#include "sdk/host/base/floating_point.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/base/result.hpp"

namespace odograph {

/// Returns the result of `work`, or a status if it throws.
template <class Work>
int32_t guarded(Work&& work) noexcept {
  const DefaultFloatingPoint environment;
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return ODO_E_MEMORY;
  } catch (...) {
    return ODO_E_ERROR;
  }
}

/// Returns the failure's status and stores its text in `error`, if not null.
inline int32_t fail(odo_error* error, const Failure& failure) {
  if (error && error->struct_size >= ODO_ERROR_SIZE_MIN) {
    error->struct_size = std::min<uint32_t>(error->struct_size, sizeof *error);
    error->status = failure.status;
    copy_text(error->message, failure.text);
  }
  return failure.status;
}

}  // namespace odograph
