// SPDX-License-Identifier: Apache-2.0
#include "tests/host/mistakes.hpp"

namespace odograph {
namespace {

std::function<void(odo_imu&)> scaled(double gyro, double accel) {
  return [=](odo_imu& m) {
    for (double& x : m.gyro_b) x *= gyro;
    for (double& x : m.accel_b) x *= accel;
  };
}

/// Of the accelerometer alone, or of both.
std::function<void(odo_imu&)> exchanged(std::array<int, 3> from, std::array<double, 3> sign, bool both = false,
                                        bool gyro = false) {
  return [=](odo_imu& m) {
    const auto exchange = [&](double* x) {
      const double old[3] = {x[0], x[1], x[2]};
      for (size_t i = 0; i < 3; ++i) x[i] = sign[i] * old[from[i]];
    };
    if (!gyro) exchange(m.accel_b);
    if (gyro || both) exchange(m.gyro_b);
  };
}

std::vector<uint8_t> turned(const std::vector<uint8_t>& from, int quarters) {
  std::vector<uint8_t> out = from;
  int w = Pictures::kWidth, h = Pictures::kHeight;
  for (int k = 0; k < quarters; ++k) {  // clockwise
    std::vector<uint8_t> next(out.size());
    for (int v = 0; v < h; ++v)
      for (int u = 0; u < w; ++u)
        next[size_t(u) * size_t(h) + size_t(h - 1 - v)] = out[size_t(v) * size_t(w) + size_t(u)];
    out = next;
    std::swap(w, h);
  }
  return out;
}

std::function<void(std::vector<uint8_t>&, odo_frame&)> turned_by(int quarters) {
  return [=](std::vector<uint8_t>& pixels, odo_frame& frame) {
    pixels = turned(pixels, quarters);
    if (quarters % 2) std::swap(frame.width, frame.height);
  };
}

/// The calibration's size for a picture turned by a quarter.
void upright(odo_calibration& c) { std::swap(c.width, c.height), std::swap(c.cx, c.cy); }

template <class Message>
std::function<void(App&, int64_t)> with(uint32_t type, std::function<void(Message&)> fill) {
  return [=](App& app, int64_t t_ns) {
    auto m = make_message<Message>(type, t_ns);
    fill(m);
    app.push(m);
  };
}

}  // namespace

std::function<void(App&, int64_t)> circle(bool exchanged, double sign) {
  return [=](App& app, int64_t t_ns) {
    const double turned = 0.2e-9 * static_cast<double>(t_ns - kStart_ns), earth_m = 6371000;
    with<odo_gnss>(ODO_TYPE_GNSS, [&](odo_gnss& m) {
      m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
      m.latitude_rad = 0.84 + 7 * std::sin(turned) / earth_m;
      m.longitude_rad = sign * (0.25 - 7 * std::cos(turned) / earth_m / std::cos(0.84));
      if (exchanged) std::swap(m.latitude_rad, m.longitude_rad);
      m.covariance_n[0] = m.covariance_n[4] = m.covariance_n[8] = 1;
    })(app, t_ns);
  };
}

std::function<void(App&, int64_t)> walk(double velocity, bool east_first) {
  return [=](App& app, int64_t t_ns) {
    const double turned = 2.0 / 30 * 1e-9 * static_cast<double>(t_ns - kStart_ns), earth_m = 6371000;
    with<odo_gnss>(ODO_TYPE_GNSS, [&](odo_gnss& m) {
      m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE | ODO_GNSS_VELOCITY;
      m.latitude_rad = 0.84 + 30 * std::sin(turned) / earth_m;
      m.longitude_rad = 0.25 - 30 * std::cos(turned) / earth_m / std::cos(0.84);
      m.covariance_n[0] = m.covariance_n[4] = m.covariance_n[8] = 1;
      m.velocity_n[0] = 2 * velocity * std::cos(turned), m.velocity_n[1] = 2 * velocity * std::sin(turned);
      if (east_first) std::swap(m.velocity_n[0], m.velocity_n[1]);
    })(app, t_ns);
  };
}

void Mistakes::units() {
  add("accelerations in g", "accel_in_g", "9.80665").imu = scaled(1, 1 / 9.80665);
  add("iOS' accelerations", "accel_in_g", "-9.80665").imu = scaled(1, -1 / 9.80665);
  add("accelerations in mg", "wild_imu", "0.00980665").imu = scaled(1, 1000 / 9.80665);
  auto& removed = add("linear acceleration", "accel_without_gravity", "gravity");
  removed.imu = [m = removed.motion](odo_imu& imu) {
    const Vector3d up_b =
        m.q_n_b(1e-9 * static_cast<double>(imu.header.t_ns - kStart_ns)).conjugate() * Vector3d(0, 0, -9.81);
    Vector3d::Map(imu.accel_b) -= up_b;
  };
  auto& removed_at_rest = add("linear acceleration of a phone at rest", "accel_without_gravity", "gravity");
  removed_at_rest.motion = {0, 0, kNoSurge, 0};
  removed_at_rest.imu = [](odo_imu& imu) { imu.accel_b[0] = 0.01, imu.accel_b[1] = imu.accel_b[2] = 0.02; };
  auto& feet = add("accelerations in ft/s^2", "accel_level", "unit");
  feet.imu = scaled(1, 3.28084);
  auto& level = add("an accelerometer 16 % too high, at rest", "accel_level", "scale error");
  level.motion = {0, 0.05, kNoSurge, 0}, level.imu = scaled(1, 1.16);
  auto& low = add("an accelerometer 16 % too low, at rest", "accel_level", "scale error");
  low.motion = {0, 0.05, kNoSurge, 0}, low.imu = scaled(1, 0.84);
  add("an accelerometer that ends at 10.5 m/s^2", "accel_clipped", "range").imu = [](odo_imu& m) {
    for (double& x : m.accel_b) x = std::clamp(x, -10.5, 10.5);
  };
  auto& degrees = add("rates in deg/s", "gyro_in_degrees", "pi/180");
  degrees.motion.swing_rad = 0.4, degrees.imu = scaled(180 / EIGEN_PI, 1);
  auto& walking = add("rates in deg/s of a phone that is held up", "gyro_in_degrees", "pi/180");
  walking.motion.swing_rad = 0.12, walking.imu = scaled(180 / EIGEN_PI, 1);
  auto& fast = add("fast rates in deg/s", "wild_imu", "pi/180");
  fast.motion.swing_rad = 1, fast.imu = scaled(180 / EIGEN_PI, 1);
  add("rates of the opposite sign", "gyro_sign", "-1").imu = scaled(-1, 1);
  auto& biased = add("a gyroscope with a bias of 0.2 rad/s", "gyro_bias", "mean at rest");
  biased.seconds = 20, biased.motion.swing_rad = 0.1, biased.imu = [](odo_imu& m) { m.gyro_b[0] += 0.2; };
  auto& in_degrees_at_rest = add("a bias of half a degree a second, in degrees, at rest", "gyro_bias", "degrees");
  in_degrees_at_rest.seconds = 20, in_degrees_at_rest.motion = {0, 0, kNoSurge, 0};
  in_degrees_at_rest.imu = [](odo_imu& m) { m.gyro_b[2] = 0.5, m.gyro_b[0] = m.gyro_b[1] = 0.1; };
  add("rates of a range twice as large", "gyro_wrong", "scale factor").imu = scaled(2, 1);
  add("angles since the sample before for rates", "gyro_wrong", "rad/s").imu = scaled(0.005, 1);
  auto& silent = add("no gyroscope", "gyro_silent", "gyroscope");
  silent.motion.swing_rad = 0.9, silent.imu = scaled(0, 1);
}

void Mistakes::axes() {
  const std::array<double, 3> plus{1, 1, 1};
  add("accelerometer y x z", "imu_axes", "(y, x, z)").imu = exchanged({1, 0, 2}, plus);
  add("accelerometer y z x", "imu_axes", "(z, x, y)").imu = exchanged({1, 2, 0}, plus);
  add("accelerometer -y x z", "imu_axes", "axes").imu = exchanged({1, 0, 2}, {-1, 1, 1});
  add("accelerometer -x y z", "imu_axes", "axes").imu = exchanged({0, 1, 2}, {-1, 1, 1});
  add("accelerometer x y -z", "imu_axes", "axes").imu = exchanged({0, 1, 2}, {1, 1, -1});
  add("gyroscope y x z", "imu_axes", "axes").imu = exchanged({1, 0, 2}, plus, false, true);
  add("gyroscope x y -z", "imu_axes", "gyro_b were (x, y, -z)").imu = exchanged({0, 1, 2}, {1, 1, -1}, false, true);
  add("a left-handed engine's axes", "gyro_sign", "left-handed").imu = exchanged({0, 1, 2}, {1, 1, -1}, true);
}

void Mistakes::cameras() {
  auto& clockwise = with_camera("pictures turned clockwise", "picture_turned", "90");
  clockwise.frame = turned_by(1), clockwise.calibration = upright;
  with_camera("pictures upside down", "picture_turned", "180").frame = turned_by(2);
  auto& anticlockwise = with_camera("pictures turned anticlockwise", "picture_turned", "270");
  anticlockwise.frame = turned_by(3), anticlockwise.calibration = upright;
  with_camera("mirrored pictures", "picture_mirrored", "front camera").frame = [](std::vector<uint8_t>& pixels,
                                                                                  odo_frame&) {
    for (int v = 0; v < Pictures::kHeight; ++v)
      std::reverse(pixels.begin() + v * Pictures::kWidth, pixels.begin() + (v + 1) * Pictures::kWidth);
  };
  with_camera("the front camera's mount", "picture_mirrored", "q_b_c").calibration = [](odo_calibration& c) {
    put_quaternion(rear_camera_mount() * Quaterniond(Eigen::AngleAxisd(EIGEN_PI, Vector3d::UnitY())), c.q_b_c);
  };
  with_camera("a mount that looks along the phone", "camera_mount", "q_b_c").calibration = [](odo_calibration& c) {
    put_quaternion(rear_camera_mount() * Quaterniond(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vector3d::UnitX())), c.q_b_c);
  };
  with_camera("no mount", "picture_turned", "180").calibration = [](odo_calibration& c) {
    put_quaternion(rear_camera_mount() * Quaterniond(Eigen::AngleAxisd(EIGEN_PI, Vector3d::UnitZ())), c.q_b_c);
  };
  with_camera("twice the focal length", "focal_length", "picture size").calibration = [](odo_calibration& c) {
    c.fx *= 2, c.fy *= 2;
  };
  with_camera("half the focal length", "focal_length", "picture size").calibration = [](odo_calibration& c) {
    c.fx /= 2, c.fy /= 2;
  };
  for (const double factor : {1.5, 1 / 1.5})
    with_camera(factor > 1 ? "a focal length half as long again" : "two thirds of the focal length", "focal_length",
                "picture size")
        .calibration = [factor](odo_calibration& c) { c.fx *= factor, c.fy *= factor; };
}

void Mistakes::pictures() {
  with_camera("a head-up display in the pictures", "picture_overlay", "drawn over").frame =
      [](std::vector<uint8_t>& pixels, odo_frame&) {
        for (int v = 0; v < 12; ++v)  // a status bar with letters
          for (int u = 0; u < Pictures::kWidth; ++u)
            pixels[size_t(v) * Pictures::kWidth + size_t(u)] = (u / 3 * 5 + v / 3 * 7) % 11 < 4 ? 240 : 40;
      };
  with_camera("frames 0.15 s late", "picture_time", "time_offset").frame = [](std::vector<uint8_t>&, odo_frame& f) {
    f.header.t_ns -= 150'000'000;
  };
  for (const double rate : {1.02, 0.98}) {
    auto& input = with_camera(rate > 1 ? "an IMU whose clock runs 2 % fast" : "an IMU whose clock runs 2 % slow",
                              "picture_time", "fast or slow");
    input.motion.swing_rad = 0.3;
    input.imu = [rate](odo_imu& m) {
      m.header.t_ns = kStart_ns + static_cast<int64_t>(rate * static_cast<double>(m.header.t_ns - kStart_ns));
    };
  }
  with_camera("frames 0.3 s ahead", "camera_clock", "time_offset").frame = [](std::vector<uint8_t>&, odo_frame& f) {
    f.header.t_ns += 300'000'000;
  };
  auto& frozen = with_camera("the same picture again", "picture_repeated", "same frame");
  frozen.frame = [first = std::make_shared<std::vector<uint8_t>>()](std::vector<uint8_t>& pixels, odo_frame&) {
    if (first->empty()) *first = pixels;
    pixels = *first;
  };
  auto& doubled = with_camera("each picture twice", "picture_repeated", "each frame once");
  doubled.frame = [last = std::make_shared<std::vector<uint8_t>>(), i = 0](std::vector<uint8_t>& pixels,
                                                                           odo_frame&) mutable {
    if (i++ % 2) pixels = *last;
    *last = pixels;
  };
  for (const int padding : {16, -16}) {  // a buffer of rows of another length, read as if it had none or some
    with_camera("rows of 160 pixels, read with another stride", "picture_rows", "row_stride").frame =
        [padding](std::vector<uint8_t>& pixels, odo_frame&) {
          std::vector<uint8_t> rows(pixels.size(), 16);
          const int length = Pictures::kWidth + padding;
          for (int v = 0; v < Pictures::kHeight; ++v)
            for (int u = 0; u < std::min(length, Pictures::kWidth); ++u)
              if (const size_t to = size_t(v) * size_t(length) + size_t(u); to < rows.size())
                rows[to] = pixels[size_t(v) * Pictures::kWidth + size_t(u)];
          pixels = rows;
        };
  }
  with_camera("a camera an hour ahead", "dropped_frame", "IMU's clock").frame =
      [](std::vector<uint8_t>&, odo_frame& f) { f.header.t_ns += 3'600'000'000'000; };
  with_camera("a camera an hour behind", "dropped_frame", "IMU's clock").frame =
      [](std::vector<uint8_t>&, odo_frame& f) { f.header.t_ns -= 3'600'000'000'000; };
}

void Mistakes::clocks() {
  add("times in ms", "time_unit", "1,000,000").time = [](int64_t t_ns) { return t_ns / 1'000'000; };
  add("times in us", "time_unit", "1,000").time = [](int64_t t_ns) { return t_ns / 1'000; };
  add("times in ns that were multiplied once more", "imu_slow", "unit").time = [](int64_t t_ns) { return t_ns * 1000; };
  auto& slow = add("five samples a second", "imu_slow", "too slow");
  slow.hz = 5;
  add("pressure in hPa", "wild_barometer", "hPa").further =
      with<odo_barometer>(ODO_TYPE_BAROMETER, [](odo_barometer& m) { m.pressure_pa = 1013.25; });
  add("pressure in kPa", "wild_barometer", "kPa").further =
      with<odo_barometer>(ODO_TYPE_BAROMETER, [](odo_barometer& m) { m.pressure_pa = 101.3; });
  const auto field = [](double scale) {
    return with<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, [scale](odo_magnetometer& m) {
      m.field_b[0] = 20e-6 * scale, m.field_b[2] = -44e-6 * scale;
    });
  };
  add("field in uT", "wild_magnetometer", "uT").further = field(1e6);
  add("field in nT", "wild_magnetometer", "nT").further = field(1e9);
  add("field in gauss", "wild_magnetometer", "gauss").further = field(1e4);
  const auto place = [](double latitude, double longitude, int64_t later_ns) {
    return with<odo_gnss>(ODO_TYPE_GNSS, [=](odo_gnss& m) {
      m.header.t_ns += later_ns, m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
      m.latitude_rad = latitude, m.longitude_rad = longitude;
      m.covariance_n[0] = m.covariance_n[4] = m.covariance_n[8] = 25;
    });
  };
  add("latitude in degrees", "invalid_gnss", "degrees").further = place(48.1, 11.5, 0);
  add("GNSS in Unix time", "dropped_gnss", "IMU's clock").further = place(0.84, 0.2, 1'700'000'000'000'000'000);
}

void Mistakes::sampling() {
  auto& batched = add("samples in batches of 20, with the time of arrival", "imu_batched", "arrival");
  batched.time = [](int64_t t_ns) {
    const int64_t sample = (t_ns - kStart_ns) / 5'000'000;
    return kStart_ns + (sample / 20 + 1) * 100'000'000 + sample % 20 * 10'000;
  };
  add("a timer at 200 Hz for a sensor of 12.5 Hz", "imu_repeated", "timer").imu = [last = odo_imu{},
                                                                                   i = 0](odo_imu& m) mutable {
    if (i++ % 16 == 0) last = m;
    std::copy_n(last.accel_b, 3, m.accel_b), std::copy_n(last.gyro_b, 3, m.gyro_b);
  };
  add("one half of each sample", "imu_half_filled", "ODO_IMU_GYRO").imu = [i = 0](odo_imu& m) mutable {
    std::fill_n(i++ % 2 ? m.accel_b : m.gyro_b, 3, 0.0);
  };
  auto& gravity = add("the gravity sensor", "accel_filtered", "gravity sensor");
  gravity.imu = [](odo_imu& m) { Vector3d::Map(m.accel_b) = 9.80665 * Vector3d(m.accel_b).normalized(); };
}

void Mistakes::others() {
  with_camera("no principal point", "principal_point", "cx").calibration = [](odo_calibration& c) { c.cx = c.cy = 0; };
  const auto place = [](double latitude_rad) {
    return with<odo_gnss>(ODO_TYPE_GNSS, [=](odo_gnss& m) {
      m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
      m.latitude_rad = latitude_rad, m.longitude_rad = 0.2;
      m.covariance_n[0] = m.covariance_n[4] = m.covariance_n[8] = 25;
    });
  };
  add("positions of 0, 0", "gnss_unset", "no position").further =
      with<odo_gnss>(ODO_TYPE_GNSS, [](odo_gnss& m) { m.header.flags = ODO_GNSS_POSITION; });
  auto& old = add("the last known position again and again", "gnss_repeated", "old position");
  old.seconds = 25, old.further = place(0.84);
  auto& exchanged = add("latitude and longitude exchanged", "gnss_mirrored", "exchanged");
  exchanged.seconds = 60, exchanged.motion = {0.1, 2.5, kNoSurge, 0.2}, exchanged.further = circle(true, 1);
  auto& unsigned_west = add("a longitude without its sign", "gnss_mirrored", "West");
  unsigned_west.seconds = 60, unsigned_west.motion = {0.1, 2.5, kNoSurge, 0.2},
  unsigned_west.further = circle(false, -1);
  for (const auto& [factor, named] : {std::pair(3.6, "is 3.6 times"), std::pair(1.94384, "is 1.94"),
                                      std::pair(1000.0, "is 1000 times"), std::pair(1.0, "(y, x, z)")}) {
    auto& velocity = add("a velocity in km/h, in knots, in mm/s, east first", "gnss_velocity", named);
    velocity.seconds = 60, velocity.motion = {0.1, 2.5, kNoSurge, 2.0 / 30};
    velocity.further = walk(factor, factor == 1);
  }
  auto& field = add("a field in the axes of the camera", "magnetometer_axes", "axes of accel_b");
  field.seconds = 20;
  field.further = [=, m = field.motion](App& app, int64_t t_ns) {
    place(0.84 + 1e-9 * static_cast<double>(t_ns % 1000))(app, t_ns);
    const Vector3d field_b =
        m.q_n_b(1e-9 * static_cast<double>(t_ns - kStart_ns)).conjugate() * Vector3d(20e-6, 0, 44e-6);
    with<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, [&](odo_magnetometer& of) {
      of.header.flags = ODO_MAGNETOMETER_CORRECTED;
      of.field_b[0] = field_b.x(), of.field_b[1] = -field_b.y(), of.field_b[2] = -field_b.z();
    })(app, t_ns);
  };
}

}  // namespace odograph
