// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sdk/host/base/ring.hpp"
#include "sdk/host/estimator/error_state.hpp"

namespace odograph::inertial {

/// Where the body was between clones: each moment's pose against the clone before it, as the IMU had it. Corrections
/// move the clones, and what lies between goes with them.
class PoseTrack {
 public:
  void clear() { moments_.clear(), segment_ = 0; }
  /// A new clone begins a segment.
  void begin_segment() { ++segment_; }
  void add(int64_t t_ns, const Clone& clone, const State& x) {
    moments_.push({t_ns, segment_, x.q_n_b * clone.q_n_b.conjugate(), x.p_n - clone.p_n});
  }
  /// n itself is turned.
  void rotate(const Eigen::Quaterniond& q) {
    for (size_t i = 0; i < moments_.size(); ++i) {
      Moment& m = moments_.back(i);
      m.dq_n = q * m.dq_n * q.conjugate(), m.dp_n = (q * m.dp_n).eval();
    }
  }

  /// Nothing before the oldest clone; from now on the pose now.
  std::optional<PastPose> at(int64_t t_ns, int64_t now_ns, const ErrorState& e) const {
    if (t_ns >= now_ns) return PastPose{e.x.q_n_b, e.x.p_n, kTheta, kTheta, 1.0};
    size_t i = 0;
    while (i < e.clone_count() && e.clone_back(i).t_ns > t_ns) ++i;
    if (i == e.clone_count()) return std::nullopt;
    const Clone& before = e.clone_back(i);
    const bool open = i == 0;
    const int64_t end_ns = open ? now_ns : e.clone_back(i - 1).t_ns;
    const Eigen::Vector3d p_end = open ? e.x.p_n : e.clone_back(i - 1).p_n;
    const Eigen::Quaterniond q_end = open ? e.x.q_n_b : e.clone_back(i - 1).q_n_b;
    const double w = static_cast<double>(t_ns - before.t_ns) / static_cast<double>(end_ns - before.t_ns);
    const uint64_t segment = segment_ - i;
    Moment low{before.t_ns, segment, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
    Moment high{end_ns, segment, q_end * before.q_n_b.conjugate(), p_end - before.p_n};
    Moment last = high;  // where the segment ended when it was recorded
    bool any = false;
    for (size_t k = 0; k < moments_.size(); ++k) {
      const Moment& m = moments_.back(k);
      if (m.segment > segment) continue;
      if (m.segment < segment) break;
      if (!any) last = m, any = true;
      if (m.t_ns > t_ns) {
        high = m;
      } else {
        low = m;
        break;
      }
    }
    const double span = static_cast<double>(high.t_ns - low.t_ns);
    const double u = span > 0 ? static_cast<double>(t_ns - low.t_ns) / span : 0.0;
    const Eigen::Vector3d moved = (p_end - before.p_n) - last.dp_n;  // by corrections since
    const Eigen::Vector3d p = before.p_n + low.dp_n + u * (high.dp_n - low.dp_n) + w * moved;
    return PastPose{low.dq_n.slerp(u, high.dq_n) * before.q_n_b, p, e.column_back(i),
                    open ? kTheta : e.column_back(i - 1), w};
  }

 private:
  struct Moment {
    int64_t t_ns;
    uint64_t segment;
    Eigen::Quaterniond dq_n = Eigen::Quaterniond::Identity();
    Eigen::Vector3d dp_n = Eigen::Vector3d::Zero();
  };
  Ring<Moment, 2048> moments_;
  uint64_t segment_ = 0;
};

}  // namespace odograph::inertial
