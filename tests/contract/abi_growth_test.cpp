// SPDX-License-Identifier: Apache-2.0
//
// Structs of other versions, and several plugins of a kind. Messages that pass through a session as a whole are a
// subject of the conformance suite.
#include <odograph/messages.h>

#include "sdk/host/core/scale_join.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("abi_growth");

namespace {

/// A vendor's message of any size, filled with its index.
std::vector<uint64_t> vendor_message(uint32_t type, int64_t t_ns, size_t size) {
  std::vector<uint64_t> bytes((size + 7) / 8);
  auto* all = reinterpret_cast<unsigned char*>(bytes.data());
  for (size_t i = sizeof(odo_header); i < size; ++i) all[i] = static_cast<unsigned char>(i);
  auto& header = *reinterpret_cast<odo_header*>(all);
  header.struct_size = static_cast<uint32_t>(size);
  header.type = type;
  header.t_ns = t_ns;
  return bytes;
}
const odo_header& head(const std::vector<uint64_t>& bytes) {
  return *reinterpret_cast<const odo_header*>(bytes.data());
}

/// A calibration, then frames at 10 Hz between the inertial samples of a walk.
void walk_with_frames(App& app, int frames) {
  app.push(calibration(64, 48));
  for (int i = 0; i < frames; ++i) {
    app.walk(10 * i, 10 * i + 10);
    app.frame(1'000'000'000 + i * int64_t{100'000'000});
  }
  app.flush();
}

}  // namespace

TEST_CASE("every message's struct of version 1.0 is a prefix of the present one, and names and numbers are unique") {
  std::vector<uint32_t> numbers;
  std::vector<std::string> names;
#define ODO_ROW(number, type, name, min_size)                     \
  CHECK(min_size <= sizeof(type));                                \
  CHECK(min_size >= sizeof(odo_header));                          \
  CHECK(std::count(numbers.begin(), numbers.end(), number) == 0); \
  CHECK(std::count(names.begin(), names.end(), #name) == 0);      \
  CHECK(message_info(number)->size == sizeof(type));              \
  numbers.push_back(number), names.emplace_back(#name);
  ODO_FOR_EACH_MESSAGE(ODO_ROW)
#undef ODO_ROW
  CHECK(numbers.size() >= 18);
}

TEST_CASE("a copied message ends at the end of the message or of the reader's struct") {
  struct Larger {
    odo_magnetometer message;
    double later;
  } larger{};
  larger.message = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 5);
  larger.message.header.struct_size = sizeof larger;
  larger.message.field_b[2] = 3, larger.later = 7;
  odo_magnetometer mine{};
  odo_copy(&mine, sizeof mine, &larger.message.header);
  CHECK(mine.header.struct_size == sizeof mine);
  CHECK(mine.field_b[2] == 3);
  Larger grown{};
  grown.later = 9;
  larger.message.header.struct_size = sizeof larger.message;
  odo_copy(&grown, sizeof grown, &larger.message.header);
  CHECK(grown.message.header.struct_size == sizeof larger.message);
  CHECK(grown.message.field_b[2] == 3);
  CHECK(grown.later == 0);
}

TEST_CASE("a session accepts structs smaller or larger than its own, and names those it rejects") {
  App app(kWalk);
  auto pressure = pressure_at(1'000'000'000, 101325);
  pressure.header.struct_size = ODO_BAROMETER_SIZE_MIN;
  CHECK(app.push(pressure) == ODO_OK);
  auto larger = vendor_message(ODO_TYPE_BAROMETER, 1'100'000'000, 200);
  reinterpret_cast<odo_barometer*>(larger.data())->pressure_pa = 101325;
  CHECK(odo_session_push(app.session, &head(larger)) == ODO_OK);
  pressure.header.struct_size = 47;
  CHECK(app.push(pressure) == ODO_E_STRUCT_SIZE);
  odo_error error = app.last_error();
  CHECK(error.status == ODO_E_STRUCT_SIZE);
  CHECK(contains(error.message, "struct_size = 47; expected 48 to 65536"));
  auto field = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 1'200'000'000);
  field.field_b[1] = std::nan("");
  CHECK(app.push(field) == ODO_E_DISCARD);
  CHECK(odo_session_last_error(app.session, &error) == ODO_OK);
  CHECK(error.status == ODO_E_DISCARD);
  CHECK(contains(error.message, "field_b[1] = nan; expected a finite number"));
}

TEST_CASE(
    "with two step estimators and two scale sources the first estimator's steps are used and the scales are joined" *
    doctest::skip(!kCameraPlugins)) {
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  - plugin: step/renaudin2012\n"
      "  - plugin: step/weinberg2002\nvo_frontend:\n  plugin: vo/five_point\nscale_source:\n"
      "  - plugin: scale/fixed_step\n  - plugin: scale/step_length\n";
  RunningApp app(yaml), alone(kWalk);
  for (App* each : {&app, &alone}) {
    each->walk(0, 2000);
    odo_session_flush(each->session);
  }
  const auto steps = app.all<odo_step>(ODO_TYPE_STEP);
  std::vector<int64_t> first, second;
  for (const odo_step& step : steps) (step.header.source == 2 ? first : second).push_back(step.t_end_ns);
  CHECK(first.size() > 10);
  CHECK(second.size() > 10);
  CHECK(first.size() == alone.all<odo_step>(ODO_TYPE_STEP).size());
  CHECK(app.statistics().steps == first.size());
}

TEST_CASE("a late scale is published as not accepted and reported, unlike one for motions to come" *
          doctest::skip(!kCameraPlugins)) {
  const odo_vo_motion motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, 100);
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 100);
  scale.valid_to_ns = 100, scale.scale = 2, scale.sigma = 0.1;
  ScaleJoin join(1);
  CHECK(join.note(0, scale) == ScaleUse::used);  // no motion yet: may apply
  join.begin(motion, false);
  CHECK(join.answer(0, scale) == ScaleUse::used);
  CHECK(join.note(0, scale) == ScaleUse::late);
  scale.valid_to_ns = 101;
  CHECK(join.note(0, scale) == ScaleUse::used);
  join.begin(motion, true);
  CHECK(join.answer(0, scale) == ScaleUse::pointless);
  CHECK(join.joined() == nullptr);
  scale.scale_group = 1;
  CHECK(join.note(0, scale) == ScaleUse::late);

  const TestPlugins plugins{"late_scale"};
  RunningApp app(kWalk + "vo_frontend:\n  plugin: vo/five_point\nscale_source:\n  plugin: test/late_scale\n",
                 ODO_RUN_REPLAY, plugins.path());
  walk_with_frames(app, 20);
  const auto scales = app.all<odo_scale>(ODO_TYPE_SCALE);
  REQUIRE(scales.size() == 19);
  const auto accepted = [](const odo_scale& s) { return (s.header.flags & ODO_FLAG_ACCEPTED) != 0; };
  CHECK(std::count_if(scales.begin(), scales.end(), accepted) == 6);
  CHECK(accepted(scales[2]));
  CHECK(std::any_of(app.reports.begin(), app.reports.end(),
                    [](const odo_report& r) { return std::string(r.key) == "late_scale"; }));
}

TEST_CASE("a source without effect is named once, with severity info and what to change, and changes no state") {
  const TestPlugins plugins{"needy_vo"};
  const auto unused = [](const App& app) {
    std::vector<std::string> said;
    for (const odo_report& report : app.reports) {
      if (std::string(report.key) != "unused_source") continue;
      CHECK(report.severity == ODO_SEVERITY_INFO);
      said.push_back(std::string(report.plugin) + ": " + report.text);
    }
    return said;
  };
  SUBCASE("its input never comes") {
    RunningApp app(kWalk + "absolute_fixers:\n  - plugin: fix/waypoint\n  - plugin: fix/gnss\n");
    app.walk(0, 900);
    app.flush();
    CHECK(unused(app).empty());  // it may still come
    app.walk(900, 2000);
    app.flush();
    const auto said = unused(app);
    REQUIRE(said.size() == 2);
    CHECK(contains(said[0], "fix/waypoint: no effect: it has given nothing, and waypoint did not come"));
    CHECK(contains(said[1], "fix/gnss: no effect: it has given nothing, and gnss"));
    CHECK(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
  }
  SUBCASE("the front-end's motions are in metres") {
    RunningApp app(kWalk + "vo_frontend:\n  plugin: test/needy_vo\nscale_source:\n  plugin: scale/fixed_step\n",
                   ODO_RUN_REPLAY, plugins.path());
    walk_with_frames(app, 50);
    const auto said = unused(app);
    REQUIRE(said.size() == 1);
    CHECK(contains(said[0], "scale/fixed_step: no effect: the front-end's motions are in metres"));
    const auto scales = app.all<odo_scale>(ODO_TYPE_SCALE);
    CHECK(scales.size() > 40);
    for (const odo_scale& scale : scales) CHECK((scale.header.flags & ODO_FLAG_ACCEPTED) == 0);
  }
}

TEST_CASE("landmarks have the time and the scale group of the motion that follows them, also after a restart") {
  const TestPlugins plugins{"needy_vo"};
  RunningApp app(kWalk + "vo_frontend:\n  plugin: test/needy_vo\n", ODO_RUN_REPLAY, plugins.path());
  app.walk(5000, 5100);
  walk_with_frames(app, 20);
  walk_with_frames(app, 20);  // the clock is set back: the front-end counts its groups anew
  const auto motions = app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION);
  const auto points = app.all<odo_points>(ODO_TYPE_POINTS);
  REQUIRE(points.size() == motions.size());
  CHECK(motions.back().scale_group > motions.front().scale_group);
  for (size_t i = 0; i < points.size(); ++i) {
    CHECK(points[i].header.t_ns == motions[i].header.t_ns);
    CHECK(points[i].scale_group == motions[i].scale_group);
    CHECK(points[i].camera == motions[i].camera);
  }
}

TEST_CASE("the next step estimator replaces one that has failed") {
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  - plugin: test/failing_steps\n"
      "  - plugin: step/renaudin2012\n";
  const TestPlugins plugins{"failing_steps"};
  RunningApp app(yaml, ODO_RUN_REPLAY, plugins.path());
  app.run(0, 2000);
  CHECK(app.statistics().steps > 10);
  CHECK(app.pose(ODO_TIME_LATEST).reason != ODO_REASON_PLUGIN_FAILED);
}

TEST_CASE("a report is an event with the plugin, a key, the status and a count") {
  App app(kWalk);
  app.walk(0, 100);
  auto bad = make_message<odo_gnss>(ODO_TYPE_GNSS, 1'500'000'000);
  bad.header.flags = ODO_GNSS_POSITION;
  bad.latitude_rad = 3;
  app.push(bad);
  app.walk(100, 101);
  REQUIRE(!app.reports.empty());
  const odo_report& report = app.reports.back();
  CHECK(std::string(report.plugin) == "host");
  CHECK(std::string(report.key) == "invalid_gnss");
  CHECK(std::string(report.text) == "dropped a sample of gnss: latitude_rad = 3; expected -pi/2 to pi/2 (degrees?)");
  CHECK(report.status == ODO_E_DISCARD);
  CHECK(report.severity == ODO_SEVERITY_WARNING);
  CHECK(report.count == 1);
}
