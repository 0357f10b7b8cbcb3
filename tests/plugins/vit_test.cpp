// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/vit/vit_system.hpp"
#include "tests/support/runs.hpp"

TEST_SUITE_BEGIN("vit");

namespace {

std::filesystem::path config_for(const TemporaryFolder& folder, const std::string& library,
                                 const std::string& parameters = "") {
  const auto file = folder / "vit.yaml";
  std::ofstream(file) << "odograph: 1\nvo_frontend:\n  plugin: vo/vit\n  parameters:\n    library: " << library << "\n"
                      << parameters << "coupling:\n  type: paper\n  vertical: scaled\n  fastest: 10 m/s\n";
  return file;
}

Recording a_walk(const TemporaryFolder& folder) {
  Scenario scenario;
  scenario.camera.width = 160, scenario.camera.height = 120, scenario.camera.focal_px = 120;
  scenario.walker.stand_s = 1;
  scenario.route = {{0, 0, 0}, {3, 0, 0}};
  return recorded(scenario, 1, folder / "walk.odo");
}

}  // namespace

TEST_CASE("a VIT system is a front-end: its metric poses arrive, converted from the IMU to the camera") {
  const TemporaryFolder folder;
  const Recording recording = a_walk(folder);
  RunOptions options{.config = config_for(folder, ODOGRAPH_TEST_VIT, "    wait: 5 s\n").string()};
  const auto result = required(replay(recording, options));
  size_t frames = 0;
  for (const auto& m : recording.messages) frames += m.message.header().type == ODO_TYPE_FRAME;
  REQUIRE(result->motions.size() == frames - 1);
  for (const odo_vo_motion& m : result->motions) {
    CHECK((m.header.flags & ODO_VO_METRIC) != 0);
    // A tenth of a metre along the body's x, which is the camera's x, plus the effect of the lever arm in a rotation.
    CHECK(std::abs(Eigen::Vector3d(m.p_c0_c1).norm() - 0.1) < 0.02);
  }
  CHECK(result->final_state == ODO_TRACKING);
  // The composed rotations are the gyroscope's, hence nearly the true ones.
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (const odo_vo_motion& m : result->motions)
    q = q * Eigen::Quaterniond(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3]);
  const auto& truth = recording.truth;
  CHECK(q.angularDistance(truth.front().q.conjugate() * truth.back().q) < 0.1);
}

TEST_CASE("a silent VIT system is lost, and one that cannot be loaded is a config error with its name") {
  const TemporaryFolder folder;
  const Recording recording = a_walk(folder);
  std::ofstream(folder / "quiet.txt") << "silent\n";
  RunOptions options{.config =
                         config_for(folder, ODOGRAPH_TEST_VIT, "    wait: 0 s\n    config: quiet.txt\n").string()};
  const auto silent = required(replay(recording, options));
  CHECK(silent->final_state == ODO_LOST);
  CHECK_FALSE(silent->motions.empty());
  const auto failure = [&](const std::string& library) {
    options.config = config_for(folder, library).string();
    const auto result = replay(recording, options);
    return result ? std::string() : result.failure().text;
  };
  CHECK(contains(failure("libnothing-such.so"), "libnothing-such.so"));
  CHECK_THROWS_WITH_AS(vit::System("libm.so.6", ""),
                       "libm.so.6: not a VIT system: missing function vit_api_get_version", std::runtime_error);
}
