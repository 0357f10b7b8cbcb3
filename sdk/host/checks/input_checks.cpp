// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/input_checks.hpp"

#include <cmath>
#include <cstdio>
#include <string>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

/// What is said of a fault: %V the measured value, %A the axes that would fit, %B of what. docs/input_checks.md has the
/// limits.
struct Row {
  const char* key;
  const char* text;
};

constexpr Row kRows[] = {
    {"accel_in_g",
     "accel_b has a norm of %V; expected 9.8 m/s^2: in g? Multiply by 9.80665; by -9.80665 if it is iOS' Core "
     "Motion, whose sign is opposite"},
    {"accel_without_gravity",
     "accel_b has no gravity (mean norm %V m/s^2); expected the specific force, 9.8 m/s^2 upwards at "
     "rest: use the accelerometer, not the linear acceleration; in iOS userAcceleration + gravity"},
    {"accel_level", "accel_b has a norm of %V m/s^2; expected 9.8 within 10 %: another unit, or a scale error?"},
    {"accel_clipped",
     "accel_b stays at %V m/s^2 in one of twenty samples or more: it is clipped; choose a larger range"},
    {"accel_filtered",
     "the norm of accel_b varies by %V m/s^2 only while gyro_b turns; expected the accelerometer, not the gravity "
     "sensor or a filtered one"},
    {"gyro_in_degrees",
     "gyro_b turns 57 times as far as gravity in accel_b or the picture: in degrees per second? Multiply by "
     "pi/180"},
    {"gyro_sign",
     "gyro_b turns gravity in accel_b the wrong way; expected right-handed rates about the axes of accel_b: "
     "multiply by -1, or convert both from left-handed axes"},
    {"gyro_silent", "gyro_b is 0 while gravity in accel_b turns by %V rad: is there a gyroscope?"},
    {"gyro_bias",
     "gyro_b turns at %V rad/s about an axis that is not vertical while gravity in accel_b stays: subtract its mean at "
     "rest; or is it in degrees per second?"},
    {"imu_axes",
     "accel_b and gyro_b do not have the same axes: gravity would fit the rotation if %B were %A of what it is"},
    {"gyro_wrong",
     "gravity in accel_b turns, and gyro_b turns it otherwise (%V rad are left), which no unit and no exchange of axes "
     "explains; expected rad/s about all three axes at the time of accel_b: a wrong scale factor, one axis in another "
     "unit, old or empty values?"},
    {"picture_turned",
     "pictures are turned clockwise by %V degrees against the camera's mount: turn them back, or q_b_c with them (by "
     "180 also where accel_b and gyro_b are in left-handed axes)"},
    {"picture_mirrored",
     "pictures are mirrored against the camera's mount: those of a front camera? Expected as the lens sees "
     "it, and q_b_c of that camera"},
    {"camera_mount",
     "the pictures' rotation contradicts the camera's mount; q_b_c would fit with the camera's axes %A, or "
     "accel_b and gyro_b are in other axes than b"},
    {"focal_length",
     "pictures shift as with a focal length of %V pixels; expected that of the calibration: is it for another "
     "picture size?"},
    {"principal_point",
     "the calibration's cx or cy lies %V of the picture's size off its middle; expected pixels of this picture size"},
    {"picture_time",
     "the frames' times are %V s too early (negative: too late) by the rotation that gyro_b shows; expected times of "
     "the IMU's clock, or this time_offset in the calibration; if it grows, one of the clocks runs fast or slow"},
    {"camera_clock",
     "frames are %V s ahead of the inertial samples when they are pushed; expected times of the IMU's "
     "clock, or time_offset in the calibration"},
    {"picture_repeated",
     "%V % of the pictures are identical to the one before while gyro_b turns: does the camera deliver the same frame "
     "again? Expected each frame once"},
    {"picture_overlay",
     "%V % of the pictures' edges stay in place while gyro_b turns: is something drawn over them? Expected the "
     "camera's own pictures; draw on a copy"},
    {"picture_rows",
     "each row of the pictures is displaced by %V pixels against the one above: is row_stride that of the plane? "
     "Expected the bytes from one row to the next, which can be more than the width"},
    {"time_unit",
     "inertial samples are %V ns apart; expected nanoseconds: in ms (multiply by 1,000,000) or us (by 1,000)?"},
    {"imu_slow",
     "inertial samples are %V s apart; expected at most 0.02 s: sampling too slow, or times in another unit?"},
    {"imu_batched",
     "inertial samples come in bursts, %V s apart within them: are these times of arrival? Expected those at which the "
     "sensor was read, which the system states with each sample"},
    {"imu_repeated",
     "%V % of the inertial samples repeat the one before: does a timer push the latest values? Expected each sample of "
     "the sensor once, with its own time"},
    {"imu_half_filled",
     "accel_b or gyro_b is 0 in %V % of the inertial samples: set ODO_IMU_GYRO and ODO_IMU_ACCEL only where the values "
     "are filled"},
    {"gnss_unset",
     "the position of gnss is latitude 0, longitude 0: not filled? Expected no position (without ODO_GNSS_POSITION, or "
     "no sample at all) until the receiver has one"},
    {"gnss_repeated",
     "all positions are the same since %V s of walking: an old position? Expected those that the receiver measures, "
     "with the time of each"},
    {"gnss_mirrored",
     "the way by gnss bends to the other side than gyro_b turns (%V rad): latitude and longitude exchanged, or the "
     "sign of one lost? West and south are negative"},
    {"gnss_velocity",
     "velocity_n is %V times the path by the positions, whose axes are %A of it (x north, y east); expected 1 and "
     "(x, y, z): in km/h, knots, mm/s, or with the axes east, north, up?"},
    {"magnetometer_axes",
     "the magnetic field's inclination is %V rad, of the other hemisphere: is field_b in the axes of accel_b?"},
};
static_assert(std::size(kRows) == static_cast<size_t>(InputFault::kCount));

static_assert(std::size(kRows) <= 32, "a bit for each");

uint32_t bit(InputFault fault) { return 1u << static_cast<uint32_t>(fault); }

constexpr uint32_t kOfPictures = 1u << uint32_t(InputFault::picture_turned) |
                                 1u << uint32_t(InputFault::picture_mirrored) |
                                 1u << uint32_t(InputFault::camera_mount) | 1u << uint32_t(InputFault::focal_length) |
                                 1u << uint32_t(InputFault::picture_time);
/// Faults of sampling, of which many others are consequences.
constexpr uint32_t kOfSampling = 1u << uint32_t(InputFault::imu_batched) | 1u << uint32_t(InputFault::imu_repeated) |
                                 1u << uint32_t(InputFault::imu_half_filled);
/// Faults that the shift of the pictures would show too: inertial ones, and what is drawn over them.
constexpr uint32_t kOfRotation = 1u << uint32_t(InputFault::gyro_in_degrees) | 1u << uint32_t(InputFault::gyro_sign) |
                                 1u << uint32_t(InputFault::gyro_silent) | 1u << uint32_t(InputFault::gyro_bias) |
                                 1u << uint32_t(InputFault::imu_axes) | 1u << uint32_t(InputFault::gyro_wrong) |
                                 1u << uint32_t(InputFault::picture_overlay);

std::string words(const Row& row, double value, const SignedAxes& axes) {
  char number[32];
  std::snprintf(number, sizeof number, "%.4g", value);
  std::string out = row.text;
  for (const auto& [mark, text] : {std::pair<const char*, std::string>{"%V", number},
                                   {"%A", axes.text()},
                                   {"%B", value < 0 ? "gyro_b" : "accel_b"}})
    if (const size_t at = out.find(mark); at != std::string::npos) out.replace(at, 2, text);
  return out;
}

}  // namespace

InputChecks::InputChecks(HostServices& host)
    : host_(host),
      motion_([this](auto... what) { found(what...); }),
      picture_([this](auto... what) { found(what...); }) {}

void InputChecks::found(InputFault fault, bool wrong, double value, const SignedAxes& axes) {
  const bool of_sampling = ((kOfSampling | bit(InputFault::time_unit)) & bit(fault)) != 0;
  const uint32_t causes = of_sampling ? 0 : kOfSampling | (kOfPictures & bit(fault) ? kOfRotation : 0);
  if (wrong && (wrong_ & causes)) wrong = false;  // a consequence
  const uint32_t before = wrong ? wrong_.fetch_or(bit(fault)) : wrong_.fetch_and(~bit(fault));
  if (((before & bit(fault)) != 0) == wrong) return;
  const Row& row = kRows[static_cast<size_t>(fault)];
  if (wrong)
    host_.report(0, ODO_SEVERITY_WARNING, row.key, words(row, value, axes), ODO_E_ARGUMENT);
  else
    host_.report(0, ODO_SEVERITY_INFO, row.key, "no longer");
}

void InputChecks::on_push(const odo_header& sample) {
  if (sample.type != ODO_TYPE_IMU && sample.type != ODO_TYPE_FRAME) return;
  const std::lock_guard lock(mutex_);
  if (sample.type == ODO_TYPE_FRAME) {
    const int64_t ahead_ns = imu_ns_ == INT64_MIN ? 0 : saturating_difference(sample.t_ns, imu_ns_);
    const bool inertial = std::exchange(imu_since_frame_, false);  // otherwise it is silent, not behind
    frames_ahead_ = inertial && ahead_ns > p_.frame_ahead_ns ? frames_ahead_ + 1 : 0;
    if (frames_ahead_ == 0 || frames_ahead_ > p_.frames_ahead)
      found(InputFault::camera_clock, frames_ahead_ > 0, seconds(ahead_ns), {});
    return;
  }
  imu_ns_ = sample.t_ns, imu_since_frame_ = true;
  sampling_[sample.flags & (ODO_IMU_GYRO | ODO_IMU_ACCEL)].add(as<odo_imu>(sample),
                                                               [this](auto... what) { found(what...); });
}

void InputChecks::on_sample(const odo_header& sample) {
  const bool of_camera = sample.type == ODO_TYPE_CALIBRATION || sample.type == ODO_TYPE_FRAME;
  if (of_camera && !std::exchange(has_camera_, true)) camera_ = sample.source;
  if (of_camera && sample.source != camera_) return;
  if (sample.type == ODO_TYPE_CALIBRATION) picture_.add(as<odo_calibration>(sample));
  if (sample.type == ODO_TYPE_FRAME) picture_.add(as<odo_frame>(sample));
  if (sample.type == ODO_TYPE_GNSS) add(as<odo_gnss>(sample));
  if (sample.type == ODO_TYPE_MAGNETOMETER) add(as<odo_magnetometer>(sample));
}

void InputChecks::add(const odo_gnss& gnss) {
  if ((gnss.header.flags & ODO_GNSS_POSITION) == 0) return;
  const bool unset = gnss.latitude_rad == 0 && gnss.longitude_rad == 0;
  found(InputFault::gnss_unset, unset, 0, {});
  if (unset) return;
  course_.add(gnss, [this](auto... what) { found(what...); });
  const bool same = gnss.latitude_rad == place_.latitude_rad && gnss.longitude_rad == place_.longitude_rad;
  if (!same) place_ = gnss, walked_s_ = motion_.walked_s(), places_ = 0;
  ++places_;
  const double walked_s = motion_.walked_s() - walked_s_;
  if (!same || places_ >= p_.repeated_places)
    found(InputFault::gnss_repeated, walked_s > p_.repeated_walk_s, walked_s, {});
}

void InputChecks::add(const odo_magnetometer& magnetometer) {
  const Eigen::Vector3d field_b(magnetometer.field_b), up_b = motion_.force_b();
  const bool far = std::abs(place_.latitude_rad) > p_.min_latitude_rad;                  // from the magnetic equator
  const bool corrected = (magnetometer.header.flags & ODO_MAGNETOMETER_CORRECTED) != 0;  // else with the phone's own
  if (!corrected || !far || up_b.isZero() || field_b.isZero()) return;
  if (seconds(saturating_difference(magnetometer.header.t_ns, dip_ns_)) < 1) return;
  dip_ns_ = magnetometer.header.t_ns;
  const double dip_rad = std::asin(-field_b.normalized().dot(up_b.normalized()));
  const double north_rad = place_.latitude_rad > 0 ? dip_rad : -dip_rad;
  wrong_dips_ = north_rad < -p_.min_dip_rad ? wrong_dips_ + 1 : 0;
  found(InputFault::magnetometer_axes, wrong_dips_ >= p_.wrong_dips, dip_rad, {});
}

void InputChecks::on_imu(const odo_imu& imu) {
  if ((imu.header.flags & ODO_IMU_GYRO) == 0) return;
  picture_.add(imu);
  if (imu.header.flags & ODO_IMU_ACCEL) motion_.add(imu);
  const double step_s = seconds(saturating_difference(imu.header.t_ns, std::exchange(turned_ns_, imu.header.t_ns)));
  const Eigen::Vector3d up_b = motion_.force_b();
  if (!up_b.isZero() && step_s > 0 && step_s < p_.max_step_s)
    course_.turn(-step_s * up_b.normalized().dot(Eigen::Vector3d(imu.gyro_b)));
}

void InputChecks::reset() {
  wrong_ = 0;
  motion_.reset();
  picture_.reset();
  course_.reset();
  place_ = {}, places_ = wrong_dips_ = 0, dip_ns_ = turned_ns_ = 0;
}

}  // namespace odograph
