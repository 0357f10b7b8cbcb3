// SPDX-License-Identifier: Apache-2.0
//
// Numbers as texts: the fallback functions for C++ libraries without std::from_chars and std::to_chars of double,
// against those of a library that has them.
#include "sdk/math/number_text.hpp"

#include <bit>
#include <clocale>
#include <random>

#include <doctest/doctest.h>

TEST_SUITE_BEGIN("number_text");

namespace {

/// Bit-identical, or none in both.
bool same(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return std::bit_cast<uint64_t>(*a) == std::bit_cast<uint64_t>(*b) || (std::isnan(*a) && std::isnan(*b));
}

/// The fallback uses the C library, which on Windows (msvcrt) rounds incorrectly beyond 1e260. It is not used there.
#if defined(_WIN32)
constexpr bool kRoundsWrongly = true;
#else
constexpr bool kRoundsWrongly = false;
#endif

void check(double value) {
  INFO(value);
  const std::string text = odograph::number_text(value);
  CHECK(odograph::plain::number_text(value) == text);
  CHECK(same(odograph::plain::parse_number(text), odograph::parse_number(text)));
  CHECK(same(odograph::parse_number(text), value));
}

}  // namespace

TEST_CASE("fallback numbers as texts are the standard library's, bit for bit" * doctest::skip(kRoundsWrongly)) {
  for (int power = -1074; power <= 1023; ++power)
    for (const double next : {0.0, -HUGE_VAL, HUGE_VAL}) {
      const double value = std::ldexp(1.0, power);
      check(next == 0.0 ? value : std::nextafter(value, next));
    }
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) check(std::bit_cast<double>(random()));
  for (int i = 0; i < 20'000; ++i)
    check(std::round(std::ldexp(static_cast<double>(random() >> 11), -53) * 1e7) / std::pow(10.0, random() % 12));
  for (int power = -323; power <= 308; ++power) check(std::pow(10.0, power)), check(-std::pow(10.0, power));
  for (const double value :
       {0.0, -0.0, HUGE_VAL, -HUGE_VAL, 123456.0, 1e5, 1e6, 1e22, 1e23, 5e-324, 1.7976931348623157e308})
    check(value);
}

TEST_CASE("a text that is not a number is rejected by every function") {
  for (const char* text : {"",
                           "-",
                           ".",
                           "-.",
                           "e5",
                           "1e",
                           "1e+",
                           "1e-",
                           "+1",
                           " 1",
                           "1 ",
                           "1,5",
                           "0x10",
                           "1.5.2",
                           "--1",
                           "1e5.0",
                           "1.",
                           ".5",
                           "-.5e1",
                           "1E5",
                           "00012",
                           "1e0000005",
                           "inf",
                           "-inf",
                           "INFINITY",
                           "nan",
                           "-NaN",
                           "infin",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "0e400",
                           "0.0e-999999999999",
                           "1e999999999999",
                           "123456789012345678901234567890",
                           "2.2250738585072011e-308",
                           "9007199254740993",
                           "0.1f"}) {
    INFO(text);
    CHECK(same(odograph::plain::parse_number(text), odograph::parse_number(text)));
  }
  CHECK_FALSE(odograph::parse_number("1,5"));
  CHECK(*odograph::parse_number("-1.5e3") == -1500);
}

TEST_CASE("numbers as texts have a decimal point in every locale") {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8", "C"}) {
    if (!std::setlocale(LC_NUMERIC, name)) continue;
    CHECK(odograph::plain::number_text(-0.125) == "-0.125");
    CHECK(odograph::plain::number_text(1.25e-9) == "1.25e-09");
    CHECK(same(odograph::plain::parse_number("0.125"), 0.125));
  }
  std::setlocale(LC_NUMERIC, before.c_str());
}

TEST_SUITE_END();
