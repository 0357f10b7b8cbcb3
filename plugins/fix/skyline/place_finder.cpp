// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/place_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdk/math/scalar.hpp"

namespace odograph::skyline {
namespace {

constexpr int kSectors = SkylineDatabase::kSectors;
constexpr double kLevels = 255 / (0.5 * std::numbers::pi);  // levels of a signature per radian
constexpr size_t kSlice = 200;                              // places of the signature search between two spends

/// A picture's sectors: the mean elevation, and whether a model above or below it is a loss.
struct Sectors {
  std::array<uint8_t, kSectors> seen{}, above{}, below{};
  explicit Sectors(const SeenSkyline& skyline) {
    std::array<double, kSectors> sum{}, up{}, down{}, n{};
    for (const auto& [azimuth, elevation, not_above, not_below] : skyline.summary()) {
      const auto s = static_cast<size_t>(std::floor((azimuth / (2 * std::numbers::pi) + 1) * kSectors)) % kSectors;
      sum[s] += elevation, up[s] += not_above, down[s] += not_below, n[s] += 1;
    }
    constexpr double kHalf = SkylineDatabase::kSectorSize / 2.0;
    for (size_t s = 0; s < kSectors; ++s) {
      if (n[s] < kHalf) continue;  // little of the sector is visible
      seen[s] = static_cast<uint8_t>(std::clamp(std::lround(sum[s] / n[s] * kLevels), 0l, 255l));
      above[s] = up[s] > 0.5 * n[s] ? 255 : 0, below[s] = down[s] > 0.5 * n[s] ? 255 : 0;
    }
  }
};

}  // namespace

bool PlaceFinder::is_far_enough(const Eigen::Vector3d& p) const {
  return pictures_.empty() || (p - pictures_.back().p).head<2>().norm() >= p_.apart_m;
}

void PlaceFinder::clear() {
  pictures_.clear(), hypotheses_.clear();
  single_count_ = 0, second_best_ratio_ = 1;
}

bool PlaceFinder::same(const Hypothesis& a, const Hypothesis& b) const {
  return (a.p - b.p).head<2>().norm() < p_.same_m &&
         std::abs(std::remainder(a.yaw - b.yaw, 2 * std::numbers::pi)) < p_.same_rad;
}

/// The best places by signature, each with its best heading, accurate to a sector's width.
std::vector<PlaceFinder::Hypothesis> PlaceFinder::coarse(const SeenSkyline& seen, const Spend& spend) const {
  const Sectors sectors(seen);
  const auto most = static_cast<uint8_t>(std::lround(p_.sector_max_rad * kLevels));
  struct Score {
    uint16_t cost;
    uint8_t rotation;
    uint32_t place;
  };
  std::vector<Score> scores(database_.size());
  std::array<uint8_t, 2 * kSectors> twice{};
  for (size_t i = 0; i < scores.size(); ++i) {
    if (i % kSlice == 0) spend(kSlice * kSectors * kSectors / 50);
    const uint8_t* signature = database_.signature(i);
    std::copy(signature, signature + kSectors, twice.begin());
    std::copy(signature, signature + kSectors, twice.begin() + kSectors);
    Score best{std::numeric_limits<uint16_t>::max(), 0, static_cast<uint32_t>(i)};
    for (size_t rotation = 0; rotation < kSectors; ++rotation) {
      uint16_t cost = 0;
      for (size_t s = 0; s < kSectors; ++s) {
        // Bytes throughout, so that compilers vectorise the loop.
        const uint8_t m = twice[s + rotation], v = sectors.seen[s], high = std::max(m, v);
        const auto over = static_cast<uint8_t>(static_cast<uint8_t>(high - v) & sectors.above[s]);
        const auto under = static_cast<uint8_t>(static_cast<uint8_t>(high - m) & sectors.below[s]);
        cost = static_cast<uint16_t>(cost + std::min(most, static_cast<uint8_t>(over | under)));
      }
      if (cost < best.cost) best.cost = cost, best.rotation = static_cast<uint8_t>(rotation);
    }
    scores[i] = best;
  }
  const size_t n = std::min(p_.coarse, scores.size());
  const auto before = [](const Score& a, const Score& b) {
    return std::tie(a.cost, a.place) < std::tie(b.cost, b.place);
  };
  std::nth_element(scores.begin(), scores.begin() + static_cast<std::ptrdiff_t>(n - 1), scores.end(), before);
  scores.resize(n);
  std::sort(scores.begin(), scores.end(), before);
  std::vector<Hypothesis> best;
  for (const Score& s : scores)
    best.push_back(
        {database_.place(s.place), s.rotation * 2 * std::numbers::pi / kSectors, 1, static_cast<double>(s.place)});
  return best;
}

/// A place with the best heading and height near a signature's; `at.cost` is the place's number.
PlaceFinder::Hypothesis PlaceFinder::refine_coarse(const SeenSkyline& seen, const Hypothesis& at) const {
  Hypothesis best{at.p, at.yaw, 1, 1e9};
  Horizon horizon;
  if (!database_.horizon(static_cast<size_t>(at.cost), horizon)) return best;
  SeenSkyline::Twice twice;
  const int middle = static_cast<int>(std::lround(at.yaw / (0.5 * kRad_per_deg)));
  for (double up = -p_.high_m; up <= p_.high_m; up += p_.high_step_m) {
    for (size_t j = 0; j < Horizon::kDirections; ++j) {
      const float h = horizon.height_m[j] - static_cast<float>(up), d = horizon.distance_m[j];
      twice[j] = twice[j + Horizon::kDirections] = d > 0 && h > 0 ? std::atan(h / d) : 0.0f;
    }
    for (int rotation = -2 * p_.headings; rotation <= 2 * p_.headings; rotation += 2) {
      const double cost = seen.turned_loss(twice, middle + rotation, p_.max_rad);
      if (cost >= best.cost) continue;
      best.cost = cost, best.yaw = (middle + rotation) * 0.5 * kRad_per_deg;
      best.p.z() = at.p.z() - up;
    }
  }
  return best;
}

/// The skyline at any point between places, from the edges that are visible at the nearest of them.
bool PlaceFinder::horizon_at(const Eigen::Vector3d& p, Horizon& out) const {
  const size_t i = database_.nearest(p.x(), p.y());
  const double reach_m = p_.reach * std::max(1.0, database_.spacing_m());
  if ((database_.place(i) - p).head<2>().norm() > reach_m) return false;
  const auto edges = database_.edges_seen_from(i);
  if (edges.empty()) return false;
  City city(edges);
  city.select_near_edges(p, 0.1, 0);
  city.horizon(p, out);
  return true;
}

/// Horizontal only: the height of an uncorrected odometry drifts most, by a tenth of the path.
Eigen::Vector3d PlaceFinder::moved(const Hypothesis& h, const Eigen::Vector3d& odometry) const {
  return Eigen::AngleAxisd(h.yaw, Eigen::Vector3d::UnitZ()) *
         (h.scale * Eigen::Vector3d(odometry.x(), odometry.y(), 0));
}

Eigen::Vector3d PlaceFinder::place_of(const Hypothesis& h, const Picture& picture) const {
  return h.p + moved(h, picture.p - pictures_.back().p);
}

/// Mean loss of a direction, rad, over all pictures but the worst of several, since one against the sun has no
/// information.
double PlaceFinder::joint_cost(const Hypothesis& h, const Spend& spend) const {
  double sum = 0, worst = 0;
  Horizon horizon;
  for (const Picture& picture : pictures_) {
    spend(6 * Horizon::kDirections + picture.seen.turned_size());
    double cost = p_.max_rad;
    if (horizon_at(place_of(h, picture), horizon)) {
      SeenSkyline::Twice twice;
      const auto middle = std::copy(horizon.elevation.begin(), horizon.elevation.end(), twice.begin());
      std::copy(horizon.elevation.begin(), horizon.elevation.end(), middle);
      cost = picture.seen.turned_loss(twice, static_cast<int>(std::lround(h.yaw / (0.5 * kRad_per_deg))), p_.max_rad);
    }
    sum += cost, worst = std::max(worst, cost);
  }
  auto n = static_cast<double>(pictures_.size());
  if (pictures_.size() >= p_.min_pictures) sum -= worst, n -= 1;
  const double stretched = (h.scale - 1) / p_.scale_sigma;
  const double prior = 0.5 * stretched * stretched * p_.noise_rad * p_.correlated_directions / Horizon::kDirections;
  return (sum + prior) / n;
}

/// Refines position, height, heading and scale of a hypothesis by a pattern search.
PlaceFinder::Hypothesis PlaceFinder::refine(Hypothesis h, const Spend& spend) const {
  h.cost = joint_cost(h, spend);
  for (double size = 1; size > 0.2; size *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int axis = 0; axis < (pictures_.size() > 1 ? 5 : 4); ++axis)
        for (const int sign : {-1, 1}) {
          Hypothesis next = h;
          if (axis < 3)
            next.p[axis] += sign * size;
          else if (axis == 4)
            next.scale += sign * size * 0.02;
          else
            next.yaw += sign * std::max(size * 2, 0.5) * kRad_per_deg;
          next.cost = joint_cost(next, spend);
          if (next.cost < h.cost - 1e-6) h = next, better = true;
        }
    }
  return h;
}

/// Fraction of the directions in which picture and model agree, mean of all pictures but the worst of several.
double PlaceFinder::agreement(const Hypothesis& h) const {
  double sum = 0, worst = 1;
  Horizon horizon;
  for (const Picture& picture : pictures_) {
    const double agreed = horizon_at(place_of(h, picture), horizon)
                              ? picture.seen.agreement(horizon, {.yaw = h.yaw}, p_.agrees_rad)
                              : 0.0;
    sum += agreed, worst = std::min(worst, agreed);
  }
  const auto n = static_cast<double>(pictures_.size());
  return pictures_.size() >= p_.min_pictures ? (sum - worst) / (n - 1) : sum / n;
}

/// The newest picture's own best places.
void PlaceFinder::search(std::vector<Hypothesis>& found, const Spend& spend) {
  const SeenSkyline& seen = pictures_.back().seen;
  std::vector<Hypothesis> close;
  for (const Hypothesis& at : coarse(seen, spend)) {
    spend(9 * Horizon::kDirections + 5 * 17 * seen.turned_size() / 4);
    close.push_back(refine_coarse(seen, at));
  }
  std::stable_sort(close.begin(), close.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  size_t taken = 0;
  for (const Hypothesis& c : close) {
    if (taken == p_.kept) break;
    if (std::any_of(found.begin(), found.end(), [&](const Hypothesis& f) { return same(f, c); })) continue;
    found.push_back(c), ++taken;
  }
}

std::optional<PlaceFinder::Found> PlaceFinder::add(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c,
                                                   const Eigen::Vector3d& p_odometry, const Spend& spend) {
  if (database_.size() == 0) return std::nullopt;
  const Eigen::Vector3d before = pictures_.empty() ? p_odometry : pictures_.back().p;
  pictures_.emplace_back();
  pictures_.back().seen.set(edges, q_n_c), pictures_.back().p = p_odometry;
  if (pictures_.size() > p_.pictures) pictures_.pop_front();
  std::optional<Hypothesis> best_before;
  for (Hypothesis& h : hypotheses_) h.p += Eigen::AngleAxisd(h.yaw, Eigen::Vector3d::UnitZ()) * (p_odometry - before);
  if (!hypotheses_.empty()) best_before = hypotheses_.front();
  auto all = hypotheses_;
  search(all, spend);
  for (Hypothesis& h : all) h.cost = joint_cost(h, spend);
  const auto by_cost = [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; };
  std::stable_sort(all.begin(), all.end(), by_cost);
  if (all.size() > p_.kept) all.resize(p_.kept);
  // Refine only the best; others return with a later picture if they fit it.
  for (size_t k = 0; k < std::min(p_.refined, all.size()); ++k) all[k] = refine(all[k], spend);
  std::stable_sort(all.begin(), all.end(), by_cost);
  hypotheses_.clear();
  for (const Hypothesis& h : all)
    if (std::none_of(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& o) { return same(o, h); }))
      hypotheses_.push_back(h);
  const Hypothesis best = hypotheses_.front();
  // Likelihood ratio of the second-best, from the losses of independent directions and pictures.
  double directions = 0;
  for (const Picture& picture : pictures_) directions += picture.seen.total_weight();
  const double scale =
      directions / (p_.correlated_directions * p_.correlated * std::max(p_.noise_rad, 0.5 * best.cost));
  second_best_ratio_ = hypotheses_.size() > 1 ? std::exp(-scale * (hypotheses_[1].cost - best.cost)) : 0;
  const bool stays = best_before && same(*best_before, best);
  const double path_m = (pictures_.back().p - pictures_.front().p).head<2>().norm();
  const double agreed = agreement(best);
  const bool alone = stays && second_best_ratio_ < p_.max_second_best_ratio && agreed >= p_.min_agreement;
  single_count_ = alone ? single_count_ + 1 : 0;
  if (single_count_ < p_.steady || pictures_.size() < p_.min_pictures || path_m < p_.min_path_m) return std::nullopt;
  return Found{best.p + offset_n_, best.yaw, agreed, second_best_ratio_};
}

}  // namespace odograph::skyline
