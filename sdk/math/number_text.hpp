// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

// Conversion between numbers and text, the same in every locale and standard library. std::from_chars and std::to_chars
// of double are missing, in whole or in part, from the libraries of Android, Apple and WebAssembly.
namespace odograph {

/// Plain C++ versions, bit-identical to the standard functions (tests/host/numbers_test.cpp compares them).
namespace plain {

inline size_t digits_at(std::string_view text, size_t from) {
  size_t end = from;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
  return end - from;
}

inline bool equals_ignoring_case(std::string_view text, std::string_view lower) {
  return text.size() == lower.size() && std::equal(text.begin(), text.end(), lower.begin(), [](char a, char b) {
           return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
         });
}

inline std::optional<double> parse_number(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const double sign = negative ? -1 : 1;
  if (equals_ignoring_case(text, "inf") || equals_ignoring_case(text, "infinity"))
    return sign * std::numeric_limits<double>::infinity();
  if (equals_ignoring_case(text, "nan")) return std::copysign(std::numeric_limits<double>::quiet_NaN(), sign);
  const size_t whole = digits_at(text, 0);
  size_t at = whole, fraction = 0;
  if (at < text.size() && text[at] == '.') fraction = digits_at(text, ++at), at += fraction;
  if (whole + fraction == 0) return std::nullopt;
  int exponent = 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const bool below = text.substr(++at).starts_with('-');
    if (below || text.substr(at).starts_with('+')) ++at;
    const size_t digits = digits_at(text, at);
    if (digits == 0) return std::nullopt;
    constexpr int kFarthest = 100'000'000;  // an exponent beyond the range of double, whatever the digits
    for (const size_t end = at + digits; at < end; ++at)
      exponent = std::min(kFarthest, 10 * exponent + (text[at] - '0'));
    if (below) exponent = -exponent;
  }
  if (at != text.size()) return std::nullopt;
  // Without a decimal point, which depends on the locale.
  std::string digits(text.substr(0, whole));
  if (fraction > 0) digits += text.substr(whole + 1, fraction);
  const bool zero = digits.find_first_not_of('0') == std::string::npos;
  digits += 'e' + std::to_string(int64_t{exponent} - static_cast<int64_t>(fraction));
  const double value = std::strtod(digits.c_str(), nullptr);
  if (!std::isfinite(value) || (value == 0 && !zero)) return std::nullopt;
  return sign * value;
}

/// The fewest digits that parse back to `value` (positive, finite), and the power of ten of the first digit.
struct Decimal {
  std::string digits;
  int exponent;
};

inline Decimal shortest_decimal(double value) {
  for (int precision = 0;; ++precision) {
    std::array<char, 40> text;
    std::snprintf(text.data(), text.size(), "%.*e", precision, value);
    const std::string_view printed(text.data());
    const size_t e = printed.find('e');
    Decimal decimal{std::string(1, printed[0]), std::atoi(printed.data() + e + 1)};
    if (precision > 0)
      decimal.digits += printed.substr(e - static_cast<size_t>(precision), static_cast<size_t>(precision));
    const auto back = [&](const std::string& digits) {
      return parse_number(digits + 'e' + std::to_string(decimal.exponent - precision)) == value;
    };
    if (precision >= std::numeric_limits<double>::max_digits10 - 1 || back(decimal.digits)) return decimal;
    // Doubles are twice as dense below a power of two as above it, so the next digits may be the nearest.
    std::string next = decimal.digits;
    if (int power = 0; std::frexp(value, &power) == 0.5 && next.back() != '9' && (++next.back(), back(next)))
      return {next, decimal.exponent};
  }
}

inline std::string number_text(double value) {
  if (std::isnan(value)) return std::signbit(value) ? "-nan" : "nan";
  const std::string sign = std::signbit(value) ? "-" : "";
  value = std::abs(value);
  if (std::isinf(value)) return sign + "inf";
  if (value == 0) return sign + "0";
  auto [digits, exponent] = shortest_decimal(value);
  digits.erase(digits.find_last_not_of('0') + 1);
  const int count = static_cast<int>(digits.size());
  std::string fixed;
  if (exponent >= count - 1) {
    std::array<char, 400> whole;
    std::snprintf(whole.data(), whole.size(), "%.0f", value);
    fixed = whole.data();
  } else if (exponent >= 0) {
    fixed =
        digits.substr(0, static_cast<size_t>(exponent) + 1) + '.' + digits.substr(static_cast<size_t>(exponent) + 1);
  } else {
    fixed = "0." + std::string(static_cast<size_t>(-exponent - 1), '0') + digits;
  }
  std::string power = std::to_string(std::abs(exponent));
  if (power.size() < 2) power.insert(0, "0");
  const std::string scientific =
      digits.substr(0, 1) + (count > 1 ? "." + digits.substr(1) : "") + (exponent < 0 ? "e-" : "e+") + power;
  return sign + (fixed.size() <= scientific.size() ? fixed : scientific);
}

}  // namespace plain

/// Parses the whole text as a number: an optional '-', digits with at most one '.', an optional exponent; or inf,
/// infinity, nan. Correctly rounded. Nothing if the text has any other form or surrounding characters, or if the value
/// is out of range for a double.
inline std::optional<double> parse_number(std::string_view text) {
#if defined(__cpp_lib_to_chars)
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
#else
  return plain::parse_number(text);
#endif
}

/// The shortest text that parse_number() converts back to `value`, without an exponent where that is no longer.
inline std::string number_text(double value) {
#if defined(__cpp_lib_to_chars)
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
#else
  return plain::number_text(value);
#endif
}

}  // namespace odograph
