// SPDX-License-Identifier: Apache-2.0
//
// The equations of Antigny et al. 2019 with values worked out on paper, and their boxes' behaviour. Eq. (4) is in
// terrain_test.cpp, eq. (2) and (3) in vo_test.cpp.
#include "tests/support/messages.hpp"
#include "tests/support/plugin_run.hpp"
#include "tests/support/runs.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("antigny2019");

namespace {

constexpr int64_t kSecond = 1'000'000'000, kFrame = kSecond / 10;

/// The messages of one type among a plugin's events.
template <class Message>
std::vector<Message> of_type(const std::vector<AnyMessage>& events, uint32_t type) {
  std::vector<Message> found;
  for (const AnyMessage& event : events)
    if (event.header().type == type) found.push_back(as<Message>(event.header()));
  return found;
}

/// A frame's motion of (0.03, 0.04, 0.5) in n, so that eq. (5) gives D_VO = sqrt(0.03^2 + 0.04^2) = 0.05: the vertical
/// displacement does not count.
odo_vo_motion motion(int64_t from_ns) {
  auto m = motion_between(from_ns, from_ns + kFrame, {0.03, 0.04, 0.5},
                          ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_FLAG_NAVIGATION);
  m.q_n_c0[0] = 1;
  return m;
}

odo_motion_mode mode_at(int64_t t_ns, uint32_t mode) {
  auto event = make_message<odo_motion_mode>(ODO_TYPE_MOTION_MODE, t_ns);
  event.mode = mode;
  return event;
}

/// A phone that rises and falls twice a second and rocks with it, at 100 Hz.
std::vector<AnyMessage> rocking(double seconds, double step_hz) {
  std::vector<AnyMessage> samples;
  for (int k = 0; k < 100 * seconds; ++k) {
    const double phase = 2 * EIGEN_PI * step_hz * 0.01 * k;
    const odo_imu imu =
        imu_at(k * kSecond / 100, {0.4 * std::sin(0.5 * phase), 0, 0}, {0, 0, 9.81 + 2.5 * std::cos(phase)});
    samples.emplace_back(imu.header);
  }
  return samples;
}

}  // namespace

TEST_CASE("eq. (1): the step length follows height and frequency") {
  // h = 1.80 m, f = 2 Hz, a = 0.1 s, b = 0.2, c = 0.05 m: 1.80 (0.1 * 2 + 0.2) + 0.05 = 1.80 * 0.4 + 0.05 = 0.77 m.
  PluginRun own("step_renaudin2012", {{"walker_height", "1.8"}, {"a", "0.1"}, {"b", "0.2"}, {"c", "0.05"}});
  const auto steps = of_type<odo_step>(own(rocking(12, 2)), ODO_TYPE_STEP);
  REQUIRE(steps.size() >= 20);
  CHECK(steps.back().frequency_hz == doctest::Approx(2).epsilon(0.02));
  CHECK(steps.back().length_m == doctest::Approx(1.8 * (0.1 * steps.back().frequency_hz + 0.2) + 0.05).epsilon(1e-9));
  CHECK(steps.back().length_m == doctest::Approx(0.77).epsilon(0.01));
  // The defaults with h = 1.70 m: 1.70 (0.1297 * 2 + 0.1388) + 0.0508 = 1.70 * 0.3982 + 0.0508 = 0.72774 m.
  PluginRun universal("step_renaudin2012");
  CHECK(of_type<odo_step>(universal(rocking(12, 2)), ODO_TYPE_STEP).back().length_m ==
        doctest::Approx(0.72774).epsilon(0.01));
}

TEST_CASE("eq. (5) to (7): a frame's scale is the share of the step before it over the horizontal displacement") {
  // A step of 0.75 m in 0.6 s, a frame of 0.1 s: D_step = 0.75 * 0.1 / 0.6 = 0.125 m, s = 0.125 / 0.05 = 2.5.
  PluginRun plugin("scale_step_length");
  const odo_step step = step_between(kSecond, kSecond * 16 / 10, kSecond * 17 / 10, 0.75, 0.06);
  const odo_vo_motion moved = motion(2 * kSecond);
  const auto scales = of_type<odo_scale>(plugin({AnyMessage(step.header), AnyMessage(moved.header)}), ODO_TYPE_SCALE);
  REQUIRE(scales.size() == 1);
  CHECK(scales[0].displacement_m == doctest::Approx(0.125).epsilon(1e-9));
  CHECK(scales[0].scale == doctest::Approx(2.5).epsilon(1e-9));
  CHECK((scales[0].header.flags & ODO_SCALE_HORIZONTAL) != 0);
}

TEST_CASE("the fixed step has one speed by body height while the person walks, and none while static") {
  // h = 1.75 m: 0.41 * 1.75 m * 1.8 Hz = 1.2915 m/s; in 0.1 s 0.12915 m, s = 0.12915 / 0.05 = 2.583.
  PluginRun plugin("scale_fixed_step", {{"walker_height", "1.75"}});
  const odo_motion_mode walks = mode_at(kSecond, ODO_MODE_WALKING_TEXTING),
                        stands = mode_at(3 * kSecond, ODO_MODE_STATIC);
  const odo_vo_motion first = motion(2 * kSecond), second = motion(4 * kSecond);
  const auto scales = of_type<odo_scale>(plugin({AnyMessage(walks.header), AnyMessage(first.header),
                                                 AnyMessage(stands.header), AnyMessage(second.header)}),
                                         ODO_TYPE_SCALE);
  REQUIRE(scales.size() == 2);
  CHECK(scales[0].displacement_m == doctest::Approx(0.12915).epsilon(1e-9));
  CHECK(scales[0].scale == doctest::Approx(2.583).epsilon(1e-9));
  CHECK(scales[1].displacement_m == 0);
}

TEST_CASE("static is reported when the next step is overdue, half a second after the end of the last one") {
  Scenario s;
  s.route = {{0, 0, 0}, {40, 0, 0}};
  s.events = {{10, "stand", 6}, {20, "stand", 6}, {30, "stand", 6}};
  std::vector<double> after_s;
  for (const uint64_t seed : {1, 2, 3}) {
    const Recording recording = recorded_sensors(s, seed);
    std::vector<AnyMessage> samples;
    for (const RecordedMessage& m : recording.messages) samples.emplace_back(m.message.header());
    PluginRun plugin("step_renaudin2012");
    int64_t last_ns = 0;
    for (const AnyMessage& event : plugin(samples)) {
      if (event.header().type == ODO_TYPE_STEP) last_ns = as<odo_step>(event.header()).t_end_ns;
      if (event.header().type != ODO_TYPE_MOTION_MODE || last_ns == 0) continue;
      if (as<odo_motion_mode>(event.header()).mode == ODO_MODE_STATIC)
        after_s.push_back(1e-9 * static_cast<double>(event.header().t_ns - last_ns));
    }
  }
  REQUIRE(after_s.size() >= 9);
  MESSAGE("static after the last step's end: median " << percentile(after_s, 0.5) << " s, worst "
                                                      << percentile(after_s, 1));
  CHECK(percentile(after_s, 0.5) < 0.65);
  CHECK(percentile(after_s, 1) < 1);
}

TEST_CASE("GNSS for the start alone gives one fix, after the first pose, and one more after a reset") {
  std::vector<AnyMessage> samples;
  for (int k = 0; k < 10; ++k) {
    auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, k * kSecond);
    gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
    gnss.latitude_rad = 0.8238 + 1e-7 * k, gnss.longitude_rad = -0.0271;
    gnss.covariance_n[0] = gnss.covariance_n[4] = gnss.covariance_n[8] = 9;
    samples.emplace_back(gnss.header);
    if (k == 2) samples.emplace_back(make_message<odo_pose>(ODO_TYPE_POSE, k * kSecond).header);
  }
  PluginRun plugin("fix_gnss", {{"start_only", "true"}, {"heading", "false"}});
  for (int run = 0; run < 2; ++run) {
    const auto fixes = of_type<odo_fix>(plugin(samples), ODO_TYPE_FIX);
    REQUIRE(fixes.size() == 1);
    CHECK(fixes[0].header.t_ns == 3 * kSecond);  // before the first pose there is no track to start
    CHECK(fixes[0].latitude_rad == doctest::Approx(0.8238003).epsilon(1e-12));
    plugin.reset();
  }
  PluginRun all("fix_gnss", {{"heading", "false"}});
  CHECK(of_type<odo_fix>(all(samples), ODO_TYPE_FIX).size() == 10);
}
