// SPDX-License-Identifier: Apache-2.0
#include "sdk/math/scalar.hpp"
#include "sdk/tools/evaluation/excitation.hpp"
#include "sdk/tools/simulation/sensors.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "sdk/tools/simulation/world.hpp"
#include "tests/support/runs.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("phone_sensors");

namespace {

Scenario walk_of(double metres) {
  Scenario s;
  s.camera.width = 96, s.camera.height = 64, s.camera.focal_px = 80;
  s.route = {{0, 0, 0}, {metres, 0, 0}};
  return s;
}

/// Rms of the vertical velocity while walking.
double rise_and_fall(const Scenario& s) {
  const Journey walk = make_walk(s, 3);
  double sum = 0, n = 0;
  for (double t = 4; t < walk.phone.duration_s() - 4; t += 0.01, n += 1)
    sum += std::pow(walk.phone.at(t).velocity_n.z(), 2);
  return std::sqrt(sum / n);
}

}  // namespace

TEST_CASE("IMU time stamps jitter and stall as requested but never go back, and the truth keeps its own times") {
  Scenario s = walk_of(60);
  s.imu.jitter_s = 1.4e-3, s.imu.gap_s = 35e-3;
  const Recording recording = recorded(s, 3, false);
  const auto samples = messages_of<odo_imu>(recording, ODO_TYPE_IMU);
  REQUIRE(samples.size() == recording.true_states.size());
  REQUIRE(samples.size() > 6000);
  double squares = 0, longest = 0;
  size_t stalled = 0;
  for (size_t i = 1; i < samples.size(); ++i) {
    const double gap = 1e-9 * static_cast<double>(samples[i].header.t_ns - samples[i - 1].header.t_ns);
    const double off = 1e-9 * static_cast<double>(samples[i].header.t_ns - recording.true_states[i].t_ns);
    CHECK(gap > 0);
    longest = std::max(longest, gap);
    if (off > 6e-3)
      ++stalled;
    else
      squares += off * off;
  }
  CHECK(std::abs(std::sqrt(squares / static_cast<double>(samples.size())) - 1.4e-3) < 0.35 * 1.4e-3);
  CHECK(longest == Between{20e-3, 45e-3});
  CHECK(stalled > 5);
}

TEST_CASE("a bias random walk has its density for any sample rate") {
  for (const double rate_hz : {50.0, 400.0}) {
    CAPTURE(rate_hz);
    double squares = 0;
    for (uint64_t seed = 1; seed <= 300; ++seed) {
      SimTriad triad(Random(seed, 1), SimTriad::Errors{.walk = 0.02, .range = 100}, rate_hz);
      Vector3d bias = Vector3d::Zero();
      for (int i = 0; i < 4 * rate_hz; ++i) bias = triad.measure(Vector3d::Zero());
      squares += bias.squaredNorm() / (3 * 300);
    }
    CHECK(std::abs(std::sqrt(squares) - 0.02 * std::sqrt(4.0)) < 0.08 * 0.02 * std::sqrt(4.0));  // 900 values: 2.4 %
  }
}

TEST_CASE("acceleration and warming change the gyro bias, and the truth's bias includes both") {
  Scenario s = walk_of(40);
  s.imu = Scenario::Imu();
  s.imu.gyro_noise = s.imu.gyro_walk = s.imu.gyro_bias = s.imu.scale_error = s.imu.misalignment_rad = 0;
  s.imu.gyro_step = 0;
  s.imu.gyro_by_g = 2e-3, s.imu.gyro_warming = 1e-3;
  const Recording recording = recorded(s, 3, false);
  const auto samples = messages_of<odo_imu>(recording, ODO_TYPE_IMU);
  const Journey walk = make_walk(s, 3);
  double most = 0, wrong = 0;
  for (size_t i = 0; i < samples.size(); i += 50) {
    const Vector3d truth = walk.phone.at(static_cast<double>(i) / s.imu.rate_hz).angular_velocity_b;
    const Vector3d off = Vector3d::Map(samples[i].gyro_b) - truth;
    most = std::max(most, off.norm());
    wrong = std::max(wrong, (off - recording.true_states[i].gyro_bias).norm());
  }
  CHECK(most == Between{1e-3, 3e-2});
  CHECK(wrong < 1e-9);
}

TEST_CASE("outliers have the requested frequency, and some exceed the sensor's range") {
  Scenario s = walk_of(60);
  s.imu.outlier_interval_s = 4;
  const auto samples = messages_of<odo_imu>(recorded(s, 3, false), ODO_TYPE_IMU);
  size_t outside = 0, spikes = 0;
  for (const odo_imu& sample : samples) {
    const double gyro = Vector3d::Map(sample.gyro_b).cwiseAbs().maxCoeff() / s.imu.gyro_range;
    const double accel = Vector3d::Map(sample.accel_b).cwiseAbs().maxCoeff() / s.imu.accel_range;
    outside += std::max(gyro, accel) > 10;
    spikes += std::max(gyro, accel) > 0.8 && std::max(gyro, accel) <= 10;
  }
  const double expected = static_cast<double>(samples.size()) / s.imu.rate_hz / 4;
  CHECK(static_cast<double>(outside + spikes) == Between{0.4 * expected, 2 * expected});
  CHECK(outside >= spikes);
  CHECK(spikes > 0);
}

TEST_CASE("without an accelerometer no sample has one") {
  Scenario s = walk_of(5);
  s.imu.accelerometer = false;
  for (const odo_imu& sample : messages_of<odo_imu>(recorded(s, 3, false), ODO_TYPE_IMU))
    CHECK(sample.header.flags == ODO_IMU_GYRO);
}

TEST_CASE("a recording that starts during the walk has nothing from before, and the same frames as the whole") {
  Scenario s = walk_of(12);
  const Recording whole = recorded(s, 3, true);
  s.record_from_s = 5;
  const Recording cut = recorded(s, 3, true);
  const int64_t from = 1'000'000'000'000 + 5'000'000'000;
  for (const auto& m : cut.messages)
    if (m.message.header().type != ODO_TYPE_CALIBRATION && m.message.header().type != ODO_TYPE_IMU_NOISE)
      CHECK(m.message.header().t_ns >= from);
  REQUIRE(cut.truth.size() > 30);
  CHECK(cut.truth.front().t_ns >= from);
  const size_t before = whole.truth.size() - cut.truth.size();
  CHECK(before == 50);
  CHECK(whole.truth[before].p == cut.truth[0].p);
  CHECK(cut.true_states.front().t_ns == from);
}

TEST_CASE("two seconds of darkness are two seconds of dark frames") {
  Scenario s = walk_of(12);
  s.events = {{4, "dark", 2.0, 0, false}};
  const TemporaryFolder folder;
  size_t dark = 0, bright = 0;
  for_each_picture(recorded(s, 3, folder / "x.odo"),
                   [&](const odo_frame& frame) { (mean_grey(frame) < 20 ? dark : bright) += 1; });
  CHECK(dark >= 17);
  CHECK(dark <= 23);
  CHECK(bright > 60);
}

TEST_CASE("a gentle walker rises and falls half as much") {
  Scenario s = walk_of(30);
  const double usual = rise_and_fall(s);
  s.walker.bounce = 0.5;
  CHECK(std::abs(rise_and_fall(s) - 0.5 * usual) < 0.2 * 0.5 * usual);
}

TEST_CASE("squares and rivers have distant facades and moving water") {
  Scenario s;
  s.route = {{0, 0, 0}, {120, 0, 0}};
  s.world.trees = s.world.cars = s.world.pedestrians = 0;
  const auto nearest_m = [&](double azimuth_from_deg, double azimuth_to_deg) {
    const World world(s, 4);
    double nearest = 1e9;
    const auto line = world.skyline({60, 0, -1.5}, 360);
    for (size_t k = static_cast<size_t>(azimuth_from_deg); k <= static_cast<size_t>(azimuth_to_deg); ++k)
      if (line[k].elevation_rad > 0.03) nearest = std::min(nearest, static_cast<double>(line[k].distance_m));
    return nearest;
  };
  CHECK(nearest_m(60, 120) < 15);   // the right side of a street
  CHECK(nearest_m(240, 300) < 15);  // and its left
  s.world.open = {{20, 100}};
  CHECK(nearest_m(75, 105) == Between{60, 110});
  CHECK(nearest_m(255, 285) > 60);
  s.world.open.clear();
  s.world.river = {{20, 100}};
  CHECK(nearest_m(60, 120) < 15);
  CHECK(nearest_m(265, 275) == Between{130, 200});
  const World world(s, 4);
  REQUIRE(world.movers().size() == 1);
  const auto& water = world.movers()[0];
  CHECK((water.at(10).translation() - water.at(0).translation()).norm() == doctest::Approx(4.0));
}

TEST_CASE(
    "a scenario extends another: its own keys replace the base's, lists as a whole, and errors keep their location") {
  const TemporaryFolder folder;
  write_text(
      folder / "base.yaml",
      "odograph_scenario: 1\nwalker: {height: 1.9 m, speed: 1.2 m/s}\nworld: {trees: 3}\n"
      "route:\n  points: [[0, 0, 0], [50, 0, 0]]\n  events:\n    - {at: 5 m, do: stand}\n    - {at: 9 m, do: stand}\n");
  write_text(folder / "own.yaml",
             "odograph_scenario: 1\nbase: base.yaml\nwalker: {speed: 1.5 m/s}\nroute:\n  events:\n    - {at: 7 m, do: "
             "turn}\n");
  const auto s = required(read_scenario((folder / "own.yaml").string()));
  CHECK(s->walker.height_m == 1.9);
  CHECK(s->walker.speed_mps == 1.5);
  CHECK(s->world.trees == 3);
  CHECK(s->route.size() == 2);
  REQUIRE(s->events.size() == 1);
  CHECK(s->events[0].what == "turn");
  const auto text = required(scenario_text((folder / "own.yaml").string()));
  CHECK(text->find("height: 1.9 m") != std::string::npos);
  write_text(folder / "base.yaml", "odograph_scenario: 1\nwalker:\n  hight: 1.9 m\n");
  const auto wrong = read_scenario((folder / "own.yaml").string());
  REQUIRE_FALSE(wrong.ok());
  CHECK(contains(wrong.failure().text, "base.yaml:3:3: walker: unknown key 'hight'"));
  write_text(folder / "base.yaml", "odograph_scenario: 1\nbase: own.yaml\n");
  const auto circle = read_scenario((folder / "own.yaml").string());
  REQUIRE_FALSE(circle.ok());
  CHECK(contains(circle.failure().text, "circle"));
}

TEST_CASE("a phone profile sets camera and IMU, and keys of the file and options override it") {
  const TemporaryFolder folder;
  const auto file = write_text(folder / "s.yaml",
                               "odograph_scenario: 1\ncamera: {profile: phone_indoors, exposure: 4 ms}\n"
                               "imu: {accel_bias: 0.3 m/s^2}\n");
  const auto s = required(read_scenario(file.string()));
  CHECK(s->camera.row_time_s * 480 == doctest::Approx(15e-3));
  CHECK(s->camera.exposure_s == 4e-3);
  CHECK(s->camera.exposure_longest_s == 20e-3);
  CHECK(s->camera.stabiliser.travel_rad == doctest::Approx(0.9 * kPi / 180));
  CHECK(s->imu.accel_bias == 0.3);
  CHECK(s->imu.gyro_bias == doctest::Approx(0.5 * kPi / 180));
  const auto old = required(read_scenario(file.string(), "phone_old"));
  CHECK(old->camera.row_time_s * 480 == doctest::Approx(31e-3));
  CHECK(old->camera.exposure_s == 4e-3);
  CHECK(old->camera.stabiliser.travel_rad == 0);
  CHECK(old->imu.accel_scale_error == 0.01);
  const auto unknown = read_scenario(file.string(), "phone_odl");
  REQUIRE_FALSE(unknown.ok());
  CHECK(contains(unknown.failure().text, "nearest: 'phone_old'"));
  const auto own = required(read_scenario(write_text(folder / "t.yaml",
                                                     "odograph_scenario: 1\ncamera: {profile: phone}\n"
                                                     "imu: {profile: clean}\n")
                                              .string()));
  CHECK(own->imu.gyro_noise == Scenario::Imu().gyro_noise);
}

TEST_CASE("excitation: S is the motion beyond a quadratic, N the error beyond one, after its own scale") {
  Pairs pairs;
  const double swing_m = 0.03, wrong_m = 0.02;
  for (int i = 0; i <= 800; ++i) {
    const double t = 0.05 * i;
    StampedPose p;
    p.t_ns = static_cast<int64_t>(std::llround(t * 1e9));
    p.p = {1.3 * t, 0.2 * std::sin(0.02 * t), swing_m * std::sin(2 * kPi * 1.9 * t)};
    pairs.reference.push_back(p);
    StampedPose e = p;  // another scale and heading, and an error of its own
    e.p += Vector3d(0, wrong_m * std::sin(2 * kPi * 1.1 * t), 0);
    e.p = 3 * (Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * e.p) + Vector3d(5, -2, 1);
    pairs.estimate.push_back(e);
  }
  const Excitation e = excitation_of(pairs, {.window_s = 4});
  CHECK(e.windows == 19);
  CHECK(std::abs(e.motion_m - swing_m / std::sqrt(2.0)) < 0.05 * swing_m / std::sqrt(2.0));
  CHECK(std::abs(e.error_m - wrong_m / std::sqrt(2.0)) < 0.08 * wrong_m / std::sqrt(2.0));
  CHECK(std::abs(e.attenuation - 9.0 / 13) < 0.1 * 9.0 / 13);
  // Standing segments are excluded; a track that never moves has the whole motion as its error.
  Pairs standing = pairs;
  for (auto& p : standing.reference) p.p *= 0.01;
  CHECK(excitation_of(standing, {.window_s = 4}).windows == 0);
  Pairs stuck = pairs;
  for (auto& p : stuck.estimate) p.p.setZero();
  CHECK(excitation_of(stuck, {.window_s = 4}).error_m == doctest::Approx(e.motion_m));
}

TEST_CASE("satellites are lost for 12 s on average at the given availability, and errors match the reported sigmas") {
  for (const double availability : {0.2, 0.5, 0.9}) {
    CAPTURE(availability);
    Scenario s;
    s.gnss = {3, 9, 20, availability};
    SimGnss gnss(s, 5);
    const Vector3d p(10, -20, -30);
    constexpr int kSeconds = 300'000;
    int there = 0, outages = 0;
    bool was_there = true;
    Vector3d squares = Vector3d::Zero();
    double log_sigma = 0;
    for (int i = 0; i < kSeconds; ++i) {
      const SimGnss::Fix fix = gnss.measure(p);
      there += fix.available, outages += was_there && !fix.available;
      was_there = fix.available;
      const double sigma = fix.sigma_m / 0.7;  // reported too small
      CHECK((sigma > 2.999 && sigma < 9.001));
      squares += ((fix.p_n - p) / sigma).cwiseAbs2() / kSeconds, log_sigma += std::log(sigma) / kSeconds;
    }
    CHECK(std::abs(static_cast<double>(there) / kSeconds / availability - 1) < 0.05);
    CHECK(static_cast<double>(kSeconds - there) / outages == doctest::Approx(12).epsilon(0.05));
    CHECK(squares.x() == doctest::Approx(1).epsilon(0.1));
    CHECK(squares.y() == doctest::Approx(1).epsilon(0.1));
    CHECK(squares.z() == doctest::Approx(4).epsilon(0.1));
    CHECK(std::exp(log_sigma) == doctest::Approx(std::sqrt(3.0 * 9)).epsilon(0.05));
  }
  Scenario s;
  s.gnss.availability = 1;
  SimGnss always(s, 1);
  s.gnss.availability = 0;
  SimGnss never(s, 1);
  for (int i = 0; i < 1000; ++i) {
    CHECK(always.measure(Vector3d::Zero()).available);
    CHECK_FALSE(never.measure(Vector3d::Zero()).available);
  }
}
