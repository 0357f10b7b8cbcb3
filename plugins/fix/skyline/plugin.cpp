// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "plugins/camera/frame_view.hpp"
#include "plugins/fix/skyline/matcher.hpp"

namespace {

using namespace odograph::skyline;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNowhere_m = 1000;
constexpr int kDoubtful = 4;  // failures in a row
constexpr double kMostTilt_rad = 3 * kDegree;
constexpr double kRival = 0.2;  // of another place's likelihood

/// Fixes from the skyline around an upward camera and a 3D city model: section 3.2 of Gakne & O'Keefe 2018.
class Skyline {
 public:
  std::string model;
  std::array<double, 3> model_origin = {0, 0, 0};
  double interval = 0.5, min_agreement = 0.75, tilt_sigma = 0.6 * kDegree, min_sigma = 0.3, radius = 40;

  static constexpr odo::Description description{
      "fix/skyline", "1.0.0", "Position and heading from the skyline of a 3D city model (Gakne & O'Keefe 2018)",
      ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Skyline>> parameters() {
    return {odo::text("model", &Skyline::model, "CityJSON file of the buildings, beside the config"),
            odo::reals("model_origin", "m", -1e8, 1e8, &Skyline::model_origin,
                       "easting, northing and height of n's origin in the model"),
            odo::real("interval", "s", 0, 3600, &Skyline::interval, "time between two fixes at least"),
            odo::real("radius", "m", 2, 200, &Skyline::radius, "farthest from the prior that is searched"),
            odo::real("min_agreement", "", 0.1, 1, &Skyline::min_agreement,
                      "part of the directions in which picture and model must agree"),
            odo::real("tilt_sigma", "rad", 0.0001, 0.5, &Skyline::tilt_sigma,
                      "least standard deviation of the prior's inclination"),
            odo::real("min_sigma", "m", 0.001, 100, &Skyline::min_sigma, "smallest standard deviation believed")};
  }

  void configured(odo::Output& host) {
    if (model.empty()) throw odo::Error(ODO_E_CONFIG, "model: expected a CityJSON file of the buildings");
    const auto file = host.asset(model);
    if (!file) throw odo::Error(ODO_E_CONFIG, "model: no file '" + model + "' where the config lies");
    try {
      matcher_.emplace(City(read_city_outline(*file, model_origin)));
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
  }

  void on(const odo_calibration& c, odo::Output&) {
    camera_.take(c);
    q_c_b_.setIdentity();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS)
      q_c_b_ = Eigen::Quaterniond(c.q_b_c[0], c.q_b_c[1], c.q_b_c[2], c.q_b_c[3]).conjugate();
  }

  void on(const odo_pose& pose, odo::Output&) { pose_ = pose; }

  void on(const odo_frame& frame, odo::Output& output) {
    const odograph::CameraModel lens = camera_.lens_of(frame);
    constexpr uint32_t needed = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_CAMERA | ODO_POSE_METRIC;
    if (!pose_ || (pose_->header.flags & needed) != needed || pose_->header.t_ns != frame.header.t_ns) return;
    const int64_t wait_ns = static_cast<int64_t>(interval * 1e9) - 1'000'000;
    if (last_ns_ != INT64_MIN && frame.header.t_ns - last_ns_ < wait_ns) return;
    const double variance = std::max(pose_->covariance[21], pose_->covariance[28]);
    if (std::sqrt(variance) > kNowhere_m) return;  // there is no prior yet
    const Eigen::Quaterniond q_n_c(pose_->q_n[0], pose_->q_n[1], pose_->q_n[2], pose_->q_n[3]);
    const Eigen::Quaterniond q_c_n = q_n_c.conjugate();
    if (!finder_ || lens != lens_) finder_.emplace(lens_ = lens, camera_.size());
    const auto& edges = finder_->find(odograph::grey_of(frame, converted_), q_c_n * -Eigen::Vector3d::UnitZ(),
                                      q_c_n * Eigen::Vector3d::UnitX());
    if (edges.empty()) return;
    last_ns_ = frame.header.t_ns;
    const double yaw_sigma = std::clamp(std::sqrt(pose_->covariance[14]), 1.0 * kDegree, 30 * kDegree);
    const double tilt =
        std::clamp(std::sqrt(std::max(pose_->covariance[0], pose_->covariance[7])), tilt_sigma, kMostTilt_rad);
    const auto match = matcher_->match(edges, {.p_n = Eigen::Vector3d(pose_->p_n),
                                               .q_n_c = q_n_c,
                                               .position_sigma_m = std::sqrt(variance) + failures_,
                                               .yaw_sigma_rad = yaw_sigma,
                                               .tilt_sigma_rad = tilt,
                                               .farthest_m = radius,
                                               .lost = failures_ >= kDoubtful});
    if (!match || match->agreement < min_agreement || match->rival > kRival) {
      ++failures_;
      return;
    }
    failures_ = 0;
    output.emit(fix_of(*match, frame.header.t_ns));
  }

 private:
  odo_fix fix_of(const Match& match, int64_t t_ns) const {
    auto fix = odo::make<odo_fix>(t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_ORIENTATION | ODO_FIX_SLANT;
    fix.header.quality = static_cast<float>(match.agreement);
    Eigen::Vector3d::Map(fix.p_n) = match.p_n;
    // What the inclination's error does to a place: roofs are seen at their height over it.
    const double leaning = tilt_sigma * (match.p_n.z() - match.landmark_n.z());
    const Eigen::Matrix2d covariance =
        match.covariance + Eigen::Matrix2d::Identity() * (min_sigma * min_sigma + leaning * leaning);
    fix.covariance_n[0] = covariance(0, 0), fix.covariance_n[1] = fix.covariance_n[3] = covariance(0, 1);
    fix.covariance_n[4] = covariance(1, 1);
    const Eigen::Quaterniond q_n_b = (match.q_n_c * q_c_b_).normalized();
    fix.q_n_b[0] = q_n_b.w(), fix.q_n_b[1] = q_n_b.x(), fix.q_n_b[2] = q_n_b.y(), fix.q_n_b[3] = q_n_b.z();
    fix.orientation_cov_n[0] = fix.orientation_cov_n[4] = tilt_sigma * tilt_sigma;
    fix.orientation_cov_n[8] = match.yaw_sigma_rad * match.yaw_sigma_rad;
    fix.integrity = std::max(0.01, match.rival);
    Eigen::Vector3d::Map(fix.landmark_n) = match.landmark_n;
    fix.slant_distance_m = match.slant_distance_m;
    return fix;
  }

  std::optional<Matcher> matcher_;
  std::optional<SkyFinder> finder_;
  std::optional<odo_pose> pose_;
  Eigen::Quaterniond q_c_b_ = Eigen::Quaterniond::Identity();
  cv::Mat converted_;
  odograph::ToldCamera camera_;
  odograph::CameraModel lens_;  // that finder_ was made for
  int64_t last_ns_ = INT64_MIN;
  int failures_ = 0;  // in a row; each widens the search by three metres
};

}  // namespace

ODO_PLUGIN(Skyline)
