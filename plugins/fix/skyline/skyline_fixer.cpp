// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/skyline_fixer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/fix/skyline/vanishing_point.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph::skyline {
namespace {

constexpr FixerParameters kParameters;

/// Replaces the prior's pitch and roll by those of the vertical lines in the picture, where there are enough.
void align_with_gravity(Prior& prior, const Picture& picture, double min_sigma_rad) {
  const VanishingPointParameters p;
  const Eigen::Vector3d up_c = prior.q_n_c.conjugate() * -Eigen::Vector3d::UnitZ();
  const auto zenith = vanishing_zenith(lines_of(picture.grey, picture.mask, picture.lens, p), up_c, p);
  if (!zenith) return;
  prior.q_n_c = (prior.q_n_c * shortest_rotation(zenith->up_c, up_c)).normalized();
  prior.tilt_sigma_rad = std::max(zenith->sigma_rad, min_sigma_rad);
}

/// The prior of a survey, with the pose's own sigma: it is not a search. A heading that is hardly known may be any.
PhotographPrior survey_prior(const Prior& prior, double sigma_m) {
  return {.p_n = prior.p_n,
          .q_n_c = prior.q_n_c,
          .sigma_m = std::max(sigma_m, kParameters.min_survey_sigma_m),
          .height_sigma_m = prior.height_sigma_m,
          .yaw_sigma_rad = prior.yaw_sigma_rad < kParameters.no_heading_rad ? prior.yaw_sigma_rad : std::numbers::pi,
          .tilt_sigma_rad = prior.tilt_sigma_rad,
          .eye_m = std::nullopt,
          .wrong_heading = 0};
}

}  // namespace

SkylineFixer::SkylineFixer(const FixerConfig& config)
    : config_(config), placed_(config.start_known), up_variance_(config.height_sigma * config.height_sigma) {
  const bool has_database = !config.skylines.empty();
  if (config.model.empty() && !has_database)
    throw std::runtime_error("model: expected a CityJSON or CityGML file of the city, or a database in `skylines`");
  if (!config.start_known && !has_database)
    throw std::runtime_error("start_known: false wants a database in `skylines`");
  if (config.geodetic && has_database)
    throw std::runtime_error("geodetic: a database lies along the model's grid; give model_origin");
  if (config.matching == "correlation" && config.photographs)
    throw std::runtime_error("match: correlation is for the frames of a camera; photographs are matched robustly");
  std::vector<Edge> edges;
  if (has_database) {
    database_ = SkylineDatabase::open(config.skylines);
    const Eigen::Vector3d d = database_.origin() - Eigen::Vector3d(config.model_origin.data());
    const Eigen::Vector3d offset_n(d.y(), d.x(), -d.z());  // from the database's n to the pipeline's
    place_finder_.emplace(PlaceFinder::Parameters{}, database_, offset_n);
    if (config.model.empty()) edges = database_.edges();
    for (Edge& e : edges) e.from += offset_n, e.to += offset_n;
  }
  if (!config.model.empty())
    edges = read_city_outline(config.model,
                              {config.model_origin, config.geodetic, config.geodetic_origin, config.geoid_height},
                              &georeference_);
  MatcherParameters matcher;
  matcher.correlation = config.matching == "correlation";
  matcher_.emplace(City(std::move(edges)), matcher);
  if (config.photographs)
    photograph_fixer_.emplace(matcher_->city());
  else if (config.survey && !config.model.empty())  // a database has no buildings
    survey_.emplace(matcher_->city());
}

std::vector<Outcome> SkylineFixer::add_pose(const PipelinePose& pose) {
  pose_ = pose;
  if (!start_n_ && pose.has_position) start_n_ = pose.p_n;
  if (waiting_ && pose.t_ns >= waiting_->t_ns) begin(*std::exchange(waiting_, std::nullopt));
  return take_outcomes();
}

void SkylineFixer::correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  window_.correct(q, p), path_validator_.correct(q, p), job_.correct(q, p);
}

std::vector<Outcome> SkylineFixer::advance(int64_t t_ns) {
  const double passed_s = frame_ns_ == INT64_MIN ? 0 : seconds(t_ns - frame_ns_);
  frame_ns_ = t_ns;
  slice_ = std::clamp(static_cast<uint64_t>(std::clamp(passed_s, 0.0, 1.0) * kParameters.work_per_second),
                      kParameters.min_slice, kParameters.max_slice);
  if (worker_.busy() && worker_.advance(slice_)) finish();
  return take_outcomes();
}

bool SkylineFixer::is_due(int64_t t_ns) const {
  return last_ns_ == INT64_MIN || t_ns - last_ns_ >= nanoseconds(config_.interval) - kMillisecond_ns;
}

std::vector<Outcome> SkylineFixer::add_picture(Picture picture) {
  last_ns_ = picture.t_ns;
  if (waiting_) refuse(kPrior, "no pose arrived for a picture");
  waiting_ = std::move(picture);
  if (pose_ && pose_->t_ns == waiting_->t_ns) begin(*std::exchange(waiting_, std::nullopt));
  return take_outcomes();
}

void SkylineFixer::begin(Picture picture) {
  if (!pose_->is_of_camera || pose_->t_ns != picture.t_ns)
    return refuse(kPrior, "no pose of the camera at the frame's time");
  if (placed_ && pose_->horizontal_sigma_m > kParameters.unplaced_sigma_m)
    return refuse(kPrior, "the pose is not placed yet");
  if (photograph_fixer_) return estimate_photograph(picture);
  // Without metric scale the position does not change: the scale itself needs fixes.
  const double sigma =
      pose_->is_metric ? pose_->horizontal_sigma_m : std::max(pose_->horizontal_sigma_m, kParameters.unscaled_sigma_m);
  const double yaw_sigma = std::clamp(pose_->yaw_sigma_rad, kParameters.min_yaw_rad, kParameters.max_yaw_rad);
  // Possible drift since the last fix, by the heading's sigma or by the pose's own covariance. A pose that is farther
  // off than the search radius would be matched to a similar place.
  const double driven_m = pose_->path_m - fixed_at_m_;
  const double drift_m = std::max(driven_m * std::min(kParameters.max_off, 3 * yaw_sigma), 3 * sigma);
  const auto slack_m = displacement_from_start();
  const bool lost = !slack_m && (drift_m > config_.radius || failures_ >= kParameters.failures_until_search);
  const bool global_search = place_finder_ && (!placed_ || lost);
  if (lost && drift_m > config_.radius && !global_search)
    return refuse(kPrior, "the pose may be off by more than the search radius");
  if (global_search && (!pose_->is_metric || pose_->is_lost)) {
    place_finder_->clear();
    return refuse(kPrior, "not placed, and the odometry has no metric scale");
  }
  const Eigen::Vector3d& p_n = pose_->p_n;
  if (global_search && !place_finder_->is_far_enough(p_n)) return;
  if (!global_search && joins_ && !window_.adds_information(p_n, pose_->q_n_c)) return;
  const double tilt_sigma = std::max(config_.tilt_sigma, std::min(pose_->tilt_sigma_rad, kParameters.max_tilt_rad));
  job_ = {std::move(picture),
          p_n,
          pose_->q_n_c,
          pose_->path_m,
          Prior{.p_n = p_n - Eigen::Vector3d(0, 0, up_m_),
                .q_n_c = pose_->q_n_c,
                .position_sigma_m = std::max(sigma + failures_, drift_m / 3),
                .yaw_sigma_rad = joins_ ? yaw_sigma + failures_ * kParameters.failed_yaw_rad : yaw_sigma,
                .tilt_sigma_rad = tilt_sigma,
                .farthest_m = config_.radius,
                .lost = failures_ >= kParameters.failures_until_lost,
                .height_sigma_m = std::sqrt(up_variance_),
                .pivot_n = slack_m ? start_n_ : std::nullopt,
                .slack_m = slack_m.value_or(0)},
          global_search,
          config_.join && !global_search && yaw_sigma < kParameters.no_heading_rad &&
              pose_->scale_sigma < kParameters.max_scale_sigma * pose_->scale,
          window_.views()};
  if (survey_ && !global_search && failures_ % 2 == 1 && drift_m <= kParameters.farthest_survey_m)
    job_.survey = survey_prior(job_.prior, sigma);
  worker_.start([this](const Spend& spend) { process_picture(spend); }, slice_);
}

/// Before the first fix, without a heading: the uncertainty of the distance from the start, m; otherwise none.
std::optional<double> SkylineFixer::displacement_from_start() const {
  if (!config_.start_known || fixed_once_ || !pose_->is_metric || !start_n_ ||
      pose_->yaw_sigma_rad < kParameters.no_heading_rad)
    return std::nullopt;
  const double far_m = (pose_->p_n - *start_n_).head<2>().norm();
  const double slack_m = kParameters.slack_m + kParameters.slack_of_path * pose_->path_m;
  // An unknown heading gives a sigma as large as the path; a larger one means that the odometry has failed.
  const double max_sigma = kParameters.max_off * (far_m + slack_m);
  if (far_m < slack_m || far_m > kParameters.farthest_from_start_m || pose_->horizontal_sigma_m > max_sigma)
    return std::nullopt;
  return slack_m;
}

/// Synchronous, on this thread: a photograph has no frame-time limit.
void SkylineFixer::estimate_photograph(const Picture& picture) {
  auto outcome = photograph_fixer_->estimate_pose(picture, pose_->photograph);
  if (outcome.match) {
    outcome.match->covariance = covariance_without_prior(outcome.match->covariance, pose_->photograph.sigma_m,
                                                         PhotographDecisionParameters().min_sigma_m);
    return emit({picture.t_ns, *outcome.match, false, true});
  }
  refuse(outcome.reason, outcome.why);
}

/// Thread: the worker's.
void SkylineFixer::process_picture(const Spend& spend) {
  if (config_.inclination == "vanishing_point") align_with_gravity(job_.prior, job_.picture, config_.tilt_sigma);
  const auto& edges = sky_detector_.find(job_.picture, job_.prior.q_n_c.conjugate(), config_.sky == "flood_fill");
  spend(kParameters.sky_work * job_.picture.grey.total());
  job_.sky_seen = !edges.empty();
  if (!job_.sky_seen) return;
  if (survey_) survey_->correct_roofs(matcher_->city(), spend);
  if (job_.global_search) return search_database(edges, spend);
  const bool alone = Matcher::has_enough_edges(edges) || !job_.may_join;
  if (alone) {
    job_.match = matcher_->match(edges, job_.prior, spend);
  } else {
    job_.view = View{edges, job_.prior.p_n, job_.prior.q_n_c};
    Prior prior = job_.prior;
    prior.lost = false, prior.pivot_n.reset();
    job_.match = matcher_->match(edges, prior, spend, job_.older);
  }
  if (job_.match && (!alone || !validate_match(*job_.match, config_.min_agreement, false))) return;
  if (!job_.survey || gathers()) return;
  job_.surveyed = survey_->match(edges, *job_.survey, spend);
}

/// Searches the database for the place on which several pictures agree, then matches this picture there.
void SkylineFixer::search_database(const std::vector<SkyEdge>& edges, const Spend& spend) {
  job_.sky_seen = Matcher::has_enough_edges(edges);
  if (!job_.sky_seen) return;
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

void SkylineFixer::finish() {
  if (!job_.sky_seen) return refuse(kSky, "no sky around the zenith, or too few roofs");
  if (job_.global_search && !job_.match) {
    char text[120];
    std::snprintf(text, sizeof text, "searched everywhere: %zu pictures, the next best place is %.2g times as likely",
                  place_finder_->pictures(), place_finder_->second_best_ratio());
    return refuse(kAmbiguity, text);
  }
  joins_ = job_.view.has_value();
  auto why = joins_ ? validate_path_match() : validate_single_match();
  std::string surveyed;
  if (why && job_.surveyed) {
    job_.match = std::move(job_.surveyed), why.reset();
    // The covariance contains the pose's, also as a fix: without it drives through flat blocks lose their fixes.
    surveyed = survey_->adopt(*job_.match);
    window_.clear(), path_validator_.clear();
  } else if (!why && survey_) {
    survey_->add_error(*job_.match);
  }
  if (why) {
    if (!gathers() && ++failures_ == kParameters.failures_until_lost && survey_) survey_->forget();
    return refuse(why->first, why->second);
  }
  failures_ = 0;
  placed_ = fixed_once_ = true;
  if (place_finder_) place_finder_->clear();
  fixed_at_m_ = job_.path_m;
  update_road_height(*job_.match);
  if (pose_->t_ns - job_.picture.t_ns > kParameters.late_ns)  // too late for estimators: refer it to the newest pose
    return emit({pose_->t_ns, job_.propagated_to(pose_->p_n, pose_->q_n_c, kParameters.drift), false, false, surveyed});
  // A survey has no slant distance: the highest roof's height is not that of the model.
  emit({job_.picture.t_ns, *job_.match, surveyed.empty(), false, surveyed});
}

std::optional<Rejection> SkylineFixer::validate_single_match() {
  window_.clear(), path_validator_.clear();
  if (!job_.match) return rejection_of(matcher_->refusal());
  return validate_match(*job_.match, config_.min_agreement, job_.global_search);
}

std::optional<Rejection> SkylineFixer::validate_path_match() {
  View& view = *job_.view;
  view.p_n = job_.corrected(view.p_n), view.q_n_c = job_.corrected(view.q_n_c);
  const Eigen::Vector3d p_n = view.p_n;
  const Eigen::Quaterniond q_n_c = view.q_n_c;
  if (closed_edges(view.edges) >= kParameters.min_of_view) window_.add(std::move(view), job_.path_m);
  if (!job_.match) return rejection_of(matcher_->refusal());
  auto why = path_validator_.validate(*job_.match, p_n, q_n_c, config_.min_agreement);
  if (!why) window_.inflate_covariance(*job_.match, kParameters.drift);
  return why;
}

/// Tracks the road's height above n's origin, which the odometry does not observe.
void SkylineFixer::update_road_height(const Match& match) {
  up_m_ = job_.p_n.z() - match.p_n.z();
  // The match includes the prior: its sigma is the posterior's, or after a survey the prior's.
  const double sigma_m = std::max(match.height_sigma_m, kParameters.min_height_sigma_m);
  up_variance_ = std::min(sigma_m * sigma_m + kParameters.road_height_m * kParameters.road_height_m,
                          config_.height_sigma * config_.height_sigma);
}

void SkylineFixer::emit(Fix fix) {
  const double variance = config_.min_sigma * config_.min_sigma + georeference_.accuracy_m * georeference_.accuracy_m;
  fix.match.covariance += Eigen::Matrix2d::Identity() * variance;
  fix.match.second_best_ratio = std::max(kParameters.min_integrity, fix.match.second_best_ratio);
  outcomes_.emplace_back(std::move(fix));
}

}  // namespace odograph::skyline
