// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "sdk/cli/runner.hpp"
#include "sdk/sim/simulate.hpp"
#include "sdk/sim/walker.hpp"
#include "tests/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("simulation");

namespace {

Scenario small() {
  Scenario s;
  s.width = 320, s.height = 240, s.focal_px = 250;
  s.straight_m = 6, s.stand_s = 1;
  return s;
}

}  // namespace

TEST_CASE("the same seed gives the same bytes, another seed others") {
  const TemporaryFolder folder;
  Scenario s = small();
  s.width = 96, s.height = 64, s.straight_m = 2;
  REQUIRE(simulate(s, 5, folder / "a.odo", nullptr).ok());
  REQUIRE(simulate(s, 5, folder / "b.odo", nullptr).ok());
  REQUIRE(simulate(s, 6, folder / "c.odo", nullptr).ok());
  const std::string a = read_text(folder / "a.odo");
  CHECK(a == read_text(folder / "b.odo"));
  CHECK(a != read_text(folder / "c.odo"));
}

TEST_CASE("the ideal IMU integrates to the true motion") {
  const Walker walker(small(), 3);
  const double dt = 1e-3;
  Eigen::Isometry3d T = walker.pose(0.5);
  Eigen::Vector3d velocity = (walker.pose(0.5 + 1e-4).translation() - walker.pose(0.5 - 1e-4).translation()) / 2e-4;
  for (double t = 0.5; t < 6.5 - dt / 2; t += dt) {
    const auto k = walker.kinematics(t + dt / 2);
    const Eigen::Vector3d w = k.angular_velocity_b * dt;
    const Eigen::Matrix3d half = Eigen::AngleAxisd(w.norm() / 2, w.normalized()).toRotationMatrix();
    const Eigen::Vector3d a = T.linear() * half * k.specific_force_b + Eigen::Vector3d(0, 0, 9.80665);
    T.translation() += velocity * dt + 0.5 * a * dt * dt;
    velocity += a * dt;
    T.linear() = (T.linear() * half * half).eval();
  }
  const Eigen::Isometry3d truth = walker.pose(6.5);
  CHECK((T.translation() - truth.translation()).norm() < 2e-3);
  CHECK(Eigen::AngleAxisd(T.linear().transpose() * truth.linear()).angle() < 1e-5);
}

TEST_CASE("the true steps cover the walk") {
  const Walker walker(small(), 3);
  double sum = 0;
  for (size_t i = 0; i < walker.steps().size(); ++i) {
    const auto& step = walker.steps()[i];
    CHECK(step.t_end_s > step.t_start_s);
    if (i > 0) CHECK(step.t_start_s == walker.steps()[i - 1].t_end_s);
    sum += step.length_m;
  }
  CHECK(sum == doctest::Approx(2 * 6 + 1.2 * 4).epsilon(0.06));  // all but the last, incomplete step
}

TEST_CASE("the paper's pipeline follows a simulated walk") {
  const TemporaryFolder folder;
  Scenario s = small();
  REQUIRE(simulate(s, 11, folder / "walk.odo", nullptr).ok());
  const auto recording = read_recording(folder / "walk.odo");
  REQUIRE(recording.ok());
  RunOptions options;
  options.config = source("samples/configs/antigny2019.yaml").string();
  options.plugin_path = plugin_folder().string();
  const auto result = replay(*recording, options);
  REQUIRE_MESSAGE(result.ok(), (result.ok() ? "" : result.failure().text));
  CHECK(result->track.size() == recording->truth.size());  // one pose a frame
  CHECK(std::abs(static_cast<double>(result->steps.size()) - static_cast<double>(recording->true_steps.size())) <= 3);
  const Pairs pairs = associate(recording->truth, result->track, 0.001);
  const auto errors = absolute_errors(pairs.reference, align(pairs, Alignment::yaw, nullptr)).translation_m;
  CHECK(statistics_of(errors).rmse < 0.06 * path_length(recording->truth));
  CHECK(result->statistics.lost_s < 1.0);
  CHECK(write_run(folder / "out", *recording, *result, options).ok());
  CHECK(write_report(folder / "out", *recording, *result).ok());
  for (const char* name : {"trajectory.tum", "steps.csv", "scale.csv", "fixes.csv", "summary.json", "report.html"})
    CHECK(std::filesystem::file_size(folder / (std::string("out/") + name)) > 30);
  const auto schema_json = nlohmann::json::parse(read_text(source("schemas/summary.schema.json")));
  const auto summary = nlohmann::json::parse(read_text(folder / "out/summary.json"));
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
  valijson::Validator validator;
  CHECK(validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(summary), nullptr));
}

TEST_CASE("fixes from GNSS bound a walk on the Earth") {
  const TemporaryFolder folder;
  Scenario s = small();
  s.width = 96, s.height = 64, s.straight_m = 25, s.camera_hz = 1, s.gnss_sigma_m = 1.0;
  REQUIRE(simulate(s, 4, folder / "walk.odo", nullptr).ok());
  const auto recording = read_recording(folder / "walk.odo");
  RunOptions options;
  options.config = write_text(folder / "c.yaml",
                              "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  parameters:\n    magnetometer: true\n"
                              "step_estimator:\n  plugin: step/renaudin2012\nabsolute_fixers:\n  - plugin: fix/gnss\n")
                       .string();
  options.plugin_path = plugin_folder().string();
  const auto result = replay(*recording, options);
  REQUIRE_MESSAGE(result.ok(), (result.ok() ? "" : result.failure().text));
  CHECK(result->statistics.fixes_accepted > 30);
  // n's origin is the first fix, the walk starts at the true origin: shifted by that fix's error and no more.
  CHECK((result->track.back().p - recording->truth.back().p).head<2>().norm() < 6.0);
}

TEST_SUITE_END();
