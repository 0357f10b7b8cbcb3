// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace odograph::skyline {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMost_rad = 3 * kDegree;      // a direction's largest loss
constexpr double kAgrees_rad = 1.0 * kDegree;  // of one in which picture and model agree
constexpr double kNoise_rad = 0.25 * kDegree;  // least mean loss believed
constexpr double kCorrelated = 12;             // neighbouring directions err together: six degrees
constexpr double kNearest_m = 6;               // always searched: priors are optimistic
constexpr double kWide_m = 12;                 // farther than this the lattice is coarse
constexpr double kApart_m = 4;                 // farther from each other than this two places are two
constexpr double kNewest = 0.35;               // a picture's part of an offset's mean
constexpr int kPictures = 4;                   // that must have been seen before one of the lost is believed
constexpr double kSlip_rad = 0.1 * kDegree;    // an offset is likelier to stay than to move by a cell
constexpr size_t kLeastEdges = 120;

double apart(const Guess& x, const Guess& y) { return std::hypot(x.north - y.north, x.east - y.east); }

/// From a mean loss to a logarithm of a likelihood.
double to_log(size_t directions, double best_cost) {
  return static_cast<double>(directions) / (kCorrelated * std::max(kNoise_rad, 0.5 * best_cost));
}

}  // namespace

int OffsetMap::average(std::vector<Place>& places, double step_m) {
  const auto cell = [&](double m) { return static_cast<int>(std::lround(m / step_m)); };
  int reach = 0;
  for (const Place& p : places) reach = std::max({reach, std::abs(cell(p.guess.north)), std::abs(cell(p.guess.east))});
  constexpr float unknown = std::numeric_limits<float>::infinity();
  const int old_reach = pictures_ > 0 ? reach_ : -1;
  before_ = means_;
  const auto old = [&](int a, int b) {
    if (std::max(std::abs(a), std::abs(b)) > old_reach) return unknown;
    return before_[static_cast<size_t>((a + old_reach) * (2 * old_reach + 1) + b + old_reach)];
  };
  means_.assign(static_cast<size_t>((2 * reach + 1) * (2 * reach + 1)), unknown);
  for (Place& p : places) {
    const int a = cell(p.guess.north), b = cell(p.guess.east);
    float past = old(a, b);
    for (int da = -1; da <= 1; ++da)
      for (int db = -1; db <= 1; ++db) past = std::min(past, old(a + da, b + db) + static_cast<float>(kSlip_rad));
    if (past < unknown) p.cost = kNewest * p.cost + (1 - kNewest) * static_cast<double>(past);
    means_[static_cast<size_t>((a + reach) * (2 * reach + 1) + b + reach)] = static_cast<float>(p.cost);
  }
  reach_ = reach;
  return ++pictures_;
}

/// Mean loss of a direction, rad, with what the prior says of the tilt.
double Matcher::cost(const Guess& g, bool new_place) {
  if (new_place) city_.horizon(prior_.p_n + Eigen::Vector3d(g.north, g.east, 0), horizon_);
  const double tilt = std::hypot(g.tilt_north, g.tilt_east) / prior_.tilt_sigma_rad;
  return seen_.loss(horizon_, g, kMost_rad) +
         0.5 * tilt * tilt * kNoise_rad * kCorrelated / static_cast<double>(seen_.size());
}

/// A lattice of places, each with the best of the headings in reach.
void Matcher::search(double radius_m, double step_m) {
  const int reach = static_cast<int>(std::ceil(radius_m / step_m));
  const int turns = static_cast<int>(std::ceil(std::min(3 * prior_.yaw_sigma_rad, std::numbers::pi) / kDegree));
  const int stride = turns > 8 ? 2 : 1;
  places_.clear();
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      Place best{{.north = a * step_m, .east = b * step_m}, 1e9};
      city_.horizon(prior_.p_n + Eigen::Vector3d(best.guess.north, best.guess.east, 0), horizon_);
      Guess g = best.guess;
      const auto look = [&](double yaw) {
        g.yaw = yaw;
        if (const double c = cost(g, false); c < best.cost) best = {g, c};
      };
      for (int y = -turns; y <= turns; y += stride) look(y * kDegree);
      if (stride > 1) {
        const double middle = best.guess.yaw;
        look(middle - kDegree), look(middle + kDegree);
      }
      places_.push_back(best);
    }
}

Place Matcher::refine(Place at, double step_m) {
  for (double size = step_m / 2; size > 0.05; size /= 2) {
    for (bool better = true; better;) {
      better = false;
      const double turn = size * kDegree;
      // The turns first: they need no other skyline of the model.
      const std::array<Guess, 10> moves = {{{.yaw = turn},
                                            {.yaw = -turn},
                                            {.tilt_north = 0.5 * turn},
                                            {.tilt_north = -0.5 * turn},
                                            {.tilt_east = 0.5 * turn},
                                            {.tilt_east = -0.5 * turn},
                                            {.north = size},
                                            {.north = -size},
                                            {.east = size},
                                            {.east = -size}}};
      city_.horizon(prior_.p_n + Eigen::Vector3d(at.guess.north, at.guess.east, 0), horizon_);
      for (const Guess& m : moves) {
        Guess g = at.guess;
        g.north += m.north, g.east += m.east, g.yaw += m.yaw;
        g.tilt_north += m.tilt_north, g.tilt_east += m.tilt_east;
        const bool moved = m.north != 0 || m.east != 0;
        if (const double c = cost(g, moved); c < at.cost - 1e-9) at = {g, c}, better = true;
      }
    }
  }
  return at;
}

std::optional<Place> Matcher::choose(double step_m, double& rival_cost) {
  const auto by_cost = [](const Place& x, const Place& y) { return x.cost < y.cost; };
  const auto other_than = [&](const Guess& guess) {
    return std::find_if(places_.begin(), places_.end(),
                        [&](const Place& p) { return apart(p.guess, guess) > kApart_m + 1; });
  };
  rival_cost = 1e9;
  if (!prior_.lost) {
    offsets_.clear();
    std::sort(places_.begin(), places_.end(), by_cost);
    Place best = refine(places_.front(), step_m);
    if (const auto other = other_than(best.guess); other != places_.end()) {
      const Place second = refine(*other, step_m);
      if (apart(second.guess, best.guess) > kApart_m) {
        rival_cost = std::max(best.cost, second.cost);
        if (second.cost < best.cost) best = second;
      }
    }
    return best;
  }
  const int pictures = offsets_.average(places_, step_m);
  std::sort(places_.begin(), places_.end(), by_cost);
  if (pictures < kPictures) return std::nullopt;
  const Place first = places_.front();
  if (const auto other = other_than(first.guess); other != places_.end()) rival_cost = other->cost - first.cost;
  Place here = first;
  here.cost = cost(here.guess, true);
  here = refine(here, step_m);
  if (apart(here.guess, first.guess) > kApart_m) return std::nullopt;
  rival_cost += here.cost;
  return here;
}

/// How fast the likelihood falls to all sides, and what the places of the lattice say.
void Matcher::weigh(const Place& best, double rival_cost, Match& match) {
  const double scale = to_log(seen_.size(), best.cost);
  match.rival = rival_cost < 1e9 ? std::exp(-scale * (rival_cost - best.cost)) : 0.0;
  const auto log_at = [&](double north, double east, double yaw) {
    Guess g = best.guess;
    g.north += north, g.east += east, g.yaw += yaw;
    return scale * (cost(g, true) - best.cost);
  };
  // A street that looks the same for a while is a long cloud, not a point.
  Eigen::Matrix2d cloud = Eigen::Matrix2d::Zero();
  double weight = 0;
  for (const Place& place : places_) {
    const double w = std::exp(-scale * (place.cost - places_.front().cost));
    const Eigen::Vector2d d(place.guess.north - best.guess.north, place.guess.east - best.guess.east);
    cloud += w * d * d.transpose(), weight += w;
  }
  cloud /= weight;
  constexpr double s = 0.6;
  const double nn = log_at(s, 0, 0) + log_at(-s, 0, 0), ee = log_at(0, s, 0) + log_at(0, -s, 0);
  const double pp = log_at(s, s, 0) + log_at(-s, -s, 0), mm = log_at(s, -s, 0) + log_at(-s, s, 0);
  Eigen::Matrix2d H;
  H << nn, (pp - mm) / 4, (pp - mm) / 4, ee;
  H /= s * s;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(H);
  const Eigen::Vector2d information = eigen.eigenvalues().cwiseMax(1.0 / (30 * 30)).cwiseMin(1.0 / (0.2 * 0.2));
  match.covariance = eigen.eigenvectors() * information.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  match.covariance += cloud;
  const double yy = log_at(0, 0, kDegree) + log_at(0, 0, -kDegree);
  match.yaw_sigma_rad = std::clamp(kDegree / std::sqrt(std::max(yy, 1e-6)), 0.1 * kDegree, 30 * kDegree);
}

/// Where the camera is, and the highest roof point that it sees; false where there is none.
bool Matcher::describe(const Place& best, Match& match) {
  match.p_n = prior_.p_n + Eigen::Vector3d(best.guess.north, best.guess.east, 0);
  match.q_n_c = best.guess.rotation() * prior_.q_n_c;
  city_.horizon(match.p_n, horizon_);
  match.agreement = seen_.agreement(horizon_, best.guess, kAgrees_rad);
  const auto highest =
      std::max_element(horizon_.elevation.begin(), horizon_.elevation.end()) - horizon_.elevation.begin();
  const double elevation = static_cast<double>(horizon_.elevation[static_cast<size_t>(highest)]);
  const double h = static_cast<double>(horizon_.height_m[static_cast<size_t>(highest)]);
  if (h <= 0) return false;
  match.slant_distance_m = h / std::sin(elevation);
  const double azimuth = (static_cast<double>(highest) + 0.5) * 2 * std::numbers::pi / Horizon::kDirections;
  const double level = match.slant_distance_m * std::cos(elevation);
  match.landmark_n = match.p_n + Eigen::Vector3d(level * std::cos(azimuth), level * std::sin(azimuth), -h);
  return true;
}

std::optional<Match> Matcher::match(const std::vector<SkyEdge>& edges, const Prior& prior) {
  const auto closed = std::count_if(edges.begin(), edges.end(), [](const SkyEdge& e) { return !e.open; });
  if (static_cast<size_t>(closed) < kLeastEdges) return std::nullopt;
  prior_ = prior;
  seen_.set(edges, prior.q_n_c);
  const double radius = std::min(std::max(3 * prior.position_sigma_m, kNearest_m), prior.farthest_m);
  const double step = radius > kWide_m || prior.lost ? 2.0 : 1.0;
  city_.look_around(prior.p_n, radius + 3, std::tan(std::max(0.05, seen_.lowest_rad() - 0.1)));
  search(radius, step);
  double rival_cost = 0;
  const auto best = choose(step, rival_cost);
  Match match;
  if (!best || !describe(*best, match)) return std::nullopt;
  weigh(*best, rival_cost, match);
  return match;
}

}  // namespace odograph::skyline
