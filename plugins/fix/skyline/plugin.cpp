// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/database_extension.hpp"
#include "plugins/fix/skyline/frame_chroma.hpp"
#include "plugins/fix/skyline/photograph_prior.hpp"
#include "plugins/fix/skyline/skyline_fixer.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::skyline;

/// The prior of a photograph from a pose and its covariance.
PhotographPrior photograph_prior(const odo_pose& pose, double height_sigma_m) {
  const auto sigma = [&](size_t a, size_t b) { return std::sqrt(std::max(pose.covariance[a], pose.covariance[b])); };
  return {.p_n = Eigen::Vector3d(pose.p_n),
          .q_n_c = odograph::raw_quaternion(pose.q_n).normalized(),
          .sigma_m = std::max(0.5, sigma(21, 28)),
          .height_sigma_m = height_sigma_m,
          .yaw_sigma_rad = std::clamp(sigma(14, 14), 0.02, std::numbers::pi),
          .tilt_sigma_rad = std::max(0.01, sigma(0, 7))};
}

/// Fixes from the skyline around a camera and a 3D city model: section 3.2 of Gakne & O'Keefe 2018.
class Skyline : public FixerConfig {
 public:
  static constexpr odo::Description description{
      "fix/skyline", "1.0.0", "Position and heading from the skyline of a 3D city model (Gakne & O'Keefe 2018)",
      ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Skyline>> parameters() {
    using P = Skyline;
    return {
        odo::text<P>("model", &P::model, "CityJSON or CityGML file of the city, beside the config"),
        odo::reals<P>("model_origin", "m", -1e8, 1e8, &P::model_origin,
                      "easting, northing and height of n's origin in the model"),
        odo::boolean<P>("geodetic", &P::geodetic,
                        "geodetic_origin stands for model_origin, by the model's reference system"),
        odo::reals<P>("geodetic_origin", "", -1e5, 1e5, &P::geodetic_origin,
                      "latitude and longitude of n's origin in degrees, its ellipsoidal height in m"),
        odo::real<P>("geoid_height", "m", -200, 200, &P::geoid_height, "ellipsoidal height of the model's zero height"),
        odo::text<P>("skylines", &P::skylines,
                     "database of skylines (`odograph city build`), beside the config; without a model also its edges"),
        odo::choice<P>("sky", "robust|flood_fill", &P::sky, "method of sky segmentation; flood_fill is the paper's"),
        odo::choice<P>("inclination", "pose|vanishing_point", &P::inclination,
                       "source of pitch and roll; vanishing_point is the paper's"),
        odo::real<P>("interval", "s", 0, 3600, &P::interval, "minimum time between two fixes"),
        odo::real<P>("radius", "m", 2, 200, &P::radius, "maximum search radius around the prior"),
        odo::real<P>("min_agreement", "", 0.1, 1, &P::min_agreement,
                     "minimum fraction of the directions with a roof's edge in which picture and model agree"),
        odo::real<P>("tilt_sigma", "rad", 0.0001, 0.5, &P::tilt_sigma,
                     "minimum standard deviation of the prior's inclination"),
        odo::real<P>("height_sigma", "m", 0.01, 100, &P::height_sigma,
                     "standard deviation of the prior's height at the start"),
        odo::boolean<P>("start_known", &P::start_known,
                        "the initial pose is known; otherwise the whole database is searched"),
        odo::boolean<P>("join", &P::join, "match a picture with too little skyline jointly with earlier ones"),
        odo::boolean<P>("survey", &P::survey,
                        "where pictures do not fit the model, estimate the height errors of its buildings and correct "
                        "them"),
        odo::real<P>("min_sigma", "m", 0.001, 100, &P::min_sigma, "minimum standard deviation of a fix"),
        odo::boolean<P>("photographs", &P::photographs,
                        "each frame is a separate photograph, searched around the pose at its time within its "
                        "covariance; pitch and roll are estimated"),
        odo::choice<P>(
            "match", "robust|correlation", &P::matching,
            "comparison of picture and model: a bounded loss of each direction, or the correlation of binary "
            "images, which is the paper's")};
  }

  void configured(odo::Output& host) {
    FixerConfig resolved = *this;
    const auto find = [&](const char* key, std::string& name) {
      if (name.empty()) return;
      const auto file = host.asset(name);
      if (!file) throw odo::Error(ODO_E_CONFIG, key + std::string(": no file '") + name + "' where the config lies");
      name = *file;
    };
    find("skylines", resolved.skylines), find("model", resolved.model);
    try {
      fixer_.emplace(resolved);
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
    if (!fixer_->georeference().description.empty())
      host.report(ODO_SEVERITY_INFO, "reference_system", "the model is in " + fixer_->georeference().description);
    extension_.emplace(host, model.empty() ? std::nullopt : std::optional(fixer_->city()),
                       Eigen::Vector3d(model_origin.data()));
  }

  const void* extension(std::string_view id) const {
    return id == ODO_EXTENSION_SKYLINES && extension_ ? extension_->table() : nullptr;
  }

  void on(const odo_calibration& c, odo::Output&) {
    camera_.take(c);
    q_c_b_.setIdentity();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS)
      q_c_b_ = odograph::raw_quaternion(c.q_b_c).conjugate(), p_b_c_ = Eigen::Vector3d(c.p_b_c);
  }

  void on(const odo_pose& pose, odo::Output& output) {
    if (pose.header.flags & ODO_POSE_EXTRAPOLATED) return;
    const auto has = [&](uint32_t flags) { return (pose.header.flags & flags) == flags; };
    const auto sigma = [&](int a, int b) {
      return std::sqrt(std::max(pose.covariance[7 * a], pose.covariance[7 * b]));
    };
    PipelinePose p{pose.header.t_ns, Eigen::Vector3d(pose.p_n), odograph::raw_quaternion(pose.q_n)};
    p.has_position = has(ODO_POSE_POSITION);
    p.is_of_camera =
        has(ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_CAMERA) && (!photographs || has(ODO_POSE_COVARIANCE));
    p.is_metric = has(ODO_POSE_METRIC), p.is_lost = pose.state == ODO_LOST;
    p.horizontal_sigma_m = sigma(3, 4), p.yaw_sigma_rad = sigma(2, 2), p.tilt_sigma_rad = sigma(0, 1);
    p.scale = pose.scale, p.scale_sigma = pose.scale_sigma, p.path_m = pose.distance_m;
    p.photograph = photograph_prior(pose, height_sigma);
    emit(fixer_->add_pose(p), output);
  }

  void on(const odo_correction& c, odo::Output&) {
    fixer_->correct(odograph::raw_quaternion(c.q_n), Eigen::Vector3d(c.p_n));
  }

  void on(const odo_frame& frame, odo::Output& output) {
    const int64_t t_ns = frame.header.t_ns;
    emit(fixer_->advance(t_ns), output);
    if (fixer_->busy()) return;
    const odograph::CameraModel lens = camera_.lens_of(frame);
    if (!fixer_->is_due(t_ns)) return;
    emit(fixer_->add_picture({t_ns, odograph::grey_of(frame, converted_).clone(), odograph::mask_of(frame).clone(),
                              sky == "robust" ? chroma_of(frame) : Chroma{}, lens}),
         output);
  }

 private:
  void emit(const std::vector<Outcome>& outcomes, odo::Output& output) {
    for (const Outcome& outcome : outcomes) {
      if (const auto* fix = std::get_if<Fix>(&outcome)) {
        output.emit(fix_of(*fix));
        if (!fix->surveyed.empty()) output.report(ODO_SEVERITY_INFO, "surveyed", fix->surveyed);
      } else {
        report(std::get<Rejection>(outcome), output);
      }
    }
  }

  /// Counts a frame without a fix and reports the reason.
  void report(const Rejection& rejection, odo::Output& output) {
    ++refused_[rejection.first];
    std::string all = rejection.second + "; refused so far:";
    for (size_t k = 0; k < kReasons; ++k)
      all += std::string(k ? ", " : " ") + kReasonNames[k] + ' ' + std::to_string(refused_[k]);
    output.report(ODO_SEVERITY_INFO, std::string("no_fix_") + kReasonNames[rejection.first], all);
  }

  odo_fix fix_of(const Fix& of) const {
    const Match& match = of.match;
    auto fix = odo::make<odo_fix>(of.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_ORIENTATION |
                       ODO_FIX_ORIENTATION_COVARIANCE | ODO_FIX_LEVER | ODO_FIX_INTEGRITY | ODO_FLAG_QUALITY;
    if (of.has_slant) fix.header.flags |= ODO_FIX_SLANT;
    if (of.has_height) fix.header.flags |= ODO_FIX_DOWN, fix.covariance_n[8] = std::pow(match.height_sigma_m, 2);
    Eigen::Vector3d::Map(fix.lever_b) = p_b_c_;  // the fix is the camera's position
    fix.header.quality = static_cast<float>(match.agreement);
    Eigen::Vector3d::Map(fix.p_n) = match.p_n;
    fix.covariance_n[0] = match.covariance(0, 0), fix.covariance_n[4] = match.covariance(1, 1);
    fix.covariance_n[1] = fix.covariance_n[3] = match.covariance(0, 1);
    odograph::put_quaternion((match.q_n_c * q_c_b_).normalized(), fix.q_n_b);
    fix.orientation_cov_n[0] = fix.orientation_cov_n[4] = std::pow(std::max(tilt_sigma, match.tilt_sigma_rad), 2);
    fix.orientation_cov_n[8] = match.yaw_sigma_rad * match.yaw_sigma_rad;
    fix.integrity = match.second_best_ratio;
    Eigen::Vector3d::Map(fix.landmark_n) = match.landmark_n;
    fix.slant_distance_m = match.slant_distance_m;
    const Eigen::Vector3d e = (match.landmark_n - match.p_n).normalized();  // the roof is surveyed: the place is not
    fix.slant_sigma_m = std::sqrt(std::max(0.0, e.head<2>().dot(match.covariance * e.head<2>())) +
                                  std::pow(e.z() * match.height_sigma_m, 2));
    return fix;
  }

  std::optional<SkylineFixer> fixer_;
  std::optional<DatabaseExtension> extension_;
  std::array<uint64_t, kReasons> refused_{};
  Eigen::Quaterniond q_c_b_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
};

}  // namespace

ODO_PLUGIN(Skyline)
