// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sdk/tools/recording/message_log.hpp"

namespace odograph {

struct LoggedMessage;

/// A message's fields, asked for in the order of its definition and by their names: by order where the encoding is
/// binary (ROS 1; CDR as ROS 2 writes it, little-endian), by name in JSON ("a/b": within; "A|a": either). What is not
/// there is 0, and good() is false from then on.
class LogFields {
 public:
  virtual ~LogFields() = default;
  /// std_msgs/Header: the stamp and whose axes.
  virtual void header(LoggedMessage& out) = 0;
  /// Foxglove's `timestamp` and `frame_id`.
  virtual void stamp(LoggedMessage& out) = 0;
  /// `count` numbers, each of 8 bytes; in JSON a number, a list, or x, y, z, w.
  virtual void numbers(const char* name, double* out, size_t count) = 0;
  /// The same; JSON may leave them out.
  virtual void optional_numbers(const char* name, double* out, size_t count) = 0;
  virtual std::vector<double> list(const char* name) = 0;
  virtual uint8_t byte(const char* name) = 0;
  virtual uint16_t half(const char* name) = 0;
  virtual uint32_t word(const char* name) = 0;
  virtual std::string text(const char* name) = 0;
  /// Base64 in JSON. Skipped where pixels are not asked for.
  virtual void bytes(const char* name, std::vector<unsigned char>& out) = 0;
  /// A list of messages: how many, and from which the fields that follow are.
  virtual size_t begin_list(const char* name) = 0;
  virtual void item(size_t number) = 0;
  bool good() const { return good_; }

 protected:
  bool good_ = true;
};

/// Encodings "ros1", "cdr", "json". `bytes` live as long as the fields.
std::unique_ptr<LogFields> log_fields(const std::string& encoding, Bytes bytes, bool with_pixels);

}  // namespace odograph
