// SPDX-License-Identifier: Apache-2.0
//
// Estimation of the walker's parameters in a session: from fixes, from a camera, and from the previous session.
#include "tests/support/session_app.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("learning");

TEST_CASE("position fixes calibrate the step estimator to the walker's step length") {
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n"
      "absolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all}\ncoupling:\n  fix_gate: 0\n";
  // The walker's path with the model's steps; the waypoints imply steps longer by a tenth.
  App model(yaml);
  model.run(0, 12000);
  std::vector<odo_waypoint> marks;
  double walked_m = 0;
  std::optional<odo_pose> last;
  for (const odo_pose& pose : model.all<odo_pose>(ODO_TYPE_POSE)) {
    if (last) walked_m += std::hypot(pose.p_n[0] - last->p_n[0], pose.p_n[1] - last->p_n[1]);
    last = pose;
    if (walked_m < 12.0 * static_cast<double>(marks.size())) continue;
    auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, pose.header.t_ns);
    for (int k = 0; k < 3; ++k) mark.p_n[k] = 1.1 * pose.p_n[k];
    marks.push_back(mark);
  }
  REQUIRE(marks.size() > 5);
  App app(yaml);
  size_t next = 0;
  const auto mean_step_m = [&](int from, int to) {
    app.events.clear();
    for (int i = from; i < to; ++i) {
      app.walk(i, i + 1);
      while (next < marks.size() && marks[next].header.t_ns <= i * 10'000'000LL + 1'000'000'000)
        app.push(marks[next++]);
    }
    app.flush();
    double sum = 0;
    const auto steps = app.all<odo_step>(ODO_TYPE_STEP);
    for (const odo_step& step : steps) sum += step.length_m;
    return sum / std::max(1.0, static_cast<double>(steps.size()));
  };
  mean_step_m(0, 400);  // the first steps after standing
  const double before_m = mean_step_m(400, 1000), after_m = mean_step_m(1000, 12000);
  mean_step_m(12000, 12001);
  CHECK(app.statistics().fixes_accepted > 5);
  const double last_m = mean_step_m(12001, 13000);
  CHECK(last_m == Between{1.06 * before_m, 1.13 * before_m});
  CHECK(after_m > before_m);
}

TEST_CASE("a metric camera calibrates the step estimator too") {
  // The VIT system of the vo/vit test moves at a metre per second; by the step model the walker moves at 1.08 m/s.
  App app(std::string("odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n") +
          "vo_frontend:\n  plugin: vo/vit\n  parameters: {library: " + ODOGRAPH_TEST_VIT + ", wait: 5 s}\n");
  REQUIRE_MESSAGE(app.session, app.message);
  app.push(calibration(64, 48));
  std::vector<uint8_t> pixels(64 * 48);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i * 37);
  for (int i = 0; i < 15000; ++i) {
    app.walk(i, i + 1);
    if (i % 10 != 5) continue;
    app.push(grey_frame_at(i * 10'000'000LL + 1'000'000'000, pixels.data(), 64, 48));
  }
  app.flush();
  std::vector<double> lengths;
  for (const odo_step& step : app.all<odo_step>(ODO_TYPE_STEP)) lengths.push_back(step.length_m);
  REQUIRE(lengths.size() > 250);
  const auto speed = [&](size_t from, size_t to) {
    double sum = 0;
    for (size_t i = from; i < to; ++i) sum += lengths[i];
    return 1.9 * sum / static_cast<double>(to - from);
  };
  CHECK(speed(0, 20) > 1.05);
  CHECK(speed(lengths.size() - 20, lengths.size()) == doctest::Approx(1.0).epsilon(0.025));
}

TEST_CASE("a session's estimates continue in the next session") {
  const std::string yaml = "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n";
  const auto walked_m = [](App& app) {
    app.run(0, 2000);
    return app.statistics().distance_m;
  };
  App before(yaml + "  parameters: {factor: 1.2}\n");  // as an estimated value
  const std::string blob = before.saved();
  CHECK(contains(blob, "step/odograph"));
  App plain(yaml), next(yaml);
  CHECK(next.load(blob) == ODO_OK);
  CHECK(next.saved() == blob);
  const double next_m = walked_m(next), plain_m = walked_m(plain);
  CHECK(next_m == doctest::Approx(1.2 * plain_m).epsilon(0.01));

  for (size_t i = 0; i < blob.size(); ++i) {  // nothing is loaded from damaged data
    std::string damaged = blob;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    CHECK(plain.load(damaged) == ODO_E_DATA);
    CHECK(odo_session_load(plain.session, blob.data(), i) == ODO_E_DATA);
  }
  CHECK(plain.saved() == App(yaml).saved());
  App other(kWalk);  // another estimator's data is ignored
  CHECK(other.load(blob) == ODO_OK);
  CHECK(odo_session_load(nullptr, blob.data(), blob.size()) == ODO_E_ARGUMENT);

  next.walk(0, 100);  // a clock that was set back: the walker is the same
  for (int i = 0; i < 60; ++i) next.walk(i, i + 1);
  CHECK(next.saved() == blob);
}
