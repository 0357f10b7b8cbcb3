// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_matcher.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "plugins/fix/skyline/match_terms.hpp"

namespace odograph::skyline {
namespace {

constexpr double kPhotographDegree = PhotographParameters::kDegree;
using Vector6 = Eigen::Matrix<double, 6, 1>;  // north, east, yaw, tilt_north, tilt_east, up
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Vector6 vector_of(const Guess& g) {
  Vector6 v;
  v << g.north, g.east, g.yaw, g.tilt_north, g.tilt_east, g.up;
  return v;
}
Guess guess_of(const Vector6& v) {
  return {.north = v[0], .east = v[1], .yaw = v[2], .tilt_north = v[3], .tilt_east = v[4], .up = v[5]};
}

}  // namespace

std::vector<int> PhotographMatcher::roofs_around(const Guess& guess, double radius_m) {
  return city_.roofs_around(place_of(guess), radius_m, p_.min_tan, p_.lower_m, p_.spread_sigmas * p_.roofs.building_m,
                            spend_);
}

/// Of the candidate's tile.
void PhotographMatcher::select_roofs(const Candidate& at, double radius_m) {
  city_.select_roofs(roofs_[at.tile], place_of(at.guess), radius_m, p_.min_tan, p_.lower_m,
                     p_.spread_sigmas * p_.roofs.building_m, spend_);
}

/// Computes the model's roof line at a guess's place; the fit treats the guess's `up` to first order.
void PhotographMatcher::render_skyline(const Guess& guess, double reach_rad) {
  const Sector sector = fit_.sector(guess.yaw - reach_rad, guess.yaw + reach_rad);
  if (spend_) spend_(2 * city_.quick_work(sector));
  city_.roof_tops(place_of(guess), p_.spread_sigmas * p_.roofs.building_m, sector, tops_);
  line_.set(tops_);
}

/// The likeliest headings of the current place within the reach: a single one is too often wrong.
void PhotographMatcher::search_place(const Candidate& at, double reach_rad) {
  const int yaws = static_cast<int>(std::ceil(reach_rad / p_.yaw_step_rad));
  const int pitches =
      static_cast<int>(std::min(p_.pitch_sigmas * prior_.tilt_sigma_rad, p_.max_pitch_rad) / p_.pitch_step_rad);
  std::vector<Candidate> headings;
  for (int y = -yaws; y <= yaws; ++y) {
    Candidate turned = at;
    turned.cost = 1e9;
    for (int k = -pitches; k <= pitches; ++k) {
      Guess g = at.guess;
      g.yaw = y * p_.yaw_step_rad;
      const double pitch = k * p_.pitch_step_rad;
      g.tilt_east = pitch * std::cos(pitch_azimuth_), g.tilt_north = -pitch * std::sin(pitch_azimuth_);
      const double c = cost_of(g, p_.stride);
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

/// The local optimum in place, heading, inclination and heights (Levenberg 1944, Marquardt 1963). The facades have a
/// part in the cost but not in the steps.
void PhotographMatcher::fit(Candidate& at) {
  const PhotographRefinementParameters& r = p_.refinement;
  const Guess from = at.guess;
  Vector6 prior, gradient;
  const auto evaluate = [&](Candidate& c) {
    render_skyline(c.guess, r.aligned_rad);
    c.cost = cost_of(c.guess);
  };
  const auto linearise = [&] {
    const auto normal = fit_.normal_equations(at.guess);
    at.information = normal.information, prior = prior_.information(at.guess);
    gradient = normal.gradient + prior.cwiseProduct(vector_of(at.guess));
  };
  evaluate(at), linearise();
  double damping = r.damping;
  for (int step = 0; step < r.steps && damping < r.max_damping; ++step) {
    Matrix6 information = at.information;
    information.diagonal() = (1 + damping) * (information.diagonal() + prior);
    const Vector6 by = -information.ldlt().solve(gradient);
    const double scale = std::max({1.0, by.head<2>().norm() / r.step_m, by.segment<3>(2).norm() / r.rotation_rad});
    Candidate there = at;
    there.guess = guess_of(vector_of(at.guess) + by / scale);
    there.guess.up = std::clamp(there.guess.up, -up_reach(), up_reach());
    const bool out_of_reach = apart(there.guess, from) > r.moved_m ||
                              std::abs(there.guess.yaw - from.yaw) > r.aligned_rad || is_built(there.guess);
    if (!out_of_reach) evaluate(there);
    const double decrease = at.cost - there.cost;
    if (out_of_reach || !(decrease > 0)) {  // nor where it is not a number
      damping = std::max(r.retry_damping, 10 * damping);
      continue;
    }
    at = there, linearise(), damping *= 0.1;
    if (decrease < r.min_decrease) break;
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
          case 0: g.yaw += by * kPhotographDegree; break;
          case 1: g.tilt_north += 0.5 * by * kPhotographDegree; break;
          case 2: g.tilt_east += 0.5 * by * kPhotographDegree; break;
          default: g.up = std::clamp(g.up + 0.5 * by, -up_reach(), up_reach()); break;
        }
        if (const double c = cost_of(g); c < at.cost - 1e-4) at.guess = g, at.cost = c, better = true;
      }
    }
}

/// The same including the position.
void PhotographMatcher::move(Candidate& at, double from_m, double to_m) {
  const Guess from = at.guess;
  render_skyline(at.guess, p_.refinement.aligned_rad);
  align(at);
  for (double size = from_m; size > 0.9 * to_m; size *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 8; ++k) {
        Candidate there = at;
        const double by = k < 4 ? size : 0.7 * size,
                     azimuth = k * 0.5 * std::numbers::pi + (k < 4 ? 0 : 0.25 * std::numbers::pi);
        there.guess.north += by * std::cos(azimuth), there.guess.east += by * std::sin(azimuth);
        if (apart(there.guess, from) > 0.5 * p_.refinement.moved_m ||
            apart(there.guess, {}) > reach_m() + p_.refinement.beyond_m || is_built(there.guess))
          continue;
        render_skyline(there.guess, p_.refinement.aligned_rad);
        align(there);
        if (there.cost < at.cost - 1e-3) at = there, better = true;
      }
    }
}

/// All places of the lattice, tile by tile, so that no visible edge is missed between them.
void PhotographMatcher::search() {
  candidates_.clear(), roofs_.clear();
  const double radius = reach_m();
  const double step = radius > p_.wide_m ? p_.wide_step_m : p_.step_m;
  const int tiles = static_cast<int>(std::ceil((radius - p_.tile_m) / (2 * p_.tile_m)));
  const int reach = static_cast<int>(std::floor(p_.tile_m / step));
  const double tile_m = (2 * reach + 1) * step;
  for (int ta = -tiles; ta <= tiles; ++ta)
    for (int tb = -tiles; tb <= tiles; ++tb) {
      const Guess middle{.north = ta * tile_m, .east = tb * tile_m};
      const double beside = reach * step;  // no place of the tile is nearer than this allows
      if (std::hypot(std::max(0.0, std::abs(middle.north) - beside), std::max(0.0, std::abs(middle.east) - beside)) >
          radius)
        continue;
      roofs_.push_back(roofs_around(middle, 0.71 * tile_m + 2 * p_.refinement.moved_m));
      for (int a = -reach; a <= reach; ++a)
        for (int b = -reach; b <= reach; ++b) {
          Candidate at{{.north = middle.north + a * step, .east = middle.east + b * step}, 0, roofs_.size() - 1};
          if (apart(at.guess, {}) > radius || is_built(at.guess)) continue;
          select_roofs(at, 0.1);
          // Headings that contradict the compass are searched at every second place in both directions.
          const bool any_heading = prior_.wrong_heading > 0 && a % 2 == 0 && b % 2 == 0;
          const double reach_rad = any_heading ? std::numbers::pi : yaw_reach();
          render_skyline(at.guess, reach_rad + p_.turned_rad);
          search_place(at, reach_rad);
        }
    }
}

/// The candidates without those that are near a likelier one, the likeliest first.
std::vector<PhotographMatcher::Candidate> PhotographMatcher::distinct(std::vector<Candidate> all, size_t most,
                                                                      double apart_m) const {
  std::sort(all.begin(), all.end(), is_likelier);
  std::vector<Candidate> out;
  for (const Candidate& c : all) {
    if (out.size() == most) break;
    if (std::none_of(out.begin(), out.end(), [&](const Candidate& o) {
          return apart(o.guess, c.guess) < apart_m &&
                 std::abs(std::remainder(o.guess.yaw - c.guess.yaw, 2 * std::numbers::pi)) < p_.turned_rad;
        }))
      out.push_back(c);
  }
  return out;
}

/// A place at its optimum. A narrow line has a small basin of attraction, so the line's sigma decreases.
void PhotographMatcher::polish(Candidate& at) {
  const PhotographRefinementParameters& r = p_.refinement;
  // Its tile may lack some; two pattern searches, the fit and measure_position() move it.
  at.tile = roofs_.size(), roofs_.push_back(roofs_around(at.guess, 3 * r.moved_m));
  select_roofs(at, r.moved_m);
  fit_.set_line(r.wide_rad);
  move(at, r.move_m, r.moved_to_m);
  fit_.set_line(p_.roofs.line_rad);
  move(at, r.sharp_move_m, r.sharp_moved_m);
  select_roofs(at, r.moved_m);
  fit(at);
}

/// The likeliest candidates of the lattice, each at the optimum of its surroundings; the likeliest first.
std::vector<PhotographMatcher::Candidate> PhotographMatcher::refined() {
  const PhotographRefinementParameters& r = p_.refinement;
  std::vector<Candidate> starts = distinct(candidates_, r.starts, r.start_m);
  fit_.set_line(r.wide_rad);
  for (Candidate& c : starts) {
    select_roofs(c, r.moved_m);
    render_skyline(c.guess, r.aligned_rad), align(c);
  }
  std::sort(starts.begin(), starts.end(), is_likelier);
  std::vector<Candidate> places;
  const auto polish_likeliest = [&](size_t count, const auto& which) {
    for (auto at = starts.begin(); at != starts.end() && count > 0;)
      if (which(*at)) {
        polish(*at), places.push_back(*at), --count;
        at = starts.erase(at);
      } else {
        ++at;
      }
  };
  polish_likeliest(r.polished, [](const Candidate&) { return true; });
  if (!places.empty()) {
    const Guess best = std::min_element(places.begin(), places.end(), is_likelier)->guess;
    polish_likeliest(r.near_best, [&](const Candidate& c) { return apart(c.guess, best) < r.near_m; });
  }
  const auto fit_all = [&](double line_rad) {
    fit_.set_line(line_rad);
    for (Candidate& c : starts) select_roofs(c, r.moved_m), fit(c);
  };
  if (r.fits_wide) fit_all(r.wide_rad);
  fit_all(p_.roofs.line_rad);
  places.insert(places.end(), starts.begin(), starts.end());
  return distinct(places, places.size(), r.mode_m);
}

/// Of the six dimensions of a guess, with the prior.
Eigen::Matrix<double, 6, 6> PhotographMatcher::covariance_of(const Candidate& at) const {
  Matrix6 information = p_.decision.power * at.information;
  information.diagonal() += prior_.information(at.guess);
  return information.inverse();
}

PhotographPlace PhotographMatcher::place_at(const Candidate& at) const {
  const Matrix6 covariance = covariance_of(at);
  return {{at.guess.north, at.guess.east, pitch_azimuth_ + at.guess.yaw},
          fit_.no_match_cost() - at.cost,
          0.5 * std::log(covariance.determinant()) - prior_.log_volume(),
          covariance.topLeftCorner<3, 3>(),
          -cost_of_facades(at.guess)};
}

/// Reduces the covariance of a place to that by its likelihood at a distance, the heading, inclination and heights as
/// they fit best there: the normal equations have no part of what is not smooth, the ends of houses and the facades.
void PhotographMatcher::measure_position(const Candidate& at, PhotographPlace& place) {
  const PhotographRefinementParameters& r = p_.refinement;
  select_roofs(at, r.moved_m);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(place.covariance.topLeftCorner<2, 2>());
  Eigen::Matrix3d information = place.covariance.inverse();
  for (const int axis : {0, 1}) {
    const Eigen::Vector2d v = axes.eigenvectors().col(axis);
    const double sigma_m = std::sqrt(axes.eigenvalues()[axis]);
    double measured_m = 0;
    for (const double side : {-1.0, 1.0}) {
      double at_m = std::min(sigma_m, r.moved_m), increase = 0;
      for (;; at_m *= 0.5) {
        Candidate there = at;
        there.guess.north += side * at_m * v.x(), there.guess.east += side * at_m * v.y();
        render_skyline(there.guess, r.aligned_rad), align(there);
        increase = p_.decision.power * (there.cost - at.cost);
        if (!(increase >= r.max_increase) || at_m < r.min_measured_m) break;
      }
      measured_m = std::max(measured_m, at_m / std::sqrt(std::max(2 * increase, 1e-6)));
    }
    const double more = 1 / (measured_m * measured_m) - 1 / (sigma_m * sigma_m);
    information.topLeftCorner<2, 2>() += std::max(0.0, more) * v * v.transpose();
  }
  const double before = place.covariance.determinant();
  place.covariance = information.inverse();
  place.log_volume += 0.5 * std::log(place.covariance.determinant() / before);
}

/// False where the model has no roof in view.
bool PhotographMatcher::describe(const Candidate& best, Match& match) {
  match.p_n = place_of(best.guess) - Eigen::Vector3d(0, 0, best.guess.up);
  match.q_n_c = best.guess.rotation() * prior_.q_n_c;
  match.height_sigma_m = prior_.height_sigma_m;
  match.tilt_sigma_rad =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance_of(best).block<2, 2>(3, 3)).eigenvalues()[1]);
  render_skyline(best.guess, p_.refinement.aligned_rad);
  fit_.cost(line_, best.guess);
  match.agreement = fit_.agreement();
  match.roofs = fit_.heights(line_);
  return line_.rises();
}

void PhotographMatcher::clear() {
  attempts_.clear();
  decision_ = {.why = "no sky is visible above roofs", .reason = kSky};
}

void PhotographMatcher::add(const std::vector<SkyEdge>& edges, const PhotographPrior& prior, const Spend& spend,
                            Facades* facades) {
  prior_ = prior, spend_ = spend, facades_ = facades;
  if (const size_t closed = closed_edges(edges); closed < p_.min_edges) {
    decision_ = {.why = "roofs are visible against the sky over " + std::to_string(closed / 2) +
                        " degrees of the picture only, " + std::to_string(p_.min_edges / 2) + " are wanted",
                 .reason = kSky};
    return;
  }
  fit_.set(edges, prior.q_n_c);
  const Eigen::Vector3d axis = prior.q_n_c * Eigen::Vector3d::UnitZ();
  pitch_azimuth_ = std::atan2(axis.y(), axis.x());
  const auto ground = ground_.at(prior.p_n.head<2>());
  if (prior.eye_m && ground && !ground->terrain)
    prior_.height_sigma_m = std::hypot(prior.height_sigma_m, p_.feet_sigma_m);
  if (attempts_.empty())
    heights_ = CameraHeights(ground_, prior.p_n, prior.eye_m, reach_m() + 2 * p_.tile_m, p_.ground_step_m);
  if (spend_ && attempts_.empty()) spend_(p_.ground_work * heights_.size());
  fit_.set_line(p_.coarse_rad);
  search();
  const std::vector<Candidate> modes = refined();
  if (modes.empty()) {
    decision_ = {.why = "every place of the search is inside a building of the model"};
    return;
  }
  PhotographAttempt attempt;
  select_roofs(modes.front(), p_.refinement.moved_m);
  if (!describe(modes.front(), attempt.match)) {
    decision_ = {.why = "the model has no roof in view there", .reason = kAgreement};
    return;
  }
  attempt.possible_gain = fit_.no_match_cost();
  const Guess& best = modes.front().guess;
  attempt.straight_gain = fit_.straight_gain() - prior_.cost(best) - cost_of_facades(best);
  attempt.outside = std::exp(-0.5 * std::pow(reach_m() / prior_.sigma_m, 2));
  for (const Candidate& c : modes) {
    attempt.places.push_back(place_at(c));
    if (c.cost < modes.front().cost + p_.refinement.measured_gain) measure_position(c, attempt.places.back());
  }
  attempts_.push_back(std::move(attempt));
}

std::optional<Match> PhotographMatcher::match() {
  if (attempts_.empty()) return std::nullopt;
  decision_ = decide(attempts_, p_.decision);
  return decision_.why.empty() ? decision_.tried : std::nullopt;
}

}  // namespace odograph::skyline
