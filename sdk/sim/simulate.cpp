// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/simulate.hpp"

#include <cmath>

#include "sdk/core/geodesy.hpp"
#include "sdk/recording/odo_file.hpp"
#include "sdk/sim/random.hpp"
#include "sdk/sim/walker.hpp"
#include "sdk/sim/world.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

int64_t nanoseconds(double t_s) { return static_cast<int64_t>(std::llround(t_s * 1e9)); }

Vector3d normal3(Random& random, double sigma) {
  return sigma * Vector3d(random.normal(), random.normal(), random.normal());
}

/// White noise, a constant bias and a random walk, as an Allan deviation separates them.
class SensorError {
 public:
  SensorError(Random random, double bias, double noise, double walk, double rate_hz)
      : random_(random),
        bias_(normal3(random_, bias)),
        noise_(noise * std::sqrt(rate_hz)),
        walk_(walk / std::sqrt(rate_hz)) {}
  Vector3d next() {
    bias_ += normal3(random_, walk_);
    return bias_ + normal3(random_, noise_);
  }

 private:
  Random random_;
  Vector3d bias_;
  double noise_, walk_;
};

/// R_b_c of a phone: the camera's x, y, z are the body's x, -y, -z.
const Eigen::Quaterniond kCameraInBody(0.0, 1.0, 0.0, 0.0);

Eigen::Isometry3d camera_pose(const Walker& walker, double t_s) {
  Eigen::Isometry3d T = walker.pose(t_s);
  T.linear() = (T.linear() * kCameraInBody.toRotationMatrix()).eval();
  return T;
}

class Simulation {
 public:
  Simulation(const Scenario& c, uint64_t seed, OdoWriter& writer)
      : c_(c), seed_(seed), writer_(writer), walker_(c, seed), world_(c, seed) {
    geodesy_.set_origin({0.8238, -0.0271, 20.0});
  }

  Result<bool> run(const std::function<void(size_t, size_t)>& progress) {
    if (const auto head = write_head(); !head) return head;
    SensorError gyro(Random(seed_, 2), c_.gyro_bias, c_.gyro_noise, c_.gyro_walk, c_.imu_hz);
    SensorError accel(Random(seed_, 3), c_.accel_bias, c_.accel_noise, c_.accel_walk, c_.imu_hz);
    const auto samples = static_cast<size_t>(walker_.duration_s() * c_.imu_hz);
    size_t next_frame = 0, next_slow = 0;
    for (size_t i = 0; i < samples; ++i) {
      const double t = static_cast<double>(i) / c_.imu_hz;
      const auto k = walker_.kinematics(t);
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, kStart_ns + nanoseconds(t));
      imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
      Vector3d::Map(imu.gyro_b) = k.angular_velocity_b + gyro.next();
      Vector3d::Map(imu.accel_b) = k.specific_force_b + accel.next();
      if (const auto w = writer_.write(imu.header); !w) return w;
      if (static_cast<double>(next_slow) <= t)
        if (const auto w = write_slow(static_cast<double>(next_slow++)); !w) return w;
      if (i % std::max<size_t>(1, static_cast<size_t>(c_.imu_hz / 50)) == 0)
        if (const auto w = write_magnetometer(t); !w) return w;
      if (static_cast<double>(next_frame) / c_.camera_hz <= t) {
        if (const auto w = write_frame(next_frame++); !w) return w;
        if (progress) progress(i, samples);
      }
    }
    for (const auto& step : walker_.steps())
      if (const auto w = write_step(step); !w) return w;
    if (!writer_.flush()) return Failure{ODO_E_NOT_FOUND, "writing the recording failed; is the disk full?"};
    return true;
  }

 private:
  static constexpr int64_t kStart_ns = 1'000'000'000'000;

  Result<bool> write_head() {
    auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, kStart_ns);
    noise.gyro_noise = c_.gyro_noise, noise.gyro_walk = c_.gyro_walk, noise.accel_noise = c_.accel_noise,
    noise.accel_walk = c_.accel_walk;
    if (const auto w = writer_.write(noise.header); !w) return w;
    auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, kStart_ns);
    calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
    calibration.model = ODO_CAMERA_PINHOLE;
    calibration.width = static_cast<uint32_t>(c_.width), calibration.height = static_cast<uint32_t>(c_.height);
    calibration.fx = calibration.fy = c_.focal_px;
    calibration.cx = 0.5 * (c_.width - 1), calibration.cy = 0.5 * (c_.height - 1);
    calibration.q_b_c[0] = kCameraInBody.w(), calibration.q_b_c[1] = kCameraInBody.x();
    return writer_.write(calibration.header);
  }

  Result<bool> write_frame(size_t index) {
    const double t = static_cast<double>(index) / c_.camera_hz;
    const Eigen::Isometry3d T_n_c = camera_pose(walker_, t);
    cv::Mat image = world_.render(T_n_c, c_);
    Random random(seed_, 1000 + index);
    for (auto pixel = image.begin<uint8_t>(); pixel != image.end<uint8_t>(); ++pixel)
      *pixel = cv::saturate_cast<uint8_t>(*pixel + c_.pixel_noise * random.normal());
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, kStart_ns + nanoseconds(t));
    frame.format = ODO_FORMAT_GREY8;
    frame.width = static_cast<uint32_t>(image.cols), frame.height = static_cast<uint32_t>(image.rows);
    frame.planes[0] = {image.data, static_cast<int64_t>(image.step[0]), 1, 0};
    if (const auto w = writer_.write(frame.header); !w) return w;
    return writer_.write_truth({frame.header.t_ns, Eigen::Quaterniond(T_n_c.linear()), T_n_c.translation()});
  }

  Result<bool> write_magnetometer(double t) {
    auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, kStart_ns + nanoseconds(t));
    Random random(seed_, 500000 + static_cast<uint64_t>(t * 1000));
    const Vector3d field_n(21e-6, 0.0, 43e-6);  // middle Europe; magnetic north is n's north
    Vector3d::Map(m.field_b) = walker_.pose(t).linear().transpose() * field_n + normal3(random, 0.3e-6);
    return writer_.write(m.header);
  }

  /// GNSS and barometer, once a second. The GNSS error is a first-order Gauss-Markov process.
  Result<bool> write_slow(double t) {
    const Vector3d p = walker_.pose(t).translation();
    const double keep = std::exp(-1.0 / 10.0);
    Random random(seed_, 900000 + static_cast<uint64_t>(t));
    gnss_error_ = keep * gnss_error_ + std::sqrt(1 - keep * keep) * normal3(random, c_.gnss_sigma_m);
    const Vector3d measured = p + Vector3d(gnss_error_.x(), gnss_error_.y(), 2 * gnss_error_.z());
    const auto geodetic = geodesy_.to_geodetic({measured.x(), measured.y(), measured.z()});
    auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, kStart_ns + nanoseconds(t));
    gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
    gnss.latitude_rad = geodetic[0], gnss.longitude_rad = geodetic[1], gnss.height_m = geodetic[2];
    gnss.covariance_n[0] = gnss.covariance_n[4] = c_.gnss_sigma_m * c_.gnss_sigma_m;
    gnss.covariance_n[8] = 4 * c_.gnss_sigma_m * c_.gnss_sigma_m;
    gnss.satellites = 9;
    if (const auto w = writer_.write(gnss.header); !w) return w;
    auto barometer = make_message<odo_barometer>(ODO_TYPE_BAROMETER, kStart_ns + nanoseconds(t));
    barometer.pressure_pa = 101325.0 + 12.0 * p.z() + random.normal();
    return writer_.write(barometer.header);
  }

  Result<bool> write_step(const Walker::Step& step) {
    auto s = make_message<odo_step>(ODO_TYPE_STEP, kStart_ns + nanoseconds(step.t_end_s));
    s.t_start_ns = kStart_ns + nanoseconds(step.t_start_s);
    s.t_end_ns = kStart_ns + nanoseconds(step.t_end_s);
    s.length_m = step.length_m;
    s.frequency_hz = 1.0 / (step.t_end_s - step.t_start_s);
    s.mode = ODO_MODE_WALKING_TEXTING;
    return writer_.write(s.header);
  }

  const Scenario& c_;
  uint64_t seed_;
  OdoWriter& writer_;
  Walker walker_;
  World world_;
  Geodesy geodesy_;
  Vector3d gnss_error_ = Vector3d::Zero();
};

}  // namespace

Result<bool> simulate(const Scenario& scenario, uint64_t seed, const std::filesystem::path& output,
                      const std::function<void(size_t, size_t)>& progress) {
  auto writer = OdoWriter::create(output, scenario.jpeg_quality);
  if (!writer) return writer.failure();
  return Simulation(scenario, seed, **writer).run(progress);
}

}  // namespace odograph
