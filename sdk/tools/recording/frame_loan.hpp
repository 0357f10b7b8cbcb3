// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <utility>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Lends a frame's pixels: `owner` holds them and is destroyed with the last release. [releases: any thread]
template <class Owner>
void set_loan(odo_frame& frame, Owner owner) {
  struct Loan {
    Owner owner;
    std::atomic<int> references{1};
  };
  frame.loan.owner = new Loan{std::move(owner)};
  frame.loan.retain = [](void* loan) -> int32_t {
    ++static_cast<Loan*>(loan)->references;
    return ODO_OK;
  };
  frame.loan.release = [](void* loan) {
    if (--static_cast<Loan*>(loan)->references == 0) delete static_cast<Loan*>(loan);
  };
}

/// A frame that borrows a picture decoded by OpenCV: 8-bit grey, BGR or BGRA. ODO_E_DATA, with `name`, for any other.
Result<odo_frame> borrow_image(cv::Mat image, const odo_frame& head, const std::string& name);

}  // namespace odograph
