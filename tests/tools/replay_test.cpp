// SPDX-License-Identifier: Apache-2.0
//
// Recordings replayed as by an app: predicted poses, anchors, waypoints on the way.
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/replay/anchor_walk.hpp"
#include "sdk/tools/replay/app_stream.hpp"
#include "sdk/tools/replay/marked_run.hpp"
#include "tests/support/runs.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("replay");

namespace {

constexpr int64_t kReplaySecond = 1'000'000'000;

/// 16 m with a corner and small pictures.
const Recording& walk() {
  static const TemporaryFolder folder;  // pictures are read from there later
  static const Recording recording = [] {
    Scenario s;
    s.camera.width = 160, s.camera.height = 120, s.camera.focal_px = 120;
    s.walker.height_m = 1.7;
    s.route = {{0, 0, 0}, {10, 0, 0}, {10, 6, 0}};
    return recorded(s, 5, folder / "walk.odo");
  }();
  return recording;
}

/// The same in a street larger than for the sensors: their track is too short.
Recording in_larger_street(double factor) {
  Recording recording = walk();
  for (StampedPose& pose : recording.truth) pose.p *= factor;
  return recording;
}

/// A pipeline with steps, or with camera, IMU and steps; with `told` it uses waypoints.
RunOptions pipeline(const TemporaryFolder& folder, bool camera, bool told = true) {
  const std::string fixer =
      "absolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all, min_sigma: 0.02 m}\n";
  RunOptions run;
  run.config = write_text(folder / "pipeline.yaml",
                          std::string("odograph: 1\nwalker: {height: 1.70 m}\n") +
                              "navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 rad}}\n"
                              "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n" +
                              (camera ? "vo_frontend: {plugin: vo/odograph}\ncoupling: {type: localizer}\n" : "") +
                              (told ? fixer : ""))
                   .string();
  return run;
}

/// Error of the last pose with a truth, with the first such one aligned; NaN if there are none.
double end_error(const std::vector<odo_pose>& poses, const StampedPoses& truth) {
  std::optional<YawAlignment> alignment;
  double error_m = std::nan("");
  for (const odo_pose& pose : poses) {
    const StampedPose x{pose.header.t_ns, {pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]}, Vector3d(pose.p_n)};
    const auto there = pose_at(truth, x.t_ns, 0.5);
    if (!there) continue;
    if (!alignment) alignment = yaw_alignment(x, *there);
    error_m = (alignment->on_truth(x.p) - there->p).head<2>().norm();
  }
  return error_m;
}

template <class Value>
Value need(Result<Value> result) {
  REQUIRE_MESSAGE(result.ok(), result.failure().text);
  return std::move(*result);
}

}  // namespace

TEST_CASE("waypoints on the way correct a track that is too short, and the recording's own are then ignored") {
  const TemporaryFolder folder;
  const RunOptions run = pipeline(folder, true);
  const Recording street = in_larger_street(1.1);
  const MarkOptions marks{.sigma_m = 0.05, .every_s = 1};
  const MarkedRun alone = need(marked_run(street, run, {}, 1e9)), told = need(marked_run(street, run, marks, 1e9));
  REQUIRE(alone.poses.size() > 20);
  REQUIRE(told.poses.size() > 20);
  const double alone_m = end_error(alone.poses, street.truth), told_m = end_error(told.poses, street.truth);
  CHECK(alone_m > 0.8);  // a tenth of 11.7 m
  CHECK(told_m < 0.4);
  CHECK(told.times_realtime > 0);
  for (size_t i = 1; i < told.poses.size(); ++i)
    REQUIRE(told.poses[i - 1].header.t_ns < told.poses[i].header.t_ns);  // each time once, as last corrected

  const auto last = [](const MarkedRun& r) { return Vector3d(r.poses.back().p_n); };
  CHECK(last(need(marked_run(street, run, marks, 1e9))) == last(told));
  CHECK(last(need(marked_run(street, run, {.sigma_m = 0.05, .every_s = 1, .seed = 2}, 1e9))) != last(told));
  Recording marked = street;  // another waypoint, far away
  auto own = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, street.truth.back().t_ns - kReplaySecond);
  own.p_n[0] = 50, own.sigma_m = 0.05;
  marked.add(own.header);
  marked.sort();
  CHECK(last(need(marked_run(marked, run, marks, 1e9))) == last(told));
}

TEST_CASE("a run limited to the first seconds ends there") {
  const TemporaryFolder folder;
  const int64_t start_ns = walk().messages.front().message.header().t_ns;
  const MarkedRun begun = need(marked_run(walk(), pipeline(folder, false), {}, 8));
  REQUIRE(begun.poses.size() > 3);
  CHECK(begun.poses.back().header.t_ns <= start_ns + 8 * kReplaySecond);
  CHECK(begun.poses.back().header.t_ns > start_ns + 6 * kReplaySecond);
}

TEST_CASE("an app polls at its screen rate, ahead of its input, and once per picture") {
  const TemporaryFolder folder;
  const RunOptions run = pipeline(folder, false);
  const AppTiming near{.ahead_ms = 30, .poll_hz = 50}, far{.ahead_ms = 230, .poll_hz = 50};
  const AppStream stream = need(app_stream(walk(), run, near)), ahead = need(app_stream(walk(), run, far));
  REQUIRE(stream.poses.polls.size() > 100);
  CHECK(stream.poll_us.size() >= stream.poses.polls.size());
  CHECK(stream.statistics_us.size() == stream.poll_us.size());
  for (size_t i = 1; i < stream.poses.polls.size(); ++i)
    REQUIRE(stream.poses.polls[i].t_ns - stream.poses.polls[i - 1].t_ns == kReplaySecond / 50);
  CHECK(ahead.poses.polls.back().t_ns - stream.poses.polls.back().t_ns == 200'000'000);
  // The screen stops with the last input: 30 ms ahead of the recording's end and its latest picture.
  const double over_s =
      1e-9 * static_cast<double>(stream.poses.polls.back().t_ns - walk().messages.back().message.header().t_ns);
  CHECK(over_s == Between{0.0, 0.1});
  std::vector<int64_t> frames;
  for (const RecordedMessage& m : walk().messages)
    if (m.message.header().type == ODO_TYPE_FRAME) frames.push_back(m.message.header().t_ns);
  REQUIRE(stream.poses.early.size() > frames.size() / 2);
  CHECK(stream.poses.early.back().t_ns == frames.back());
  CHECK(stream.poses.poses.size() > 15);  // one per step
  CHECK(stream.corrections == 0);
}

TEST_CASE("a waypoint on the way is a correction of the stream") {
  const TemporaryFolder folder;
  Recording told = walk();
  auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, walk().truth.back().t_ns - kReplaySecond);
  mark.p_n[0] = 12, mark.p_n[1] = 4, mark.sigma_m = 0.05;
  told.add(mark.header);
  told.sort();
  CHECK(need(app_stream(told, pipeline(folder, false), {})).corrections > 0);
}

TEST_CASE("anchors have the error of the track, and a final fix is used if there is a fixer") {
  const TemporaryFolder folder;
  const AnchorWalkOptions options{.settle_s = 3};
  const AnchorFigures untold = need(anchor_walk(walk(), pipeline(folder, true, false), options));
  const RunOptions run = pipeline(folder, true);
  const AnchorFigures right = need(anchor_walk(walk(), run, options));
  const AnchorFigures wrong = need(anchor_walk(in_larger_street(1.25), run, options));
  REQUIRE(right.px.size() > 20);
  CHECK(right.px.size() == right.smooth_px.size());
  const double right_px = percentile(right.px, 0.5), wrong_px = percentile(wrong.px, 0.5);
  CHECK(right_px < 3);
  CHECK(wrong_px > 2 * right_px);
  CHECK(right.drift_m < 0.5);
  CHECK(wrong.drift_m == doctest::Approx(0.25 * std::hypot(10, 6)).epsilon(0.25));
  CHECK(right.view_sigma_m > 0);
  CHECK(right.fixed);
  CHECK_FALSE(untold.fixed);
  CHECK(untold.px.size() == right.px.size());
  CHECK(right.start_off_m < 0.5);
  CHECK(std::isfinite(right.by_newest_m));
}
