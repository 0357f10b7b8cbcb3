// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Dense>

namespace odograph::skyline {
namespace {

constexpr double kDegree = PhotographParameters::kDegree;
constexpr double kThreeSigma2 = 11.829;  // chi-square of two degrees of freedom, 99.73 %

double apart(const Guess& x, const Guess& y) { return std::hypot(x.north - y.north, x.east - y.east); }

template <class... Numbers>
std::string format_text(const char* format, Numbers... numbers) {
  char text[160];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

}  // namespace

Eigen::Vector3d PhotographMatcher::place_of(const Guess& guess) const {
  Eigen::Vector3d p = prior_.p_n + Eigen::Vector3d(guess.north, guess.east, 0);
  if (const auto ground = ground_.at(p.head<2>())) p.z() = ground->down_m - prior_.eye_m;
  return p;
}

void PhotographMatcher::select_roofs(const Eigen::Vector3d& p_n, double radius_m) {
  city_.select_roofs(p_n, radius_m, 0.03, 4, p_.spread_sigmas * p_.roofs.building_m);
}

/// Computes the model's roof line at a guess's place; the fit treats the guess's `up` to first order.
void PhotographMatcher::render_skyline(const Guess& guess, double reach_rad) {
  const Sector sector = fit_.sector(guess.yaw - reach_rad, guess.yaw + reach_rad);
  city_.roof_tops(place_of(guess), p_.spread_sigmas * p_.roofs.building_m, sector, tops_);
  line_.set(tops_);
}

double PhotographMatcher::cost_of_prior(const Guess& g) const {
  const double far = std::hypot(g.north, g.east) / prior_.sigma_m, yaw = g.yaw / prior_.yaw_sigma_rad;
  const double tilt = std::hypot(g.tilt_north, g.tilt_east) / prior_.tilt_sigma_rad;
  const double up = g.up / prior_.height_sigma_m;
  const double turned = prior_.yaw_sigma_rad > 1.5 ? 0 : yaw * yaw;  // any heading
  return 0.5 * (far * far + turned + tilt * tilt + up * up);
}

/// The likeliest headings of the current place: a single one is too often wrong.
void PhotographMatcher::search_place(const Candidate& at) {
  const int yaws = static_cast<int>(std::ceil(yaw_reach() / p_.yaw_step_rad));
  const int pitches =
      static_cast<int>(std::min(1.5 * prior_.tilt_sigma_rad, 12 * kDegree) / p_.pitch_step_rad);  // else one
  std::vector<Candidate> headings;
  for (int y = -yaws; y <= yaws; ++y) {
    Candidate turned = at;
    turned.cost = 1e9;
    for (int k = -pitches; k <= pitches; ++k) {
      Guess g = at.guess;
      g.yaw = y * p_.yaw_step_rad;
      const double pitch = k * p_.pitch_step_rad;
      g.tilt_east = pitch * std::cos(pitch_azimuth_), g.tilt_north = -pitch * std::sin(pitch_azimuth_);
      const double c = fit_.cost(line_, g, p_.stride) + cost_of_prior(g);
      if (c < turned.cost) turned.guess = g, turned.cost = c;
    }
    headings.push_back(turned);
  }
  std::sort(headings.begin(), headings.end(), is_likelier);
  const size_t before = candidates_.size();
  for (const Candidate& h : headings) {
    if (candidates_.size() == before + p_.headings) break;
    if (std::all_of(candidates_.begin() + static_cast<std::ptrdiff_t>(before), candidates_.end(), [&](const auto& c) {
          return std::abs(std::remainder(c.guess.yaw - h.guess.yaw, 2 * std::numbers::pi)) > p_.turned_rad;
        }))
      candidates_.push_back(h);
  }
}

/// The heading, inclination and height that fit a place best, by a pattern search.
void PhotographMatcher::align(Candidate& at) {
  at.cost = cost_of(at.guess);
  for (double size = 1; size > p_.refinement.align_deg; size *= 0.4)
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 8; ++k) {
        Guess g = at.guess;
        const double by = (k % 2 ? -1 : 1) * size;
        switch (k / 2) {
          case 0: g.yaw += by * kDegree; break;
          case 1: g.tilt_north += 0.5 * by * kDegree; break;
          case 2: g.tilt_east += 0.5 * by * kDegree; break;
          default: g.up = std::clamp(g.up + 0.5 * by, -p_.max_up_m, p_.max_up_m); break;
        }
        if (const double c = cost_of(g); c < at.cost - 1e-4) at.guess = g, at.cost = c, better = true;
      }
    }
}

/// The same including the position.
void PhotographMatcher::move(Candidate& at, double from_m, double to_m) {
  for (double size = from_m; size > 0.9 * to_m; size *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 8; ++k) {
        Candidate there = at;
        const double by = k < 4 ? size : 0.7 * size,
                     azimuth = k * 0.5 * std::numbers::pi + (k < 4 ? 0 : 0.25 * std::numbers::pi);
        there.guess.north += by * std::cos(azimuth), there.guess.east += by * std::sin(azimuth);
        if (apart(there.guess, {}) > p_.max_m + 2 || is_built(there.guess)) continue;
        render_skyline(there.guess, p_.refinement.aligned_rad);
        align(there);
        if (there.cost < at.cost - 1e-3) at = there, better = true;
      }
    }
}

/// All places of the lattice, tile by tile, so that no visible edge is missed between them.
void PhotographMatcher::search() {
  candidates_.clear(), lines_.clear();
  const double radius = std::clamp(p_.sigmas * prior_.sigma_m, p_.min_m, p_.max_m);
  const double step = radius > p_.wide_m ? p_.wide_step_m : p_.step_m;
  const int tiles = static_cast<int>(std::ceil((radius - p_.tile_m) / (2 * p_.tile_m)));
  const int reach = static_cast<int>(std::floor(p_.tile_m / step));
  const double tile_m = (2 * reach + 1) * step;
  for (int ta = -tiles; ta <= tiles; ++ta)
    for (int tb = -tiles; tb <= tiles; ++tb) {
      const Guess middle{.north = ta * tile_m, .east = tb * tile_m};
      if (apart(middle, {}) > radius + tile_m) continue;
      select_roofs(place_of(middle), 0.71 * tile_m + 1);
      for (int a = -reach; a <= reach; ++a)
        for (int b = -reach; b <= reach; ++b) {
          Candidate at{{.north = middle.north + a * step, .east = middle.east + b * step}, 0, step * step};
          if (apart(at.guess, {}) > radius || is_built(at.guess)) continue;
          render_skyline(at.guess, yaw_reach() + p_.turned_rad);
          at.line = lines_.size();
          lines_.push_back(line_);
          search_place(at);
        }
    }
  std::sort(candidates_.begin(), candidates_.end(), is_likelier);
}

/// A finer lattice around the best place.
std::vector<PhotographMatcher::Candidate> PhotographMatcher::surroundings_of(const Candidate& best) {
  std::vector<Candidate> all;
  const int reach = static_cast<int>(std::lround(p_.fine_m / p_.fine_step_m));
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      Candidate at = best;
      at.guess.north += a * p_.fine_step_m, at.guess.east += b * p_.fine_step_m;
      if (apart(at.guess, best.guess) > p_.fine_m || is_built(at.guess)) continue;
      render_skyline(at.guess, p_.refinement.aligned_rad);
      align(at);
      at.area_m2 = p_.fine_step_m * p_.fine_step_m;
      all.push_back(at);
    }
  return all;
}

/// Variance of the heading at the best place, from the fit one degree aside.
double PhotographMatcher::own_yaw_variance(const Candidate& best) {
  Candidate aside = best;
  render_skyline(best.guess, p_.refinement.aligned_rad);
  double curvature = 0;
  for (const double by : {-1.0, 1.0}) {
    aside.guess.yaw = best.guess.yaw + by * kDegree;
    curvature += std::max(0.0, cost_of(aside.guess) - best.cost) / (kDegree * kDegree);
  }
  return 1 / std::max(curvature, 1 / (5 * kDegree * 5 * kDegree));
}

/// Coarse candidates refined to places, each the best of its surroundings; the likeliest first. A narrow line has too
/// small a basin of attraction for the lattice, so the line's sigma decreases from stage to stage.
std::vector<PhotographMatcher::Candidate> PhotographMatcher::refined_modes() {
  fit_.set_line(p_.refinement.medium_rad);
  std::vector<Candidate> best(
      candidates_.begin(),
      candidates_.begin() + static_cast<std::ptrdiff_t>(std::min(p_.refinement.refined, candidates_.size())));
  for (Candidate& c : best) line_ = lines_[c.line], align(c);
  std::copy(best.begin(), best.end(), candidates_.begin());
  // Candidates that are not refined are at most as likely as the worst refined one.
  double last = 0;
  for (const Candidate& c : best) last = std::max(last, c.cost);
  for (size_t i = best.size(); i < candidates_.size(); ++i) candidates_[i].cost = std::max(candidates_[i].cost, last);
  std::sort(best.begin(), best.end(), is_likelier);
  std::vector<Candidate> modes;
  for (const Candidate& c : best) {
    if (modes.size() == p_.refinement.modes) break;
    if (std::none_of(modes.begin(), modes.end(),
                     [&](const Candidate& m) { return apart(m.guess, c.guess) < p_.refinement.mode_m; }))
      modes.push_back(c);
  }
  const auto refine = [&](Candidate& m, double from_m, double to_m) {
    select_roofs(place_of(m.guess), p_.refinement.around_m);
    render_skyline(m.guess, p_.refinement.aligned_rad), align(m), move(m, from_m, to_m);
  };
  for (Candidate& m : modes) m.unrefined = m.cost, refine(m, p_.refinement.move_m, p_.refinement.moved_m);
  std::sort(modes.begin(), modes.end(), is_likelier);
  fit_.set_line(p_.roofs.line_rad);
  for (size_t i = 0; i < modes.size(); ++i)
    refine(modes[i], p_.refinement.sharp_move_m,
           i < p_.refinement.sharp ? p_.refinement.sharp_moved_m : p_.refinement.sharp_move_m);
  // The others would have gained too if they had been refined: at least by the factor that nearly all of those gained.
  const double no_match = fit_.no_match_cost();
  std::vector<double> factors;
  for (const Candidate& m : modes) factors.push_back((no_match - m.cost) / std::max(1.0, no_match - m.unrefined));
  const auto at = factors.begin() +
                  static_cast<std::ptrdiff_t>(p_.refinement.gained_quantile * static_cast<double>(factors.size()));
  std::nth_element(factors.begin(), at, factors.end());
  if (at != factors.end())
    for (Candidate& c : candidates_) c.cost -= std::max(0.0, *at - 1) * std::max(0.0, no_match - c.cost);
  std::sort(modes.begin(), modes.end(), is_likelier);
  return modes;
}

bool PhotographMatcher::describe(const Candidate& best, Match& match) {
  match.p_n = place_of(best.guess) - Eigen::Vector3d(0, 0, best.guess.up);
  match.q_n_c = best.guess.rotation() * prior_.q_n_c;
  match.height_sigma_m = prior_.height_sigma_m;
  render_skyline(best.guess, p_.refinement.aligned_rad);
  fit_.cost(line_, best.guess);
  match.agreement = fit_.agreement();
  size_t direction = 0;
  const RoofLine::Layer* const highest = line_.highest(direction);
  if (!highest || highest->elevation <= 0) return false;
  const double e = static_cast<double>(highest->elevation);
  const double azimuth = (static_cast<double>(direction) + 0.5) * kDegree / 2;
  const double r = std::cos(e) * std::cos(e) / static_cast<double>(highest->per_m), h = r * std::tan(e);
  match.slant_distance_m = h / std::sin(e);
  match.landmark_n = place_of(best.guess) + Eigen::Vector3d(r * std::cos(azimuth), r * std::sin(azimuth), -h);
  return true;
}

void PhotographMatcher::clear() {
  attempts_.clear();
  why_ = "nothing was searched";
}

void PhotographMatcher::add(const std::vector<SkyEdge>& edges, const PhotographPrior& prior) {
  prior_ = prior;
  if (const size_t closed = closed_edges(edges); closed < p_.min_edges) {
    why_ = format_text("roofs end against the sky in %.0f degrees of the picture only, %.0f are wanted",
                       0.5 * static_cast<double>(closed), 0.5 * static_cast<double>(p_.min_edges));
    return;
  }
  fit_.set(edges, prior.q_n_c);
  const Eigen::Vector3d axis = prior.q_n_c * Eigen::Vector3d::UnitZ();
  pitch_azimuth_ = std::atan2(axis.y(), axis.x());
  const auto ground = ground_.at(prior.p_n.head<2>());
  terrain_ = ground && ground->terrain;
  if (ground && !terrain_) prior_.height_sigma_m = std::hypot(prior.height_sigma_m, p_.feet_sigma_m);
  fit_.set_line(p_.coarse_rad);
  search();
  const auto modes = refined_modes();
  if (modes.empty()) return;
  const Candidate best = modes.front();
  select_roofs(place_of(best.guess), p_.refinement.around_m);
  Attempt attempt;
  if (!describe(best, attempt.match)) {
    why_ = "the model has no roof in view there";
    return;
  }
  attempt.own_yaw_variance = own_yaw_variance(best);
  const double no_match = attempt.possible_gain = fit_.no_match_cost();
  const auto put = [&](const Candidate& c) {
    attempt.places.push_back({c.guess.north, c.guess.east, pitch_azimuth_ + c.guess.yaw, no_match - c.cost, c.area_m2});
  };
  put(best);
  attempt.places.front().area_m2 = 0;  // the lattice has its area
  for (const Candidate& c : surroundings_of(best)) put(c);
  for (const std::vector<Candidate>& others : {candidates_, modes})
    for (const Candidate& c : others)
      if (apart(c.guess, best.guess) > p_.fine_m) put(c);
  attempts_.push_back(std::move(attempt));
}

/// Covariance, and the probability that the camera is beyond three of its sigmas or not in the model at all, over the
/// places of all attempts, by a power of their likelihoods (Wedderburn 1974): the model's errors are not those assumed.
void PhotographMatcher::estimate_uncertainty(const Attempt& best, Match& match) {
  const Place& at = best.places.front();
  const auto weight = [&](const Attempt& of, const Place& c) {
    // A sky with fewer edges has less to gain, and skies' likelihoods are hardly comparable.
    const double gain = of.places.front().gain * std::max(1.0, best.possible_gain / of.possible_gain);
    const double less = p_.sky_power * std::max(0.0, at.gain - gain) + of.places.front().gain - c.gain;
    return c.area_m2 * std::exp(-p_.power * std::max(0.0, less));
  };
  const auto offset = [&](const Place& c) { return Eigen::Vector2d(c.north - at.north, c.east - at.east); };
  const auto for_each = [&](const auto& with) {
    for (const Attempt& attempt : attempts_)
      for (const Place& c : attempt.places) with(weight(attempt, c), offset(c), c);
  };
  double all = 0, turned = 0, others = 0;
  for_each([&](double w, const Eigen::Vector2d&, const Place&) { all += w; });
  // Spread about the best place, which is the estimate, not about the mean: of the places around it, or of all where
  // that leaves too many out.
  const double floor = p_.fine_step_m * p_.fine_step_m / 12 + p_.min_sigma_m * p_.min_sigma_m;
  for (const double radius_m : {p_.mode_radius_m, 1e9}) {
    double within = 0;
    match.covariance.setZero(), turned = others = 0;
    for_each([&](double w, const Eigen::Vector2d& d, const Place& c) {
      if (d.norm() > radius_m) return;
      const double yaw = std::remainder(c.yaw - at.yaw, 2 * std::numbers::pi);
      within += w, turned += w * yaw * yaw, match.covariance += w * d * d.transpose();
    });
    turned /= within;
    match.covariance = match.covariance / within + floor * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d information = match.covariance.inverse();
    for_each([&](double w, const Eigen::Vector2d& d, const Place&) {
      if (d.dot(information * d) > kThreeSigma2) others += w;
    });
    if (others <= p_.max_other * all) break;
  }
  // Likelihood that the model has nothing of the picture, in the same measure: over the prior's area and the ratio of
  // the prior's headings to the place's. A right place has most of the line in the model.
  const double own = best.own_yaw_variance / p_.power;
  const double headings = std::max(1.0, prior_.yaw_sigma_rad / std::sqrt(own + turned));
  const double share = (p_.modelled_power + 1) * std::pow(std::max(match.agreement, 1e-6), p_.modelled_power);
  const double none = p_.unmodelled / share * 2 * std::numbers::pi * prior_.sigma_m * prior_.sigma_m * headings *
                      std::exp(std::min(50.0, -p_.power * at.gain));
  other_ = (others + none) / (all + none);
  chance_ = none > others;
  match.second_best_ratio = other_;
  const double doubt = std::sqrt(match.covariance.trace() / 2) / p_.roof_distance_m;
  match.yaw_sigma_rad = std::sqrt(turned + own + doubt * doubt);
}

std::optional<Match> PhotographMatcher::match() {
  tried_.reset(), gain_ = -1e9, other_ = 1;
  if (attempts_.empty()) return std::nullopt;
  why_.clear();
  const Attempt& best = *std::max_element(attempts_.begin(), attempts_.end(), [](const Attempt& x, const Attempt& y) {
    return x.places.front().gain < y.places.front().gain;
  });
  gain_ = best.places.front().gain;
  Match match = best.match;
  estimate_uncertainty(best, match);
  const double worst_m = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(match.covariance).eigenvalues()[1]);
  if (chance_ && other_ > p_.max_other)
    why_ = format_text("only %.0f %% of the sky's edge coincides with a roof of the model: that may be chance",
                       100 * match.agreement);
  else if (other_ > p_.max_other)
    why_ = format_text("it fits elsewhere too: the best place is right with %.0f %%", 100 * (1 - other_));
  else if (worst_m > p_.max_sigma_m)
    why_ = format_text("the visible roofs determine the place only to %.1f m; %.1f m are required", worst_m,
                       p_.max_sigma_m);
  tried_ = match;
  if (!why_.empty()) return std::nullopt;
  return match;
}

}  // namespace odograph::skyline
