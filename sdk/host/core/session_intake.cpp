// SPDX-License-Identifier: Apache-2.0
//
// Inputs as the session keeps them: borrowed memory retained or copied, cameras on the IMU's clock.
#include <cstring>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/core/session.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// Borrowed memory is retained or copied, times are brought onto the IMU's clock.
int32_t Session::own(AnyMessage&& sample, OwnedMessage& out) {
  const uint32_t type = sample.header().type;
  if (type == ODO_TYPE_CALIBRATION) take_calibration(reinterpret_cast<odo_calibration&>(sample.header()));
  if (type == ODO_TYPE_FRAME)
    if (const std::string fault = size_fault(as<odo_frame>(sample.header())); !fault.empty())
      return refuse_invalid(sample.header(), ODO_E_DISCARD, fault);
  if (ODO_IS_BORROWED(type))
    if (const int32_t status = borrow(reinterpret_cast<odo_borrowed&>(sample.header())); status < 0) return status;
  if (type == ODO_TYPE_FRAME) put_timing(reinterpret_cast<odo_frame&>(sample.header()));
  out = OwnedMessage(std::move(sample));
  return ODO_OK;
}

int32_t Session::borrow(odo_borrowed& message) {
  const int32_t status = frames_.adopt(message);
  if (status == ODO_E_DISCARD)
    return refuse_invalid(message.header, status, "a plane's row_stride is smaller than its row");
  if (status == ODO_E_UNSUPPORTED)
    return refuse_invalid(message.header, status, "it cannot be copied and has no retain and release");
  if (status < 0) {
    ++intake_.overflow;
    host_.report(0, ODO_SEVERITY_WARNING, "dropped_" + message_name(message.header.type),
                 "a sample of " + message_name(message.header.type) +
                     " was dropped: all that may be retained are still in use: they come faster than they are "
                     "processed, or its retain refused",
                 status);
  }
  return status;
}

/// Brings a calibration to what plugins are given: the config's values replace those that are pushed (mount, time
/// offset and row time only where the config has them), and the time offset, which the session applies, is taken out.
void Session::take_calibration(odo_calibration& c) {
  const auto& own = config_.camera;
  const bool configured = own && own->header.source == c.header.source;
  if (configured) {
    constexpr uint32_t optional = ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET | ODO_CALIBRATION_LINE_TIME;
    const odo_calibration pushed = copy_as<odo_calibration>(c.header);
    const odo_header header = c.header;
    std::memcpy(static_cast<void*>(&c), &*own, sizeof c);
    c.header = header;
    c.header.flags = header.flags | (own->header.flags & optional);
    if (!(own->header.flags & ODO_CALIBRATION_EXTRINSICS)) {
      std::memcpy(c.q_b_c, pushed.q_b_c, sizeof c.q_b_c);
      std::memcpy(c.p_b_c, pushed.p_b_c, sizeof c.p_b_c);
    }
    if (!(own->header.flags & ODO_CALIBRATION_TIME_OFFSET)) c.time_offset_ns = pushed.time_offset_ns;
    if (!(own->header.flags & ODO_CALIBRATION_LINE_TIME)) c.line_time_ns = pushed.line_time_ns;
  }
  note_camera(c, configured && (own->header.flags & ODO_CALIBRATION_LINE_TIME));
  c.header.flags &= ~ODO_CALIBRATION_TIME_OFFSET;
  c.time_offset_ns = 0;
}

void Session::note_camera(const odo_calibration& calibration, bool line_time_above_frames) {
  const std::lock_guard lock(mutex_);
  const uint32_t flags = calibration.header.flags;
  Camera& camera = cameras_[calibration.header.source];
  camera.width = calibration.width;
  camera.height = calibration.height;
  camera.offset_ns = flags & ODO_CALIBRATION_TIME_OFFSET ? calibration.time_offset_ns : 0;
  camera.line_time_ns = calibration.line_time_ns;
  camera.line_time = (flags & ODO_CALIBRATION_LINE_TIME) != 0;
  camera.above_frames = line_time_above_frames;
  if (flags & ODO_CALIBRATION_EXTRINSICS)
    camera.q_b_c = quaternion(calibration.q_b_c), camera.p_b_c = Eigen::Vector3d(calibration.p_b_c);
}

/// From here on everything runs on the IMU's clock: a camera's frames are shifted as they come in. A frame that does
/// not tell its row time gets the calibration's.
void Session::put_timing(odo_frame& frame) {
  const std::lock_guard lock(mutex_);
  const auto found = cameras_.find(frame.header.source);
  if (found == cameras_.end()) return;
  const Camera& timing = found->second;
  frame.header.t_ns = saturating_sum(frame.header.t_ns, timing.offset_ns);
  if (!timing.line_time || (!timing.above_frames && (frame.header.flags & ODO_FRAME_LINE_TIME))) return;
  frame.line_time_ns = timing.line_time_ns;
  frame.header.flags |= ODO_FRAME_LINE_TIME;
}

/// A lens is known for one size of picture, unless the frame brings its own intrinsics.
std::string Session::size_fault(const odo_frame& frame) const {
  const std::lock_guard lock(mutex_);
  const auto found = cameras_.find(frame.header.source);
  if (found == cameras_.end() || (frame.header.flags & ODO_FRAME_INTRINSICS)) return "";
  const Camera& camera = found->second;
  if (camera.width == frame.width && camera.height == frame.height) return "";
  const auto size = [](uint32_t w, uint32_t h) { return std::to_string(w) + " x " + std::to_string(h); };
  return "it has " + size(frame.width, frame.height) + " pixels; the calibration of camera " +
         std::to_string(frame.header.source) + " is for " + size(camera.width, camera.height);
}

}  // namespace odograph
