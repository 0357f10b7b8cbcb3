// SPDX-License-Identifier: Apache-2.0
//
// A fixer and a front-end that say whatever comes to their mind: nothing impossible is accepted, and every pose is one.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/session_app.hpp"
#include "tests/test_plugins.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("liar");

namespace {

bool whole(const odo_pose& pose) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(pose.q_n, pose.q_n + 4, finite) && std::all_of(pose.p_n, pose.p_n + 3, finite) &&
         std::all_of(pose.velocity_n, pose.velocity_n + 3, finite) &&
         std::all_of(pose.covariance, pose.covariance + 36, finite) && finite(pose.distance_m);
}

struct Lies {
  size_t poses = 0, broken = 0, accepted = 0, outside = 0, restarts = 0;
};

/// So many samples with 20 lies each.
Lies lied(const std::string& yaml, int samples) {
  const TestPlugins plugins{"liar"};
  App app(yaml, ODO_RUN_REPLAY, plugins.path());
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  const auto c = calibration(64, 48);
  odo_session_push(app.session, &c.header);
  Lies lies;
  for (int from = 0; from < samples; from += 100) {
    app.walk(from, from + 100);
    odo_session_flush(app.session);
    for (const odo_pose& pose : app.all<odo_pose>(ODO_TYPE_POSE)) ++lies.poses, lies.broken += whole(pose) ? 0 : 1;
    odo_pose now{}, smooth{};
    now.header.struct_size = smooth.header.struct_size = sizeof now;
    if (odo_session_get_pose(app.session, ODO_TIME_LATEST, &now) == ODO_OK) lies.broken += whole(now) ? 0 : 1;
    if (odo_session_get_smooth_pose(app.session, ODO_TIME_LATEST, &smooth) == ODO_OK)
      lies.broken += whole(smooth) ? 0 : 1;
    for (const odo_fix& fix : app.all<odo_fix>(ODO_TYPE_FIX)) {
      if ((fix.header.flags & ODO_FLAG_ACCEPTED) == 0) continue;
      ++lies.accepted;
      const uint32_t flags = fix.header.flags;
      bool possible = fix.header.t_ns <= 1'000'000'000 + (from + 100) * 10'000'000LL + 1'000'000'000;
      if (flags & ODO_FIX_GEODETIC)
        possible = possible && std::abs(fix.latitude_rad) <= 1.5708 && std::abs(fix.longitude_rad) <= 6.2832;
      for (int i = 0; i < 2; ++i)
        if (flags & (ODO_FIX_NORTH << i)) possible = possible && std::abs(fix.p_n[i]) <= 1e5;
      if (flags & ODO_FIX_YAW) possible = possible && fix.yaw_sigma_rad > 0 && std::abs(fix.yaw_rad) <= 1e9;
      if (flags & ODO_FIX_NORTH) possible = possible && fix.covariance_n[0] > 0 && fix.covariance_n[0] <= 1e15;
      lies.outside += possible ? 0 : 1;
    }
    app.events.clear();
  }
  for (const odo_report& report : app.reports) lies.restarts += std::string(report.key) == "broken_pose" ? 1 : 0;
  return lies;
}

}  // namespace

TEST_CASE(
    "of 100,000 random fixes and motions none makes a pose that is no number, and no impossible one is accepted") {
  const std::string walk =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n";
  const std::string fixer = "absolute_fixers: [{plugin: test/liar}]\n", paper = "coupling: {type: paper}\n";
  const std::string camera = "vo_frontend: {plugin: test/liar}\n";
  Lies all;
  for (const std::string& yaml : {walk + fixer, walk + fixer + paper, walk + camera, walk + camera + paper}) {
    CAPTURE(yaml);
    const Lies lies = lied(yaml, 1300);  // 4 x 26,000
    CHECK(lies.poses > 0);
    CHECK(lies.broken == 0);
    CHECK(lies.outside == 0);
    all.poses += lies.poses, all.accepted += lies.accepted, all.restarts += lies.restarts;
  }
  MESSAGE(all.poses << " poses, " << all.accepted << " fixes accepted, started anew " << all.restarts << " times");
  CHECK(all.accepted > 0);
}

TEST_SUITE_END();
