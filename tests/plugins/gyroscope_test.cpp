// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/sensor_range.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/plugin_run.hpp"

using namespace odograph::vo;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("gyroscope");

namespace {

constexpr int64_t kMilli = 1'000'000;
const GyroscopeParameters kParameters;

/// 100 Hz up to `last_ms`, starting at one second.
Gyroscope sampled(int64_t last_ms, const Vector3d& rate) {
  Gyroscope gyroscope;
  for (int64_t ms = 1000; ms <= last_ms; ms += 10) gyroscope.add(ms * kMilli, rate);
  return gyroscope;
}

}  // namespace

TEST_CASE("a gyroscope with an early end, a gap or a late start gives no rotation") {
  const int64_t gap = kParameters.longest_gap_ns / kMilli;
  const Vector3d rate(0.2, -0.4, 1.5), none = Vector3d::Zero();
  const Gyroscope gyroscope = sampled(1200, rate);
  const auto whole = gyroscope.between(1100 * kMilli, (1200 + gap) * kMilli, none);
  REQUIRE(whole);  // the last rate is extrapolated for a short time
  CHECK((log_rotation(whole->q_c0_c1) - 0.001 * static_cast<double>(100 + gap) * rate).norm() < 1e-6);
  CHECK_FALSE(gyroscope.between(1100 * kMilli, (1201 + gap) * kMilli, none));
  CHECK_FALSE(gyroscope.between(1200 * kMilli, 1210 * kMilli, none));         // no sample after its start
  CHECK_FALSE(gyroscope.between((999 - gap) * kMilli, 1100 * kMilli, none));  // started too late
  CHECK(gyroscope.between((1000 - gap) * kMilli, 1100 * kMilli, none));
  Gyroscope broken = sampled(1200, rate);
  broken.add((1201 + gap) * kMilli, rate);
  CHECK_FALSE(broken.between(1150 * kMilli, (1201 + gap) * kMilli, none));
  CHECK(broken.between(1150 * kMilli, 1190 * kMilli, none));
}

TEST_CASE("repeated and backward samples are ignored, and cleared ones are gone") {
  Gyroscope gyroscope = sampled(1200, {0, 0, 1});
  gyroscope.add(1200 * kMilli, {0, 0, 50});
  gyroscope.add(1100 * kMilli, {0, 0, 50});
  const auto rotation = required(gyroscope.between(1050 * kMilli, 1200 * kMilli, Vector3d::Zero()));
  CHECK(log_rotation(rotation->q_c0_c1).z() == doctest::Approx(0.15));
  gyroscope.clear();
  CHECK_FALSE(gyroscope.between(1050 * kMilli, 1200 * kMilli, Vector3d::Zero()));
  CHECK_FALSE(gyroscope.rate(1200 * kMilli));
}

TEST_CASE("a sample counts as the mean of it and the previous one, up to its time, without the bias") {
  Gyroscope gyroscope;
  const double rates[] = {10, 50, -30, 80};  // fast enough for the scale error to matter
  for (int k = 0; k < 4; ++k) gyroscope.add((1000 + 10 * k) * kMilli, {0, rates[k], 0});
  const auto part = required(gyroscope.between(1004 * kMilli, 1027 * kMilli, {0, 0.2, 0}));
  const double expected = 0.006 * (30 - 0.2) + 0.010 * (10 - 0.2) + 0.007 * (25 - 0.2);
  CHECK(std::abs(log_rotation(part->q_c0_c1).y() - expected) < 1e-9);
  CHECK(std::abs(part->by_bias(1, 1) + 0.023) < 1e-9);
  const auto& p = kParameters;
  const double sigma_rad =
      std::hypot(p.angle_random_walk * std::sqrt(0.023), p.timing_rad) + p.scale_error * std::abs(expected);
  CHECK(std::abs(part->sigma_rad / sigma_rad - 1) < 1e-6);
}

TEST_CASE("the rate at a time is the latest sample's, while that is recent") {
  Gyroscope gyroscope;
  for (int k = 0; k < 20; ++k) gyroscope.add((1000 + 10 * k) * kMilli, {0, 0, 0.1 * k});
  CHECK(gyroscope.rate(1057 * kMilli)->z() == doctest::Approx(0.5));
  CHECK(gyroscope.rate(1060 * kMilli)->z() == doctest::Approx(0.6));
  CHECK_FALSE(gyroscope.rate(999 * kMilli));
  CHECK(gyroscope.rate(1190 * kMilli + kParameters.longest_gap_ns)->z() == doctest::Approx(1.9));
  CHECK_FALSE(gyroscope.rate(1191 * kMilli + kParameters.longest_gap_ns));
}

TEST_CASE(
    "a sample beyond the range of any phone's sensor is discarded by all plugins that integrate it, one at it is not") {
  const auto config = required(read_pipeline_config(
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nvo_frontend: {plugin: vo/odograph}\nscale_source: {plugin: "
      "scale/inertial}\n",
      "<text>", {plugin_folder()}));
  for (const PluginChoice& choice :
       {config->attitudes.front(), config->vo_frontends.front(), config->scale_sources.front()}) {
    CAPTURE(choice.manifest.id);
    HostServices host(0, {}, nullptr);
    auto plugin = required(PluginInstance::make(choice, LibraryCheck::hash, 1, host));
    int64_t t_ns = 0;
    const auto is_discarded = [&](double rate_radps, double force_mps2) {
      auto imu = imu_at(t_ns += 10 * kMilli, {0, rate_radps, 0}, {0, 0, force_mps2});
      const uint64_t before = (*plugin)->faults();
      (*plugin)->process(imu.header);
      return (*plugin)->faults() != before;
    };
    CHECK_FALSE(is_discarded(-SensorRange::rate_radps, 9.8));
    CHECK(is_discarded(-1.001 * SensorRange::rate_radps, 9.8));
    CHECK_FALSE(is_discarded(0, SensorRange::force_mps2));
    CHECK(is_discarded(0, 1.001 * SensorRange::force_mps2));
  }
}

TEST_CASE("an attitude source turns by the rate times the time between samples, whatever that is, but 0.2 s at most") {
  constexpr double kRate_radps = 0.5, kTurn_s = 2;
  for (const char* name : {"attitude_vqf", "attitude_magyq"})
    for (const int64_t step_ms : {2, 5, 10, 20, 50, 400}) {
      CAPTURE(name);
      CAPTURE(step_ms);
      PluginRun run(name, {{"magnetometer", "false"}});
      std::vector<odograph::AnyMessage> samples;
      int64_t ms = 1000;
      // At rest until the filter has started, then turning about the vertical.
      for (; ms < 3000; ms += 10) samples.emplace_back(imu_at(ms * kMilli, {0, 0, 0}, {0, 0, 9.81}).header);
      const auto started = run(samples);
      samples.clear();
      const auto steps = static_cast<int64_t>(kTurn_s * 1000) / step_ms;
      ms -= 10;  // of the last sample
      for (int64_t i = 0; i < steps; ++i)
        samples.emplace_back(imu_at((ms += step_ms) * kMilli, {0, 0, kRate_radps}, {0, 0, 9.81}).header);
      const auto turned = run(samples);
      REQUIRE((!started.empty() && !turned.empty()));
      const auto q_of = [](const odograph::AnyMessage& event) {
        return odograph::quaternion(as<odo_attitude>(event.header()).q_n_b);
      };
      const double angle = q_of(started.back()).angularDistance(q_of(turned.back()));
      const double expected = kRate_radps * static_cast<double>(steps * std::min<int64_t>(step_ms, 200)) * 1e-3;
      CHECK(angle == doctest::Approx(expected).epsilon(0.03));
    }
}
