// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace odograph {

/// Writes indented JSON text in the order of the calls. The host core writes three small files with it; reading and
/// larger files use libraries.
class JsonText {
 public:
  JsonText& open(char bracket);
  JsonText& close(char bracket);
  JsonText& key(std::string_view name);
  JsonText& string(std::string_view text);
  JsonText& number(double value);  // shortest round-trip text; null if not finite
  JsonText& boolean(bool value);
  const std::string& text() const { return text_; }

 private:
  void before_value();
  void raw(std::string_view quoted);

  std::string text_;
  int depth_ = 0;
  bool first_ = true;
  bool after_key_ = false;
};

}  // namespace odograph
