// SPDX-License-Identifier: Apache-2.0
//
// Benchmark figures on synthetic cases with known answers.
#include <opencv2/imgproc.hpp>

#include "sdk/tools/evaluation/corner_flow.hpp"
#include "sdk/tools/evaluation/fix_figures.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/evaluation/stream_figures.hpp"
#include "sdk/tools/evaluation/vo_consistency.hpp"
#include "sdk/tools/evaluation/vo_figures.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"
#include "tests/support/support.hpp"

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("figures");

namespace {

constexpr int64_t kSecond = 1'000'000'000;
constexpr double kDegree = EIGEN_PI / 180;

Quaterniond yaw(double rad) { return Quaterniond(AngleAxisd(rad, Vector3d::UnitZ())); }

/// One metre per second to the north, after half the time to the east; the camera looks along the path.
StampedPoses corner(int seconds) {
  StampedPoses t;
  Vector3d p(5, -3, 1);
  for (int i = 0; i <= 10 * seconds; ++i) {
    const double heading = i > 5 * seconds ? 90 * kDegree : 0;
    if (i > 0) p += 0.1 * Vector3d(std::cos(heading), std::sin(heading), 0);
    t.push_back({i * kSecond / 10, yaw(heading), p});
  }
  return t;
}

/// The same with unknown position and north.
StampedPoses moved(const StampedPoses& truth, double rad, const Vector3d& by, double scale = 1) {
  StampedPoses t = truth;
  for (StampedPose& x : t) x.p = yaw(rad) * (scale * x.p) + by, x.q = yaw(rad) * x.q;
  return t;
}

odo_pose pose_of(const StampedPose& x, double sigma_m, double sigma_rad) {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, x.t_ns);
  pose.header.flags = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_METRIC;
  pose.q_n[0] = x.q.w(), pose.q_n[1] = x.q.x(), pose.q_n[2] = x.q.y(), pose.q_n[3] = x.q.z();
  Vector3d::Map(pose.p_n) = x.p;
  for (int i = 0; i < 3; ++i)
    pose.covariance[7 * i] = sigma_rad * sigma_rad, pose.covariance[7 * (i + 3)] = sigma_m * sigma_m;
  return pose;
}

TrueState state_at(int64_t t_ns, const Vector3d& p = Vector3d::Zero()) {
  TrueState s;
  s.t_ns = t_ns, s.p = p, s.v = s.gyro_bias = s.accel_bias = Vector3d::Zero();
  return s;
}

odo_step step_of(int64_t start_ns, int64_t end_ns, double length_m, double sigma_m = 0) {
  auto step = make_message<odo_step>(ODO_TYPE_STEP, end_ns + 50'000'000);
  step.t_start_ns = start_ns, step.t_end_ns = end_ns, step.length_m = length_m, step.sigma_m = sigma_m;
  return step;
}

}  // namespace

TEST_CASE("a track that is correct up to position and heading has no error after either alignment") {
  const StampedPoses truth = corner(60), track = moved(truth, 0.7, {20, 30, 0});
  CHECK(horizontal_error(truth, track, 30 * kSecond) > 10);
  for (const double e : horizontal_errors(truth, aligned_at_start(truth, track, 12))) CHECK(e < 1e-9);
  for (const double e : horizontal_errors(truth, aligned_by_pose(truth, track, 12))) CHECK(e < 1e-9);
  const StampedPoses small = moved(truth, 0.7, {20, 30, 0}, 0.5);
  for (const double e : horizontal_errors(truth, aligned_at_start(truth, scaled_by_start(truth, small, 20), 12)))
    CHECK(e < 1e-6);
}

TEST_CASE("a track is rotated in all axes onto the first true pose") {
  const StampedPoses truth = corner(4);
  const Quaterniond off(AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()));
  StampedPoses track = truth;
  for (StampedPose& x : track) x.p = off * x.p, x.q = off * x.q;
  const StampedPoses turned = rotated_onto_first(truth, track);
  CHECK((turned.back().p - truth.back().p).norm() < 1e-9);
  CHECK(turned.back().q.angularDistance(truth.back().q) < 1e-9);
}

TEST_CASE("a yaw alignment maps the track to the truth and back") {
  const StampedPose truth{0, yaw(1.0), {1, 2, 3}}, estimate{0, yaw(-2.5), {4, 4, 4}};
  const YawAlignment a = yaw_alignment(estimate, truth);
  CHECK(std::abs(a.yaw_error(estimate.q, truth.q)) < 1e-12);
  CHECK((a.on_truth(estimate.p) - truth.p).norm() < 1e-12);
  CHECK((a.on_track(a.on_truth({7, 8, 9})) - Vector3d(7, 8, 9)).norm() < 1e-12);
  CHECK(yaw_error(yaw(0.1), yaw(0.4)) == doctest::Approx(0.3));
}

TEST_CASE("poses with errors of one sigma have a NEES of one, and the time beyond four sigma is reported") {
  const StampedPoses truth = corner(20);
  std::vector<odo_pose> poses;
  for (const StampedPose& x : truth) poses.push_back(pose_of(x, 0.5, 0.02));
  CHECK(pose_consistency(poses, truth).position_nees < 1e-12);
  for (size_t i = 1; i < poses.size(); ++i) {
    const double sigmas = i >= 100 && i < 130 ? 4 : 1;
    poses[i].p_n[0] += 0.5 * sigmas, poses[i].p_n[1] += (i % 2 ? 0.5 : -0.5) * sigmas;
    const Quaterniond q = yaw(-0.02 * sigmas) * truth[i].q;
    poses[i].q_n[0] = q.w(), poses[i].q_n[3] = q.z();
  }
  const PoseConsistency f = pose_consistency(poses, truth);
  CHECK(f.poses == truth.size());
  CHECK(f.path_m == doctest::Approx(20));
  CHECK(f.position_nees == doctest::Approx((170 + 30 * 16) / 201.0).epsilon(0.01));
  CHECK(f.heading_nees == doctest::Approx((170 + 30 * 16) / 201.0).epsilon(0.01));
  CHECK(f.position_beyond_s == doctest::Approx(3));
  CHECK(f.heading_beyond_s == doctest::Approx(3));
  CHECK(pose_consistency({poses.begin(), poses.begin() + 2}, truth).poses == 2);
  const double covariance[9] = {4, 0, 0, 0, 1, 0, 0, 0, 1};
  CHECK(horizontal_nees({2, 3, 100}, covariance) == doctest::Approx(10));
}

TEST_CASE("a track's covariance is rotated onto the truth together with its positions") {
  const StampedPoses truth = corner(20);
  for (const double yaw_rad : {0.0, 1.5, -0.7}) {
    CAPTURE(yaw_rad);
    const StampedPoses track = moved(truth, yaw_rad, {5, -3, 0});
    std::vector<odo_pose> poses;
    for (const StampedPose& x : track) {
      poses.push_back(pose_of(x, 0.1, 0.02));
      poses.back().covariance[3 * 6 + 3] = 2 * 2;  // along the track's own north
      if (poses.size() > 1) poses.back().p_n[0] += 2, poses.back().p_n[1] += poses.size() % 2 ? 0.1 : -0.1;
    }
    CHECK(pose_consistency(poses, truth).position_nees == doctest::Approx(1).epsilon(0.02));
  }
}

TEST_CASE("the scale error of poses is that of their path") {
  const StampedPoses truth = corner(20);
  std::vector<odo_pose> poses;
  for (const StampedPose& x : moved(truth, 0, {0, 0, 0}, 1.05)) poses.push_back(pose_of(x, 1, 1));
  CHECK(pose_consistency(poses, truth).scale_error == doctest::Approx(0.05));
}

TEST_CASE("a motion with errors of one sigma in rotation and across its direction is consistent") {
  const StampedPoses truth = {{0, Quaterniond::Identity(), {0, 0, 0}},
                              {kSecond / 10, Quaterniond::Identity(), {0, 0, 1}}};
  auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, kSecond / 10);
  m.header.flags = ODO_VO_COVARIANCE;
  const Quaterniond q(AngleAxisd(0.01 * std::sqrt(3.0), Vector3d(1, 1, 1).normalized()));
  m.q_c0_c1[0] = q.w(), m.q_c0_c1[1] = q.x(), m.q_c0_c1[2] = q.y(), m.q_c0_c1[3] = q.z();
  Vector3d::Map(m.p_c0_c1) = Vector3d(0.02, 0.02, 1);
  for (int i = 0; i < 3; ++i) m.covariance[7 * i] = 1e-4, m.covariance[7 * (i + 3)] = 4e-4;
  const MotionConsistency f = motion_consistency(truth, {m});
  REQUIRE(f.rotation.size() == 1);
  CHECK(f.rotation[0] == doctest::Approx(1));
  CHECK(f.direction[0] == doctest::Approx(1).epsilon(0.01));
  m.header.flags = 0;
  CHECK(motion_consistency(truth, {m}).rotation.empty());
}

TEST_CASE("steps are counted, timed and compared with the true ones") {
  Recording r;
  for (int i = 0; i < 10; ++i) r.true_steps.push_back(step_of(i * kSecond, (i + 1) * kSecond, 0.7));
  for (int i = 0; i <= 2000; ++i) {
    TrueState s = state_at(i * kSecond / 20);
    s.mode = i < 1000 ? ODO_MODE_WALKING_TEXTING : ODO_MODE_WALKING_SWINGING, s.q = yaw(0);
    r.true_states.push_back(s);
  }
  std::vector<odo_step> steps;
  for (int i = 0; i < 9; ++i)
    steps.push_back(step_of(i * kSecond + 20'000'000, (i + 1) * kSecond - 30'000'000, 0.8, 0.05));
  std::vector<odo_motion_mode> modes(2, make_message<odo_motion_mode>(ODO_TYPE_MOTION_MODE, 0));
  modes[0].mode = ODO_MODE_WALKING_TEXTING, modes[1].mode = ODO_MODE_WALKING_SWINGING,
  modes[1].header.t_ns = 60 * kSecond;
  std::vector<odo_attitude> attitudes;  // tilted by 2 degrees, with 6 degrees per minute of drift
  for (int i = 0; i <= 1000; ++i) {
    auto a = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, i * kSecond / 10);
    const Quaterniond q = yaw(0.1 * kDegree * 0.1 * i) * Quaterniond(AngleAxisd(2 * kDegree, Vector3d::UnitX()));
    a.q_n_b[0] = q.w(), a.q_n_b[1] = q.x(), a.q_n_b[2] = q.y(), a.q_n_b[3] = q.z();
    attitudes.push_back(a);
  }
  const WalkFigures f = walk_figures(r, {steps, modes, attitudes});
  CHECK(f.count_percent == doctest::Approx(-10));
  CHECK(f.distance_percent == doctest::Approx(100 * (7.2 - 7) / 7));
  REQUIRE(f.start_ms.size() == 9);
  CHECK(f.start_ms[0] == doctest::Approx(20));
  CHECK(f.end_ms[0] == doctest::Approx(30));
  CHECK(f.latency_ms[0] == doctest::Approx(50));
  CHECK(f.normalised_error[0] == doctest::Approx(4));
  CHECK(std::abs(f.mode_right_s / f.mode_all_s - 0.9) < 0.009);
  CHECK(f.tilt_deg.at(0) == doctest::Approx(2).epsilon(0.01));
  CHECK(f.drift_deg_min.at(0) == doctest::Approx(6).epsilon(0.01));
  CHECK(f.heading_error_deg.at(0) == doctest::Approx(0.95 * 7).epsilon(0.02));
  std::vector<StampedPose> own;
  for (const TrueState& s : r.true_states) own.push_back({s.t_ns, s.q, s.p});
  CHECK(heading_drift(attitudes, own) == doctest::Approx(6).epsilon(0.01));
  CHECK(std::isnan(heading_drift({attitudes.begin(), attitudes.begin() + 50}, own)));
}

TEST_CASE("a pose stream's early poses are compared with later ones, and its jumps with the truth's steps") {
  const StampedPoses truth = corner(10);
  PoseStream stream;
  for (const StampedPose& x : truth) stream.poses[x.t_ns] = pose_of(x, 1, 1);
  for (const StampedPose& x : truth) {
    StampedPose off = x;
    off.p.x() += x.t_ns >= 8 * kSecond ? 0.3 : 0.0;  // it jumps once; the smooth one does not
    off.q = yaw(1 * kDegree) * x.q;
    stream.polls.push_back({x.t_ns, pose_of(off, 1, 1), pose_of(x, 1, 1)});
  }
  stream.early = stream.polls;
  stream.early.back().pose.header.flags = 0;
  const StreamFigures f = stream_figures(stream, truth, 5 * kSecond);
  CHECK(f.frames == 51);
  CHECK(f.without_position == 1);
  CHECK(percentile(f.orientation_deg, 0.5) == doctest::Approx(1));
  CHECK(percentile(f.position_m, 1) == doctest::Approx(0.3));
  CHECK(f.repeated == 49);  // except at the corner
  CHECK(f.jump_m == doctest::Approx(std::hypot(0.3, 0.1) - 0.1));
  CHECK(f.smooth_jump_m < 1e-9);
}

TEST_CASE("fixes are compared with the truth and their own covariance") {
  Recording r;
  r.truth = corner(20);
  r.true_skylines = {{10 * kSecond, std::vector<float>(30, 0.3f), {}},
                     {15 * kSecond, std::vector<float>(30, 0.3f), {}},
                     {18 * kSecond, std::vector<float>(30, 0.1f), {}}};
  std::vector<odo_fix> fixes(2, make_message<odo_fix>(ODO_TYPE_FIX, 0));
  for (size_t i = 0; i < 2; ++i) {
    fixes[i].header.t_ns = (5 + 5 * static_cast<int64_t>(i)) * kSecond;
    Vector3d::Map(fixes[i].p_n) = position_at(r.truth, fixes[i].header.t_ns) + Vector3d(0, i ? 4.0 : 1.0, 9);
    fixes[i].covariance_n[0] = fixes[i].covariance_n[4] = fixes[i].covariance_n[8] = 1;
  }
  const FixFigures f = fix_figures(r, fixes);
  CHECK(f.error_m == std::vector<double>{1, 4});
  CHECK(f.beyond == 1);
  CHECK(f.seconds == 2);
  CHECK(f.with_fix == 1);
  CHECK(f.first_after_m == doctest::Approx(5));
  CHECK(f.first_off_m == doctest::Approx(1));
  CHECK(fix_figures(r, {}).first_after_m == -1);
  StampedPoses tilted = r.truth;
  for (StampedPose& x : tilted) x.q = Quaterniond(AngleAxisd(3 * kDegree, Vector3d::UnitX())) * yaw(1) * x.q;
  CHECK(tilt_errors_deg(r.truth, tilted).at(7) == doctest::Approx(3));
}

TEST_CASE("a walk between buildings is scored after it has settled, and while the receiver is off") {
  std::vector<TrueState> truth;
  StampedPoses track;
  for (int i = 0; i <= 200 * 150; ++i) {
    const TrueState s = state_at(i * kSecond / 200, Vector3d(i / 200.0, 0, 0));
    truth.push_back(s);
    const double t = i / 200.0, off = t < 20 ? 50 : t > 70 && t < 80 ? 9 : t > 130 && t < 131 ? 12 : 2;
    if (i % 20 == 0) track.push_back({s.t_ns, yaw(4 * kDegree), s.p + Vector3d(0, off, 3)});
  }
  const CanyonFigures f = canyon_figures(truth, track);
  CHECK(f.yaw_deg == doctest::Approx(4));
  CHECK(f.median_m == doctest::Approx(2));
  CHECK(f.largest_m == doctest::Approx(12));
  CHECK(f.in_reflection_m == doctest::Approx(9));
}

TEST_CASE("corners of a picture that moves by three pixels are tracked with that flow until it ends") {
  cv::Mat wide(240, 700, CV_8U, cv::Scalar(90));
  cv::RNG random(4);
  for (int k = 0; k < 300; ++k)
    wide({random.uniform(0, 675), random.uniform(0, 215), random.uniform(5, 25), random.uniform(5, 25)}) =
        random.uniform(0, 255);
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.model = ODO_CAMERA_PINHOLE, c.fx = c.fy = 300, c.cx = 160, c.cy = 120;
  CornerFlowStatistics follower(12);
  for (int i = 0; i < 12; ++i) follower.add(wide(cv::Rect(3 * i, 0, 320, 240)).clone(), c);
  follower.finish();
  const TrackFigures& f = follower.figures;
  CHECK(f.frames == 12);
  CHECK(percentile(f.flow_px, 0.5) == doctest::Approx(3).epsilon(0.02));
  CHECK(percentile(f.kept, 0.5) > 0.95);
  CHECK(percentile(f.lengths, 0.5) == doctest::Approx(12));
}

TEST_CASE("the shape error is independent of the scale, and separates a changing scale from a wrong direction") {
  const StampedPoses truth = corner(30);
  std::vector<odo_vo_motion> motions(4, make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, kSecond / 10));
  for (odo_vo_motion& m : motions) m.state = ODO_TRACKING;
  motions[3].state = ODO_LOST;
  for (int k = 0; k < 2; ++k) {  // one with errors of one sigma, and an exact one
    odo_vo_motion& m = motions[static_cast<size_t>(k)];
    m.header.flags = ODO_VO_COVARIANCE;
    const Quaterniond q(AngleAxisd(k == 0 ? 0.01 * std::sqrt(3.0) : 0, Vector3d(1, 1, 1).normalized()));
    m.q_c0_c1[0] = q.w(), m.q_c0_c1[1] = q.x(), m.q_c0_c1[2] = q.y(), m.q_c0_c1[3] = q.z();
    Vector3d::Map(m.p_c0_c1) = Vector3d(0.1, k == 0 ? 0.002 : 0, k == 0 ? 0.002 : 0);
    for (int i = 0; i < 3; ++i) m.covariance[7 * i] = 1e-4, m.covariance[7 * (i + 3)] = 4e-6;
  }
  const VoShape right = vo_shape(truth, motions, {truth, moved(truth, 0.3, {1, 2, 3}, 2)});
  CHECK(right.path_m == doctest::Approx(30));
  CHECK(right.ape_m < 1e-6);
  CHECK(right.end_per_frame_m < 1e-6);
  CHECK(right.end_per_window_m < 1e-6);
  CHECK(percentile(right.scale_change, 1) < 1e-6);
  CHECK(percentile(right.rotation_rad, 1) < 1e-6);
  CHECK(right.rotation_nees == doctest::Approx(0.5));
  CHECK(std::abs(right.direction_nees - 0.5) < 0.005);
  CHECK(right.tracking_share == doctest::Approx(0.75));
  CHECK(right.lost_share == doctest::Approx(0.25));

  StampedPoses grown = truth;  // a quarter too long after the corner
  for (size_t i = 1; i < truth.size(); ++i)
    grown[i].p = grown[i - 1].p + (i > 150 ? 1.25 : 1.0) * (truth[i].p - truth[i - 1].p);
  const VoShape changed = vo_shape(truth, motions, {truth, grown});
  CHECK(changed.end_per_frame_m < 1e-6);
  CHECK(std::abs(percentile(changed.scale_change, 1) - 0.2) < 0.004);
  CHECK(changed.ape_m > 0.2);
  // The window about the corner is 5 m north, 6.25 m east, and is scaled to the length of 5 m and 5 m.
  const double factor = std::hypot(5, 5) / std::hypot(5, 6.25);
  CHECK(changed.end_per_window_m == doctest::Approx(std::hypot(5 - factor * 5, 5 - factor * 6.25)).epsilon(0.05));

  const StampedPoses few(truth.begin(), truth.begin() + 9);
  const VoShape none = vo_shape(truth, motions, {few, few});
  CHECK(std::isnan(none.path_m));
  CHECK(std::isnan(none.direction_nees));
  CHECK(none.lost_share == doctest::Approx(0.25));
}

TEST_CASE("errors are compared with those of another track at the same times") {
  CHECK(part_below({1, 5, 3, 0}, {2, 4, 3, 1}) == doctest::Approx(0.5));
}

TEST_CASE("position errors are given by axis, and displacements by their length") {
  const StampedPoses truth = corner(10);
  const PositionErrors shifted = position_errors(truth, moved(truth, 0, {1, -2, 5}));
  CHECK(shifted.north_m.size() == truth.size());
  CHECK(shifted.north_m[7] == doctest::Approx(1));
  CHECK(shifted.east_m[7] == doctest::Approx(-2));
  CHECK(shifted.horizontal_m[7] == doctest::Approx(std::sqrt(5.0)));
  CHECK(percentile(shifted.displacement_m, 1) < 1e-9);
  const PositionErrors scaled = position_errors(truth, moved(truth, 1, {0, 0, 0}, 1.1));
  CHECK(scaled.displacement_m.size() == truth.size() - 1);
  CHECK(scaled.displacement_m[7] == doctest::Approx(0.01));
}

TEST_CASE("a position is found by the distance walked") {
  Recording r;
  for (int i = 0; i < 10; ++i) r.true_steps.push_back(step_of(i * kSecond, (i + 1) * kSecond, 0.7));
  r.truth = corner(10);
  for (const int s : {3, 6}) r.add(make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, s * kSecond).header);
  CHECK(place_walked_to(r, 4).t_ns == 6 * kSecond);
  CHECK(place_walked_to(r, 4).walked_m == doctest::Approx(4.2));
  CHECK(place_walked_to(r, 1).t_ns == 3 * kSecond);
  CHECK(place_walked_to(r, 1e9).t_ns == 10 * kSecond);
  CHECK(place_walked_to(r, 1e9).walked_m == doctest::Approx(7));
  const PlaceErrors e = place_errors(r.truth, moved(r.truth, 0, {3, 4, 9}), {place_walked_to(r, 4)});
  CHECK(e.mean_m == doctest::Approx(5));
  REQUIRE(e.error_m.size() == 1);
  CHECK(e.error_m[0] == doctest::Approx(5));
  CHECK(e.error_percent[0] == doctest::Approx(100 * 5 / 4.2));
}
