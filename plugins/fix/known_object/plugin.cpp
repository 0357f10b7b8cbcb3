// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <optional>

#include "plugins/fix/known_object/judge.hpp"
#include "plugins/fix/known_object/read_objects.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace {

using namespace odograph::known_object;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

/// Not configurable. Empirical, not tuned.
struct PluginParameters {
  int64_t keep_ns = 2'000'000'000;          ///< ns of stored poses
  int64_t patience_ns = 1'000'000'000;      ///< ns that a sighting waits for its pose
  int64_t near_ns = 120'000'000;            ///< ns: max age of a pose for a frame, if none is nearer ...
  size_t waiting = 3;                       ///< ... and more sightings than these are waiting
  size_t max_waiting = 16;                  ///< sightings; further ones are dropped
  double max_between_ns = 5e8;              ///< max interval of poses for interpolation, ns
  double min_motion_s = 1e-3;               ///< min interval of two poses for the camera's motion, s
  double max_motion_s = 0.3;                ///< max interval, s
  double satellites_m = 15;                 ///< error of GNSS positions, m, in addition to ...
  double satellite_sigmas = 4;              ///< ... this many of the receiver's own sigmas
  double satellite_sigma_m = 10;            ///< of a receiver that reports none, m
  int64_t fresh_ns = 10'000'000'000;        ///< max age of a GNSS position, ns
  double max_tilt_sigma_rad = 5 * kDegree;  ///< upper bound of the prior's inclination sigma, rad: gravity observes it
  double off_m = 3;                         ///< error of the prior, m, in addition to ...
  double off_sigmas = 4;                    ///< ... this many of its own sigmas and the drift since the last fix
  double integrity_standing = 0.001;        ///< integrity risk of a fix while standing before the object (README, 6)
  double integrity_walking = 0.01;          ///< of one while walking
};
constexpr PluginParameters kParameters;

/// Camera pose from objects of known picture, size and position: Antigny et al. 2019, section 3.5.
class KnownObject {
 public:
  std::string objects, prior = "after_first";
  bool geodetic = false;
  std::array<double, 3> geodetic_origin = {0, 0, 0};
  double interval = 0.5, search_interval = 0.5, stand = 3, hold = 10, range = 30, min_correlation = 0.8,
         min_agreement = 0.9, max_oblique = 70 * kDegree, gravity_sigma = 1 * kDegree, pixel_sigma = 0.15,
         focal_sigma = 0.003, drift = 0.05;

  static constexpr odo::Description description{
      "fix/known_object", "1.0.0",
      "Position and orientation from pictures and tags of known position (Antigny et al. 2019)",
      ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<KnownObject>> parameters() {
    using P = KnownObject;
    return {
        odo::text("objects", &P::objects, "GeoJSON or YAML file of the objects, beside the config"),
        odo::boolean("geodetic", &P::geodetic, "geodetic_origin is n's origin"),
        odo::reals("geodetic_origin", "", -1e5, 1e5, &P::geodetic_origin,
                   "latitude and longitude of n's origin in degrees, its ellipsoidal height in m"),
        odo::choice("prior", "after_first|always", &P::prior,
                    "when the pose must agree with the object's position: after the first fix by an object, or always"),
        odo::real("interval", "s", 0, 3600, &P::interval, "minimum time between two fixes by the same object"),
        odo::real("search_interval", "s", 0, 3600, &P::search_interval, "time between two searches for pictures"),
        odo::real("stand", "s", 0.5, 60, &P::stand, "time in one position after which a fix counts as taken in front"),
        odo::real("hold", "s", 0, 3600, &P::hold, "after such a fix: time without fixes by this object while walking"),
        odo::real("range", "m", 0.5, 200, &P::range, "largest distance of an object that is searched for"),
        odo::real("min_correlation", "", 0.3, 1, &P::min_correlation,
                  "smallest correlation of the expected picture with the frame"),
        odo::real("min_agreement", "", 0.3, 1, &P::min_agreement,
                  "share of an object's parts that must correlate individually"),
        odo::real("max_oblique", "rad", 0.1, 1.4, &P::max_oblique,
                  "largest angle between the line of sight and the normal"),
        odo::real("gravity_sigma", "rad", 0.0001, 0.5, &P::gravity_sigma,
                  "lower bound of the standard deviation of the pose's inclination"),
        odo::real("pixel_sigma", "", 0.001, 10, &P::pixel_sigma,
                  "error common to a frame, at each corner, in pixels: lens, interpolation"),
        odo::real("focal_sigma", "", 0, 0.2, &P::focal_sigma, "relative standard deviation of the focal length"),
        odo::real("drift", "", 0, 1, &P::drift,
                  "of the path since the last fix: error of the pose beyond its own sigma")};
  }

  void configured(odo::Output& host) {
    if (objects.empty()) throw odo::Error(ODO_E_CONFIG, "objects: expected a file of objects");
    const auto file = host.asset(objects);
    if (!file) throw odo::Error(ODO_E_CONFIG, "objects: no file '" + objects + "' beside the config");
    Finder::Parameters f;
    f.search_interval_s = search_interval, f.min_correlation = min_correlation, f.min_agreeing = min_agreement;
    f.max_oblique_rad = max_oblique;
    Judge::Parameters j;
    j.interval_s = interval, j.stand_s = stand, j.hold_s = hold, j.gravity_sigma_rad = gravity_sigma;
    j.pixel_sigma = pixel_sigma, j.focal_sigma = focal_sigma, j.drift = drift;
    judge_.emplace(j);
    try {
      auto all = read_objects(*file);
      lay_out(all);
      finder_ = std::make_unique<Finder>(f, std::move(all));
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
    reset();
  }

  void reset() {
    finder_->forget();
    judge_->forget();
    poses_.clear(), waiting_.clear();
    calibrated_ = false;
    camera_ = {};
    // The positions are in n from the start for local objects, and for geodetic ones if the origin is known.
    map_known_ = !any_geodetic_ || geodetic;
    placed_ = prior == "always" && map_known_;
    n_from_map_.setZero();
    told_map_.reset(), satellites_.reset();
  }

  void on(const odo_calibration& c, odo::Output&) {
    camera_.take(c);
    lens_.camera = odograph::camera_of(c);
    lens_.width = static_cast<int>(c.width), lens_.height = static_cast<int>(c.height);
    line_time_ns_ = (c.header.flags & ODO_CALIBRATION_LINE_TIME) ? c.line_time_ns : 0;
    q_b_c_ = odograph::rear_camera_mount();
    p_b_c_.setZero();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) {
      q_b_c_ = odograph::quaternion(c.q_b_c);
      p_b_c_ = Vector3d(c.p_b_c);
    }
    calibrated_ = true;
  }

  void on(const odo_gnss& g, odo::Output&) {
    if (!(g.header.flags & ODO_GNSS_POSITION) || !any_geodetic_) return;
    const bool given = (g.header.flags & ODO_GNSS_COVARIANCE) && g.covariance_n[0] > 0;
    const double sigma =
        given ? std::sqrt(std::max(g.covariance_n[0], g.covariance_n[4])) : kParameters.satellite_sigma_m;
    satellites_ = Satellites{g.header.t_ns, on_map(g.latitude_rad, g.longitude_rad, datum_[2]),
                             kParameters.satellites_m + kParameters.satellite_sigmas * sigma};
  }

  void on(const odo_pose& pose, odo::Output& output) {
    if (!(pose.header.flags & ODO_POSE_ORIENTATION) || (pose.header.flags & ODO_POSE_EXTRAPOLATED)) return;
    while (!poses_.empty() && poses_.back().header.t_ns >= pose.header.t_ns) poses_.pop_back();
    poses_.push_back(pose);
    while (pose.header.t_ns - poses_.front().header.t_ns > kParameters.keep_ns) poses_.pop_front();
    learn_map(pose);
    decide(output);
  }

  void on(const odo_frame& frame, odo::Output& output) {
    RollingLens lens = lens_;
    lens.camera = camera_.lens_of(frame);
    const int64_t line_ns = (frame.header.flags & ODO_FRAME_LINE_TIME) ? frame.line_time_ns : line_time_ns_;
    lens.line_time_s = odograph::seconds(line_ns);
    move(lens);
    const cv::Mat grey = odograph::grey_of(frame, converted_);
    for (Sighting& s : finder_->find(frame.header.t_ns, grey, odograph::mask_of(frame), lens, possible()))
      waiting_.push_back({std::move(s), lens});
    decide(output);
  }

 private:
  struct Waiting {
    Sighting sighting;
    RollingLens lens;
  };
  struct Satellites {
    int64_t t_ns;
    Vector3d p_map;
    double loose_m;
  };

  /// Converts geodetic objects to positions on a map: n if its origin is known, otherwise north, east, down about the
  /// first of them.
  void lay_out(std::vector<PlaneObject>& all) {
    any_geodetic_ = false;
    for (const PlaneObject& o : all) {
      if (!o.place.geodetic || any_geodetic_) continue;
      any_geodetic_ = true;
      datum_ = {o.place.latitude_rad, o.place.longitude_rad, o.place.height_m};
    }
    if (geodetic) datum_ = {geodetic_origin[0] * kDegree, geodetic_origin[1] * kDegree, geodetic_origin[2]};
    for (PlaneObject& o : all) {
      if (any_geodetic_ && !o.place.geodetic && !geodetic)
        throw std::runtime_error("object '" + o.id +
                                 "' has its position in n, others have geodetic positions: set geodetic_origin");
      if (o.place.geodetic) o.place.p_n = on_map(o.place.latitude_rad, o.place.longitude_rad, o.place.height_m);
    }
  }

  Vector3d on_map(double latitude_rad, double longitude_rad, double height_m) const {
    const RadianLengths metres(datum_[0]);
    const double east_rad = std::remainder(longitude_rad - datum_[1], 2 * std::numbers::pi);
    return {(latitude_rad - datum_[0]) * metres.north_m, east_rad * metres.east_m, datum_[2] - height_m};
  }

  /// Determines n on the map of objects without a known origin, from the first pose after a fix.
  void learn_map(const odo_pose& pose) {
    if (!told_map_ || !(pose.header.flags & ODO_POSE_METRIC) || !(pose.header.flags & ODO_POSE_POSITION)) return;
    if (!map_known_) n_from_map_ = Vector3d(pose.p_n) - *told_map_;
    placed_ = true;
    told_map_.reset();
  }

  /// Angular rate and velocity of the camera, from the two newest poses.
  void move(RollingLens& lens) const {
    lens.rate_c.setZero(), lens.velocity_c.setZero();
    if (poses_.size() < 2) return;
    const odo_pose &a = poses_[poses_.size() - 2], &b = poses_.back();
    const double dt_s = odograph::seconds(b.header.t_ns - a.header.t_ns);
    if (dt_s < kParameters.min_motion_s || dt_s > kParameters.max_motion_s) return;
    lens.rate_c = odograph::log_rotation(camera(a).conjugate() * camera(b)) / dt_s;
    constexpr uint32_t moving = ODO_POSE_VELOCITY | ODO_POSE_METRIC;
    if ((b.header.flags & moving) == moving) lens.velocity_c = camera(b).conjugate() * Vector3d(b.velocity_n);
  }

  Quaterniond camera(const odo_pose& pose) const {
    const Quaterniond q = odograph::quaternion(pose.q_n);
    return (pose.header.flags & ODO_POSE_CAMERA) ? q : (q * q_b_c_).normalized();
  }

  Prior prior_of(const odo_pose& pose) const {
    Prior p;
    p.q_n_c = camera(pose);
    p.p_n = Vector3d(pose.p_n) - n_from_map_;
    if (!(pose.header.flags & ODO_POSE_CAMERA)) p.p_n += p.q_n_c * (q_b_c_.conjugate() * p_b_c_);
    const auto sigma = [&](int a, int b) {
      return std::sqrt(std::max({0.0, pose.covariance[7 * a], pose.covariance[7 * b]}));
    };
    p.tilt_sigma_rad = std::min(sigma(0, 1), kParameters.max_tilt_sigma_rad), p.yaw_sigma_rad = sigma(2, 2);
    p.horizontal_sigma_m = sigma(3, 4), p.vertical_sigma_m = sigma(5, 5);
    p.path_m = pose.distance_m;
    p.placed = placed_ && (pose.header.flags & ODO_POSE_METRIC) && (pose.header.flags & ODO_POSE_POSITION);
    if (!p.placed && satellites_ && std::abs(pose.header.t_ns - satellites_->t_ns) < kParameters.fresh_ns)
      p.p_n = satellites_->p_map, p.loose_m = satellites_->loose_m;
    return p;
  }

  /// Prior at a frame's time: a pose at that time, or interpolated between two poses.
  std::optional<Prior> prior_at(int64_t t_ns) const {
    for (size_t k = poses_.size(); k-- > 0;) {
      const odo_pose& b = poses_[k];
      if (b.header.t_ns == t_ns) return prior_of(b);
      if (b.header.t_ns > t_ns) continue;
      if (k + 1 == poses_.size()) return {};
      const odo_pose& after = poses_[k + 1];
      const double all = static_cast<double>(after.header.t_ns - b.header.t_ns);
      const double part = static_cast<double>(t_ns - b.header.t_ns) / all;
      if (all > kParameters.max_between_ns) return {};
      Prior p = prior_of(part < 0.5 ? b : after);
      p.q_n_c = camera(b).slerp(part, camera(after));
      return p;
    }
    return {};
  }

  std::vector<char> possible() const {
    const auto& all = finder_->objects();
    std::vector<char> result(all.size(), 1);
    if (poses_.empty() || !calibrated_) return result;
    const Prior p = prior_of(poses_.back());
    if (!p.placed && p.loose_m <= 0) return result;
    const double off_m =
        p.placed ? kParameters.off_sigmas * p.horizontal_sigma_m + kParameters.off_m + drift * p.path_m : p.loose_m;
    for (size_t k = 0; k < all.size(); ++k) {
      const Vector3d to = all[k].place.p_n - p.p_n;
      result[k] = to.head<2>().norm() < range + off_m && all[k].place.R_n_o.col(2).dot(to) > -off_m;
    }
    return result;
  }

  void decide(odo::Output& output) {
    std::deque<Waiting> still;
    std::vector<std::pair<Estimate, Prior>> told;
    for (Waiting& w : waiting_) {
      const int64_t t = w.sighting.t_ns;
      auto p = prior_at(t);
      const bool late = !poses_.empty() && poses_.back().header.t_ns - t > kParameters.patience_ns;
      if (!p && !poses_.empty() && std::abs(poses_.back().header.t_ns - t) < kParameters.near_ns &&
          waiting_.size() > kParameters.waiting)
        p = prior_of(poses_.back());
      if (!p) {
        if (!late && still.size() < kParameters.max_waiting) still.push_back(std::move(w));
        continue;
      }
      const PlaneObject& object = finder_->objects()[w.sighting.object];
      if (auto estimate = judge_->judge(w.sighting, object, w.lens, *p)) told.emplace_back(*estimate, *p);
    }
    waiting_ = std::move(still);
    for (const auto& [estimate, p] : told) tell(estimate, output);
  }

  void tell(const Estimate& e, odo::Output& output) {
    const PlaneObject& object = finder_->objects()[e.object];
    auto fix = odo::make<odo_fix>(e.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_ORIENTATION |
                       ODO_FIX_ORIENTATION_COVARIANCE | ODO_FIX_LEVER | ODO_FIX_INTEGRITY | ODO_FLAG_QUALITY;
    fix.header.quality = static_cast<float>(std::clamp(e.correlation, 0.0, 1.0));
    const Quaterniond q_n_b = (e.q_n_c * q_b_c_.conjugate()).normalized();
    Vector3d::Map(fix.lever_b) = p_b_c_;  // position of the camera
    if (object.place.geodetic && !geodetic) {
      fix.header.flags |= ODO_FIX_GEODETIC;
      const RadianLengths metres(object.place.latitude_rad);
      const Vector3d& from = e.from_object_n;
      fix.latitude_rad = object.place.latitude_rad + from.x() / metres.north_m;
      fix.longitude_rad = object.place.longitude_rad + from.y() / metres.east_m;
      fix.height_m = object.place.height_m - from.z();
    } else {
      Vector3d::Map(fix.p_n) = e.p_n;
    }
    Eigen::Map<Matrix3d>(fix.covariance_n) = 0.5 * (e.covariance_n + e.covariance_n.transpose());
    odograph::put_quaternion(q_n_b, fix.q_n_b);
    Eigen::Map<Matrix3d>(fix.orientation_cov_n) =
        0.5 * (e.orientation_covariance_n + e.orientation_covariance_n.transpose());
    fix.integrity = e.standing ? kParameters.integrity_standing : kParameters.integrity_walking;
    told_map_ = e.p_n;
    output.emit(fix);
  }

  std::unique_ptr<Finder> finder_;
  std::optional<Judge> judge_;
  RollingLens lens_;
  bool calibrated_ = false, any_geodetic_ = false, map_known_ = false, placed_ = false;
  odograph::ToldCamera camera_;
  int64_t line_time_ns_ = 0;
  Quaterniond q_b_c_ = odograph::rear_camera_mount();
  Vector3d p_b_c_ = Vector3d::Zero(), n_from_map_ = Vector3d::Zero();
  std::array<double, 3> datum_ = {0, 0, 0};  // latitude and longitude in rad, height in m, of the map's origin
  std::deque<odo_pose> poses_;
  std::deque<Waiting> waiting_;
  std::optional<Vector3d> told_map_;
  std::optional<Satellites> satellites_;
  cv::Mat converted_;
};

}  // namespace

ODO_PLUGIN(KnownObject)
