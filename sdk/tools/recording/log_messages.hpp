// SPDX-License-Identifier: Apache-2.0
//
// Decodes single messages of bags and MCAP files: sensor_msgs in the encodings of ROS 1, ROS 2 (CDR) and JSON, and
// Foxglove's schemas as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/recording/message_log.hpp"

namespace odograph {

/// One decoded message. Only the members of its type are set.
struct LoggedMessage {
  int64_t t_ns = 0;   ///< its own time stamp; 0: none
  std::string frame;  ///< the coordinate frame
  /// Imu, MagneticField, FluidPressure, NavSatFix, CameraInfo; type 0: none, or invalid. Its time is not set.
  AnyMessage message;
  std::string lens_fault;  ///< of a CameraInfo: why its lens is refused
  /// A picture: PNG or JPEG unchanged, or pixels in an `encoding` as ROS names them.
  struct Picture {
    std::string encoding;  ///< "": a file format
    uint32_t width = 0, height = 0, step = 0;
    std::vector<unsigned char> bytes;  ///< empty if not requested
  };
  std::optional<Picture> picture;
  /// From the child frame to the parent frame.
  struct Transform {
    std::string parent, child;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
  };
  std::vector<Transform> transforms;
};

/// Why messages of this topic are not decoded, such as "of an unsupported type"; empty if they are.
std::string unsupported_reason(const LogTopic& topic);

/// Fails with ODO_E_DATA, without a file name, if the message is shorter than its type or invalid JSON.
Result<LoggedMessage> decode_logged(const LogTopic& topic, Bytes bytes, bool with_pixels);

/// Grey or BGR; empty if undecodable.
cv::Mat image_of(const LoggedMessage::Picture& picture);
/// Whether pixels of this encoding are supported.
bool is_supported_encoding(const std::string& encoding);

}  // namespace odograph
