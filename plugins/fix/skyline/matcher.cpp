// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Dense>

#include "plugins/fix/skyline/match_terms.hpp"

namespace odograph::skyline {
size_t closed_edges(const std::vector<SkyEdge>& edges) {
  return static_cast<size_t>(
      std::count_if(edges.begin(), edges.end(), [](const SkyEdge& e) { return !e.open && !e.above; }));
}

/// The prior's cost of height and inclination, as a mean loss.
double Matcher::cost_of_prior(const Guess& g) const {
  const double tilt = std::hypot(g.tilt_north, g.tilt_east) / prior_.tilt_sigma_rad;
  const double high = g.up / prior_.height_sigma_m;
  return 0.5 * (tilt * tilt + high * high) * p_.noise_rad * p_.correlated * seen_.correlated() /
         std::max(1.0, seen_.total_weight());
}

/// Mean loss of a direction plus the prior's cost, rad.
double Matcher::cost(const Guess& g, bool new_place) {
  spend(seen_.directions() + seen_.work_to_recompute(city_, place_of(g), g.yaw, new_place));
  seen_.look(city_, place_of(g), g.yaw, new_place);
  return (p_.correlation ? correlation_loss(g) : seen_.loss(g, p_.max_rad)) + cost_of_prior(g);
}

/// Eq. (3) as a mean difference of elevations, rad: the share of the pixels that differ, (1 - CC) / 2, times the
/// height of the image in a mean direction.
double Matcher::correlation_loss(const Guess& guess) const {
  double loss = 0;
  for (const auto& seen : seen_.seen()) {
    const BinarySky image = seen.skyline.image(guess);
    const auto rows =
        static_cast<double>(image.pixels_seen()) / static_cast<double>(std::max<size_t>(1, image.columns_seen()));
    const double differ = 0.5 * (1 - cross_correlation(image, BinarySky(seen.horizon.elevation)));
    loss += differ * rows * BinarySky::kRow_rad;
  }
  return loss / static_cast<double>(seen_.seen().size());
}

/// Adds a place of the lattice with the best of the headings in reach.
void Matcher::look_at_place(Place best, int middle_deg, int yaw_steps, int stride) {
  best.cost = 1e9;
  auto& newest = seen_.newest();
  const auto& seen = newest.skyline;
  auto& horizon = newest.horizon;
  spend(city_.quick_work() +
        static_cast<uint64_t>(2 * yaw_steps / stride + 3) * seen.turned_size() / p_.rotated_cheaper);
  city_.quick_horizon(place_of(best.guess), horizon);
  const double max_rad = p_.correlation ? std::numbers::pi : p_.max_rad;  // the images of eq. (3) have no bound
  const auto middle = std::copy(horizon.elevation.begin(), horizon.elevation.end(), twice_.begin());
  std::copy(horizon.elevation.begin(), horizon.elevation.end(), middle);
  const auto look = [&](int degrees) {
    const int turned = static_cast<int>(std::lround(std::remainder(degrees, 360)));
    if (const double c = seen.turned_loss(twice_, 2 * turned, max_rad); c < best.cost)
      best.guess.yaw = turned * kDegree, best.cost = c;
  };
  for (int y = -yaw_steps; y <= yaw_steps; y += stride) look(middle_deg + y);
  if (stride > 1) {
    const auto best_degrees = static_cast<int>(std::lround(best.guess.yaw / kDegree));
    look(best_degrees - 1), look(best_degrees + 1);
  }
  places_.push_back(best);
}

void Matcher::search(double radius_m, double step_m) {
  const int reach = static_cast<int>(std::ceil(radius_m / step_m));
  const int yaw_steps = static_cast<int>(std::ceil(std::min(3 * prior_.yaw_sigma_rad, std::numbers::pi) / kDegree));
  places_.clear();
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b)
      look_at_place({{.north = a * step_m, .east = b * step_m}, 0}, 0, yaw_steps, yaw_steps > 8 ? 2 : 1);
}

/// A lattice over the ring around the pivot, which is the prior's position here. `displacement` is from there to the
/// track's position, m north and east. The bearing of a place on the ring gives its heading.
void Matcher::search_circle(const Eigen::Vector2d& displacement, double step_m) {
  const double chord_m = displacement.norm();
  const int reach = static_cast<int>(std::ceil((chord_m + prior_.slack_m) / step_m));
  const double aside_rad = std::asin(std::min(1.0, prior_.slack_m / chord_m));
  const int yaw_steps = std::min(180, static_cast<int>(std::ceil(aside_rad / kDegree)) + 2);
  places_.clear();
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      const Eigen::Vector2d at(a * step_m, b * step_m);
      if (std::abs(at.norm() - chord_m) > prior_.slack_m) continue;
      const double yaw_rad = std::atan2(at.y(), at.x()) - std::atan2(displacement.y(), displacement.x());
      look_at_place({{.north = at.x(), .east = at.y()}, 0}, static_cast<int>(std::lround(yaw_rad / kDegree)), yaw_steps,
                    yaw_steps > 8 ? 2 : 1);
    }
}

/// Normal equations of all six unknowns (north, east, up, yaw, tilt about north and east) at a guess: numeric
/// derivatives of the model's skyline, each direction weighted after Geman & McClure.
bool Matcher::linearise(const Guess& at, double soft_rad, Matrix6d& H, Vector6d& b) {
  H.setZero(), b.setZero();
  seen_.look(city_, place_of(at), at.yaw, true);
  double directions = 0;
  for (const auto& seen : seen_.seen()) directions += add_view(seen, at, soft_rad, H, b);
  const double noise = p_.noise_rad * p_.noise_rad * p_.correlated * seen_.correlated();
  H /= noise, b /= noise;
  const double height = 1 / (prior_.height_sigma_m * prior_.height_sigma_m);
  const double tilt = 1 / (prior_.tilt_sigma_rad * prior_.tilt_sigma_rad);
  H(2, 2) += height, b[2] -= height * at.up;
  H(4, 4) += tilt, b[4] -= tilt * at.tilt_north;
  H(5, 5) += tilt, b[5] -= tilt * at.tilt_east;
  return directions > 20;
}

/// Adds one picture to the normal equations. Returns the sum of its weights.
double Matcher::add_view(const SeenPath::Seen& seen, const Guess& at, double soft_rad, Matrix6d& H, Vector6d& b) {
  const Eigen::Vector3d p = seen.computed_n, offset_n = p - place_of(at);
  spend(7 * city_.quick_work(seen.sector) + 4 * seen.skyline.size());
  Horizon moved[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      Eigen::Vector3d there = p;
      there[axis] += side ? p_.derivative_step_m : -p_.derivative_step_m;
      city_.quick_horizon(there, moved[axis][side], seen.sector);
    }
  seen.skyline.residuals(seen.horizon, at, residuals_);
  double directions = 0;
  for (const auto& r : residuals_) {
    const double soft = soft_rad * soft_rad / (soft_rad * soft_rad + r.value * r.value);
    const double w = r.weight * soft * soft;
    if (w < 1e-3) continue;
    directions += w;
    Vector6d J;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = moved[axis][1].elevation_at(r.azimuth) - moved[axis][0].elevation_at(r.azimuth);
      // A jump is a house's end that enters the direction, not a slope.
      J[axis] = std::abs(d) < 0.1 ? d / (2 * p_.derivative_step_m) : 0.0;
    }
    J[2] = -J[2];  // up
    const double rise = seen.horizon.elevation_at(r.azimuth + p_.derivative_step_rad) -
                        seen.horizon.elevation_at(r.azimuth - p_.derivative_step_rad);
    J[3] = std::abs(rise) < 0.1 ? rise / (2 * p_.derivative_step_rad) : 0.0;
    J[4] = J[3] * r.slope * r.cosine + r.sine;
    J[5] = J[3] * r.slope * r.sine - r.cosine;
    J[3] += J[1] * offset_n.x() - J[0] * offset_n.y();  // an older place moves with the heading
    H += w * J * J.transpose();
    b -= w * r.value * J;
  }
  return directions;
}

/// One step of Levenberg's method.
std::optional<Guess> Matcher::step(const Guess& at, double soft_rad, double damping) {
  Matrix6d H;
  Vector6d b;
  if (!linearise(at, soft_rad, H, b)) return std::nullopt;
  H.diagonal() *= 1 + damping;
  H.diagonal().head<3>().array() += 1e-3;
  H(3, 3) += 1e-3 / (kDegree * kDegree);
  Vector6d d = H.ldlt().solve(b);
  if (!d.allFinite()) return std::nullopt;
  if (const double far = d.head<3>().norm(); far > p_.max_step_m) d *= p_.max_step_m / far;
  if (const double yaw_rad = std::abs(d[3]); yaw_rad > p_.max_rad) d *= p_.max_rad / yaw_rad;
  Guess g = at;
  g.north += d[0], g.east += d[1], g.up += d[2], g.yaw += d[3], g.tilt_north += d[4], g.tilt_east += d[5];
  return g;
}

/// Steps with a decreasing tolerance, so that walls that are degrees off contribute at first; then descending steps
/// only.
Place Matcher::refine(Place at) {
  at.cost = cost(at.guess, true);
  Place now = at;
  for (const double soft_rad : {4 * p_.soft_rad, 2 * p_.soft_rad, p_.soft_rad}) {
    const auto next = step(now.guess, soft_rad, 1e-3);
    if (!next) return at;
    now = {*next, cost(*next, true)};
    if (now.cost < at.cost) at = now;
  }
  now = at;
  double damping = 1e-3;
  for (int k = 0; k < p_.last_steps; ++k) {
    const auto next = step(now.guess, p_.soft_rad, damping);
    if (!next) break;
    const double c = cost(*next, true);
    if (c < now.cost - 1e-6) {
      now = {*next, c}, damping = 1e-3;
    } else if ((damping *= 100) > 20) {
      break;
    }
  }
  return now;
}

/// The best heading and inclination for a place, by a pattern search on the skyline computed there.
void Matcher::align_heading(Place& at) {
  for (double size = 0.8 * kDegree; size > 0.08 * kDegree; size *= 0.4)
    for (bool better = true; better;) {
      better = false;
      const std::array<Guess, 6> moves = {{{.yaw = size},
                                           {.yaw = -size},
                                           {.tilt_north = 0.5 * size},
                                           {.tilt_north = -0.5 * size},
                                           {.tilt_east = 0.5 * size},
                                           {.tilt_east = -0.5 * size}}};
      for (const Guess& m : moves) {
        Guess g = at.guess;
        g.yaw += m.yaw, g.tilt_north += m.tilt_north, g.tilt_east += m.tilt_east;
        if (const double c = cost(g, false); c < at.cost - 1e-7) at = {g, c}, better = true;
      }
    }
}

/// Vertical edges of houses determine the heading but have no slope: a pattern search over the last metre, each place
/// with the heading and the inclination that fit it best.
Place Matcher::polish(Place at) {
  at.cost = cost(at.guess, true);
  align_heading(at);
  for (double size = 0.6; size > 0.05; size *= 0.5)
    for (bool better = true; better;) {
      better = false;
      const std::array<Guess, 6> moves = {
          {{.north = size}, {.north = -size}, {.east = size}, {.east = -size}, {.up = size}, {.up = -size}}};
      for (const Guess& m : moves) {
        Place there = at;
        there.guess.north += m.north, there.guess.east += m.east, there.guess.up += m.up;
        there.cost = cost(there.guess, true);
        if (there.cost > at.cost + p_.prune_rad) continue;
        align_heading(there);
        if (there.cost < at.cost - 1e-6) at = there, better = true;
      }
    }
  return at;
}

std::optional<Place> Matcher::choose(double step_m, double& second_best_cost) {
  second_best_cost = 1e9;
  ends_.clear();
  if (!prior_.lost) {
    offsets_.clear();
    std::sort(places_.begin(), places_.end(), by_cost);
    // Refine the best few places of the lattice that are apart from each other.
    std::vector<Place> starts;
    for (const Place& p : places_) {
      if (std::any_of(starts.begin(), starts.end(),
                      [&](const Place& s) { return apart(s.guess, p.guess) < p_.spread_m; }))
        continue;
      starts.push_back(p);
      if (starts.size() == (seen_.is_path() ? p_.starts_of_path : p_.starts)) break;
    }
    for (const Place& p : starts) ends_.push_back(refine(p));
    std::sort(ends_.begin(), ends_.end(), by_cost);
    ends_.front() = polish(ends_.front());
    // Beside a wall the skyline changes within less than a cell, so that the lattice may miss the place: the prior's
    // own position is refined too.
    if (!prior_.pivot_n) ends_.push_back(polish(refine({})));
    std::sort(ends_.begin(), ends_.end(), by_cost);
    for (const Place& p : ends_)
      if (apart(p.guess, ends_.front().guess) > p_.apart_m) {
        second_best_cost = p.cost;
        break;
      }
    return ends_.front();
  }
  const int pictures = offsets_.average(places_, step_m);
  std::sort(places_.begin(), places_.end(), by_cost);
  refusal_ = Refusal::gathering;
  if (pictures < p_.pictures) return std::nullopt;
  const Place first = places_.front();
  const auto other = std::find_if(places_.begin(), places_.end(),
                                  [&](const Place& p) { return apart(p.guess, first.guess) > p_.apart_m + 1; });
  if (other != places_.end()) second_best_cost = other->cost - first.cost;
  const Place here = polish(refine(first));
  refusal_ = Refusal::ambiguous;
  if (apart(here.guess, first.guess) > p_.apart_m) return std::nullopt;
  second_best_cost += here.cost;
  return here;
}

/// Whether a place lies in the searched area, at `chord_m` from the middle to within `reach_m`, and at a height that
/// the prior allows. Otherwise the refinement has diverged.
bool Matcher::within_reach(const Place& best, double chord_m, double reach_m) const {
  const double high_m = p_.height_sigmas * std::max(prior_.height_sigma_m, p_.climbed_m);
  const double far_m = std::hypot(best.guess.north, best.guess.east);
  const double lattice_m = chord_m > 0 ? reach_m : reach_m * std::numbers::sqrt2;  // the corner of the square lattice
  return std::abs(best.guess.up) <= high_m && std::abs(far_m - chord_m) <= lattice_m + p_.outside_m;
}

/// Fills in the camera's pose and the highest roof point in view; false where there is none.
bool Matcher::describe(const Place& best, Match& match) {
  match.p_n = place_of(best.guess);
  match.q_n_c = best.guess.rotation() * prior_.q_n_c;
  std::map<int, double> directions;  // by object
  for (auto& seen : seen_.seen()) {
    spend(city_.work());
    City::EdgeIndices edges;
    city_.horizon(seen.place(match.p_n, best.guess.yaw), seen.horizon, edges);
    for (const auto& ray : seen.skyline.summary()) {
      const double at = (ray.azimuth + best.guess.yaw) / (2 * std::numbers::pi);
      const int edge = edges[static_cast<size_t>((at - std::floor(at)) * Horizon::kDirections) % Horizon::kDirections];
      if (edge >= 0) ++directions[city_.edges()[static_cast<size_t>(edge)].object];
    }
  }
  for (const auto& [object, count] : directions) match.roofs.push_back({object, 0, count});
  match.agreement = seen_.agreement(best.guess, p_.agrees_rad);
  const Horizon& horizon = seen_.newest().horizon;
  const auto highest = std::max_element(horizon.elevation.begin(), horizon.elevation.end()) - horizon.elevation.begin();
  const double elevation = static_cast<double>(horizon.elevation[static_cast<size_t>(highest)]);
  const double h = static_cast<double>(horizon.height_m[static_cast<size_t>(highest)]);
  if (h <= 0) return false;
  match.slant_distance_m = h / std::sin(elevation);
  const double azimuth = (static_cast<double>(highest) + 0.5) * 2 * std::numbers::pi / Horizon::kDirections;
  const double horizontal = match.slant_distance_m * std::cos(elevation);
  match.landmark_n = match.p_n + Eigen::Vector3d(horizontal * std::cos(azimuth), horizontal * std::sin(azimuth), -h);
  return true;
}

bool Matcher::has_enough_edges(const std::vector<SkyEdge>& edges, const std::vector<View>& older,
                               const MatcherParameters& p) {
  size_t closed = closed_edges(edges);
  for (const View& view : older) closed += closed_edges(view.edges);
  return closed >= p.min_edges;
}

std::optional<Match> Matcher::match(const std::vector<SkyEdge>& edges, const Prior& prior, const Spend& spend,
                                    const std::vector<View>& older) {
  spend_ = spend;
  refusal_ = Refusal::few_edges;
  if (!has_enough_edges(edges, older, p_)) return std::nullopt;
  refusal_ = Refusal::none;
  prior_ = prior;
  const double yaw_reach = 3 * prior.yaw_sigma_rad;
  seen_.set(edges, prior.p_n, prior.q_n_c, older, yaw_reach);
  const Eigen::Vector2d displacement =
      prior.pivot_n ? Eigen::Vector2d((prior.p_n - *prior.pivot_n).head<2>()) : Eigen::Vector2d::Zero();
  const double radius = prior.pivot_n ? displacement.norm() + prior.slack_m
                                      : std::min(std::max(3 * prior.position_sigma_m, p_.nearest_m), prior.farthest_m);
  if (prior.pivot_n) prior_.p_n.head<2>() = prior.pivot_n->head<2>(), prior_.lost = false;
  const double step = radius > p_.wide_m || prior_.lost ? p_.coarse_step_m : p_.fine_step_m;
  const Eigen::Vector3d middle_n = seen_.middle_n();
  const double path_m = seen_.half_length_m() + std::min(yaw_reach, 2.0) * middle_n.norm();
  city_.select_edges(prior_.p_n + middle_n, radius + 3 + path_m,
                     std::tan(std::max(p_.lowest_rad, seen_.lowest_rad() - 0.1)), 3 * prior.height_sigma_m, spend);
  if (prior.pivot_n)
    search_circle(displacement, step);
  else if (seen_.is_path())
    search_path(radius, step);
  else
    search(radius, step);
  double second_best_cost = 0;
  const auto best = choose(step, second_best_cost);
  Match match;
  if (!best) return std::nullopt;
  refusal_ = Refusal::beyond;
  const bool ring = prior.pivot_n.has_value();
  if (!within_reach(*best, ring ? displacement.norm() : 0, ring ? prior.slack_m : radius)) return std::nullopt;
  refusal_ = Refusal::nothing_in_view;
  if (!describe(*best, match)) return std::nullopt;
  sample_neighbours(*best);
  refusal_ = Refusal::none;
  if (!estimate_covariance(*best, second_best_cost, match)) {
    refusal_ = Refusal::ambiguous;
    return std::nullopt;
  }
  return match;
}

}  // namespace odograph::skyline
