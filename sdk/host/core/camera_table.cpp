// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/camera_table.hpp"

#include <cstring>

#include "sdk/math/rotation.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

void CameraTable::take_calibration(odo_calibration& c) {
  const bool replaces = configured_ && configured_->header.source == c.header.source;
  const uint32_t given = replaces ? configured_->header.flags : 0;
  if (replaces) {
    constexpr uint32_t optional = ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET | ODO_CALIBRATION_LINE_TIME;
    const odo_calibration pushed = copy_as<odo_calibration>(c.header);
    const odo_header header = c.header;
    std::memcpy(static_cast<void*>(&c), &*configured_, sizeof c);
    c.header = header;
    c.header.flags |= given & optional;
    if (!(given & ODO_CALIBRATION_EXTRINSICS)) {
      std::memcpy(c.q_b_c, pushed.q_b_c, sizeof c.q_b_c);
      std::memcpy(c.p_b_c, pushed.p_b_c, sizeof c.p_b_c);
    }
    if (!(given & ODO_CALIBRATION_TIME_OFFSET)) c.time_offset_ns = pushed.time_offset_ns;
    if (!(given & ODO_CALIBRATION_LINE_TIME)) c.line_time_ns = pushed.line_time_ns;
  }
  {
    const std::lock_guard lock(mutex_);
    Camera& camera = cameras_[c.header.source];
    camera.calibration = copy_as<odo_calibration>(c.header);
    camera.config_line_time = (given & ODO_CALIBRATION_LINE_TIME) != 0;
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS)
      camera.mount = Mount{quaternion(c.q_b_c), Eigen::Vector3d(c.p_b_c)};
  }
  c.header.flags &= ~ODO_CALIBRATION_TIME_OFFSET;
  c.time_offset_ns = 0;
}

std::optional<CameraTable::Camera> CameraTable::find(uint32_t source) const {
  const std::lock_guard lock(mutex_);
  const auto found = cameras_.find(source);
  return found == cameras_.end() ? std::nullopt : std::optional(found->second);
}

std::string CameraTable::complete(odo_frame& frame) const {
  const auto camera = find(frame.header.source);
  if (!camera) return "";
  if (std::string fault = size_fault(*camera, frame); !fault.empty()) return fault;
  const odo_calibration& known = camera->calibration;
  if (known.header.flags & ODO_CALIBRATION_TIME_OFFSET)
    frame.header.t_ns = saturating_sum(frame.header.t_ns, known.time_offset_ns);
  const bool has_line_time = (frame.header.flags & ODO_FRAME_LINE_TIME) && !camera->config_line_time;
  if ((known.header.flags & ODO_CALIBRATION_LINE_TIME) && !has_line_time) {
    frame.line_time_ns = known.line_time_ns;
    frame.header.flags |= ODO_FRAME_LINE_TIME;
  }
  return "";
}

std::string CameraTable::size_fault(const Camera& camera, const odo_frame& frame) {
  const odo_calibration& known = camera.calibration;
  if ((frame.header.flags & ODO_FRAME_INTRINSICS) || (known.width == frame.width && known.height == frame.height))
    return "";
  const auto size = [](uint32_t w, uint32_t h) { return std::to_string(w) + " x " + std::to_string(h); };
  return "it has " + size(frame.width, frame.height) + " pixels; the calibration of camera " +
         std::to_string(frame.header.source) + " is for " + size(known.width, known.height);
}

std::optional<odo_calibration> CameraTable::calibration(uint32_t source) const {
  const auto camera = find(source);
  return camera ? std::optional(camera->calibration) : std::nullopt;
}

std::optional<CameraTable::Mount> CameraTable::mount(uint32_t source) const {
  const auto camera = find(source);
  return camera ? camera->mount : std::nullopt;
}

}  // namespace odograph
