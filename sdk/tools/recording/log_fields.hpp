// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sdk/tools/recording/message_log.hpp"

namespace odograph {

struct LoggedMessage;

/// Access to a message's fields, in the order of its definition and by name: binary encodings (ROS 1; CDR as written by
/// ROS 2, little-endian) use the order, JSON the names ("a/b": nested; "A|a": either). A missing field is 0 and makes
/// good() false.
class LogFields {
 public:
  virtual ~LogFields() = default;
  /// std_msgs/Header, or in JSON Foxglove's `timestamp` and `frame_id`: the time stamp and the frame.
  virtual void header(LoggedMessage& out) = 0;
  /// `count` numbers of 8 bytes each; in JSON a number, a list, or x, y, z, w.
  virtual void numbers(const char* name, double* out, size_t count) = 0;
  /// The same, optional in JSON.
  virtual void optional_numbers(const char* name, double* out, size_t count) = 0;
  virtual std::vector<double> list(const char* name) = 0;
  virtual uint8_t byte(const char* name) = 0;
  virtual uint16_t half(const char* name) = 0;
  virtual uint32_t word(const char* name) = 0;
  virtual std::string text(const char* name) = 0;
  /// Base64 in JSON. Skipped if pixels are not requested.
  virtual void bytes(const char* name, std::vector<unsigned char>& out) = 0;
  /// Enters a list of messages and returns its size; the following fields are its items'.
  virtual size_t begin_list(const char* name) = 0;
  virtual void item(size_t number) = 0;
  bool good() const { return good_; }

 protected:
  bool good_ = true;
};

/// Encodings "ros1", "cdr", "json". `bytes` must outlive the fields.
std::unique_ptr<LogFields> log_fields(const std::string& encoding, Bytes bytes, bool with_pixels);

}  // namespace odograph
