// SPDX-License-Identifier: Apache-2.0
//
// vo/odograph with inertia over whole recordings: the metre from the middle of a flight, a walk that starts from
// standing, a lens that is told again.
#include <doctest/doctest.h>

#include "sdk/cli/runner.hpp"
#include "sdk/evaluation/evaluation.hpp"
#include "sdk/sim/simulate.hpp"
#include "tests/support.hpp"

using namespace odograph;

namespace {

struct Chain {
  Trajectory track;  ///< metric motions, one after the other
  double first_metric_s = -1;
  size_t motions = 0, groups = 0, refined = 0;
};

RunResult run(const Recording& recording) {
  RunOptions options;
  options.config = source("samples/configs/inertial_odograph.yaml").string();
  options.plugin_path = plugin_folder().string();
  const auto result = replay(recording, options);
  REQUIRE(result);
  return *result;
}

Chain chain_of(const RunResult& result) {
  Chain chain;
  StampedPose pose{0, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
  uint32_t group = UINT32_MAX;
  REQUIRE_FALSE(result.motions.empty());
  const int64_t start_ns = result.motions.front().t_from_ns;
  for (const odo_vo_motion& m : result.motions) {
    ++chain.motions;
    if (!(m.header.flags & ODO_VO_METRIC)) continue;
    chain.groups += m.scale_group != group;
    group = m.scale_group;
    if (chain.first_metric_s < 0) chain.first_metric_s = static_cast<double>(m.header.t_ns - start_ns) * 1e-9;
    pose.p += pose.q * Eigen::Vector3d(m.p_c0_c1);
    pose.q = (pose.q * Eigen::Quaterniond(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3])).normalized();
    pose.t_ns = m.header.t_ns;
    chain.track.push_back(pose);
  }
  return chain;
}

struct Errors {
  double se3_m, scale;
};

Errors errors_of(const Recording& recording, const Chain& chain) {
  const Pairs pairs = associate(recording.truth, chain.track, 0.02);
  REQUIRE(pairs.reference.size() > 50);
  double scale = 1, one = 1;
  align(pairs, Alignment::sim3, &scale);
  const Trajectory aligned = align(pairs, Alignment::se3, &one);
  return {statistics_of(absolute_errors(pairs.reference, aligned).translation_m).rmse, 1 / scale};
}

}  // namespace

TEST_SUITE_BEGIN("vio_recordings");

TEST_CASE("the metre is found in mid-flight and kept (EuRoC MH_05)") {
  const auto path = data_or_skip("euroc_mh05");
  if (path.empty()) return;
  const auto recording = read_recording(path);
  REQUIRE(recording);
  const Chain chain = chain_of(run(*recording));
  CHECK(chain.first_metric_s < 2.0);
  CHECK(chain.groups == 1);
  CHECK(static_cast<double>(chain.track.size()) > 0.93 * static_cast<double>(chain.motions));
  const Errors e = errors_of(*recording, chain);
  MESSAGE("SE(3) " << e.se3_m << " m, scale " << e.scale);
  CHECK(e.se3_m < 0.13);                 // measured: 0.100 m
  CHECK(std::abs(e.scale - 1) < 0.018);  // measured: 1.4 %
}

TEST_CASE("a walk from standing is metric from its first step, through a lens that is told again with every frame") {
  const TemporaryFolder folder;
  const auto scenario = read_scenario(source("samples/scenarios/walk_short.yaml").string());
  REQUIRE(scenario);
  Scenario shorter = *scenario;
  shorter.walk_m = 8;
  REQUIRE(simulate(shorter, 5, folder / "walk.odo", {}));
  auto recording = read_recording(folder / "walk.odo");
  REQUIRE(recording);
  odo_calibration camera{};
  for (const RecordedMessage& m : recording->messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION) camera = as<odo_calibration>(m.message.header());
  std::vector<int64_t> times;
  for (const RecordedMessage& m : recording->messages)
    if (m.message.header().type == ODO_TYPE_FRAME) times.push_back(m.message.header().t_ns);
  for (const int64_t t_ns : times) {
    camera.header.t_ns = t_ns - 1;
    recording->add(camera.header);
  }
  recording->sort();
  const Chain chain = chain_of(run(*recording));
  CHECK(chain.first_metric_s < 1.5);
  CHECK(chain.groups == 1);
  const Errors e = errors_of(*recording, chain);
  MESSAGE("SE(3) " << e.se3_m << " m, scale " << e.scale);
  CHECK(e.se3_m < 0.15);
  CHECK(std::abs(e.scale - 1) < 0.05);
}

TEST_SUITE_END();
