// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "plugins/fix/known_object/object_fixer.hpp"
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

/// Integrity risk of a fix (README, 6), while standing in front of the object and while walking.
constexpr double kIntegrityStanding = 0.001, kIntegrityWalking = 0.01;

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
    SightingValidator::Parameters j;
    j.interval_s = interval, j.stand_s = stand, j.hold_s = hold, j.gravity_sigma_rad = gravity_sigma;
    j.pixel_sigma = pixel_sigma, j.focal_sigma = focal_sigma, j.drift = drift;
    ObjectFixer::Parameters p;
    p.always_placed = prior == "always", p.range_m = range, p.drift = drift;
    if (geodetic) p.origin = {geodetic_origin[0] * kDegree, geodetic_origin[1] * kDegree, geodetic_origin[2]};
    try {
      fixer_.emplace(p, f, j, read_objects(*file));
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
  }

  void reset() {
    fixer_->reset();
    camera_ = {};
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
    fixer_->set_mount(q_b_c_, p_b_c_);
  }

  void on(const odo_gnss& g, odo::Output&) {
    if (!(g.header.flags & ODO_GNSS_POSITION)) return;
    std::optional<double> sigma_m;
    if ((g.header.flags & ODO_GNSS_COVARIANCE) && g.covariance_n[0] > 0)
      sigma_m = std::sqrt(std::max(g.covariance_n[0], g.covariance_n[4]));
    fixer_->add_gnss(g.header.t_ns, g.latitude_rad, g.longitude_rad, sigma_m);
  }

  void on(const odo_pose& pose, odo::Output& output) {
    if (!(pose.header.flags & ODO_POSE_ORIENTATION) || (pose.header.flags & ODO_POSE_EXTRAPOLATED)) return;
    const auto has = [&](uint32_t flags) { return (pose.header.flags & flags) == flags; };
    const auto sigma = [&](int a, int b) {
      return std::sqrt(std::max({0.0, pose.covariance[7 * a], pose.covariance[7 * b]}));
    };
    PipelinePose p{pose.header.t_ns, odograph::quaternion(pose.q_n), Vector3d(pose.p_n)};
    p.is_of_camera = has(ODO_POSE_CAMERA);
    p.is_metric_position = has(ODO_POSE_METRIC | ODO_POSE_POSITION);
    if (has(ODO_POSE_VELOCITY | ODO_POSE_METRIC)) p.velocity_n = Vector3d(pose.velocity_n);
    p.tilt_sigma_rad = sigma(0, 1), p.yaw_sigma_rad = sigma(2, 2);
    p.horizontal_sigma_m = sigma(3, 4), p.vertical_sigma_m = sigma(5, 5);
    p.path_m = pose.distance_m;
    emit(fixer_->add_pose(p), output);
  }

  void on(const odo_frame& frame, odo::Output& output) {
    RollingLens lens = lens_;
    lens.camera = camera_.lens_of(frame);
    const int64_t line_ns = (frame.header.flags & ODO_FRAME_LINE_TIME) ? frame.line_time_ns : line_time_ns_;
    lens.line_time_s = odograph::seconds(line_ns);
    const cv::Mat grey = odograph::grey_of(frame, converted_);
    emit(fixer_->add_frame(frame.header.t_ns, grey, odograph::mask_of(frame), lens), output);
  }

 private:
  void emit(const std::vector<Estimate>& fixes, odo::Output& output) const {
    for (const Estimate& e : fixes) {
      const PlaneObject& object = fixer_->object(e.object);
      auto fix = odo::make<odo_fix>(e.t_ns);
      fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_ORIENTATION |
                         ODO_FIX_ORIENTATION_COVARIANCE | ODO_FIX_LEVER | ODO_FIX_INTEGRITY | ODO_FLAG_QUALITY;
      fix.header.quality = static_cast<float>(std::clamp(e.correlation, 0.0, 1.0));
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
      odograph::put_quaternion((e.q_n_c * q_b_c_.conjugate()).normalized(), fix.q_n_b);
      Eigen::Map<Matrix3d>(fix.orientation_cov_n) =
          0.5 * (e.orientation_covariance_n + e.orientation_covariance_n.transpose());
      fix.integrity = e.standing ? kIntegrityStanding : kIntegrityWalking;
      output.emit(fix);
    }
  }

  std::optional<ObjectFixer> fixer_;
  RollingLens lens_;
  odograph::CalibratedCamera camera_;
  int64_t line_time_ns_ = 0;
  Quaterniond q_b_c_ = odograph::rear_camera_mount();
  Vector3d p_b_c_ = Vector3d::Zero();
  cv::Mat converted_;
};

}  // namespace

ODO_PLUGIN(KnownObject)
