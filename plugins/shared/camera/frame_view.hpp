// SPDX-License-Identifier: Apache-2.0
//
// Common preprocessing of frames for plugins.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>
#include <opencv2/imgproc.hpp>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/tracking.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

inline CameraModel camera_of(const odo_calibration& c) {
  CameraModel camera;
  camera.distortion = c.model == ODO_CAMERA_KANNALA_BRANDT ? CameraModel::Distortion::kannala_brandt
                                                           : CameraModel::Distortion::radial_tangential;
  camera.fx = c.fx, camera.fy = c.fy, camera.cx = c.cx, camera.cy = c.cy;
  camera.coefficients.assign(c.distortion, c.distortion + c.distortion_count);
  return camera;
}

/// The camera as described by its calibrations and frames. Pixels.
class CalibratedCamera {
 public:
  /// Takes a calibration. True if it is a different camera; a phone with autofocus or stabiliser sends its own lens
  /// repeatedly. Throws odo::Error (unsupported) for an unknown model, and then has no camera.
  bool take(const odo_calibration& c) {
    const bool same = calibration_ && calibration_->header.source == c.header.source &&
                      calibration_->model == c.model && calibration_->width == c.width &&
                      calibration_->height == c.height;
    calibration_.reset();
    if (c.model != ODO_CAMERA_PINHOLE && c.model != ODO_CAMERA_KANNALA_BRANDT)
      throw odo::Error(ODO_E_UNSUPPORTED, "camera model " + std::to_string(c.model) + " is unknown to this plugin");
    calibration_ = c;
    return !same;
  }

  const std::optional<odo_calibration>& calibration() const { return calibration_; }
  cv::Size size() const {
    return calibration_ ? cv::Size(static_cast<int>(calibration_->width), static_cast<int>(calibration_->height))
                        : cv::Size();
  }

  /// The lens of a frame: that of the calibration, with the frame's own focal length and principal point if given.
  /// Throws odo::Error (discard) if the frame does not belong to the calibration.
  CameraModel lens_of(const odo_frame& frame) const {
    const auto discard = [](const std::string& text) { throw odo::Error(ODO_E_DISCARD, text); };
    if (!calibration_ || frame.header.source != calibration_->header.source)
      discard("header.source = " + std::to_string(frame.header.source) +
              (calibration_
                   ? "; expected the camera of the last calibration, " + std::to_string(calibration_->header.source)
                   : "; this camera has no calibration"));
    if (frame.width != calibration_->width || frame.height != calibration_->height)
      discard("width x height = " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
              "; expected its calibration's " + std::to_string(calibration_->width) + " x " +
              std::to_string(calibration_->height));
    CameraModel lens = camera_of(*calibration_);
    if (frame.header.flags & ODO_FRAME_INTRINSICS)
      lens.fx = frame.fx, lens.fy = frame.fy, lens.cx = frame.cx, lens.cy = frame.cy;
    return lens;
  }

 private:
  std::optional<odo_calibration> calibration_;
};

/// Grey picture of a frame, without a copy if the format has a grey plane.
inline cv::Mat grey_of(const odo_frame& frame, cv::Mat& converted) {
  const int rows = static_cast<int>(frame.height), columns = static_cast<int>(frame.width);
  auto* data = const_cast<uint8_t*>(frame.planes[0].data);
  const auto stride = static_cast<size_t>(frame.planes[0].row_stride);
  switch (frame.format) {
    case ODO_FORMAT_RGB8:
      cv::cvtColor(cv::Mat(rows, columns, CV_8UC3, data, stride), converted, cv::COLOR_RGB2GRAY);
      return converted;
    case ODO_FORMAT_RGBA8:
      cv::cvtColor(cv::Mat(rows, columns, CV_8UC4, data, stride), converted, cv::COLOR_RGBA2GRAY);
      return converted;
    case ODO_FORMAT_BGRA8:
      cv::cvtColor(cv::Mat(rows, columns, CV_8UC4, data, stride), converted, cv::COLOR_BGRA2GRAY);
      return converted;
    case ODO_FORMAT_GREY8:
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21:
    case ODO_FORMAT_YUV420: return {rows, columns, CV_8UC1, data, stride};
    default:
      throw odo::Error(ODO_E_DISCARD, "format = " + std::to_string(frame.format) + "; expected one of ODO_FORMAT_*");
  }
}

/// The frame's mask (0 = do not use); empty if it has none.
inline cv::Mat mask_of(const odo_frame& frame) {
  if ((frame.header.flags & ODO_FRAME_MASK) == 0 || !frame.mask.data) return {};
  return {static_cast<int>(frame.height), static_cast<int>(frame.width), CV_8UC1, const_cast<uint8_t*>(frame.mask.data),
          static_cast<size_t>(frame.mask.row_stride)};
}

/// The event of a motion that ends with a frame, without the motion itself and the state.
inline odo_vo_motion motion_event(const odo_frame& frame, int64_t from_ns, bool rotation, bool translation,
                                  uint32_t tracked, uint32_t inliers) {
  auto event = odo::make<odo_vo_motion>(frame.header.t_ns);
  event.t_from_ns = from_ns;
  if (rotation) event.header.flags |= ODO_VO_ROTATION;
  if (translation) event.header.flags |= ODO_VO_TRANSLATION | ODO_VO_COVARIANCE;
  event.camera = frame.header.source;
  event.tracked = tracked, event.inliers = inliers;
  event.header.flags |= ODO_FLAG_QUALITY;
  event.header.quality = tracked ? static_cast<float>(inliers) / static_cast<float>(tracked) : 0.0f;
  return event;
}

inline void put_state(Tracking tracking, FailureReason failure, odo_vo_motion& event) {
  event.state = tracking == Tracking::tracking ? ODO_TRACKING : tracking == Tracking::lost ? ODO_LOST : ODO_DEGRADED;
  event.reason = failure == FailureReason::none           ? ODO_REASON_NONE
                 : failure == FailureReason::too_dark     ? ODO_REASON_TOO_DARK
                 : failure == FailureReason::few_features ? ODO_REASON_FEW_FEATURES
                 : failure == FailureReason::no_parallax  ? ODO_REASON_NO_PARALLAX
                                                          : ODO_REASON_INITIALISING;
}

/// Writes a motion and its isotropic uncertainty into an event.
inline void put_motion(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector3d& p_c0_c1, double rotation_sigma_rad,
                       double position_sigma, odo_vo_motion& event) {
  put_quaternion(q_c0_c1, event.q_c0_c1);
  Eigen::Vector3d::Map(event.p_c0_c1) = p_c0_c1;
  for (int i = 0; i < 3; ++i) {
    event.covariance[7 * i] = rotation_sigma_rad * rotation_sigma_rad;
    event.covariance[7 * (i + 3)] = position_sigma * position_sigma;
  }
}

}  // namespace odograph
