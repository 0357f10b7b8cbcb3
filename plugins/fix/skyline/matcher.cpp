// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
constexpr size_t kLeastEdges = 120;

}  // namespace

Eigen::Quaterniond Matcher::turned(const Guess& g) const {
  const Eigen::Vector3d turn(g.tilt_north, g.tilt_east, g.yaw);
  const double angle = turn.norm();
  if (angle < 1e-12) return prior_.q_n_c;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * prior_.q_n_c;
}

/// Mean loss of a direction, rad, with what the prior says of the tilt.
double Matcher::cost(const Guess& g, bool new_place) {
  if (new_place) city_.horizon(prior_.p_n + Eigen::Vector3d(g.north, g.east, 0), horizon_);
  const Eigen::Matrix3d turn = (turned(g) * prior_.q_n_c.conjugate()).toRotationMatrix();
  double sum = 0;
  for (size_t i = 0; i < rays_n_.size(); ++i) {
    const Eigen::Vector3d u = turn * rays_n_[i];
    double azimuth = std::atan2(u.y(), u.x());
    if (azimuth < 0) azimuth += 2 * std::numbers::pi;
    const auto j = std::min<size_t>(static_cast<size_t>(azimuth * (Horizon::kDirections / (2 * std::numbers::pi))),
                                    Horizon::kDirections - 1);
    const double seen = std::atan2(-u.z(), std::hypot(u.x(), u.y()));
    const double above = std::atan(static_cast<double>(horizon_.elevation_tan[j])) - seen;  // the model's over it
    sum += std::min(kMost_rad, open_[i] ? std::max(0.0, above) : std::abs(above));
  }
  const double tilt = std::hypot(g.tilt_north, g.tilt_east) / prior_.tilt_sigma_rad;
  return sum / static_cast<double>(rays_n_.size()) +
         0.5 * tilt * tilt * kNoise_rad * kCorrelated / static_cast<double>(rays_n_.size());
}

std::optional<Match> Matcher::match(const std::vector<SkyEdge>& edges, const Prior& prior) {
  const auto closed = std::count_if(edges.begin(), edges.end(), [](const SkyEdge& e) { return !e.open; });
  if (static_cast<size_t>(closed) < kLeastEdges) return std::nullopt;
  prior_ = prior;
  rays_n_.clear(), open_.clear();
  double lowest = 1;
  for (const SkyEdge& e : edges) {
    rays_n_.push_back(prior.q_n_c * e.ray_c);
    open_.push_back(e.open);
    lowest = std::min(lowest, -rays_n_.back().z());
  }
  const double radius = std::min(std::max(3 * prior.position_sigma_m, kNearest_m), prior.farthest_m);
  const double least = std::max(0.05, lowest - 0.1);
  city_.look_around(prior.p_n, radius + 3, least / std::sqrt(1 - least * least));

  // A grid of places, and of headings at each.
  const double step = radius > 12 ? 2.0 : 1.0;
  const int reach = static_cast<int>(std::ceil(radius / step));
  const int turns = static_cast<int>(std::ceil(std::min(3 * prior.yaw_sigma_rad, std::numbers::pi) / kDegree));
  struct Place {
    Guess guess;
    double cost;
  };
  std::vector<Place> places;
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      Place best{{}, 1e9};
      for (int y = -turns; y <= turns; ++y) {
        const Guess g{.north = a * step, .east = b * step, .yaw = y * kDegree};
        if (const double c = cost(g, y == -turns); c < best.cost) best = {g, c};
      }
      places.push_back(best);
    }
  std::sort(places.begin(), places.end(), [](const Place& x, const Place& y) { return x.cost < y.cost; });

  const auto refine = [&](Place at) {
    for (double size = step / 2; size > 0.05; size /= 2) {
      for (bool better = true; better;) {
        better = false;
        const double turn = size * kDegree;
        const std::array<Guess, 10> moves = {{{.north = size},
                                              {.north = -size},
                                              {.east = size},
                                              {.east = -size},
                                              {.yaw = turn},
                                              {.yaw = -turn},
                                              {.tilt_north = 0.5 * turn},
                                              {.tilt_north = -0.5 * turn},
                                              {.tilt_east = 0.5 * turn},
                                              {.tilt_east = -0.5 * turn}}};
        for (const Guess& m : moves) {
          Guess g = at.guess;
          g.north += m.north, g.east += m.east, g.yaw += m.yaw;
          g.tilt_north += m.tilt_north, g.tilt_east += m.tilt_east;
          if (const double c = cost(g, true); c < at.cost - 1e-9) at = {g, c}, better = true;
        }
      }
    }
    return at;
  };
  const auto apart = [](const Guess& x, const Guess& y) { return std::hypot(x.north - y.north, x.east - y.east); };
  Place best = refine(places.front());
  double rival = 1e9;
  const auto other =
      std::find_if(places.begin(), places.end(), [&](const Place& p) { return apart(p.guess, best.guess) > 5.0; });
  if (other != places.end()) {
    const Place second = refine(*other);
    if (apart(second.guess, best.guess) > 4.0) {
      rival = std::max(best.cost, second.cost);
      if (second.cost < best.cost) best = second;
    }
  }

  Match match;
  const double n = static_cast<double>(rays_n_.size());
  const double to_log = n / (kCorrelated * std::max(kNoise_rad, 0.5 * best.cost));
  match.rival = rival < 1e9 ? std::exp(-to_log * (rival - best.cost)) : 0.0;
  // How fast the likelihood falls to all sides.
  const auto log_at = [&](double north, double east, double yaw) {
    Guess g = best.guess;
    g.north += north, g.east += east, g.yaw += yaw;
    return to_log * (cost(g, true) - best.cost);
  };
  // The places of the grid, weighed: a street that looks the same for a while is a long cloud, not a point.
  Eigen::Matrix2d cloud = Eigen::Matrix2d::Zero();
  double weight = 0;
  for (const Place& place : places) {
    const double w = std::exp(-to_log * (place.cost - places.front().cost));
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

  match.p_n = prior.p_n + Eigen::Vector3d(best.guess.north, best.guess.east, 0);
  match.q_n_c = turned(best.guess);
  cost(best.guess, true);  // the skyline of the place found
  size_t agreeing = 0, highest = 0;
  const Eigen::Matrix3d turn = (match.q_n_c * prior.q_n_c.conjugate()).toRotationMatrix();
  for (size_t i = 0; i < rays_n_.size(); ++i) {
    const Eigen::Vector3d u = turn * rays_n_[i];
    const double azimuth = std::atan2(u.y(), u.x()) + (u.y() < 0 ? 2 * std::numbers::pi : 0);
    const auto j = std::min<size_t>(static_cast<size_t>(azimuth * (Horizon::kDirections / (2 * std::numbers::pi))),
                                    Horizon::kDirections - 1);
    const double above =
        std::atan(static_cast<double>(horizon_.elevation_tan[j])) - std::atan2(-u.z(), std::hypot(u.x(), u.y()));
    agreeing += (open_[i] ? std::max(0.0, above) : std::abs(above)) < kAgrees_rad;
  }
  match.agreement = static_cast<double>(agreeing) / n;
  for (size_t j = 0; j < Horizon::kDirections; ++j)
    if (horizon_.elevation_tan[j] > horizon_.elevation_tan[highest]) highest = j;
  const double h = horizon_.height_m[highest],
               elevation = std::atan(static_cast<double>(horizon_.elevation_tan[highest]));
  if (h <= 0) return std::nullopt;
  match.slant_distance_m = h / std::sin(elevation);
  const double azimuth = (static_cast<double>(highest) + 0.5) * 2 * std::numbers::pi / Horizon::kDirections;
  const double level = match.slant_distance_m * std::cos(elevation);
  match.landmark_n = match.p_n + Eigen::Vector3d(level * std::cos(azimuth), level * std::sin(azimuth), -h);
  return match;
}

}  // namespace odograph::skyline
