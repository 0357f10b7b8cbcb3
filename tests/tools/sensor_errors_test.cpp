// SPDX-License-Identifier: Apache-2.0
//
// Every error of a simulated sensor has the requested size, measured over seeds or samples.
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/sensors.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

namespace {

/// Rms over 600 seeds and three axes: known to 1.7 %.
double over_seeds(const std::function<Vector3d(uint64_t seed)>& value) {
  double squares = 0;
  for (uint64_t seed = 1; seed <= 600; ++seed) squares += value(seed).squaredNorm() / (3 * 600);
  return std::sqrt(squares);
}

bool is_near(double found, double expected, double part) { return std::abs(found - expected) < part * expected; }

SimTriad::Errors none() { return {0, 0, 0, 0, 0, 100, 0}; }

SimTriad triad(uint64_t seed, const SimTriad::Errors& errors, double rate_hz = 100) {
  return {Random(seed, 5), errors, rate_hz};
}

Scenario::Magnetometer quiet() { return {50, 0, 0, 0, 0}; }

/// Autocorrelation of a signal at a lag of one sample.
double correlation(const std::vector<double>& x) {
  const double mean = statistics_of(x).mean;
  double same = 0, next = 0;
  for (size_t i = 1; i < x.size(); ++i)
    same += (x[i] - mean) * (x[i] - mean), next += (x[i] - mean) * (x[i - 1] - mean);
  return next / same;
}

}  // namespace

TEST_SUITE("phone_sensors") {
  TEST_CASE("a triad's bias, scale, misalignment and noise each have the requested size") {
    const Vector3d truth(2, -3, 5);
    const auto with = [&](auto set) {
      SimTriad::Errors errors = none();
      set(errors);
      return over_seeds([&](uint64_t seed) -> Vector3d { return triad(seed, errors).measure(truth) - truth; });
    };
    CHECK(with([](auto&) {}) == 0);
    CHECK(is_near(with([](auto& e) { e.bias = 0.04; }), 0.04, 0.06));
    CHECK(is_near(with([](auto& e) { e.scale = 0.01; }), 0.01 * std::sqrt((4 + 9 + 25) / 3.0), 0.06));
    CHECK(is_near(with([](auto& e) { e.misalignment = 0.01; }), 0.01 * std::sqrt(2 * (4 + 9 + 25) / 3.0), 0.06));
    CHECK(is_near(with([](auto& e) { e.noise = 0.02; }), 0.02 * std::sqrt(100.0), 0.06));
    CHECK(is_near(with([](auto& e) { e.walk = 0.3; }), 0.3 / std::sqrt(100.0), 0.06));
    SimTriad::Errors scaled = none();
    scaled.scale = 0.01;  // of each axis separately
    const Vector3d x = triad(3, scaled).measure({1, 0, 0});
    CHECK((x.x() != 1 && x.y() == 0 && x.z() == 0));
    SimTriad::Errors biased = none();
    biased.bias = 1;
    SimTriad one = triad(3, biased);
    CHECK((one.measure(truth) - truth - one.bias()).norm() < 1e-12);
  }

  TEST_CASE("a triad saturates at its range on both sides and is quantised") {
    SimTriad::Errors errors = none();
    errors.range = 4, errors.step = 0.25;
    SimTriad sensor = triad(1, errors);
    CHECK(sensor.measure({9, -9, 3.9}) == Vector3d(4, -4, 4));
    CHECK(sensor.measure({0.3, -0.3, 0.12}) == Vector3d(0.25, -0.25, 0));
    CHECK(sensor.measure({0.4, -0.4, 0.13}) == Vector3d(0.5, -0.5, 0.25));
  }

  TEST_CASE("a gyroscope drifts by its temperature coefficient over 10 K in five minutes, and by its g-sensitivity") {
    Scenario::Imu imu;
    imu.gyro_warming = 1e-3, imu.gyro_by_g = 0;
    const Vector3d force(0, 0, 9.80665);
    const auto at = [&](double t) {
      return over_seeds([&](uint64_t seed) { return SimGyroErrors(imu, seed).at(t, force); });
    };
    CHECK(at(0) == 0);
    CHECK(is_near(at(1e6), 1e-2, 0.06));
    CHECK(is_near(at(300) / at(1e6), 1 - std::exp(-1), 1e-6));
    imu.gyro_warming = 0, imu.gyro_by_g = 2e-3;
    CHECK(is_near(at(100), 2e-3, 0.06));
    CHECK(SimGyroErrors(imu, 1).at(9, 2 * force).isApprox(2 * SimGyroErrors(imu, 1).at(0, force)));
  }

  TEST_CASE("stalls have the requested interval, and last from a third of the maximum to the maximum") {
    Scenario::Imu imu;
    imu.gap_s = 0.04, imu.gap_interval_s = 2;
    SimStamps stamps(imu, 3);
    std::vector<double> gaps;
    double last = -1;
    for (int i = 0; i < 400'000; ++i) {
      const double stamp = stamps.of(i / 400.0);
      CHECK(stamp > last);
      if (i > 0 && stamp - last > 8e-3) gaps.push_back(stamp - last);
      last = stamp;
    }
    CHECK(std::abs(static_cast<double>(gaps.size()) - 1000 / 2.026) < 70);  // three sigmas
    const Statistics s = statistics_of(gaps);
    CHECK(s.max < 0.0427);
    CHECK(std::abs(s.mean - 0.65 * 0.04) < 3e-3);
  }

  TEST_CASE("outliers alternate between a thousand ranges and nine tenths of one, on every axis and with both signs") {
    Scenario::Imu imu;
    imu.outlier_interval_s = 0.5, imu.gyro_range = 3, imu.accel_range = 7;
    SimOutliers wild(imu, 3);
    std::map<std::pair<int, double>, int> seen;  // by axis, the accelerometer's from 3 on, and value
    double parts = 0;
    int count = 0;
    for (int i = 0; i < 200'000; ++i) {
      Vector3d gyro = Vector3d::Zero(), accel = Vector3d::Zero();
      wild.apply(i / 200.0, gyro, accel);
      for (int k = 0; k < 3; ++k) {
        if (gyro[k] != 0) ++seen[{k, gyro[k] / 3}], ++count, parts += std::abs(gyro[k]) > 100;
        if (accel[k] != 0) ++seen[{k + 3, accel[k] / 7}], ++count, parts += std::abs(accel[k]) > 100;
      }
    }
    CHECK(std::abs(count - 1000 / 0.5) < 150);
    CHECK(std::abs(parts - count / 2.0) <= 1);
    CHECK(seen.size() == 6 * 4);
    for (const auto& [what, times] : seen) {
      CHECK((is_near(std::abs(what.second), 1000, 1e-9) || is_near(std::abs(what.second), 0.9, 1e-9)));
      CHECK(times > 40);
    }
  }

  TEST_CASE("a magnetometer has the Earth's field in the body, and each kind of iron and noise in its size") {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    const Vector3d field_b = T.linear().transpose() * Vector3d(21e-6, 0, 43e-6);
    CHECK((SimMagnetometer(quiet(), 1).measure(T) - field_b).norm() < 1e-15);
    const auto off = [&](auto set) {
      Scenario::Magnetometer m = quiet();
      set(m);
      return over_seeds([&](uint64_t seed) -> Vector3d { return SimMagnetometer(m, seed).measure(T) - field_b; });
    };
    CHECK(is_near(off([](auto& m) { m.noise = 1e-6; }), 1e-6, 0.06));
    CHECK(is_near(off([](auto& m) { m.hard_iron = 3e-6; }), 3e-6, 0.06));
    CHECK(is_near(off([](auto& m) { m.soft_iron = 0.02; }), 0.02 * field_b.norm(), 0.06));
    CHECK(is_near(off([](auto& m) { m.disturbance = 5e-6; }), 5e-6, 0.06));
    Scenario::Magnetometer iron = quiet();  // the phone's own is constant, the path's changes within metres
    iron.disturbance = 5e-6;
    SimMagnetometer along(iron, 2);
    std::vector<double> x;
    for (double s = 0; s < 2000; s += 0.5) {
      T.translation() = Vector3d(s, 0.7 * s, 0);
      x.push_back(along.measure(T).x());
    }
    CHECK(correlation(x) == Between{0.8, 0.995});
  }

  TEST_CASE("a barometer has the standard atmosphere's pressure, noise, gusts of four seconds and an hour's drift") {
    CHECK(is_near(SimBarometer({0, 0, 0}, 1).measure(0), 101325, 1e-9));
    CHECK(is_near(SimBarometer({0, 0, 0}, 1).measure(1000), 89874.6, 1e-5));
    const auto series = [](const Scenario::Barometer& b, uint64_t seed, int n) {
      SimBarometer barometer(b, seed);
      std::vector<double> x;
      for (int i = 0; i < n; ++i) x.push_back(barometer.measure(0) - 101325);
      return x;
    };
    const auto noise = series({3, 0, 0}, 2, 20'000), wind = series({0, 0, 4}, 2, 40'000);
    CHECK(is_near(statistics_of(noise).std, 3, 0.03));
    CHECK(std::abs(correlation(noise)) < 0.03);
    CHECK(is_near(statistics_of(wind).std, 4, 0.06));
    CHECK(is_near(correlation(wind), std::exp(-0.25), 0.02));
    double squares = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) squares += std::pow(series({0, 20, 0}, seed, 3600).back(), 2) / 200;
    CHECK(is_near(std::sqrt(squares), 20, 0.15));
  }

  TEST_CASE("a receiver's error has its correlation time, and indoors there are no satellites") {
    Scenario s;
    s.gnss = {3, 3, 20, 1};
    SimGnss gnss(s, 5);
    std::vector<double> east;
    for (int i = 0; i < 40'000; ++i) east.push_back(gnss.measure(Vector3d(1, 2, 3)).p_n.y());
    CHECK(is_near(correlation(east), std::exp(-1 / 20.0), 0.006));
    CHECK(is_near(statistics_of(east).std, 3, 0.1));
    CHECK(std::abs(statistics_of(east).mean - 2) < 0.4);
    s.world.type = "room";
    CHECK_FALSE(SimGnss(s, 5).measure(Vector3d::Zero()).available);
  }
}
