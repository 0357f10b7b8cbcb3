// SPDX-License-Identifier: Apache-2.0
//
// Basic utilities: texts, saturating times, the Earth, a value read while it is written.
#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/base/json_text.hpp"
#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/base/snapshot.hpp"
#include "sdk/host/core/sensor_watch.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("texts");

TEST_CASE("the edit distance counts insertions, deletions and substitutions, case-insensitively") {
  struct Case {
    const char *a, *b;
    int distance;
  };
  for (const Case& c : {Case{"", "", 0},
                        {"", "abc", 3},
                        {"abc", "", 3},
                        {"abc", "abc", 0},
                        {"ABC", "abc", 0},
                        {"kitten", "sitting", 3},
                        {"flaw", "lawn", 2},
                        {"abc", "acb", 2},
                        {"abcd", "bcd", 1}}) {
    CAPTURE(c.a);
    CAPTURE(c.b);
    CHECK(edit_distance(c.a, c.b) == c.distance);
    CHECK(edit_distance(c.b, c.a) == c.distance);
  }
  CHECK(nearest("hight", {"weight", "height", "fight"}) == "height");  // the first of equals
  CHECK(nearest("bbb", {"abb", "bba"}) == "abb");
  CHECK(nearest("x", {}).empty());
  CHECK(did_you_mean("abxx", {"abcd"}) == "; did you mean 'abcd'?");  // 2 of 4: (4 + 1) / 2 are near
  CHECK(did_you_mean("axxx", {"abcd"}).empty());
  CHECK(did_you_mean("xxxde", {"abcde"}) == "; did you mean 'abcde'?");  // 3 of 5
  CHECK(did_you_mean("xxxxe", {"abcde"}).empty());
  CHECK(did_you_mean("x", {}).empty());
}

TEST_CASE("texts are joined with a separator, and split without empty parts") {
  CHECK(join({"a", "b", "c"}) == "a, b, c");
  CHECK(join({"a", "b"}, "|") == "a|b");
  CHECK(join({}).empty());
  CHECK(split("a:b:c", ':') == std::vector<std::string>{"a", "b", "c"});
  CHECK(split(":a::b:", ':') == std::vector<std::string>{"a", "b"});
  CHECK(split("", ':').empty());
}

TEST_CASE("JSON has commas, indentation, escapes and the shortest digits") {
  JsonText json;
  json.open('{').key("a").number(0.1).key("b").open('[').number(1).number(-2.5e-300).boolean(true).boolean(false);
  json.close(']').key("c").open('{').close('}').key("d\"\\").string("x\n\x1f\"\\/\xc3\xa4");
  json.key("e").number(std::numeric_limits<double>::infinity()).key("f").number(std::nan(""));
  json.key("g").open('[').close(']').close('}');
  CHECK(json.text() ==
        "{\n  \"a\": 0.1,\n  \"b\": [\n    1,\n    -2.5e-300,\n    true,\n    false\n  ],\n  \"c\": {},\n"
        "  \"d\\\"\\\\\": \"x\\u000a\\u001f\\\"\\\\/\xc3\xa4\",\n  \"e\": null,\n  \"f\": null,\n  \"g\": []\n}");
}

TEST_CASE("every control character is escaped, and nothing else is changed") {
  for (int c = 0; c < 256; ++c) {
    const std::string one(1, static_cast<char>(c));
    const bool shown = (c < 0x20 && c != '\n') || c == 0x7f;
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\x%02X", c);
    CHECK(printable(one) == (shown ? escaped : one));
    const std::string behind = "\xc2" + one;  // U+0080 to U+009F are control characters too
    std::snprintf(escaped, sizeof escaped, "\\x%02X", c);
    if (c >= 0x80 && c < 0xC0) CHECK(printable(behind) == (c < 0xA0 ? escaped : behind));
  }
  CHECK(printable("\xc2") == "\xc2");
  CHECK(printable("a\xc2\x9b"
                  "b") ==
        "a\\x9B"
        "b");
}

TEST_CASE("a line from outside is whole characters of UTF-8, without cursor movements or line breaks") {
  CHECK(one_line("a\nb\x1b[1m\xc2\x85\xe2\x82\xac", 100) == "a b\\x1B[1m\\x85\xe2\x82\xac");
  CHECK(one_line("\xc0\xaf \xe0\x80\xaf \xed\xa0\x80 \xf4\x90\x80\x80 \xc3", 100) ==
        "\\xC0\\xAF \\xE0\\x80\\xAF \\xED\\xA0\\x80 \\xF4\\x90\\x80\\x80 \\xC3");
  CHECK(one_line("\xe2\x82\xac\xe2\x82\xac", 5) == "\xe2\x82\xac");
  CHECK(one_line("ab\x01", 5) == "ab");
  CHECK(utf8_character("") == 0);
  for (const auto& [text, bytes] : {std::pair{"a", 1}, {"\xc3\xa4", 2}, {"\xed\x9f\xbf", 3}, {"\xf4\x8f\xbf\xbf", 4}}) {
    CHECK(utf8_character(text) == static_cast<size_t>(bytes));
    CHECK(whole_characters(text, 3) == (bytes > 3 ? "" : text));
  }
  char field[4];
  copy_text(field, "ab\xc3\xa4");
  CHECK(std::string(field) == "ab");
}

TEST_CASE("differences and sums of times saturate at the ends of the range") {
  constexpr int64_t least = INT64_MIN, most = INT64_MAX;
  CHECK(saturating_difference(5, 3) == 2);
  CHECK(saturating_difference(3, 5) == -2);
  CHECK(saturating_difference(most, -1) == most);
  CHECK(saturating_difference(least, 1) == least);
  CHECK(saturating_difference(most, 0) == most);
  CHECK(saturating_difference(0, least) == most);
  CHECK(saturating_difference(-1, least) == most);
  CHECK(saturating_difference(-2, most) == least);
  CHECK(saturating_sum(5, -3) == 2);
  CHECK(saturating_sum(most, 1) == most);
  CHECK(saturating_sum(1, most) == most);
  CHECK(saturating_sum(least, -1) == least);
  CHECK(saturating_sum(-1, least) == least);
  CHECK(saturating_sum(most, least) == -1);
}

TEST_CASE("the frame n is North-East-Down at its origin on WGS 84, and the conversion is invertible") {
  Geodesy earth;
  CHECK_FALSE(earth.has_origin());
  const double latitude = 0.9, longitude = -0.2, height = 100;
  earth.set_origin({latitude, longitude, height});
  CHECK(earth.has_origin());
  // Radii of curvature of the ellipsoid in closed form.
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), s = std::sin(latitude);
  const double meridian = a * (1 - e2) / std::pow(1 - e2 * s * s, 1.5), normal = a / std::sqrt(1 - e2 * s * s);
  constexpr double step = 1e-6;
  const auto north = earth.from_geodetic({latitude + step, longitude, height});
  const auto east = earth.from_geodetic({latitude, longitude + step, height});
  const auto up = earth.from_geodetic({latitude, longitude, height + 10});
  CHECK(north[0] == doctest::Approx((meridian + height) * step).epsilon(1e-6));
  CHECK(std::abs(north[1]) < 1e-6);
  CHECK(east[1] == doctest::Approx((normal + height) * std::cos(latitude) * step).epsilon(1e-6));
  CHECK(std::abs(east[0]) < 1e-4);
  CHECK(up[2] == doctest::Approx(-10).epsilon(1e-9));
  const std::array<double, 3> p = {120, -340, 25};
  const auto back = earth.from_geodetic(earth.to_geodetic(p));
  for (int i = 0; i < 3; ++i) CHECK(std::abs(back[i] - p[i]) < 1e-6);
  earth.set_origin({0.1, 0.2, 0});
  const auto origin = earth.to_geodetic({0, 0, 0});
  CHECK(origin[0] == doctest::Approx(0.1).epsilon(1e-12));
  CHECK(origin[1] == doctest::Approx(0.2).epsilon(1e-12));
}

TEST_CASE("a snapshot reads the last written value, and zero before") {
  struct Value {
    uint64_t a, b, c;
  };
  Snapshot<Value> snapshot;
  CHECK(snapshot.read().b == 0);
  for (uint64_t i = 1; i < 6; ++i) {
    snapshot.write({i, 10 * i, 100 * i});
    const Value v = snapshot.read();
    CHECK((v.a == i && v.b == 10 * i && v.c == 100 * i));
  }
}

TEST_CASE("a sensor is silent beyond the longest gap, not at it, and each gap counts once") {
  constexpr int64_t gap = 500'000'000;
  const auto see = [](SensorWatch& watch, uint32_t type, int64_t t_ns) {
    odo_header h{};
    h.type = type, h.t_ns = t_ns;
    watch.on_message(h);
  };
  for (const uint32_t type : {ODO_TYPE_IMU, ODO_TYPE_FRAME}) {
    const uint32_t other = type == ODO_TYPE_IMU ? ODO_TYPE_FRAME : ODO_TYPE_IMU;
    SensorWatch watch(0.5);
    const auto silent = [&](uint32_t of) { return of == ODO_TYPE_IMU ? watch.imu_silent() : watch.camera_silent(); };
    see(watch, ODO_TYPE_BAROMETER, 0);
    CHECK_FALSE(watch.recent(INT64_MIN));
    see(watch, ODO_TYPE_BAROMETER, 9 * gap);
    CHECK((!watch.imu_silent() && !watch.camera_silent()));  // never received
    see(watch, type, 10 * gap);
    see(watch, other, 11 * gap);
    CHECK((!silent(type) && watch.recent(10 * gap)));
    see(watch, ODO_TYPE_BAROMETER, 11 * gap + 1);
    CHECK((silent(type) && !silent(other) && !watch.recent(10 * gap)));
    CHECK(watch.gaps() == 0);
    see(watch, type, 11 * gap);  // at the gap: none; an older sample does not set the time back
    CHECK(watch.gaps() == 0);
    CHECK(watch.now_ns() == 11 * gap + 1);
    see(watch, type, 12 * gap + 1);
    CHECK(watch.gaps() == 1);
    see(watch, type, 12 * gap + 2);
    CHECK(watch.gaps() == 1);
    watch.reset();
    CHECK((watch.now_ns() == INT64_MIN && !silent(type) && !silent(other)));
    see(watch, type, 0);
    CHECK((watch.now_ns() == 0 && watch.gaps() == 1));
  }
}
