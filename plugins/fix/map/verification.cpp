// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/verification.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace odograph::place_map {
namespace {

using Eigen::Vector3d;

/// Half of the time of a recognition is here. x86-64 does not guarantee an instruction that counts bits; the loader
/// chooses the version that the processor has.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__)
#define ODOGRAPH_COUNTS_BITS __attribute__((target_clones("popcnt", "default")))
#else
#define ODOGRAPH_COUNTS_BITS
#endif

struct NearestLook {
  int16_t distance = 257;
  uint16_t look = 0;
};

ODOGRAPH_COUNTS_BITS void compare_look(const Descriptor& look, uint16_t number, const std::vector<Feature>& features,
                                       NearestLook* nearest) {
  for (size_t k = 0; k < features.size(); ++k) {
    const Descriptor& other = features[k].descriptor;
    const int distance = __builtin_popcountll(look[0] ^ other[0]) + __builtin_popcountll(look[1] ^ other[1]) +
                         __builtin_popcountll(look[2] ^ other[2]) + __builtin_popcountll(look[3] ^ other[3]);
    if (distance < nearest[k].distance) nearest[k] = {static_cast<int16_t>(distance), number};
  }
}

/// Hamming distances of all pairs of a landmark and a feature, by its nearest look.
class Distances {
 public:
  Distances(const QueryView& query, const LocalMap& map)
      : columns_(query.features.size()), nearest_(map.size() * columns_) {
    for (size_t i = 0; i < map.size(); ++i)
      for (size_t look = 0; look < map[i].looks.size(); ++look)
        compare_look(map[i].looks[look].descriptor, static_cast<uint16_t>(look), query.features,
                     &nearest_[i * columns_]);
  }
  int distance(size_t landmark, size_t feature) const { return nearest_[landmark * columns_ + feature].distance; }
  size_t look(size_t landmark, size_t feature) const { return nearest_[landmark * columns_ + feature].look; }

 private:
  size_t columns_;
  std::vector<NearestLook> nearest_;
};

/// Matches that are best in both directions, the most confident first.
std::vector<Correspondence> tentative_matches(const QueryView& query, const LocalMap& map,
                                              const VerificationParameters& p, const FeatureParameters& f) {
  const Distances distances(query, map);
  std::vector<size_t> of_feature(query.features.size(), 0);
  for (size_t k = 0; k < query.features.size(); ++k)
    for (size_t i = 1; i < map.size(); ++i)
      if (distances.distance(i, k) < distances.distance(of_feature[k], k)) of_feature[k] = i;
  std::vector<Correspondence> matches;
  for (size_t i = 0; i < map.size(); ++i) {
    size_t best = 0;
    for (size_t k = 1; k < query.features.size(); ++k)
      if (distances.distance(i, k) < distances.distance(i, best)) best = k;
    if (query.features.empty() || distances.distance(i, best) > p.max_distance || of_feature[best] != i) continue;
    const Feature& feature = query.features[best];
    int second = 257;  // what else it might be, in the picture and in the map
    for (size_t k = 0; k < query.features.size(); ++k)
      if (distances.distance(i, k) < second && (query.features[k].ray_c - feature.ray_c).norm() > p.distinct_rad)
        second = distances.distance(i, k);
    const Vector3d towards = map[i].p_k.normalized();
    for (size_t other = 0; other < map.size(); ++other)
      if (distances.distance(other, best) < second && (map[other].p_k.normalized() - towards).norm() > p.distinct_rad)
        second = distances.distance(other, best);
    Correspondence& match = matches.emplace_back();
    match.p_k = map[i].p_k, match.across_sigma = map[i].across_sigma, match.along_sigma = map[i].along_sigma;
    match.ray_c = feature.ray_c, match.sigma_rad = 0.5 * feature.sigma_rad;
    const LocalLandmark::Look& look = map[i].looks[distances.look(i, best)];
    match.zoom = std::pow(f.ratio, feature.level - look.level) * map[i].p_k.norm() / look.distance_m;
    match.distance = distances.distance(i, best), match.landmark = i, match.feature = best;
    const double ratio = match.distance / (second + 5.0);
    match.confidence = 1 / (1 + std::exp((ratio - p.even_ratio) / p.ratio_width));
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Correspondence& a, const Correspondence& b) { return a.confidence > b.confidence; });
  return matches;
}

std::pair<int, int> cell_of(const Vector3d& ray, double side) {
  return {static_cast<int>(std::floor(std::atan2(ray.x(), ray.z()) / side)),
          static_cast<int>(std::floor(std::asin(std::clamp(ray.y(), -1.0, 1.0)) / side))};
}

class Verifier {
 public:
  Verifier(const QueryView& query, const LocalMap& map, const Gravity& gravity, const PoseParameters& pose,
           const VerificationParameters& p, const FeatureParameters& f)
      : query_(query), map_(map), gravity_(gravity), pose_(pose), p_(p), f_(f) {}

  std::optional<Verified> run() {
    Verified out;
    const auto tentative = tentative_matches(query_, map_, p_, f_);
    out.evidence.tentative = static_cast<int>(tentative.size());
    const auto found = ransac_pose(tentative, gravity_, pose_);
    if (!found) return std::nullopt;
    std::vector<Correspondence> agreeing;
    for (const size_t i : found->inliers) agreeing.push_back(tentative[i]);
    auto refined = refine_pose(agreeing, gravity_, found->T_c_k, pose_);
    if (!refined) return std::nullopt;
    out.evidence.inliers = static_cast<int>(agreeing.size());
    out.evidence.log_chance = chance(tentative, found->inliers, refined->T_c_k, out.evidence);
    for (int round = 0; round < 2; ++round) {
      out.matches = guided_matches(refined->T_c_k, p_.guided_rad, out.evidence);
      if (out.matches.size() < 3) return std::nullopt;
      refined = refine_pose(out.matches, gravity_, refined->T_c_k, pose_);
      if (!refined) return std::nullopt;
    }
    std::erase_if(out.matches, [&](const Correspondence& match) {
      return residual_of(match, refined->T_c_k, pose_.lens_rad, 0).squared > pose_.gate;
    });
    refined = refine_pose(out.matches, gravity_, refined->T_c_k, pose_);
    if (!refined) return std::nullopt;
    out.T_c_k = refined->T_c_k, out.information = refined->information;
    count_matches(out);
    return out;
  }

 private:
  /// Logarithm of the expected number of poses that random places of the matches support as well: Chernoff's bound for
  /// the sum of the inliers' weights, which are their likelihood ratios. Of each cell the best inlier counts: others
  /// show the same thing.
  double chance(const std::vector<Correspondence>& all, const std::vector<size_t>& inliers, const Rigid& T,
                Evidence& evidence) const {
    struct Match {
      double alpha, weight;
    };
    struct Cell {
      std::vector<Match> matches;
      double found = 0;  // weight of the best inlier
    };
    std::map<std::pair<int, int>, Cell> cells;
    for (size_t i = 0; i < all.size(); ++i) {
      const double area = pose_.gate * residual_of(all[i], T, pose_.lens_rad, 0).area_sr;
      const double alpha = std::clamp(area / query_.area_sr, 1e-6, 0.5);
      const double weight = std::log1p(all[i].confidence * (1 / alpha - 1));
      Cell& cell = cells[cell_of(all[i].ray_c, p_.cell_rad)];
      cell.matches.push_back({alpha, weight});
      if (std::binary_search(inliers.begin(), inliers.end(), i)) cell.found = std::max(cell.found, weight);
    }
    std::vector<double> found;
    for (const auto& [at, cell] : cells)
      if (cell.found > 0) found.push_back(cell.found);
    evidence.inlier_cells = static_cast<int>(found.size());
    std::sort(found.begin(), found.end());
    double sum = 0;  // three determine the pose: the strongest do not count
    for (size_t i = 0; i + 3 < found.size(); ++i) sum += found[i];
    double best = 0;
    for (double t = 0.1; t < 1.6; t += 0.1) {
      double bound = -t * sum;
      for (const auto& [at, cell] : cells) {
        double more = 0;  // expectation of exp(t max) less 1 is at most the sum over the matches
        for (const Match& match : cell.matches) more += match.alpha * std::expm1(t * match.weight);
        bound += std::log1p(more);
      }
      best = std::min(best, bound);
    }
    return std::min(0.0, 3 * std::log(std::max(1.0, static_cast<double>(cells.size()))) + best);
  }

  void count_matches(Verified& out) const {
    std::map<std::pair<int, int>, int> visible, matched;
    for (const LocalLandmark& landmark : map_)
      if (is_visible(landmark, out.T_c_k)) ++visible[cell_of((out.T_c_k * landmark.p_k).normalized(), p_.cell_rad)];
    for (const Correspondence& match : out.matches) ++matched[cell_of(match.ray_c, p_.cell_rad)];
    out.evidence.matched = static_cast<int>(out.matches.size());
    out.evidence.cells = static_cast<int>(matched.size());
    int full = 0, covered = 0;
    for (const auto& [cell, count] : visible)
      if (count >= 3) ++full, covered += matched.contains(cell);
    out.evidence.covered = covered / std::max(1.0, static_cast<double>(full));
    set_plane(out);
  }

  /// A picture on a wall, a front or a door may have copies.
  void set_plane(Verified& out) const {
    const std::vector<Correspondence>& matches = out.matches;
    const auto is_off = [&](const Correspondence& match, const Vector3d& normal, const Vector3d& through) {
      const double along = std::abs(normal.dot(match.p_k.normalized()));
      const double tolerance = 3 * std::hypot(along * match.along_sigma, match.across_sigma);
      return std::abs(normal.dot(match.p_k - through)) > tolerance + p_.plane_part * match.p_k.norm();
    };
    size_t least = matches.size(), state = 1;
    std::vector<char> off(matches.size(), 1), best = off;
    const auto draw = [&] { return (state = state * 6364136223846793005u + 1442695040888963407u) >> 33; };
    for (int trial = 0; trial < 200 && matches.size() > 3; ++trial) {
      const Vector3d a = matches[draw() % matches.size()].p_k;
      const Vector3d b = matches[draw() % matches.size()].p_k - a, c = matches[draw() % matches.size()].p_k - a;
      const Vector3d across = b.cross(c);
      if (across.norm() < 0.05 * b.norm() * c.norm() || across.isZero()) continue;
      size_t count = 0;
      for (size_t i = 0; i < matches.size(); ++i)
        off[i] = is_off(matches[i], across.normalized(), a) ? 1 : 0, count += static_cast<size_t>(off[i]);
      if (count < least) least = count, best = off, out.normal_k = across.normalized();
    }
    std::set<std::pair<int, int>> cells;
    for (size_t i = 0; i < matches.size(); ++i)
      if (best[i]) cells.insert(cell_of(matches[i].ray_c, p_.cell_rad));
    out.evidence.off_plane = static_cast<int>(cells.size());
  }

  bool is_visible(const LocalLandmark& landmark, const Rigid& T) const {
    const Vector3d x = T * landmark.p_k;
    const double distance = x.norm(), zoom = landmark.seen_from_m / distance;
    if (!query_.shows(x) || zoom > p_.max_zoom || zoom < 1 / p_.max_zoom) return false;
    const Vector3d seen_along = T.q * landmark.seen_along_k;
    return x.dot(seen_along) > std::cos(p_.max_view_angle_rad) * distance;
  }

  std::vector<Correspondence> guided_matches(const Rigid& T, double sigma_rad, Evidence& evidence) const {
    std::vector<Correspondence> matches;
    evidence.visible = 0;
    std::vector<int> taken(query_.features.size(), -1);
    for (size_t i = 0; i < map_.size(); ++i) {
      const LocalLandmark& landmark = map_[i];
      const Vector3d x = T * landmark.p_k;
      const double distance = x.norm();
      if (!is_visible(landmark, T)) continue;
      ++evidence.visible;
      Correspondence match;
      match.p_k = landmark.p_k, match.across_sigma = landmark.across_sigma, match.along_sigma = landmark.along_sigma;
      match.landmark = i, match.id = landmark.id, match.distance = p_.max_distance + 1;
      for (size_t k = 0; k < query_.features.size(); ++k) {
        const Feature& feature = query_.features[k];
        if (feature.ray_c.dot(x) < std::cos(0.06) * distance) continue;
        Correspondence other = match;
        other.ray_c = feature.ray_c, other.sigma_rad = 0.5 * feature.sigma_rad, other.feature = k;
        if (residual_of(other, T, pose_.lens_rad, sigma_rad).squared > pose_.gate) continue;
        for (const LocalLandmark::Look& look : landmark.looks) {
          const double off = std::pow(f_.ratio, feature.level - look.level) * distance / look.distance_m;
          if (off > pose_.max_zoom_error || off < 1 / pose_.max_zoom_error) continue;
          other.distance = hamming_within(look.descriptor, feature.descriptor, p_.max_distance);
          if (other.distance < match.distance) match = other;
        }
      }
      if (match.distance > p_.max_distance) continue;
      if (int& owner = taken[match.feature]; owner < 0) {
        owner = static_cast<int>(matches.size());
        matches.push_back(match);
      } else if (match.distance < matches[static_cast<size_t>(owner)].distance) {
        matches[static_cast<size_t>(owner)] = match;
      }
    }
    return matches;
  }

  const QueryView& query_;
  const LocalMap& map_;
  const Gravity& gravity_;
  const PoseParameters& pose_;
  const VerificationParameters& p_;
  const FeatureParameters& f_;
};

}  // namespace

std::optional<Verified> verify(const QueryView& query, const LocalMap& map, const Gravity& gravity,
                               const PoseParameters& pose, const VerificationParameters& parameters,
                               const FeatureParameters& features) {
  return Verifier(query, map, gravity, pose, parameters, features).run();
}

}  // namespace odograph::place_map
