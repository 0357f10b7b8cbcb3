// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/merge.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::place_map {
namespace {

using Eigen::Vector3d;

/// A key frame of one map that is recognised in the other.
struct Vote {
  Vector3d p_m, p_o;
  double yaw;  ///< of the other map in the map
  bool is_sure, is_of_other;
};

Rigid upright(double yaw, const Vector3d& p_m, const Vector3d& p_o) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  return {q, p_m - q * p_o};
}
double yaw_of(const Eigen::Quaterniond& q) { return 2 * std::atan2(q.z(), q.w()); }

size_t step_of(const PlaceMap& map, const PlacingParameters& p) {
  return 1 + map.key_frames().size() / (p.max_asked + 1);
}

/// Those of the other map's key frames.
std::vector<Vote> votes_of(const PlaceMap& other, const PlaceMap& map, const PlacingParameters& p) {
  std::vector<Vote> votes;
  for (size_t i = 0; i < other.key_frames().size(); i += step_of(other, p)) {
    const KeyFrame& frame = other.key_frames()[i];
    const QueryView view = view_of(frame, map.parameters().features);
    const auto found = map.best_of(view, map.candidates(view));
    if (!found || !map.is_plausible(*found)) continue;
    const Rigid T_m_k = map.find(found->key_frame)->T_m_k * found->T_k_c;
    const double yaw = yaw_of(T_m_k.q * frame.T_m_k.q.conjugate());
    votes.push_back({T_m_k.p, frame.T_m_k.p, yaw, map.is_accepted(*found), true});
  }
  return votes;
}

/// Those that agree with a place of the other map, which is known best at `around`.
std::vector<Vote> agreeing(const std::vector<Vote>& votes, const Rigid& T_m_o, const Vector3d& around,
                           const PlacingParameters& p) {
  std::vector<Vote> out;
  for (const Vote& vote : votes)
    if (std::abs(std::remainder(vote.yaw - yaw_of(T_m_o.q), 2 * M_PI)) < p.agree_rad &&
        (T_m_o * vote.p_o - vote.p_m).norm() < p.agree_m + p.agree_part * (vote.p_o - around).norm())
      out.push_back(vote);
  return out;
}

Vector3d middle(const std::vector<Vote>& votes) {
  Vector3d sum = Vector3d::Zero();
  for (const Vote& vote : votes) sum += vote.p_o / static_cast<double>(votes.size());
  return sum;
}

/// Least squares of places and headings, with the weights of a Cauchy distribution.
Rigid fit(const std::vector<Vote>& votes, Rigid T) {
  constexpr double kSigma_m = 0.1, kSigma_rad = 0.02;
  for (int round = 0; round < 10; ++round) {
    std::vector<double> weights;
    double sum = 0, sine = 0, cosine = 0;
    Vector3d m = Vector3d::Zero(), o = m;
    for (const Vote& vote : votes) {
      weights.push_back(1 / (1 + (T * vote.p_o - vote.p_m).squaredNorm() / (kSigma_m * kSigma_m)));
      sum += weights.back(), m += weights.back() * vote.p_m, o += weights.back() * vote.p_o;
    }
    m /= sum, o /= sum;
    for (size_t i = 0; i < votes.size(); ++i) {
      const Eigen::Vector2d to = (votes[i].p_m - m).head<2>() / kSigma_m,
                            from = (votes[i].p_o - o).head<2>() / kSigma_m;
      sine += weights[i] * (from.x() * to.y() - from.y() * to.x() + std::sin(votes[i].yaw) / (kSigma_rad * kSigma_rad));
      cosine += weights[i] * (from.dot(to) + std::cos(votes[i].yaw) / (kSigma_rad * kSigma_rad));
    }
    T = upright(std::atan2(sine, cosine), m, o);
  }
  return T;
}

/// Key frames of the other map that are beside one of the map.
size_t count_beside(const PlaceMap& other, const PlaceMap& map, const Rigid& T_m_o, const PlacingParameters& p) {
  size_t count = 0;
  for (size_t i = 0; i < other.key_frames().size(); i += step_of(other, p)) {
    const Rigid T = T_m_o * other.key_frames()[i].T_m_k;
    count += std::any_of(map.key_frames().begin(), map.key_frames().end(), [&](const KeyFrame& frame) {
      return (frame.T_m_k.p - T.p).norm() < p.beside_m && frame.T_m_k.q.angularDistance(T.q) < p.beside_rad;
    });
  }
  return count;
}

/// Key frames that agree on the best place among those that do not agree with `T_m_o`.
size_t count_runner_up(const std::vector<Vote>& votes, const Rigid& T_m_o, const Vector3d& around,
                       const PlacingParameters& p) {
  std::vector<Vote> others;
  for (const Vote& vote : votes)
    if (agreeing({vote}, T_m_o, around, p).empty()) others.push_back(vote);
  size_t most = 0;
  for (const Vote& vote : others)
    most = std::max(most, agreeing(others, upright(vote.yaw, vote.p_m, vote.p_o), vote.p_o, p).size());
  return most;
}

}  // namespace

void JoinedFrames::add(const PlaceMap& map, const Rigid& T_j_m) {
  const auto before = static_cast<ptrdiff_t>(frames_.size());
  for (KeyFrame frame : map.key_frames()) {
    frame.id = frames_.size() + 1, frame.epoch += epochs_, frame.T_m_k = T_j_m * frame.T_m_k;
    const auto is_beside = [&](const KeyFrame& other) {
      return (other.T_m_k.p - frame.T_m_k.p).norm() < kKnown_m &&
             other.T_m_k.q.angularDistance(frame.T_m_k.q) < kKnown_rad;
    };
    if (std::none_of(frames_.begin(), frames_.begin() + before, is_beside)) frames_.push_back(std::move(frame));
  }
  epochs_ += map.next_epoch();
}

Placed place_of(const PlaceMap& other, const PlaceMap& map, const PlacingParameters& p) {
  Placed out;
  std::vector<Vote> votes = votes_of(other, map, p);
  for (const Vote& vote : votes_of(map, other, p))
    votes.push_back({vote.p_o, vote.p_m, -vote.yaw, vote.is_sure, false});
  for (const PlaceMap* asked : {&other, &map})
    out.asked += (asked->key_frames().size() + step_of(*asked, p) - 1) / step_of(*asked, p);
  out.recognised = votes.size();
  std::vector<Vote> best;
  for (const Vote& vote : votes) {
    const Rigid T = upright(vote.yaw, vote.p_m, vote.p_o);
    auto group = agreeing(votes, T, vote.p_o, p);
    if (group.size() > best.size()) best = std::move(group), out.T_m_o = T;
  }
  if (best.empty()) return out;
  out.T_m_o = fit(best, out.T_m_o);
  best = agreeing(votes, out.T_m_o, middle(best), p);
  if (best.empty()) return out;
  out.agreeing = best.size();
  out.runner_up = count_runner_up(votes, out.T_m_o, middle(best), p);
  out.beside = count_beside(other, map, out.T_m_o, p) + count_beside(map, other, out.T_m_o.inverse(), p);
  double squared = 0;
  for (const Vote& vote : best) squared += (out.T_m_o * vote.p_o - vote.p_m).squaredNorm();
  const auto count = static_cast<double>(best.size());
  out.sigma_m = std::sqrt(squared / (3 * count));
  const auto of_other =
      static_cast<size_t>(std::count_if(best.begin(), best.end(), [](const Vote& vote) { return vote.is_of_other; }));
  out.is_found = std::max(of_other, best.size() - of_other) >= p.fewest &&
                 static_cast<double>(out.runner_up) < p.max_runner_up * count &&
                 count > p.min_share * static_cast<double>(out.beside) &&
                 std::any_of(best.begin(), best.end(), [](const Vote& vote) { return vote.is_sure; });
  return out;
}

}  // namespace odograph::place_map
