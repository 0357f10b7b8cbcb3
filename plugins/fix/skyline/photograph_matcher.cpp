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

/// Computes the model's roof line at a guess's place; the fit treats the guess's `up` to first order.
void PhotographMatcher::render_skyline(const Guess& guess) {
  city_.quick_horizon(place_of(guess), horizon_, edge_indices_);
  line_.set(horizon_, edge_indices_, city_.edges(), p_.roofs);
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
  const double yaw_reach = std::min(p_.sigmas * prior_.yaw_sigma_rad, std::numbers::pi);
  const int yaws = static_cast<int>(std::ceil(yaw_reach / p_.yaw_step_rad));
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
  std::sort(headings.begin(), headings.end(), [](const auto& x, const auto& y) { return x.cost < y.cost; });
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
  for (double size = 1; size > 0.1; size *= 0.4)
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
void PhotographMatcher::move(Candidate& at) {
  for (double size = 0.8; size > 0.15; size *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 4; ++k) {
        Candidate there = at;
        (k / 2 ? there.guess.east : there.guess.north) += k % 2 ? -size : size;
        if (apart(there.guess, {}) > p_.max_m + 2 || is_built(there.guess)) continue;
        render_skyline(there.guess);
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
      city_.select_edges(place_of(middle), 0.71 * tile_m + 1, 0.03, 4);
      for (int a = -reach; a <= reach; ++a)
        for (int b = -reach; b <= reach; ++b) {
          Candidate at{{.north = middle.north + a * step, .east = middle.east + b * step}, 0, step * step};
          if (apart(at.guess, {}) > radius || is_built(at.guess)) continue;
          render_skyline(at.guess);
          at.line = lines_.size();
          lines_.push_back(line_);
          search_place(at);
        }
    }
  std::sort(candidates_.begin(), candidates_.end(), [](const auto& x, const auto& y) { return x.cost < y.cost; });
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
      render_skyline(at.guess);
      align(at);
      at.area_m2 = p_.fine_step_m * p_.fine_step_m;
      all.push_back(at);
    }
  return all;
}

/// Probabilities of the surroundings and of all other places that were evaluated, by a power of their likelihoods
/// (Wedderburn 1974): the less of the line fits at the best place, the less the model's errors are those assumed, and
/// the less a difference of likelihoods means.
PhotographMatcher::Spread PhotographMatcher::spread_of(const Candidate& best) {
  auto places = surroundings_of(best);
  for (const Candidate& c : candidates_)
    if (apart(c.guess, best.guess) > p_.fine_m) places.push_back(c);
  const double fits = std::clamp(1 - best.cost / fit_.no_match_cost(), 0.1, 1.0);
  Spread s{.power = std::min(1.0, p_.trust * fits * fits * fits)};
  const auto weight = [&](const Candidate& c) {
    return c.area_m2 * std::exp(s.power * std::min(0.0, best.cost - c.cost));
  };
  const auto offset = [&](const Candidate& c) {
    return Eigen::Vector2d(c.guess.north - best.guess.north, c.guess.east - best.guess.east);
  };
  for (const Candidate& c : places) {
    const double yaw = std::remainder(c.guess.yaw - best.guess.yaw, 2 * std::numbers::pi);
    s.all += weight(c), s.turned += weight(c) * yaw * yaw;
    s.covariance += weight(c) * offset(c) * offset(c).transpose();
  }
  // Spread about the best place, which is the estimate, not about the mean.
  const double cell = p_.fine_step_m * p_.fine_step_m / 12;
  s.covariance = s.covariance / s.all + (cell + p_.min_sigma_m * p_.min_sigma_m) * Eigen::Matrix2d::Identity();
  s.turned /= s.all;
  const Eigen::Matrix2d information = s.covariance.inverse();
  for (const Candidate& c : places)
    if (offset(c).dot(information * offset(c)) > kThreeSigma2) s.others += weight(c);
  return s;
}

/// Variance of the heading at the best place, from the fit one degree aside.
double PhotographMatcher::own_yaw_variance(const Candidate& best) {
  Candidate aside = best;
  render_skyline(best.guess);
  double curvature = 0;
  for (const double by : {-1.0, 1.0}) {
    aside.guess.yaw = best.guess.yaw + by * kDegree;
    curvature += std::max(0.0, cost_of(aside.guess) - best.cost) / (kDegree * kDegree);
  }
  return 1 / std::max(curvature, 1 / (5 * kDegree * 5 * kDegree));
}

/// Covariance, and the probability that the camera is beyond three of its sigmas or not in the model at all. False,
/// with the reason, where either is too large.
bool PhotographMatcher::accept(const Candidate& best, Match& match) {
  const Spread spread = spread_of(best);
  match.covariance = spread.covariance;
  const double worst_m = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(match.covariance).eigenvalues()[1]);
  const double own = own_yaw_variance(best) / spread.power;
  fit_.cost(line_, best.guess);
  match.agreement = fit_.agreement();
  // Likelihood that the model has nothing of the picture, in the same measure: over the prior's area and the ratio of
  // the prior's headings to the place's. A right place has most of the line in the model.
  const double headings = std::max(1.0, prior_.yaw_sigma_rad / std::sqrt(own + spread.turned));
  const double share = (p_.modelled_power + 1) * std::pow(std::max(match.agreement, 1e-6), p_.modelled_power);
  const double none = p_.unmodelled / share * 2 * std::numbers::pi * prior_.sigma_m * prior_.sigma_m * headings *
                      std::exp(std::min(50.0, spread.power * (best.cost - fit_.no_match_cost())));
  other_ = (spread.others + none) / (spread.all + none);
  match.second_best_ratio = other_;
  const double doubt = std::sqrt(match.covariance.trace() / 2) / p_.roof_distance_m;
  match.yaw_sigma_rad = std::sqrt(spread.turned + own + doubt * doubt);
  match.height_sigma_m = prior_.height_sigma_m;
  if (none > spread.others && other_ > p_.max_other)
    why_ = format_text("only %.0f %% of the sky's edge coincides with a roof of the model: that may be chance",
                       100 * match.agreement);
  else if (other_ > p_.max_other)
    why_ = format_text("it fits elsewhere too: the best place is right with %.0f %%", 100 * (1 - other_));
  else if (worst_m > p_.max_sigma_m)
    why_ = format_text("the visible roofs determine the place only to %.1f m; %.1f m are required", worst_m,
                       p_.max_sigma_m);
  return why_.empty();
}

bool PhotographMatcher::describe(const Candidate& best, Match& match) {
  match.p_n = place_of(best.guess) - Eigen::Vector3d(0, 0, best.guess.up);
  match.q_n_c = best.guess.rotation() * prior_.q_n_c;
  render_skyline(best.guess);
  const auto highest = static_cast<size_t>(std::max_element(horizon_.elevation.begin(), horizon_.elevation.end()) -
                                           horizon_.elevation.begin());
  const double h = static_cast<double>(horizon_.height_m[highest]);
  if (h <= 0) return false;
  const double elevation = static_cast<double>(horizon_.elevation[highest]);
  const double azimuth = (static_cast<double>(highest) + 0.5) * kDegree / 2, r = h / std::tan(elevation);
  match.slant_distance_m = h / std::sin(elevation);
  match.landmark_n = place_of(best.guess) + Eigen::Vector3d(r * std::cos(azimuth), r * std::sin(azimuth), -h);
  return true;
}

std::optional<Match> PhotographMatcher::match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior) {
  prior_ = prior;
  gain_ = -1e9, other_ = 1;
  why_.clear(), tried_.reset();
  if (const size_t closed = closed_edges(edges); closed < p_.min_edges) {
    why_ = format_text("roofs end against the sky in %.0f degrees of the picture only, %.0f are wanted",
                       0.5 * static_cast<double>(closed), 0.5 * static_cast<double>(p_.min_edges));
    return std::nullopt;
  }
  fit_.set(edges, prior.q_n_c);
  const Eigen::Vector3d axis = prior.q_n_c * Eigen::Vector3d::UnitZ();
  pitch_azimuth_ = std::atan2(axis.y(), axis.x());
  const auto ground = ground_.at(prior.p_n.head<2>());
  terrain_ = ground && ground->terrain;
  if (ground && !terrain_) prior_.height_sigma_m = std::hypot(prior.height_sigma_m, p_.feet_sigma_m);
  search();
  // Refine the candidates that may be correct by the coarse loss.
  std::vector<Candidate> best(
      candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(std::min(p_.refined, candidates_.size())));
  for (Candidate& c : best) line_ = lines_[c.line], align(c);
  std::copy(best.begin(), best.end(), candidates_.begin());
  // Candidates that are not refined are at most as likely as the worst refined one.
  double last = 0;
  for (const Candidate& c : best) last = std::max(last, c.cost);
  for (size_t i = best.size(); i < candidates_.size(); ++i) candidates_[i].cost = std::max(candidates_[i].cost, last);
  std::sort(best.begin(), best.end(), [](const auto& x, const auto& y) { return x.cost < y.cost; });
  std::vector<Candidate> modes;
  for (const Candidate& c : best) {
    if (modes.size() == p_.modes) break;
    if (std::none_of(modes.begin(), modes.end(), [&](const Candidate& m) { return apart(m.guess, c.guess) < 2; }))
      modes.push_back(c);
  }
  for (Candidate& m : modes) {
    city_.select_edges(place_of(m.guess), 8, 0.03, 4);
    render_skyline(m.guess), align(m), move(m);
  }
  candidates_.insert(candidates_.end(), modes.begin(), modes.end());
  std::sort(modes.begin(), modes.end(), [](const auto& x, const auto& y) { return x.cost < y.cost; });
  if (modes.empty()) {
    why_ = "nothing was searched";
    return std::nullopt;
  }
  gain_ = fit_.no_match_cost() - modes.front().cost;
  city_.select_edges(place_of(modes.front().guess), 8, 0.03, 4);
  Match match;
  if (!describe(modes.front(), match)) {
    why_ = "the model has no roof in view there";
    return std::nullopt;
  }
  const bool good = accept(modes.front(), match);
  tried_ = match;
  if (!good) return std::nullopt;
  return match;
}

}  // namespace odograph::skyline
