// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/verification.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace odograph::place_map {
namespace {

using Eigen::Vector3d;

struct Best {
  int distance = 257;
  size_t other = 0;
  size_t look = 0;
};

/// Matches that are best in both directions, the nearest descriptors first.
std::vector<Correspondence> tentative_matches(const QueryView& query, const LocalMap& map,
                                              const PoseParameters& pose, const VerificationParameters& p,
                                              const FeatureParameters& f) {
  (void)pose;
  std::vector<Best> of_feature(query.features.size()), of_landmark(map.size());
  for (size_t i = 0; i < map.size(); ++i)
    for (size_t look = 0; look < map[i].looks.size(); ++look)
      for (size_t k = 0; k < query.features.size(); ++k) {
        const int distance = hamming(map[i].looks[look].descriptor, query.features[k].descriptor);
        if (distance < of_feature[k].distance) of_feature[k] = {distance, i, look};
        if (distance < of_landmark[i].distance) of_landmark[i] = {distance, k, look};
      }
  std::vector<Correspondence> matches;
  for (size_t i = 0; i < map.size(); ++i) {
    const Best& best = of_landmark[i];
    if (best.distance > p.max_distance || of_feature[best.other].other != i) continue;
    const Feature& feature = query.features[best.other];
    Correspondence& match = matches.emplace_back();
    match.p_k = map[i].p_k, match.across_sigma = map[i].across_sigma, match.along_sigma = map[i].along_sigma;
    match.ray_c = feature.ray_c, match.sigma_rad = 0.5 * feature.sigma_rad;
    const LocalLandmark::Look& look = map[i].looks[best.look];
    match.zoom = std::pow(f.ratio, feature.level - look.level) * map[i].p_k.norm() / look.distance_m;
    match.distance = best.distance, match.landmark = i, match.feature = best.other;
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Correspondence& a, const Correspondence& b) { return a.distance < b.distance; });
  return matches;
}

/// log of the probability that at least k of n succeed, each by chance alpha; a bound (Chernoff).
double log_binomial_tail(int n, int k, double alpha) {
  if (k <= n * alpha) return 0;
  const double q = static_cast<double>(k) / n;
  double sum = q * std::log(q / alpha);
  if (q < 1) sum += (1 - q) * std::log((1 - q) / (1 - alpha));
  return -n * sum;
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
    const auto tentative = tentative_matches(query_, map_, pose_, p_, f_);
    out.evidence.tentative = static_cast<int>(tentative.size());
    const auto found = ransac_pose(tentative, gravity_, pose_);
    if (!found) return std::nullopt;
    std::vector<Correspondence> agreeing;
    for (const size_t i : found->inliers) agreeing.push_back(tentative[i]);
    auto refined = refine_pose(agreeing, gravity_, found->T_c_k, pose_);
    if (!refined) return std::nullopt;
    out.evidence.inliers = static_cast<int>(agreeing.size());
    out.evidence.log_chance = chance(tentative, agreeing, refined->T_c_k);
    for (int round = 0; round < 2; ++round) {
      out.matches = guided_matches(refined->T_c_k, out.evidence);
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
    std::set<std::pair<int, int>> cells;
    for (const Correspondence& match : out.matches) cells.insert(cell_of(match.ray_c, p_.cell_rad));
    out.evidence.matched = static_cast<int>(out.matches.size());
    out.evidence.cells = static_cast<int>(cells.size());
    return out;
  }

 private:
  /// Logarithm of the expected number of poses that as many of random matches support.
  double chance(const std::vector<Correspondence>& all, const std::vector<Correspondence>& agreeing,
                const Rigid& T) const {
    double alpha = 0;
    for (const Correspondence& match : all) {
      const double area = pose_.gate * residual_of(match, T, pose_.lens_rad, 0).area_sr;
      alpha += std::min(1.0, area / query_.area_sr) / static_cast<double>(all.size());
    }
    const int n = static_cast<int>(all.size()), k = static_cast<int>(agreeing.size());
    if (k <= 3) return 0;
    // Three matches determine the pose; any three may have.
    return 3 * std::log(static_cast<double>(n)) + log_binomial_tail(n - 3, k - 3, alpha);
  }

  bool is_in_picture(const Vector3d& x) const {
    if (x.z() < std::cos(f_.max_off_axis_rad) * x.norm()) return false;
    const Eigen::Vector2d pixel = query_.picture.lens.project(x.head<2>() / x.z());
    const double margin = 15 * query_.picture.lens.focal() / f_.finest_focal_px;
    return pixel.x() > margin && pixel.y() > margin && pixel.x() < query_.picture.grey.cols - margin &&
           pixel.y() < query_.picture.grey.rows - margin;
  }

  std::vector<Correspondence> guided_matches(const Rigid& T, Evidence& evidence) const {
    std::vector<Correspondence> matches;
    std::set<std::pair<int, int>> cells;
    evidence.visible = 0;
    const Vector3d eye_k = T.inverse().p;
    std::vector<int> taken(query_.features.size(), -1);
    for (size_t i = 0; i < map_.size(); ++i) {
      const LocalLandmark& landmark = map_[i];
      const Vector3d x = T * landmark.p_k;
      const double distance = x.norm(), zoom = landmark.seen_from_m / distance;
      if (!is_in_picture(x) || zoom > p_.max_zoom || zoom < 1 / p_.max_zoom) continue;
      if ((landmark.p_k - eye_k).dot(landmark.seen_along_k) < std::cos(p_.max_turn_rad) * distance) continue;
      ++evidence.visible;
      cells.insert(cell_of(x / distance, p_.cell_rad));
      Correspondence match;
      match.p_k = landmark.p_k, match.across_sigma = landmark.across_sigma, match.along_sigma = landmark.along_sigma;
      match.landmark = i, match.distance = p_.max_distance + 1;
      for (size_t k = 0; k < query_.features.size(); ++k) {
        const Feature& feature = query_.features[k];
        if (feature.ray_c.dot(x) < std::cos(4 * p_.guided_rad) * distance) continue;
        Correspondence other = match;
        other.ray_c = feature.ray_c, other.sigma_rad = 0.5 * feature.sigma_rad, other.feature = k;
        if (residual_of(other, T, pose_.lens_rad, 0.33 * p_.guided_rad).squared > pose_.gate) continue;
        for (const LocalLandmark::Look& look : landmark.looks) {
          const double off = std::pow(f_.ratio, feature.level - look.level) * distance / look.distance_m;
          if (off > pose_.max_zoom_error || off < 1 / pose_.max_zoom_error) continue;
          other.distance = hamming(look.descriptor, feature.descriptor);
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
    evidence.visible_cells = static_cast<int>(cells.size());
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
