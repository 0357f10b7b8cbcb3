// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <odograph/messages.h>

namespace odograph {

/// Takes model and distortion by the model's name in ROS, ASL or Kalibr: radial-tangential ("" included), fisheye, or
/// none. Returns why the lens is refused, which no reader may read as undistorted; empty if it is not.
std::string take_distortion(odo_calibration& calibration, const std::string& model, std::vector<double> k);

}  // namespace odograph
