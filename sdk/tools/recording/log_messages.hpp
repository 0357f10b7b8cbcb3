// SPDX-License-Identifier: Apache-2.0
//
// What single messages of bags and MCAP files hold: sensor_msgs as ROS 1, ROS 2 (CDR) and JSON encode them, and
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

/// One decoded message. Only what its type has is set.
struct LoggedMessage {
  int64_t t_ns = 0;   ///< its own stamp; 0: none
  std::string frame;  ///< whose axes it has
  /// Imu, MagneticField, FluidPressure, NavSatFix, CameraInfo; type 0: none, or not valid. Its time is not set.
  AnyMessage message;
  /// A picture: PNG or JPEG as it is, or pixels of an `encoding` as ROS names them.
  struct Picture {
    std::string encoding;  ///< "": a file format
    uint32_t width = 0, height = 0, step = 0;
    std::vector<unsigned char> bytes;  ///< empty where it was not asked for
  };
  std::optional<Picture> picture;
  /// From the child's axes to the parent's.
  struct Transform {
    std::string parent, child;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
  };
  std::vector<Transform> transforms;
};

/// Whether messages of this topic are decoded; what keeps them from it is in words otherwise: "of an unknown type".
std::string why_not_read(const LogTopic& topic);

/// Failure (ODO_E_DATA, no file in it): shorter than its type, or no JSON.
Result<LoggedMessage> decode_logged(const LogTopic& topic, Bytes bytes, bool with_pixels);

/// Grey or BGR; empty where it cannot be decoded.
cv::Mat image_of(const LoggedMessage::Picture& picture);
/// Whether pixels of this encoding are read.
bool knows_encoding(const std::string& encoding);

}  // namespace odograph
