// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/guessed_camera.hpp"

#include <algorithm>

#include "sdk/math/scalar.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/replay/camera_imu_source.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

/// The beginning of a recording with a limited number of frames.
Recording begin_of(const Recording& recording, const GuessedCameraOptions& o) {
  Recording part{.format = recording.format, .path = recording.path};
  int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
  for (const RecordedMessage& m : recording.messages) {
    const odo_header& header = m.message.header();
    if (header.type == ODO_TYPE_FRAME) {
      first_ns = std::min(first_ns, header.t_ns);
      const bool late = seconds(header.t_ns - first_ns) > o.span_s;
      if (late || (last_ns != INT64_MIN && seconds(header.t_ns - last_ns) < 0.8 / o.rate_hz)) continue;
      last_ns = header.t_ns;
    } else if (header.type != ODO_TYPE_IMU && header.type != ODO_TYPE_CALIBRATION) {
      continue;
    }
    part.messages.push_back(m);
  }
  return part;
}

/// Replaces guesses by estimates, and describes the change.
std::string take(const CameraImuCalibration& found, const Recording::Guesses& guessed, odo_calibration& c) {
  std::string words;
  if (guessed.lens && found.focal_px.observable) {
    c.fx = found.lens.fx, c.fy = found.lens.fy, c.cx = found.lens.cx, c.cy = found.lens.cy;
    std::copy_n(found.lens.distortion, 8, c.distortion);
    c.distortion_count = found.lens.distortion_count;
    words += text("focal length %.1f +- %.1f px, ", found.focal_px.value, found.focal_px.sigma);
  }
  if (guessed.mount && found.rotation_observable) {
    words += text("mount %.1f degrees from the guess, ", kDeg_per_rad * found.q_b_c.angularDistance(found.given_q_b_c));
    put_quaternion(found.q_b_c, c.q_b_c);
    c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
  }
  if (found.time_offset_s.observable) {
    words += text("frames %.1f +- %.1f ms later than their time stamps, ", 1e3 * found.time_offset_s.value,
                  1e3 * found.time_offset_s.sigma);
    c.time_offset_ns = nanoseconds(found.time_offset_s.value);
    c.header.flags |= ODO_CALIBRATION_TIME_OFFSET;
  }
  return words.empty() ? words : words.substr(0, words.size() - 2);
}

}  // namespace

void refine_guessed_camera(Recording& recording, const GuessedCameraOptions& o, const ProgressCallback& progress) {
  if (!recording.guessed.any() || !recording.has(ODO_TYPE_FRAME)) return;
  const auto keeps = [&](const std::string& why) {
    recording.warnings.push_back(
        "the guessed camera parameters are kept, because the gyroscope does not improve them: " + why);
  };
  auto data = camera_imu_data(begin_of(recording, o), progress);
  if (!data) return keeps(data.failure().text);
  CameraImuOptions options{.refine_lens = recording.guessed.lens};
  if (recording.guessed.times) options.search_s = o.search_s;
  const auto found = calibrate_camera_imu(*data, options);
  if (!found) return keeps(found.failure().text);
  if (found->correlation < o.min_correlation)
    return keeps(text("correlation of pictures and gyroscope %.2f", found->correlation));
  std::string words;
  for (RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION)
      words = take(*found, recording.guessed, reinterpret_cast<odo_calibration&>(m.message.header()));
  if (words.empty()) return keeps("too little rotation in its first seconds");
  recording.warnings.push_back("camera against gyroscope: " + words);
}

}  // namespace odograph
