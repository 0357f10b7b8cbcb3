// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>

#include "plugins/shared/sensor_range.hpp"
#include "plugins/fix/gnss/correlated_error.hpp"
#include "plugins/fix/gnss/path_heading.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace {

using odograph::gnss::CorrelatedError;
using odograph::gnss::PathHeading;

constexpr double kPi = 3.14159265358979323846;
constexpr double kEquator_m = 6378137.0, kEccentricity2 = 6.69437999014e-3;  // WGS 84

/// Position fixes from the receiver, with a model of errors that persist for tens of seconds and jump.
class Gnss {
 public:
  double sigma = 10.0, sigma_factor = 1.5, min_sigma = 2.0, correlation = 20.0, bias_time = 60.0;
  int64_t min_satellites = 0;
  bool height = false, heading = true, start_only = false;
  double hold_sigma = 0.05, velocity_sigma = 0.5;

  static constexpr odo::Description description{"fix/gnss", "1.2.0", "Position and heading fixes from a GNSS receiver",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Gnss>> parameters() {
    return {
        odo::real("sigma", "m", 0.01, 1000, &Gnss::sigma, "standard deviation of a position without one"),
        odo::real("sigma_factor", "", 0.1, 100, &Gnss::sigma_factor, "factor on the receiver's own standard deviation"),
        odo::real("min_sigma", "m", 0.001, 1000, &Gnss::min_sigma, "lower bound of the standard deviation"),
        odo::real("correlation", "s", 0, 3600, &Gnss::correlation,
                  "time constant of the receiver's error; 0: positions are independent and do not jump"),
        odo::real("bias_time", "s", 1, 3600, &Gnss::bias_time, "time constant with which the bias of a jump decays"),
        odo::integer("min_satellites", 0, 100, &Gnss::min_satellites,
                     "positions from fewer are ignored (if the number is known)"),
        odo::boolean("height", &Gnss::height, "use the height as well"),
        odo::boolean("heading", &Gnss::heading, "emit the heading that rotates the walked path onto the positions"),
        odo::real("hold_sigma", "rad", 0, 3.2, &Gnss::hold_sigma,
                  "standard deviation of the phone's direction against the walk's"),
        odo::real("velocity_sigma", "m/s", 0.01, 100, &Gnss::velocity_sigma,
                  "standard deviation of a satellite velocity between buildings"),
        odo::boolean(
            "start_only", &Gnss::start_only,
            "the first position after the first pose starts the track, all others are ignored (Antigny et al. 2019, "
            "section 5.2)")};
  }

  void configured() { reset(); }
  void reset() {
    CorrelatedError::Parameters p;
    p.correlation_s = correlation, p.bias_s = bias_time;
    error_.emplace(p);
    has_origin_ = started_ = posed_ = false;
    PathHeading::Parameters h;
    h.correlation_s = std::max(0.5, correlation);
    path_.emplace(h);
    attitude_.reset();
    gyro_ = {};
  }

  void on(const odo_pose& pose, odo::Output&) {
    posed_ = true;
    constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_METRIC;
    if ((pose.header.flags & needed) != needed || (pose.header.flags & ODO_POSE_EXTRAPOLATED)) return;
    if (!(std::hypot(pose.p_n[0], pose.p_n[1]) < kFarthest_m))
      throw odo::Error(ODO_E_DISCARD, "p_n is out of range or not finite");
    error_->on_path(pose.header.t_ns, {pose.p_n[0], pose.p_n[1]}, std::sqrt(std::max(0.0, pose.covariance[14])));
  }

  /// Between buildings compass headings are wrong, and step headings with them. The path therefore follows the
  /// gyroscope's heading, which has a constant offset and a drift.
  void on(const odo_imu& imu, odo::Output&) {
    if (!(Eigen::Vector3d(imu.gyro_b).norm() <= odograph::SensorRange::rate_radps))
      throw odo::Error(ODO_E_DISCARD, "gyro_b exceeds the range of any phone's sensor");
    const double dt_s = odograph::seconds(imu.header.t_ns - gyro_.t_ns);
    if (attitude_ && dt_s > 0 && dt_s < kLongestStep_s) {
      const Eigen::Vector3d rate_b = Eigen::Vector3d(imu.gyro_b) - gyro_.bias_b;
      gyro_.heading_rad += (orientation(*attitude_) * rate_b).z() * dt_s;
    }
    gyro_.t_ns = imu.header.t_ns;
  }

  void on(const odo_attitude& attitude, odo::Output&) {
    const Eigen::Vector3d bias_b(attitude.gyro_bias_b);
    const Eigen::Quaterniond q = orientation(attitude);
    if (!bias_b.allFinite() || !q.coeffs().allFinite())
      throw odo::Error(ODO_E_DISCARD, "q_n_b or gyro_bias_b is not finite");
    if (!attitude_) gyro_.bias_b = bias_b;
    if (attitude_) {
      // The rotation about the vertical between two attitudes, which exists in every attitude, as a heading does not.
      const Eigen::Quaterniond by = q * orientation(*attitude_).conjugate();
      gyro_.attitude_heading_rad += 2 * std::atan2(by.z(), by.w());
    }
    attitude_ = attitude;
    gyro_.heading_offset_rad = std::remainder(gyro_.heading_rad - gyro_.attitude_heading_rad, 2 * kPi);
  }

  void on(const odo_step& step, odo::Output&) {
    if ((step.header.flags & ODO_STEP_HEADING) == 0) return;
    if (!std::isfinite(step.length_m) || !std::isfinite(step.heading_rad))
      throw odo::Error(ODO_E_DISCARD, "length_m or heading_rad is not finite");
    path_->add_step(step.t_start_ns, step.t_end_ns, step.length_m, step.heading_rad + gyro_.heading_offset_rad);
  }

  void on(const odo_gnss& sample, odo::Output& output) {
    if ((sample.header.flags & ODO_GNSS_POSITION) == 0) return;
    const bool on_earth = std::abs(sample.latitude_rad) <= EIGEN_PI / 2 &&
                          std::abs(sample.longitude_rad) <= 2 * EIGEN_PI &&
                          ((sample.header.flags & ODO_GNSS_HEIGHT) == 0 || std::abs(sample.height_m) < kFarthest_m);
    if (!on_earth) throw odo::Error(ODO_E_DISCARD, "latitude_rad, longitude_rad or height_m is out of range");
    if (sample.satellites > 0 && sample.satellites < min_satellites) return;
    if (start_only && (!posed_ || std::exchange(started_, true))) return;  // earlier fixes move no track
    auto fix = odo::make<odo_fix>(sample.header.t_ns);
    fix.header.flags = ODO_FIX_GEODETIC | ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
    if (sample.header.flags & ODO_GNSS_LEVER) {
      fix.header.flags |= ODO_FIX_LEVER;
      std::copy(sample.lever_b, sample.lever_b + 3, fix.lever_b);
    }
    if (height && (sample.header.flags & ODO_GNSS_HEIGHT)) fix.header.flags |= ODO_FIX_DOWN;
    fix.latitude_rad = sample.latitude_rad;
    fix.longitude_rad = sample.longitude_rad;
    fix.height_m = (sample.header.flags & ODO_GNSS_HEIGHT) ? sample.height_m : 0.0;
    double variance[3];
    for (int i = 0; i < 3; ++i) {
      const bool given = (sample.header.flags & ODO_GNSS_COVARIANCE) && sample.covariance_n[4 * i] > 0;
      const double own = given ? sample.covariance_n[4 * i] * sigma_factor * sigma_factor : sigma * sigma;
      variance[i] = std::clamp(own, min_sigma * min_sigma, kFarthest_m * kFarthest_m);
    }
    if (heading) follow(sample, std::sqrt(0.5 * (variance[0] + variance[1])), output);
    if (correlation > 0) apply_correlation(sample, variance, fix);
    for (int i = 0; i < 3; ++i) fix.covariance_n[4 * i] = variance[i];
    fix.integrity = 0.05;
    output.emit(fix);
  }

 private:
  /// About the circumference of the Earth. Larger positions or sigmas carry no information and would stay in the sums
  /// forever.
  static constexpr double kFarthest_m = 4e7;
  /// Horizontal part of the phone's top, 0 to 1, below which it counts as upright: 60 degrees from the horizontal.
  static constexpr double kUprightTop = 0.5;
  static constexpr double kLongestStep_s = 0.2;  ///< between samples of a gyroscope

  /// Heading by the gyroscope alone, about the attitude's vertical.
  struct Gyro {
    int64_t t_ns = 0;
    double heading_rad = 0, attitude_heading_rad = 0, heading_offset_rad = 0;
    /// Initial estimate, kept so that the remaining bias is constant.
    Eigen::Vector3d bias_b = Eigen::Vector3d::Zero();
  };

  static Eigen::Quaterniond orientation(const odo_attitude& attitude) { return odograph::quaternion(attitude.q_n_b); }

  /// North and east about the first position, m.
  Eigen::Vector2d seen_at(const odo_gnss& sample) {
    if (!std::exchange(has_origin_, true)) {
      latitude_rad_ = sample.latitude_rad, longitude_rad_ = sample.longitude_rad;
      const double s = std::sin(latitude_rad_), w = std::sqrt(1 - kEccentricity2 * s * s);
      north_per_rad_ = kEquator_m * (1 - kEccentricity2) / (w * w * w);
      east_per_rad_ = kEquator_m / w * std::cos(latitude_rad_);
    }
    return {(sample.latitude_rad - latitude_rad_) * north_per_rad_,
            std::remainder(sample.longitude_rad - longitude_rad_, 2 * kPi) * east_per_rad_};
  }

  /// Emits the heading that fits the whole path to all positions so far, if its uncertainty has decreased.
  void follow(const odo_gnss& sample, double sigma_m, odo::Output& output) {
    path_->add_position(sample.header.t_ns, seen_at(sample), sigma_m);
    if (sample.header.flags & ODO_GNSS_VELOCITY)
      path_->add_velocity(sample.header.t_ns, {sample.velocity_n[0], sample.velocity_n[1]}, velocity_sigma);
    if (!attitude_) return;
    const auto yaw = path_->new_information();
    if (!yaw) return;
    // On a phone held upright the top has no heading, so the back is used.
    const Eigen::Quaterniond q_n_b = orientation(*attitude_);
    const bool upright = (q_n_b * Eigen::Vector3d::UnitY()).head<2>().norm() < kUprightTop;
    const Eigen::Vector3d axis_b = upright ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ()) : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d axis_n = q_n_b * axis_b;
    auto fix = odo::make<odo_fix>(attitude_->header.t_ns);
    fix.header.flags = ODO_FIX_YAW | ODO_FIX_INTEGRITY;
    Eigen::Vector3d::Map(fix.yaw_axis_b) = axis_b;
    fix.yaw_rad = std::remainder(std::atan2(axis_n.y(), axis_n.x()) + gyro_.heading_offset_rad + yaw->rad, 2 * kPi);
    if (!std::isfinite(fix.yaw_rad))
      throw odo::Error(ODO_E_DISCARD, "steps or attitudes out of any range gave no heading");
    fix.yaw_sigma_rad = std::hypot(yaw->sigma_rad, hold_sigma);
    fix.integrity = 0.05;
    output.emit(fix);
  }

  /// Removes a jump's bias from the fix and sets the variance that gives correlated fixes their correct total weight.
  void apply_correlation(const odo_gnss& sample, double (&variance)[3], odo_fix& fix) {
    const Eigen::Vector2d seen = seen_at(sample);
    const double own = 0.5 * (variance[0] + variance[1]);
    const auto corrected = error_->on_position(sample.header.t_ns, seen, std::sqrt(own));
    const Eigen::Vector2d off = seen - corrected.position_m;
    fix.latitude_rad -= off.x() / north_per_rad_;
    fix.longitude_rad -= off.y() / east_per_rad_;
    for (double& v : variance) v *= corrected.sigma_m * corrected.sigma_m / own;
  }

  std::optional<CorrelatedError> error_;
  std::optional<PathHeading> path_;
  std::optional<odo_attitude> attitude_;
  Gyro gyro_;
  bool has_origin_ = false, started_ = false, posed_ = false;
  double latitude_rad_ = 0, longitude_rad_ = 0, north_per_rad_ = 1, east_per_rad_ = 1;
};

}  // namespace

ODO_PLUGIN(Gnss)
