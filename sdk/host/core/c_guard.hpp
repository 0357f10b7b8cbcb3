// SPDX-License-Identifier: Apache-2.0
//
// What every function of the C API does at the border: no exception leaves, a failure has its text, and
// the caller's rounding is not ours.
#pragma once

#include <algorithm>
#include <new>

#include <odograph/messages.h>

#include "sdk/host/base/floating_point.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/base/result.hpp"

namespace odograph {

/// What `work` returns; a status where it throws.
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

/// The failure's status, with its text in `error` where the caller gave one.
inline int32_t fail(odo_error* error, const Failure& failure) {
  if (error && error->struct_size >= ODO_ERROR_SIZE_MIN) {
    error->struct_size = std::min<uint32_t>(error->struct_size, sizeof *error);
    error->status = failure.status;
    copy_text(error->message, failure.text);
  }
  return failure.status;
}

}  // namespace odograph
