// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

std::string base64(const std::vector<unsigned char>& bytes);
/// The calibration of the main camera, the first that has one; null if none.
const odo_calibration* camera_of(const Recording& recording);
/// Frames of that camera, or all frames if it is unknown.
std::vector<const RecordedMessage*> frames_of(const Recording& recording, const odo_calibration* camera);
/// A JPEG of at most `width` px, in colour if the camera has it; empty if unreadable, which the run reports.
std::vector<unsigned char> jpeg_of(const RecordedMessage& message, int width);

}  // namespace odograph
