// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/evaluation/start_windows.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("start_windows");

namespace {

constexpr int64_t kFrame_ns = 50'000'000;

/// 8 s of a camera on an arc; its odometry is metric from `metric_from` on, too large by `scale` with sigma `sigma`.
struct Flight {
  StampedPoses truth;
  std::vector<odo_vo_motion> motions;

  Flight(double scale, double sigma, size_t metric_from, size_t new_group_at = SIZE_MAX) {
    for (int64_t k = 0; k <= 160; ++k) {
      const double a = 0.02 * static_cast<double>(k);
      truth.push_back({k * kFrame_ns, Quaterniond::Identity(), Vector3d(2 * std::sin(a), 2 * std::cos(a), 0)});
    }
    for (size_t k = 1; k < truth.size(); ++k) {
      auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, truth[k].t_ns);
      m.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION;
      if (k >= metric_from) m.header.flags |= ODO_VO_METRIC | ODO_VO_INERTIAL;
      m.t_from_ns = truth[k - 1].t_ns, m.state = ODO_TRACKING, m.scale_sigma = sigma;
      m.scale_group = k >= new_group_at ? 2 : k >= metric_from;
      m.q_c0_c1[0] = 1;
      Vector3d::Map(m.p_c0_c1) = scale * (truth[k].p - truth[k - 1].p);
      motions.push_back(m);
    }
  }
};

}  // namespace

TEST_CASE("a scale that is off by ten stated sigmas counts as wrong and certain, one within does not") {
  const Flight wrong(1.1, 0.01, 20), right(1.1, 0.05, 20);
  const StartWindow w = start_window(wrong.truth, wrong.motions, 0);
  CHECK(w.start_s == doctest::Approx(1.0));
  CHECK(w.groups == 1);
  CHECK(w.log_scale == doctest::Approx(std::log(1.1)).epsilon(1e-6));
  CHECK(w.worst_sigmas == doctest::Approx(std::log(1.1) / 0.01).epsilon(1e-6));
  CHECK(w.scales.size() == 4);  // after 1, 2, 4 s and at the end
  CHECK(w.sim3_rmse_m < 1e-9);
  CHECK(w.se3_rmse_m > 0.05);
  CHECK(start_window(right.truth, right.motions, 0).worst_sigmas < 3);
}

TEST_CASE("every scale group is evaluated, not only the longest") {
  Flight flight(1, 0.01, 1, 60);
  for (size_t k = 0; k < 58; ++k) Vector3d::Map(flight.motions[k].p_c0_c1) *= 1.3;
  const StartWindow w = start_window(flight.truth, flight.motions, 0);
  CHECK(w.groups == 2);
  CHECK(std::abs(w.log_scale) < 0.02);
  CHECK(w.worst_sigmas > 20);
}

TEST_CASE("an odometry that is never metric has no scale, and neither has a standing one") {
  const Flight never(1, 0.01, 1000);
  const StartWindow w = start_window(never.truth, never.motions, 0);
  CHECK(std::isnan(w.start_s));
  CHECK(w.scales.empty());
  CHECK(std::isnan(w.worst_sigmas));
  Flight stands(1, 0.01, 1);
  for (StampedPose& x : stands.truth) x.p *= 0.01;
  CHECK(start_window(stands.truth, stands.motions, 0).scales.empty());
}
