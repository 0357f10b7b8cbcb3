// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/database_extension.hpp"
#include "plugins/fix/skyline/fixer_config.hpp"
#include "plugins/fix/skyline/fixer_parameters.hpp"
#include "plugins/fix/skyline/frame_chroma.hpp"
#include "plugins/fix/skyline/validate_match.hpp"
#include "plugins/fix/skyline/picture_job.hpp"
#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/photograph_fixer.hpp"
#include "plugins/fix/skyline/photograph_prior.hpp"
#include "plugins/fix/skyline/place_finder.hpp"
#include "plugins/fix/skyline/sky_detector.hpp"
#include "plugins/fix/skyline/skyline_database.hpp"
#include "plugins/fix/skyline/sliced_worker.hpp"
#include "plugins/fix/skyline/vanishing_point.hpp"
#include "plugins/fix/skyline/view_window.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace {

using namespace odograph::skyline;
constexpr double kDegree = std::numbers::pi / 180;
constexpr FixerParameters kParameters;

/// Fixes from the skyline around a camera and a 3D city model: section 3.2 of Gakne & O'Keefe 2018.
class Skyline : public FixerConfig {
 public:
  static constexpr odo::Description description{
      "fix/skyline", "1.0.0", "Position and heading from the skyline of a 3D city model (Gakne & O'Keefe 2018)",
      ODO_INTERFACE_ABSOLUTE_FIXER};
  static constexpr uint32_t extra_inputs[] = {ODO_TYPE_CORRECTION};
  static std::vector<odo::Parameter<Skyline>> parameters() { return fixer_parameters<Skyline>(); }

  void configured(odo::Output& host) {
    if (model.empty() && skylines.empty())
      throw odo::Error(ODO_E_CONFIG,
                       "model: expected a CityJSON or CityGML file of the city, or a database in `skylines`");
    if (!start_known && skylines.empty())
      throw odo::Error(ODO_E_CONFIG, "start_known: false wants a database in `skylines`");
    up_variance_ = height_sigma * height_sigma;
    placed_ = start_known;
    if (geodetic && !skylines.empty())
      throw odo::Error(ODO_E_CONFIG, "geodetic: a database lies along the model's grid; give model_origin");
    const auto find = [&](const char* key, const std::string& name) {
      const auto file = host.asset(name);
      if (!file) throw odo::Error(ODO_E_CONFIG, key + std::string(": no file '") + name + "' where the config lies");
      return *file;
    };
    try {
      if (!skylines.empty()) {
        database_ = SkylineDatabase::open(find("skylines", skylines));
        place_finder_.emplace(PlaceFinder::Parameters{}, database_, database_offset());
      }
      const CityPlacement placement{model_origin, geodetic, geodetic_origin, geoid_height};
      matcher_.emplace(City(model.empty() ? edges_of_database() : read_city_outline(find("model", model), placement)));
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
    if (photographs) photograph_fixer_.emplace(matcher_->city());
    extension_.emplace(host, model.empty() ? nullptr : &matcher_->city(), Eigen::Vector3d(model_origin.data()));
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
    pose_ = pose;
    if (!start_n_ && (pose.header.flags & ODO_POSE_POSITION)) start_n_ = Eigen::Vector3d(pose.p_n);
    if (!waiting_ || pose.header.t_ns < waiting_->t_ns) return;
    begin(*std::exchange(waiting_, std::nullopt), output);
  }

  void on(const odo_correction& c, odo::Output&) {
    const Eigen::Quaterniond q = odograph::raw_quaternion(c.q_n);
    const Eigen::Vector3d p(c.p_n);
    window_.correct(q, p), path_validator_.correct(q, p), job_.correct(q, p);
  }

  /// A frame waits for its pose where the front-end, which waits for the IMU, emits it later. While a picture is
  /// processed no other is accepted; its fix is emitted at the frame by which the work is done.
  void on(const odo_frame& frame, odo::Output& output) {
    const double passed_s = frame_ns_ == INT64_MIN ? 0 : odograph::seconds(frame.header.t_ns - frame_ns_);
    frame_ns_ = frame.header.t_ns;
    slice_ = std::clamp(static_cast<uint64_t>(std::clamp(passed_s, 0.0, 1.0) * kParameters.work_per_second),
                        kParameters.min_slice, kParameters.max_slice);
    if (worker_.busy()) {
      if (!worker_.advance(slice_)) return;
      finish(output);
    }
    const odograph::CameraModel lens = camera_.lens_of(frame);
    const int64_t t_ns = frame.header.t_ns, wait_ns = odograph::nanoseconds(interval) - 1'000'000;
    if (last_ns_ != INT64_MIN && t_ns - last_ns_ < wait_ns) return;
    last_ns_ = t_ns;
    if (waiting_) refuse(kPrior, "no pose arrived for a picture", output);
    waiting_ = Picture{t_ns, odograph::grey_of(frame, converted_).clone(), odograph::mask_of(frame).clone(),
                       sky == "robust" ? chroma_of(frame) : Chroma{}, lens};
    if (pose_ && pose_->header.t_ns == t_ns) begin(*std::exchange(waiting_, std::nullopt), output);
  }

 private:
  void begin(const Picture& picture, odo::Output& output) {
    constexpr uint32_t needed = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_CAMERA;
    if ((pose_->header.flags & needed) != needed || pose_->header.t_ns != picture.t_ns)
      return refuse(kPrior, "no pose of the camera at the frame's time", output);
    if (photograph_fixer_) return place_photograph(picture, output);
    const double variance = std::max(pose_->covariance[21], pose_->covariance[28]);
    if (placed_ && std::sqrt(variance) > kParameters.unplaced_sigma_m)
      return refuse(kPrior, "the pose is not placed yet", output);
    // Without metric scale the position does not change: the scale itself needs fixes.
    const bool metric = (pose_->header.flags & ODO_POSE_METRIC) != 0;
    const double sigma = metric ? std::sqrt(variance) : std::max(std::sqrt(variance), kParameters.unscaled_sigma_m);
    const double yaw_sigma =
        std::clamp(std::sqrt(pose_->covariance[14]), kParameters.min_yaw_rad, kParameters.max_yaw_rad);
    // Possible drift since the last fix, by the heading's sigma or by the pose's own covariance. A pose that is farther
    // off than the search radius would be matched to a similar place.
    const double driven_m = pose_->distance_m - fixed_at_m_;
    const double drift_m = std::max(driven_m * std::min(kParameters.max_off, 3 * yaw_sigma), 3 * sigma);
    const auto slack_m = displacement_from_start(yaw_sigma, sigma, metric);
    const bool lost = !slack_m && (drift_m > radius || failures_ >= kParameters.failures_until_search);
    const bool global_search = place_finder_ && (!placed_ || lost);
    if (lost && drift_m > radius && !global_search)
      return refuse(kPrior, "the pose may be off by more than the search radius", output);
    if (global_search && (!metric || pose_->state == ODO_LOST)) {
      place_finder_->clear();
      return refuse(kPrior, "not placed, and the odometry has no metric scale", output);
    }
    const double tilt = std::clamp(std::sqrt(std::max(pose_->covariance[0], pose_->covariance[7])), tilt_sigma,
                                   kParameters.max_tilt_rad);
    const Eigen::Quaterniond q_n_c = orientation_of(*pose_);
    const Eigen::Vector3d p_n(pose_->p_n);
    if (global_search && !place_finder_->is_far_enough(p_n)) return;
    if (!global_search && joins_ && !window_.adds_information(p_n, q_n_c)) return;
    job_ = {picture,
            p_n,
            q_n_c,
            pose_->distance_m,
            Prior{.p_n = p_n - Eigen::Vector3d(0, 0, up_m_),
                  .q_n_c = q_n_c,
                  .position_sigma_m = std::max(sigma + failures_, drift_m / 3),
                  .yaw_sigma_rad = joins_ ? yaw_sigma + failures_ * kParameters.failed_yaw_rad : yaw_sigma,
                  .tilt_sigma_rad = tilt,
                  .farthest_m = radius,
                  .lost = failures_ >= kParameters.failures_until_lost,
                  .height_sigma_m = std::sqrt(up_variance_),
                  .pivot_n = slack_m ? start_n_ : std::nullopt,
                  .slack_m = slack_m.value_or(0)},
            global_search,
            join && !global_search && yaw_sigma < kParameters.no_heading_rad &&
                pose_->scale_sigma < kParameters.max_scale_sigma * pose_->scale,
            window_.views()};
    worker_.start([this](const Spend& spend) { process_picture(spend); }, slice_);
  }

  /// Synchronous, on this thread: a photograph has no frame-time limit.
  void place_photograph(const Picture& picture, odo::Output& output) {
    const auto outcome = photograph_fixer_->estimate_pose(picture, photograph_prior(*pose_, height_sigma));
    if (!outcome.match)
      return refuse(outcome.no_sky                              ? kSky
                    : outcome.other > kParameters.max_elsewhere ? kAmbiguity
                                                                : kAgreement,
                    outcome.why, output);
    odo_fix fix = fix_of(*outcome.match, picture.t_ns);
    fix.header.flags |= ODO_FIX_DOWN;
    fix.covariance_n[8] = outcome.match->height_sigma_m * outcome.match->height_sigma_m;
    output.emit(fix);
  }

  static Eigen::Quaterniond orientation_of(const odo_pose& pose) { return odograph::raw_quaternion(pose.q_n); }

  /// Before the first fix, without a heading: the uncertainty of the distance from the start, m; otherwise none.
  std::optional<double> displacement_from_start(double yaw_sigma, double sigma, bool metric) const {
    if (!start_known || fixed_once_ || !metric || !start_n_ || yaw_sigma < kParameters.no_heading_rad)
      return std::nullopt;
    const double far_m = (Eigen::Vector3d(pose_->p_n) - *start_n_).head<2>().norm();
    const double slack_m = kParameters.slack_m + kParameters.slack_of_path * pose_->distance_m;
    // An unknown heading gives a sigma as large as the path; a larger one means that the odometry has failed.
    const double max_sigma = kParameters.max_off * (far_m + slack_m);
    if (far_m < slack_m || far_m > kParameters.farthest_from_start_m || sigma > max_sigma) return std::nullopt;
    return slack_m;
  }

  /// Thread: the worker's.
  void process_picture(const Spend& spend) {
    if (inclination == "vanishing_point") align_with_gravity(job_.prior, job_.picture, tilt_sigma);
    const auto& edges = sky_detector_.find(job_.picture, job_.prior.q_n_c.conjugate(), sky == "flood_fill");
    spend(kParameters.sky_work * job_.picture.grey.total());
    job_.sky_seen = !edges.empty();
    if (!job_.sky_seen) return;
    if (job_.global_search) return search_database(edges, spend);
    const bool alone = Matcher::has_enough_edges(edges) || !job_.may_join;
    if (alone) return void(job_.match = matcher_->match(edges, job_.prior, spend));
    job_.view = View{edges, job_.prior.p_n, job_.prior.q_n_c};
    Prior prior = job_.prior;
    prior.lost = false, prior.pivot_n.reset();
    job_.match = matcher_->match(edges, prior, spend, job_.older);
  }

  /// Replaces the prior's pitch and roll by those of the vertical lines in the picture, where there are enough.
  static void align_with_gravity(Prior& prior, const Picture& picture, double min_sigma_rad) {
    const VanishingPointParameters p;
    const Eigen::Vector3d up_c = prior.q_n_c.conjugate() * -Eigen::Vector3d::UnitZ();
    const auto zenith = vanishing_zenith(lines_of(picture.grey, picture.lens, p), up_c, p);
    if (!zenith) return;
    prior.q_n_c = (prior.q_n_c * Eigen::Quaterniond::FromTwoVectors(zenith->up_c, up_c)).normalized();
    prior.tilt_sigma_rad = std::max(zenith->sigma_rad, min_sigma_rad);
  }

  /// Searches the database for the place on which several pictures agree, then matches this picture there.
  void search_database(const std::vector<SkyEdge>& edges, const Spend& spend) {
    if (!Matcher::has_enough_edges(edges)) {
      job_.sky_seen = false;
      return;
    }
    const auto found = place_finder_->add(edges, job_.prior.q_n_c, job_.p_n, spend);
    if (!found) return;
    Prior& prior = job_.prior;
    prior.p_n = found->p_n;
    prior.q_n_c = Eigen::AngleAxisd(found->yaw_rad, Eigen::Vector3d::UnitZ()) * prior.q_n_c;
    prior.position_sigma_m = kParameters.found_sigma_m, prior.yaw_sigma_rad = kParameters.found_sigma_rad;
    prior.height_sigma_m = kParameters.found_sigma_m, prior.lost = false;
    job_.match = matcher_->match(edges, prior, spend);
    if (job_.match && (job_.match->p_n - found->p_n).head<2>().norm() > kParameters.found_apart_m) job_.match.reset();
  }

  void finish(odo::Output& output) {
    if (!job_.sky_seen) return refuse(kSky, "no sky around the zenith, or too few roofs", output);
    if (job_.global_search && !job_.match) {
      char text[120];
      std::snprintf(text, sizeof text, "searched everywhere: %zu pictures, the next best place is %.2g times as likely",
                    place_finder_->pictures(), place_finder_->second_best_ratio());
      return refuse(kAmbiguity, text, output);
    }
    joins_ = job_.view.has_value();
    const auto why = joins_ ? validate_path_match() : validate_single_match();
    if (why) {
      const bool gathers = joins_ && !job_.match && matcher_->refusal() == Refusal::few_edges;
      if (!gathers) ++failures_;
      return refuse(why->first, why->second, output);
    }
    failures_ = 0;
    placed_ = fixed_once_ = true;
    if (place_finder_) place_finder_->clear();
    fixed_at_m_ = job_.path_m;
    update_road_height(*job_.match);
    odo_fix fix = fix_of(*job_.match, job_.picture.t_ns);
    if (pose_->header.t_ns - job_.picture.t_ns >
        kParameters.late_ns) {  // too late for estimators: refer it to the newest pose
      fix = fix_of(job_.propagated_to(Eigen::Vector3d(pose_->p_n), orientation_of(*pose_), kParameters.drift),
                   pose_->header.t_ns);
      fix.header.flags &= ~ODO_FIX_SLANT;
    }
    output.emit(fix);
  }

  std::optional<Rejection> validate_single_match() {
    window_.clear(), path_validator_.clear();
    if (!job_.match) return rejection_of(matcher_->refusal());
    return validate_match(*job_.match, min_agreement, job_.global_search);
  }

  std::optional<Rejection> validate_path_match() {
    View& view = *job_.view;
    view.p_n = job_.corrected(view.p_n), view.q_n_c = job_.corrected(view.q_n_c);
    const Eigen::Vector3d p_n = view.p_n;
    const Eigen::Quaterniond q_n_c = view.q_n_c;
    if (closed_edges(view.edges) >= kParameters.min_of_view) window_.add(std::move(view), job_.path_m);
    if (!job_.match) return rejection_of(matcher_->refusal());
    const auto why = path_validator_.validate(*job_.match, p_n, q_n_c, min_agreement);
    if (!why) window_.inflate_covariance(*job_.match, kParameters.drift);
    return why;
  }

  /// From the database's n to the pipeline's.
  Eigen::Vector3d database_offset() const {
    const Eigen::Vector3d d = database_.origin() - Eigen::Vector3d(model_origin.data());
    return {d.y(), d.x(), -d.z()};
  }
  std::vector<Edge> edges_of_database() const {
    auto edges = database_.edges();
    for (Edge& e : edges) e.from += database_offset(), e.to += database_offset();
    return edges;
  }

  /// Counts a frame without a fix and reports the reason.
  void refuse(Reason reason, const std::string& text, odo::Output& output) {
    ++refused_[reason];
    std::string all = text + "; refused so far:";
    for (size_t k = 0; k < kReasons; ++k)
      all += std::string(k ? ", " : " ") + kReasonNames[k] + ' ' + std::to_string(refused_[k]);
    output.report(ODO_SEVERITY_INFO, std::string("no_fix_") + kReasonNames[reason], all);
  }

  /// Tracks the road's height above n's origin, which the odometry does not observe.
  void update_road_height(const Match& match) {
    const double measured = job_.p_n.z() - match.p_n.z();
    // The match includes the prior: its sigma is the posterior's.
    up_m_ = measured;
    up_variance_ = std::max(match.height_sigma_m * match.height_sigma_m,
                            kParameters.min_height_sigma_m * kParameters.min_height_sigma_m) +
                   kParameters.road_height_m * kParameters.road_height_m;
    up_variance_ = std::min(up_variance_, height_sigma * height_sigma);
  }

  odo_fix fix_of(const Match& match, int64_t t_ns) const {
    auto fix = odo::make<odo_fix>(t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_ORIENTATION |
                       ODO_FIX_ORIENTATION_COVARIANCE | ODO_FIX_SLANT | ODO_FIX_LEVER | ODO_FIX_INTEGRITY |
                       ODO_FLAG_QUALITY;
    Eigen::Vector3d::Map(fix.lever_b) = p_b_c_;  // the fix is the camera's position
    fix.header.quality = static_cast<float>(match.agreement);
    Eigen::Vector3d::Map(fix.p_n) = match.p_n;
    const Eigen::Matrix2d covariance = match.covariance + Eigen::Matrix2d::Identity() * (min_sigma * min_sigma);
    fix.covariance_n[0] = covariance(0, 0), fix.covariance_n[1] = fix.covariance_n[3] = covariance(0, 1);
    fix.covariance_n[4] = covariance(1, 1);
    const Eigen::Quaterniond q_n_b = (match.q_n_c * q_c_b_).normalized();
    odograph::put_quaternion(q_n_b, fix.q_n_b);
    fix.orientation_cov_n[0] = fix.orientation_cov_n[4] = tilt_sigma * tilt_sigma;
    fix.orientation_cov_n[8] = match.yaw_sigma_rad * match.yaw_sigma_rad;
    fix.integrity = std::max(kParameters.min_integrity, match.second_best_ratio);
    Eigen::Vector3d::Map(fix.landmark_n) = match.landmark_n;
    fix.slant_distance_m = match.slant_distance_m;
    return fix;
  }

  SkylineDatabase database_;
  std::optional<PlaceFinder> place_finder_;
  bool placed_ = true, fixed_once_ = false;
  std::optional<Eigen::Vector3d> start_n_;  // first position of the pose
  std::optional<DatabaseExtension> extension_;
  std::optional<Matcher> matcher_;
  std::optional<PhotographFixer> photograph_fixer_;
  SkyDetector sky_detector_;
  ViewWindow window_;
  PathMatchValidator path_validator_;
  bool joins_ = false;  // the latest picture saw too little to be matched alone
  std::array<uint64_t, kReasons> refused_{};
  double fixed_at_m_ = 0;              // distance along the path at the last fix
  double up_m_ = 0, up_variance_ = 1;  // the camera's height above the pose's
  std::optional<odo_pose> pose_;
  std::optional<Picture> waiting_;
  PictureJob job_;
  Eigen::Quaterniond q_c_b_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t last_ns_ = INT64_MIN, frame_ns_ = INT64_MIN;
  uint64_t slice_ = kParameters.min_slice;  // of the newest frame
  int failures_ = 0;                        // consecutive; each adds a metre to the prior's standard deviation
  SlicedWorker worker_;                     // last member: its thread ends before its data are destroyed
};

}  // namespace

ODO_PLUGIN(Skyline)
