// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "plugins/fix/map/place_map.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::place_map {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

std::vector<double> PlaceMap::votes(const std::vector<Feature>& features, const std::vector<char>& excluded) const {
  std::vector<double> votes(frames_.size(), 0.0);
  std::vector<int> nearest(frames_.size(), 257);  // of this feature
  std::vector<uint32_t> touched;
  for (const Feature& feature : features) {
    touched.clear();
    words_.look_up(feature.descriptor, [&](uint32_t number) {
      const Owner& owner = owners_[number];
      if (excluded[owner.frame]) return;
      const int distance = hamming_within(
          feature.descriptor, frames_[owner.frame].landmarks[owner.landmark].descriptors[owner.look], p_.vote_distance);
      if (distance > p_.vote_distance) return;
      int& best = nearest[owner.frame];
      if (best > 256) touched.push_back(owner.frame);
      best = std::min(best, distance);
    });
    // Inverse document frequency: a look that many key frames have tells little.
    const double rarity = std::log(1 + static_cast<double>(frames_.size()) / (1 + static_cast<double>(touched.size())));
    for (const uint32_t frame : touched) {
      votes[frame] += rarity * (1 - static_cast<double>(nearest[frame]) / (p_.vote_distance + 20));
      nearest[frame] = 257;
    }
  }
  return votes;
}

std::vector<size_t> PlaceMap::beside(size_t frame, const std::vector<char>& excluded) const {
  const KeyFrame& middle = frames_[frame];
  std::vector<std::pair<double, size_t>> near;
  for (size_t i = 0; i < frames_.size(); ++i) {
    if (i == frame || excluded[i] || frames_[i].epoch != middle.epoch) continue;
    const double distance = (frames_[i].T_m_k.p - middle.T_m_k.p).norm();
    const double turn = frames_[i].T_m_k.q.angularDistance(middle.T_m_k.q);
    if (distance < p_.neighbour_m && turn < p_.neighbour_rad)
      near.emplace_back(distance / p_.neighbour_m + turn / p_.neighbour_rad, i);
  }
  std::sort(near.begin(), near.end());
  std::vector<size_t> chosen;
  for (const auto& [far, i] : near) chosen.push_back(i);
  return chosen;
}

LocalMap PlaceMap::local_map(size_t frame, const std::vector<char>& excluded) const {
  LocalMap local;
  std::map<uint64_t, size_t> known;
  std::vector<size_t> sources = beside(frame, excluded);
  sources.resize(std::min(sources.size(), p_.neighbours));
  sources.insert(sources.begin(), frame);
  for (const size_t source : sources) {
    const KeyFrame& from = frames_[source];
    const Rigid T_k_s = source == frame ? Rigid() : frames_[frame].T_m_k.inverse() * from.T_m_k;
    for (const KeptLandmark& landmark : from.landmarks) {
      const Vector3d p_s = Eigen::Vector3f::Map(landmark.p_k.data()).cast<double>();
      const auto [at, is_new] = known.try_emplace(landmark.id, local.size());
      if (is_new)
        local.push_back({landmark.id,
                         T_k_s * p_s,
                         static_cast<double>(landmark.across_sigma),
                         static_cast<double>(landmark.along_sigma),
                         T_k_s.q * p_s.normalized(),
                         p_s.norm(),
                         {}});
      for (size_t look = 0; look < 2; ++look)
        if (landmark.levels[look] >= 0 && local[at->second].looks.size() < p_.max_looks)
          local[at->second].looks.push_back({landmark.descriptors[look], landmark.levels[look], p_s.norm()});
    }
  }
  return local;
}

std::vector<PlaceMap::Candidate> PlaceMap::candidates(const QueryView& query, const Excludes& excludes) const {
  std::vector<char> excluded(frames_.size(), 0);
  if (excludes)
    for (size_t i = 0; i < frames_.size(); ++i) excluded[i] = excludes(frames_[i]) ? 1 : 0;
  const std::vector<double> score = votes(query.features, excluded);
  std::vector<size_t> order;
  for (size_t i = 0; i < frames_.size(); ++i)
    if (!excluded[i] && score[i] > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return score[a] > score[b]; });
  std::vector<Candidate> found;
  std::vector<char> covered(frames_.size(), 0);
  for (const size_t frame : order) {
    if (found.size() >= p_.candidates) break;
    if (covered[frame]) continue;
    std::vector<size_t> near = beside(frame, excluded);
    for (size_t i = 0; i < std::min(near.size(), p_.neighbours); ++i) covered[near[i]] = 1;
    const Gravity gravity{frames_[frame].down_k, query.down_c,
                          std::hypot(frames_[frame].tilt_sigma_rad, query.tilt_sigma_rad)};
    found.push_back({frame, score[frame],
                     verify(query, local_map(frame, excluded), gravity, p_.pose, p_.verification, p_.features)});
  }
  const auto strength = [](const Candidate& c) { return c.verified ? -c.verified->evidence.log_chance : -1.0; };
  std::sort(found.begin(), found.end(), [&](const Candidate& a, const Candidate& b) {
    return std::pair(strength(a), a.votes) > std::pair(strength(b), b.votes);
  });
  return found;
}

double PlaceMap::log_odds(const Candidate& candidate) const {
  if (!candidate.verified) return 0;
  return std::max(0.0, -candidate.verified->evidence.log_chance - std::log(static_cast<double>(frames_.size())));
}

void PlaceMap::set_covariance(const Candidate& candidate, Recognition& recognition) const {
  const Verified& verified = *candidate.verified;
  const KeyFrame& frame = frames_[candidate.frame];
  // From T_c_k to T_k_c, both perturbed on the left.
  const Matrix3d R = verified.T_c_k.q.conjugate().toRotationMatrix();
  Matrix6d J;
  J << -R, Matrix3d::Zero(), -R * skew(verified.T_c_k.p), -R;
  // Matches of a cell have errors in common: they count as one.
  const Evidence& e = verified.evidence;
  const double alike = static_cast<double>(e.matched) / std::max(1, e.cells);
  recognition.covariance = alike * J * verified.information.ldlt().solve(J.transpose());
  double range = 0;
  for (const Correspondence& match : verified.matches)
    range += (verified.T_c_k * match.p_k).norm() / static_cast<double>(verified.matches.size());
  const auto variance = [](double sigma) { return sigma * sigma; };
  recognition.covariance.diagonal().head<3>().array() += variance(p_.rotation_floor_rad);
  recognition.covariance.diagonal().tail<3>().array() += variance(p_.position_floor_m);
  const Vector3d ahead = R.col(2), from = recognition.T_k_c.p;
  recognition.covariance.bottomRightCorner<3, 3>() += variance(p_.focal_sigma * range) * ahead * ahead.transpose() +
                                                      variance(frame.scale_sigma) * from * from.transpose();
}

std::optional<Recognition> PlaceMap::best_of(const QueryView& query, const std::vector<Candidate>& found) const {
  if (found.empty() || !found[0].verified) return std::nullopt;
  const Candidate& best = found[0];
  Recognition out;
  out.key_frame = frames_[best.frame].id, out.t_ns = query.t_ns;
  out.T_k_c = best.verified->T_c_k.inverse();
  out.inliers = best.verified->evidence.matched, out.cells = best.verified->evidence.inlier_cells;
  out.share = static_cast<double>(out.inliers) / std::max(1, best.verified->evidence.visible);
  out.covered = best.verified->evidence.covered;
  out.normal_k = best.verified->normal_k;
  out.off_plane = best.verified->evidence.off_plane;
  out.log_odds = log_odds(best);
  set_covariance(best, out);
  const Rigid T_m_c = frames_[best.frame].T_m_k * out.T_k_c;
  for (size_t i = 1; i < found.size(); ++i) {
    if (!found[i].verified) continue;
    const Rigid other = frames_[found[i].frame].T_m_k * found[i].verified->T_c_k.inverse();
    if ((other.p - T_m_c.p).norm() > p_.same_place_m || other.q.angularDistance(T_m_c.q) > p_.same_place_rad)
      out.runner_up = std::max(out.runner_up, log_odds(found[i]));
  }
  return out;
}

bool PlaceMap::is_plausible(const Recognition& recognition) const {
  return recognition.log_odds > p_.min_log_odds && recognition.share > p_.min_share &&
         recognition.cells >= p_.min_cells && recognition.runner_up < p_.max_runner_up * recognition.log_odds;
}

std::optional<Recognition> PlaceMap::recognise(const Picture& picture, const Excludes& excludes) const {
  const QueryView query = view_of(picture, p_.features);
  const auto best = best_of(query, candidates(query, excludes));
  return best && is_accepted(*best) ? best : std::nullopt;
}

}  // namespace odograph::place_map
