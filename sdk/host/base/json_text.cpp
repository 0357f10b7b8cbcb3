// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/json_text.hpp"

#include <cmath>
#include <cstdio>

#include "sdk/math/number_text.hpp"

namespace odograph {

void JsonText::before_value() {
  if (!after_key_) {
    if (!first_) text_ += ',';
    if (depth_ > 0) text_ += '\n' + std::string(static_cast<size_t>(depth_) * 2, ' ');
  }
  first_ = false;
  after_key_ = false;
}

JsonText& JsonText::open(char bracket) {
  before_value();
  text_ += bracket;
  ++depth_;
  first_ = true;
  return *this;
}

JsonText& JsonText::close(char bracket) {
  --depth_;
  if (!first_) text_ += '\n' + std::string(static_cast<size_t>(depth_) * 2, ' ');
  text_ += bracket;
  first_ = false;
  return *this;
}

JsonText& JsonText::key(std::string_view name) {
  before_value();
  raw(name);
  text_ += ": ";
  after_key_ = true;
  return *this;
}

JsonText& JsonText::string(std::string_view text) {
  before_value();
  raw(text);
  return *this;
}

JsonText& JsonText::number(double value) {
  before_value();
  if (!std::isfinite(value)) {
    text_ += "null";
    return *this;
  }
  text_ += number_text(value);
  return *this;
}

JsonText& JsonText::boolean(bool value) {
  before_value();
  text_ += value ? "true" : "false";
  return *this;
}

void JsonText::raw(std::string_view quoted) {
  text_ += '"';
  for (const char c : quoted) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += c;
    } else if (byte < 0x20) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", byte);
      text_ += escaped;
    } else {
      text_ += c;
    }
  }
  text_ += '"';
}

}  // namespace odograph
