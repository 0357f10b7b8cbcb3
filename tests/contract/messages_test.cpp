// SPDX-License-Identifier: Apache-2.0
//
// Validation of messages: every number of every type in turn, at and beside its limits.
#include <regex>

#include <odograph/plugin_messages.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/validator/message_fields.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("messages");

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

const uint8_t kPixel = 0;

/// A valid message with all flags set, all numbers different from zero.
AnyMessage good(uint32_t type) {
  alignas(8) unsigned char zero[ODO_LARGEST_MESSAGE] = {};
  auto& header = *reinterpret_cast<odo_header*>(zero);
  header.struct_size = static_cast<uint32_t>(message_info(type)->size);
  header.type = type;
  header.t_ns = 1000;
  AnyMessage made(header);
  auto* bytes = reinterpret_cast<unsigned char*>(&made.header());
  for (const MessageField& field : kMessageFields) {
    if (field.type != type) continue;
    auto* values = reinterpret_cast<double*>(bytes + field.offset);
    const double value =
        field.rule == Rule::direction ? std::sqrt(1.0 / 3) : 0.5;  // four of these are a unit quaternion
    for (size_t i = 0; i < field.count(); ++i) values[i] = value;
    const size_t rows = field.count() == 36 ? 6 : 3;
    for (size_t i = 0; field.rule == Rule::matrix && i < field.count(); ++i)
      values[i] = i % (rows + 1) == 0 ? 0.5 : 0.0;
    made.header().flags |= field.flag;
  }
  if (type == ODO_TYPE_FRAME) {
    auto& m = reinterpret_cast<odo_frame&>(made.header());
    m.width = m.height = 1, m.format = ODO_FORMAT_GREY8;
    for (odo_plane& plane : m.planes) plane.data = &kPixel;
    m.mask.data = &kPixel;
    m.header.flags |= ODO_FRAME_MASK;
  }
  if (type == ODO_TYPE_CALIBRATION) {
    auto& m = reinterpret_cast<odo_calibration&>(made.header());
    m.width = m.height = 1, m.model = ODO_CAMERA_PINHOLE;
  }
  if (type == ODO_TYPE_SURFACE) {  // without an outline
    auto& m = reinterpret_cast<odo_surface&>(made.header());
    m.id = 1, m.kind = ODO_SURFACE_FLOOR, m.state = ODO_SURFACE_WITHDRAWN;
    m.stride = sizeof(odo_vertex), m.offset = sizeof m;
  }
  if (type == ODO_TYPE_KEY_FRAME) reinterpret_cast<odo_key_frame&>(made.header()).id = 1;
  if (type == ODO_TYPE_MAP_POSE) reinterpret_cast<odo_map_pose&>(made.header()).map = 1;
  if (type == ODO_TYPE_STEP) reinterpret_cast<odo_step&>(made.header()).t_end_ns = 1;
  return made;
}

std::string fault_with(const MessageField& field, size_t i, double value, uint32_t cleared = 0) {
  AnyMessage m = good(field.type);
  reinterpret_cast<double*>(reinterpret_cast<unsigned char*>(&m.header()) + field.offset)[i] = value;
  m.header().flags &= ~(cleared | flags_that_need(field.type, cleared));
  return message_fault(m.header());
}

std::set<uint32_t> judged_types() {
  std::set<uint32_t> types;
  for (const MessageField& field : kMessageFields) types.insert(field.type);
  return types;
}

}  // namespace

namespace {

/// Checks that each double of a struct in the ABI's headers is listed; returns their number.
size_t check_listed(uint32_t type, const std::string& name) {
  static const std::string text =
      read_text(source("abi/include/odograph/samples.h")) + read_text(source("abi/include/odograph/events.h"));
  static const std::regex member("double ([^;]+);"), field("([a-z_][a-z_0-9]*)(\\[[0-9]+\\])?");
  const size_t begin = text.find("typedef struct " + name + " {"), end = text.find("} " + name + ";");
  REQUIRE(begin < end);
  const std::string body = text.substr(begin, end - begin);
  size_t found = 0;
  for (std::sregex_iterator m(body.begin(), body.end(), member), none; m != none; ++m) {
    const std::string list = (*m)[1];
    for (std::sregex_iterator f(list.begin(), list.end(), field); f != none; ++f, ++found) {
      const std::string one = (*f)[1];
      CAPTURE(name);
      CAPTURE(one);
      CHECK(std::count_if(std::begin(kMessageFields), std::end(kMessageFields),
                          [&](const MessageField& each) { return each.type == type && each.name == one; }) == 1);
    }
  }
  return found;
}

}  // namespace

TEST_CASE("every floating-point field of every external message is in the table of this test") {
  size_t found = 0;
#define ODO_ROW(number, message, plain, min_size)                                    \
  if (number != ODO_TYPE_POSE && number != ODO_TYPE_CORRECTION) /* the host's own */ \
    found += check_listed(number, #message);
  ODO_FOR_EACH_MESSAGE(ODO_ROW)
#undef ODO_ROW
  CHECK(found == std::size(kMessageFields));
}

TEST_CASE("a non-finite number in a valid field of any message is rejected") {
  for (const uint32_t type : judged_types()) CHECK(message_fault(good(type).header()) == "");
  for (const MessageField& field : kMessageFields)
    for (size_t i = 0; i < field.count(); ++i)
      for (const double wild : {kNan, kInfinity, -kInfinity}) {
        CAPTURE(field.type);
        CAPTURE(field.name);
        CAPTURE(i);
        const std::string fault = fault_with(field, i, wild);
        const bool named = fault.find(field.name) == 0 || field.type == ODO_TYPE_IMU_NOISE;
        CHECK(((field.rule == Rule::any) ? fault.empty() : !fault.empty() && named));
        if (field.flag != 0) CHECK(fault_with(field, i, wild, field.flag) == "");
      }
}

TEST_CASE("numbers are accepted at the ends of their range and rejected beyond") {
  const double half_pi = std::acos(0.0);
  for (const MessageField& field : kMessageFields) {
    CAPTURE(field.type);
    CAPTURE(field.name);
    const auto good_with = [&](double value) { return fault_with(field, 0, value).empty(); };
    switch (field.rule) {
      case Rule::finite:
        CHECK(good_with(-1e6));
        CHECK(good_with(0));
        CHECK(good_with(1e9));
        CHECK_FALSE(good_with(-1.001e9));
        CHECK_FALSE(good_with(1e300));
        break;
      case Rule::sensed:  // implausible sensor values are detected by the gate
        CHECK((good_with(-1e300) && good_with(1e300)));
        break;
      case Rule::place:
        CHECK((good_with(-2e7) && good_with(2e7)));
        CHECK_FALSE(good_with(2.001e7));
        break;
      case Rule::height:
        CHECK((good_with(-12e3) && good_with(100e3)));
        CHECK_FALSE((good_with(-12.1e3) || good_with(101e3)));
        break;
      case Rule::lon:
        CHECK((good_with(-2 * std::acos(-1.0)) && good_with(2 * std::acos(-1.0))));
        CHECK_FALSE((good_with(6.3) || good_with(11.575)));
        break;
      case Rule::matrix: {
        CHECK(good_with(1e15));
        CHECK_FALSE((good_with(-1e-9) || good_with(1.1e15)));
        CHECK_FALSE(fault_with(field, 1, 0.1).empty());  // not symmetric
        const bool known = field.type == ODO_TYPE_FIX;   // a known quantity has a variance
        CHECK(good_with(0) == !known);
        CHECK(good_with(1e-12));
        break;
      }
      case Rule::natural:
        CHECK(good_with(0));
        CHECK_FALSE(good_with(-1e-12));
        break;
      case Rule::positive:
        CHECK(good_with(1e-12));
        CHECK_FALSE(good_with(0));
        CHECK_FALSE(good_with(-1));
        break;
      case Rule::share:
        CHECK((good_with(0) && good_with(1)));
        CHECK_FALSE(good_with(-1e-9));
        CHECK_FALSE(good_with(1 + 1e-9));
        break;
      case Rule::lat:
        for (const double sign : {-1, 1}) {
          CHECK(good_with(sign * half_pi));
          CHECK_FALSE(good_with(sign * (half_pi + 1e-9)));
        }
        break;
      case Rule::unit:  // 1e-3 of the norm: one of the four halves is changed
        for (size_t i = 0; i < 4; ++i) {
          CHECK(fault_with(field, i, 0.5 + 1.9e-3).empty());
          CHECK_FALSE(fault_with(field, i, 0.5 + 2.1e-3).empty());
          CHECK(fault_with(field, i, 0.5 - 1.9e-3).empty());
          CHECK_FALSE(fault_with(field, i, 0.5 - 2.1e-3).empty());
          CHECK(fault_with(field, i, -0.5).empty());
        }
        break;
      default: break;
    }
  }
}

TEST_CASE("the quality and the time of every message are checked, the time up to 2^62") {
  for (const uint32_t type : judged_types())
    for (const int sign : {-1, 1}) {
      AnyMessage m = good(type);
      if (type == ODO_TYPE_VO_MOTION) reinterpret_cast<odo_vo_motion&>(m.header()).t_from_ns = INT64_MIN;
      if (type == ODO_TYPE_RELATIVE_POSE) reinterpret_cast<odo_relative_pose&>(m.header()).t_from_ns = INT64_MIN;
      m.header().t_ns = sign * (int64_t(1) << 62);
      CHECK(message_fault(m.header()) == "");
      m.header().t_ns += sign;
      CHECK(message_fault(m.header()).find("t_ns") == 0);
      m = good(type);
      m.header().quality = static_cast<float>(kNan);
      CHECK(message_is_good(m.header()));  // it is not flagged valid
      m.header().flags |= ODO_FLAG_QUALITY;
      m.header().quality = static_cast<float>(sign * kInfinity);
      CHECK(message_fault(m.header()).find("quality") == 0);
      m.header().quality = static_cast<float>(kNan);
      CHECK_FALSE(message_is_good(m.header()));
    }
}

TEST_CASE("an odo_points is refused unless all its elements are within it and finite, and keeps them in a copy") {
  odo::PointsWriter writer;
  const auto made = [&](auto&& change) {
    writer.begin(1000, 0, 0, true);
    for (uint64_t id = 1; id <= 3; ++id) {
      odo_point point{};
      point.id = id;
      writer.add(point);
    }
    AnyMessage m(writer.message().header);
    change(reinterpret_cast<odo_points&>(m.header()));
    return m;
  };
  const auto fault = [&](auto&& change) { return message_fault(made(change).header()); };
  const auto element = [](odo_points& m, uint32_t i) -> odo_point& {
    return const_cast<odo_point&>(*ODO_POINTS_AT(&m, i));
  };
  const AnyMessage m = made([](odo_points&) {});
  CHECK(message_fault(m.header()) == "");
  const odo::Points points(as<odo_points>(m.header()));
  CHECK(points.size() == 3);
  uint64_t sum = 0;
  for (const odo_point& point : points) sum += point.id;
  CHECK(sum == 6);
  CHECK(odo::Points(copy_as<odo_points>(m.header())).size() == 0);  // the struct alone
  CHECK(fault([](odo_points& p) { p.total = 5; }) == "");
  CHECK(fault([](odo_points& p) { p.total = 2; }).starts_with("total = 2"));
  CHECK(fault([](odo_points& p) { p.count = p.total = 4; }).starts_with("count = 4"));
  CHECK(fault([](odo_points& p) { p.count = p.total = 1001; }).starts_with("count = 1001"));
  CHECK(fault([](odo_points& p) { p.count = UINT32_MAX, p.stride = UINT32_MAX - 7; }).starts_with("count"));
  CHECK(fault([](odo_points& p) { p.stride = 60; }).starts_with("stride = 60"));
  CHECK(fault([](odo_points& p) { p.stride = 68; }).starts_with("stride = 68"));
  CHECK(fault([](odo_points& p) { p.offset = 48; }).starts_with("offset = 48"));
  CHECK(fault([](odo_points& p) { p.offset = 60; }).starts_with("offset = 60"));
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(fault([&](odo_points& p) { element(p, 2).p_c[1] = nan; }).starts_with("p_c of an element"));
  CHECK(fault([&](odo_points& p) { element(p, 1).covariance[1] = nan; }).starts_with("covariance of an element"));
  CHECK(fault([&](odo_points& p) { element(p, 0).covariance[3] = -1; }).starts_with("covariance of an element"));
  CHECK(fault([&](odo_points& p) { element(p, 0).pixel[1] = nan; }).starts_with("pixel of an element"));
  writer.begin(1000, 0, 0, true);
  for (int i = 0; i < 1200; ++i) writer.add(odo_point{});
  CHECK(writer.message().count == ODO_MOST_POINTS);
  CHECK(writer.message().total == 1200);
  CHECK(message_fault(AnyMessage(writer.message().header).header()) == "");
}

TEST_CASE("an odo_surface is refused unless its outline is within it, and its state and ids agree") {
  odo::SurfaceWriter writer;
  const auto fault = [&](auto&& change) {
    writer.begin(1000, 5);
    odo_surface& surface = writer.message();
    surface.kind = ODO_SURFACE_FLOOR, surface.q_n[0] = 1, surface.sigma_m = surface.tilt_sigma_rad = 0.1;
    for (const float x : {0.0f, 1.0f, 2.0f}) writer.add(x, x * x);
    change(surface);
    return message_fault(AnyMessage(surface.header).header());
  };
  CHECK(fault([](odo_surface&) {}) == "");
  CHECK(ODO_VERTEX_AT(&writer.message(), 2)->p[1] == 4);
  CHECK(ODO_VERTEX_AT(&writer.message(), 3) == nullptr);
  CHECK(fault([](odo_surface& s) { s.id = 0; }).starts_with("id = 0"));
  CHECK(fault([](odo_surface& s) { s.kind = 0; }).starts_with("kind = 0"));
  CHECK(fault([](odo_surface& s) { s.state = 4; }).starts_with("state = 4"));
  CHECK(fault([](odo_surface& s) { s.count = 2; }).starts_with("count = 2; expected 3 to 32"));
  CHECK(fault([](odo_surface& s) { s.count = 4; }).starts_with("count = 4; expected vertices within"));
  CHECK(fault([](odo_surface& s) { s.count = 33; }).starts_with("count = 33"));
  CHECK(fault([](odo_surface& s) { s.stride = 12; }).starts_with("stride = 12"));
  CHECK(fault([](odo_surface& s) { s.offset = 136; }).starts_with("offset = 136"));
  CHECK(fault([](odo_surface& s) { s.sigma_m = 0; }).starts_with("sigma_m, tilt_sigma_rad = 0"));
  CHECK(fault([](odo_surface& s) { s.q_n[0] = 2; }).starts_with("q_n has the norm 2"));
  CHECK(fault([](odo_surface& s) { s.p_n[1] = 1e8; }).starts_with("p_n[1] = 1e+08"));
  CHECK(fault([](odo_surface& s) { s.merged_into = 6; }).starts_with("merged_into = 6"));
  CHECK(fault([](odo_surface& s) { s.state = ODO_SURFACE_WITHDRAWN; }).starts_with("count = 3"));
  CHECK(fault([](odo_surface& s) { s.state = ODO_SURFACE_WITHDRAWN, s.count = 0, s.sigma_m = 0; }) == "");
  CHECK(fault([](odo_surface& s) { s.state = ODO_SURFACE_MERGED, s.count = 0; }).starts_with("merged_into = 0"));
  CHECK(fault([](odo_surface& s) { s.state = ODO_SURFACE_MERGED, s.count = 0, s.merged_into = 6; }) == "");
}

TEST_CASE("integers of calibrations and frames are accepted within their limits only") {
  struct Limit {
    uint32_t type;
    size_t offset;
    std::vector<uint32_t> good, bad;
  };
  const std::vector<uint32_t> size = {1, 2, 16383, 16384}, no_size = {0, 16385, UINT32_MAX};
  const Limit limits[] = {
      {ODO_TYPE_FRAME, offsetof(odo_frame, width), size, no_size},
      {ODO_TYPE_FRAME, offsetof(odo_frame, height), size, no_size},
      {ODO_TYPE_FRAME,
       offsetof(odo_frame, format),
       {1, 2, 3, 4, 5, 6, 7, 8, UINT32_MAX},
       {0}},  // newer ones are passed on
      {ODO_TYPE_FRAME, offsetof(odo_frame, plane_count), {0, 1, 2, 3, 4}, {5, UINT32_MAX}},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, width), size, no_size},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, height), size, no_size},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, model), {1, 2, 3, UINT32_MAX}, {0}},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, distortion_count), {0, 4, 5, 8}, {1, 2, 3, 6, 7, 9}},
  };
  for (const Limit& limit : limits) {
    const auto fault = [&](uint32_t value) {
      AnyMessage m = good(limit.type);
      std::memcpy(reinterpret_cast<unsigned char*>(&m.header()) + limit.offset, &value, sizeof value);
      return message_fault(m.header());
    };
    CAPTURE(limit.offset);
    for (const uint32_t value : limit.good) CHECK(fault(value) == "");
    for (const uint32_t value : limit.bad) CHECK(fault(value) != "");
  }
}

TEST_CASE("a frame needs the planes of its format, and a mask if it is flagged") {
  const std::map<uint32_t, int> planes = {{ODO_FORMAT_GREY8, 1}, {ODO_FORMAT_NV12, 2},  {ODO_FORMAT_NV21, 2},
                                          {ODO_FORMAT_RGB8, 1},  {ODO_FORMAT_RGBA8, 1}, {ODO_FORMAT_YUV420, 3},
                                          {ODO_FORMAT_BGRA8, 1}};
  for (const auto& [format, count] : planes)
    for (int missing = 0; missing < 5; ++missing) {
      AnyMessage any = good(ODO_TYPE_FRAME);
      auto& m = reinterpret_cast<odo_frame&>(any.header());
      m.format = format;
      (missing < 4 ? m.planes[missing] : m.mask).data = nullptr;
      CAPTURE(m.format);
      CAPTURE(missing);
      CHECK(message_is_good(m.header) == (missing >= count && missing < 4));
      m.header.flags &= ~ODO_FRAME_MASK;
      CHECK(message_is_good(m.header) == (missing >= count));
    }
}

TEST_CASE("a motion and a step have a duration of at least a nanosecond") {
  AnyMessage any = good(ODO_TYPE_VO_MOTION);
  auto& motion = reinterpret_cast<odo_vo_motion&>(any.header());
  for (const int64_t from : {999, 1000, 1001}) {
    motion.t_from_ns = from;
    CHECK(message_is_good(motion.header) == (from < 1000));
  }
  AnyMessage other = good(ODO_TYPE_STEP);
  auto& step = reinterpret_cast<odo_step&>(other.header());
  step.t_start_ns = 500;
  for (const int64_t end : {499, 500, 501}) {
    step.t_end_ns = end;
    CHECK(message_is_good(step.header) == (end > 500));
  }
}
