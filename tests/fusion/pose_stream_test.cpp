// SPDX-License-Identifier: Apache-2.0
//
// Predicted poses against a known motion: a walk with bounce, sway and a change of heading.
#include <chrono>
#include <random>

#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/plain_walk.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("pose_stream");

namespace {

int64_t ns(double t_s) { return std::llround(t_s * 1e9); }

/// A walk passed to a PoseStream as by an app and a pipeline, in simulated time.
struct Replay {
  PlainWalk walk{1.3, 0.7, 1, 1.0};
  PoseStream poses;
  double gyro_hz = 200, accel_hz = 104, camera_hz = 30;
  double latency_s = 0.045;     // from a frame's time to its pose
  double poll_ahead_s = 0.030;  // time of a poll beyond the newest pushed sample
  Vector3d gyro_bias{0.01, -0.01, 0.005}, accel_bias{0.1, -0.05, 0.05};
  double position_noise_m = 0.0005;
  Quaterniond q_b_c = Quaterniond(0, 1, 0, 0);
  Vector3d p_b_c{0.03, 0.05, 0};
  bool has_velocity = false;
  std::mt19937 generator{7};  // portable, unlike the distributions

  double noise(double sigma) {  // from twelve uniform numbers
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(generator()) / 4294967296.0;
    return sigma * sum;
  }
  void push_imu(double t_s, uint32_t flags) {
    const auto state = walk.phone.at(t_s);
    const Vector3d gyro_b = state.angular_velocity_b + gyro_bias + 0.002 * Vector3d{noise(1), noise(1), noise(1)};
    const Vector3d accel_b = state.specific_force_b() + accel_bias + 0.02 * Vector3d{noise(1), noise(1), noise(1)};
    poses.add_imu(imu_at(ns(t_s), gyro_b, accel_b, flags));
  }
  odo_pose truth(double t_s) const {
    const auto state = walk.phone.at(t_s);
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, ns(t_s));
    pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_CAMERA;
    const Quaterniond q = Quaterniond(state.T_n_b.rotation()) * q_b_c;
    pose.q_n[0] = q.w(), pose.q_n[1] = q.x(), pose.q_n[2] = q.y(), pose.q_n[3] = q.z();
    Vector3d::Map(pose.p_n) = state.T_n_b * p_b_c;
    pose.state = ODO_TRACKING;
    return pose;
  }
  PosePredictor::Base base(double t_s, const Vector3d& shift = Vector3d::Zero()) {
    PosePredictor::Base out;
    out.pose = truth(t_s);
    const Vector3d error = shift + position_noise_m * Vector3d{noise(1), noise(1), noise(1)};
    for (int i = 0; i < 3; ++i) out.pose.p_n[i] += error[i];
    const auto state = walk.phone.at(t_s);
    out.q_n_b = Quaterniond(state.T_n_b.rotation());
    out.p_n_b = state.T_n_b.translation() + error;
    if (has_velocity) out.v_n_b = state.velocity_n;
    out.biases = {gyro_bias, accel_bias + Vector3d(0.05, 0.05, -0.05)};
    return out;
  }
  std::function<void(PosePredictor::Base&)> add_hook = [](PosePredictor::Base&) {};
  void add(PosePredictor::Base base) {
    add_hook(base);
    poses.add_pose(base.pose, base);
  }
  /// Runs all events up to the end in order: `poll(t, newest sample)` comes at 60 Hz.
  void run(double end_s, const std::function<Vector3d(double)>& shift, const std::function<void(double)>& poll) {
    poses.set_state(ODO_TRACKING, ODO_REASON_NONE);
    struct Event {
      double at_s, t_s;
      int kind;
    };
    std::vector<Event> events;
    for (int i = 0; i / gyro_hz < end_s; ++i) events.push_back({i / gyro_hz, i / gyro_hz, 0});
    for (int i = 0; i / accel_hz < end_s; ++i) events.push_back({i / accel_hz + 0.002, i / accel_hz, 1});
    for (int i = 0; i / camera_hz < end_s; ++i) events.push_back({i / camera_hz + latency_s, i / camera_hz, 2});
    for (int i = 0; i / 60.0 < end_s; ++i) events.push_back({i / 60.0 + 1e-4, i / 60.0, 3});
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at_s < b.at_s; });
    for (const Event& event : events) {
      if (event.kind == 0) push_imu(event.t_s, ODO_IMU_GYRO);
      if (event.kind == 1) push_imu(event.t_s, ODO_IMU_ACCEL);
      if (event.kind == 2) add(base(event.t_s, shift(event.t_s)));
      if (event.kind == 3) poll(event.t_s);
    }
  }
  odo_pose at(double t_s, bool smooth = false) const {
    odo_pose out{};
    CHECK(poses.at(ns(t_s), smooth, out) == ODO_OK);
    return out;
  }
};

Vector3d none(double) { return Vector3d::Zero(); }

double angle_deg(const odo_pose& a, const odo_pose& b) {
  double dot = 0;
  for (int i = 0; i < 4; ++i) dot += a.q_n[i] * b.q_n[i];
  return 2 * std::acos(std::min(1.0, std::abs(dot))) * 180 / EIGEN_PI;
}

double distance_m(const odo_pose& a, const odo_pose& b) { return (Vector3d(a.p_n) - Vector3d(b.p_n)).norm(); }

double percentile(std::vector<double> x, double part) {
  std::sort(x.begin(), x.end());
  return x[static_cast<size_t>(part * static_cast<double>(x.size() - 1))];
}

}  // namespace

TEST_CASE("the pose predicted by 30 ms matches the phone's") {
  for (const bool has_velocity : {false, true}) {
    for (const double camera_hz : {10.0, 30.0}) {
      CAPTURE(has_velocity);
      CAPTURE(camera_hz);
      Replay replay;
      replay.has_velocity = has_velocity;
      replay.camera_hz = camera_hz;
      std::vector<double> degrees, metres;
      int repeated = 0;
      odo_pose last{};
      replay.run(30, none, [&](double now_s) {
        if (now_s < 2) return;
        const odo_pose ahead = replay.at(now_s + 0.030), truth = replay.truth(now_s + 0.030);
        CHECK((ahead.header.flags & ODO_POSE_POSITION) != 0);
        degrees.push_back(angle_deg(ahead, truth));
        metres.push_back(distance_m(ahead, truth));
        if (angle_deg(ahead, last) == 0 || distance_m(ahead, last) == 0) ++repeated;
        last = ahead;
      });
      MESSAGE("orientation " << percentile(degrees, 0.5) << " deg, 99 % " << percentile(degrees, 0.99) << "; position "
                             << percentile(metres, 0.5) * 1e3 << " mm, 99 % " << percentile(metres, 0.99) * 1e3);
      CHECK(percentile(degrees, 0.5) < 0.2);
      CHECK(percentile(degrees, 0.99) < 0.5);
      CHECK(percentile(metres, 0.5) < 0.006);
      CHECK(percentile(metres, 0.99) < 0.020);
      CHECK(repeated == 0);
    }
  }
}

TEST_CASE("between the newest pose and the newest sample the pose follows the measured motion") {
  Replay replay;
  replay.run(10, none, [&](double now_s) {
    if (now_s < 2) return;
    const odo_pose then = replay.at(now_s - 0.010), truth = replay.truth(now_s - 0.010);
    CHECK(angle_deg(then, truth) < 0.2);
    CHECK(distance_m(then, truth) < 0.02);
  });
}

TEST_CASE("an estimate newer than the published pose is propagated from its own time") {
  Replay replay;
  replay.has_velocity = true;
  replay.run(10, none, [&](double now_s) {
    if (now_s < 2) return;
    const auto published = replay.base(now_s - 0.05);
    replay.poses.add_pose(published.pose, replay.base(now_s - 0.01));
    for (const double after_s : {-0.03, 0.0, 0.03}) {
      const odo_pose pose = replay.at(now_s + after_s), truth = replay.truth(now_s + after_s);
      CHECK(distance_m(pose, truth) < 0.006);
      CHECK((pose.header.flags & ODO_POSE_EXTRAPOLATED) != 0);
    }
    CHECK(distance_m(replay.at(now_s - 0.05), published.pose) == 0);
  });
}

TEST_CASE("a correction is blended into the smooth pose and never appears as a jump") {
  Replay replay;
  const Vector3d correction(1.5, -1.0, 0.2);
  odo_pose smooth_before{}, before{};
  double largest_smooth = 0, largest = 0, last_s = 0;
  replay.run(
      20, [&](double t_s) { return t_s < 8 ? Vector3d::Zero() : correction; },
      [&](double now_s) {
        if (now_s < 0.1) return;
        const double t_s = now_s + 0.030;
        const odo_pose smooth = replay.at(t_s, true), pose = replay.at(t_s);
        if (now_s > 2) {
          const Vector3d moved = Vector3d(replay.truth(t_s).p_n) - Vector3d(replay.truth(last_s).p_n);
          const auto beyond = [&](const odo_pose& a, const odo_pose& b) {
            return (Vector3d(b.p_n) - Vector3d(a.p_n) - moved).norm();
          };
          largest_smooth = std::max(largest_smooth, beyond(smooth_before, smooth));
          largest = std::max(largest, beyond(before, pose));
          if (now_s > 14) CHECK(distance_m(smooth, pose) < 0.01);
        }
        smooth_before = smooth, before = pose, last_s = t_s;
      });
  CHECK(largest > 1.5);
  CHECK(largest_smooth < 0.035);  // 1.8 m with a time constant of a second, between two polls: 3 cm
}

TEST_CASE("a horizontal-only pipeline is not disturbed by the bounce or an inclination error") {
  Replay replay;
  replay.camera_hz = 10;
  replay.position_noise_m = 0;
  replay.p_b_c.setZero();
  double height_m = 0;
  const Quaterniond tilted(Eigen::AngleAxisd(0.03, Vector3d::UnitX()));
  std::vector<double> metres;
  replay.add_hook = [&](PosePredictor::Base& base) {
    base.p_n_b.z() = base.pose.p_n[2] = -1.4;
    base.q_n_b = tilted * base.q_n_b;
    const Quaterniond q = base.q_n_b * replay.q_b_c;
    base.pose.q_n[0] = q.w(), base.pose.q_n[1] = q.x(), base.pose.q_n[2] = q.y(), base.pose.q_n[3] = q.z();
  };
  replay.run(30, none, [&](double now_s) {
    if (now_s < 8) return;
    const odo_pose ahead = replay.at(now_s + 0.030), truth = replay.truth(now_s + 0.030);
    height_m = std::max(height_m, std::abs(ahead.p_n[2] + 1.4));
    metres.push_back(std::hypot(ahead.p_n[0] - truth.p_n[0], ahead.p_n[1] - truth.p_n[1]));
  });
  MESSAGE("horizontal " << percentile(metres, 0.5) * 1e3 << " mm, 99 % " << percentile(metres, 0.99) * 1e3);
  CHECK(height_m < 1e-9);
  CHECK(percentile(metres, 0.5) < 0.006);  // 0.3 m/s^2 would move it by 8 mm within the window alone, and more beyond
  CHECK(percentile(metres, 0.99) < 0.020);
}

TEST_CASE("a correction that rotates the track causes no false velocity") {
  Replay replay;
  const Quaterniond q(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()));
  const Vector3d p(3, 2, 0);
  bool turned = false;
  replay.run(9, none, [&](double now_s) {
    if (now_s < 8.95 || turned) return;
    turned = true;
    auto base = replay.base(8.9);
    const auto moved = [&](double t_s) {
      Vector3d out = q * Vector3d(replay.truth(t_s).p_n) + p;
      return out;
    };
    replay.poses.correct({q, p});
    base.q_n_b = q * base.q_n_b, base.p_n_b = q * base.p_n_b + p;
    const Quaterniond q_n = base.q_n_b * replay.q_b_c;
    base.pose.q_n[0] = q_n.w(), base.pose.q_n[1] = q_n.x(), base.pose.q_n[2] = q_n.y(), base.pose.q_n[3] = q_n.z();
    Vector3d::Map(base.pose.p_n) = q * Vector3d(base.pose.p_n) + p;
    replay.add(base);
    CHECK((Vector3d(replay.at(now_s + 0.030).p_n) - moved(now_s + 0.030)).norm() < 0.03);
  });
  CHECK(turned);
}

TEST_CASE("after a correction that rotates the track the pose follows it before there is another pose") {
  const Quaterniond q(Eigen::AngleAxisd(2.0, Vector3d::UnitZ()));
  const Vector3d p(3, 2, 0);
  for (const bool has_velocity : {false, true}) {
    CAPTURE(has_velocity);
    Replay replay;
    replay.has_velocity = has_velocity;
    bool turned = false;
    replay.run(9, none, [&](double now_s) {
      if (now_s < 8.95 || turned) return;
      turned = true;
      replay.poses.correct({q, p});
      const double t_s = now_s + 0.030;
      const odo_pose ahead = replay.at(t_s), before = replay.at(t_s - 0.01);
      CHECK((Vector3d(ahead.p_n) - (q * Vector3d(replay.truth(t_s).p_n) + p)).norm() < 0.03);
      const Vector3d v_n = (Vector3d(replay.truth(t_s).p_n) - Vector3d(replay.truth(t_s - 0.01).p_n)) / 0.01;
      CHECK(((Vector3d(ahead.p_n) - Vector3d(before.p_n)) / 0.01 - q * v_n).norm() < 0.3);
    });
    CHECK(turned);
  }
}

TEST_CASE("a correction moves all poses of the past and no smooth one") {
  const Quaterniond q(Eigen::AngleAxisd(0.4, Vector3d::UnitZ()));
  const Vector3d p(3, -2, 0.5);
  constexpr double kAgo_s[] = {2, 1, 0.1, 0.05, 0.04, 0.02, 0, -0.03};
  Replay replay;
  int corrected = 0;
  replay.run(9, none, [&](double now_s) {
    if (now_s < 8.95 || corrected > 0) return;
    for (int again = 0; again < 2; ++again, ++corrected) {  // the second while the first is still blended in
      std::vector<odo_pose> poses, smooth;
      for (const double ago_s : kAgo_s)
        poses.push_back(replay.at(now_s - ago_s)), smooth.push_back(replay.at(now_s - ago_s, true));
      replay.poses.correct({q, p});
      for (size_t i = 0; i < poses.size(); ++i) {
        CAPTURE(kAgo_s[i]);
        const odo_pose pose = replay.at(now_s - kAgo_s[i]);
        CHECK((Vector3d(pose.p_n) - (q * Vector3d(poses[i].p_n) + p)).norm() < 1e-9);
        CHECK(quaternion(pose.q_n).angularDistance(q * quaternion(poses[i].q_n)) < 1e-7);
        CHECK(distance_m(replay.at(now_s - kAgo_s[i], true), smooth[i]) < 1e-9);
        CHECK(angle_deg(replay.at(now_s - kAgo_s[i], true), smooth[i]) < 1e-5);
      }
    }
  });
  CHECK(corrected == 2);
}

TEST_CASE("a picture shown late sees no correction jump in the smooth world") {
  for (const double late_s : {0.02, 0.07, 0.5}) {  // before and after its pose, and a network away
    CAPTURE(late_s);
    Replay replay;
    const Vector3d correction(3, -1, 0.2);
    bool corrected = false;
    double largest_smooth = 0, largest = 0;
    odo_pose smooth_before{}, before{}, fixed{};
    replay.run(
        14, [&](double) { return corrected ? correction : Vector3d::Zero(); },
        [&](double now_s) {
          if (now_s > 8 && !corrected) corrected = true, replay.poses.correct({Quaterniond::Identity(), correction});
          const double t_s = now_s - late_s;
          if (t_s < 2) return;
          const odo_pose smooth = replay.at(t_s, true), pose = replay.at(t_s);
          if (before.header.t_ns != 0) {
            const Vector3d moved = Vector3d(replay.truth(t_s).p_n) - Vector3d(replay.truth(t_s - 1 / 60.0).p_n);
            const auto beyond = [&](const odo_pose& a, const odo_pose& b) {
              return (Vector3d(b.p_n) - Vector3d(a.p_n) - moved).norm();
            };
            largest_smooth = std::max(largest_smooth, beyond(smooth_before, smooth));
            largest = std::max(largest, beyond(before, pose));
          }
          smooth_before = smooth, before = pose;
          if (now_s > 8.6 && fixed.header.t_ns == 0) fixed = replay.at(8.2, true);
          if (now_s > 8.6) CHECK(distance_m(replay.at(8.2, true), fixed) == 0);
        });
    CHECK(largest > 3);
    CHECK(largest_smooth < 0.075);  // 3.2 m with a time constant of a second, between two polls: 5.3 cm
  }
}

TEST_CASE("without poses there is the attitude alone, and without that nothing") {
  Replay replay;
  odo_pose out{};
  CHECK(replay.poses.at(ns(1), false, out) == ODO_NOT_READY);
  for (int i = 0; i <= 200; ++i) replay.push_imu(i * 0.005, ODO_IMU_GYRO | ODO_IMU_ACCEL);
  CHECK(replay.poses.at(ns(1), false, out) == ODO_NOT_READY);
  auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, ns(0.9));
  const Quaterniond q(replay.walk.phone.at(0.9).T_n_b.rotation());
  attitude.q_n_b[0] = q.w(), attitude.q_n_b[1] = q.x(), attitude.q_n_b[2] = q.y(), attitude.q_n_b[3] = q.z();
  replay.poses.add_attitude(attitude);
  CHECK(replay.poses.at(ns(1.03), false, out) == ODO_OK);
  CHECK(out.header.flags == (ODO_POSE_ORIENTATION | ODO_POSE_EXTRAPOLATED | ODO_POSE_ANGULAR_VELOCITY));
  CHECK(replay.poses.at(ns(2), false, out) == ODO_E_NOT_FOUND);
}

TEST_CASE("a pose for the screen takes microseconds") {
  Replay replay;
  replay.run(10, none, [](double) {});
  std::vector<double> us;
  for (int i = 0; i < 20000; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const odo_pose pose = replay.at(10 + 0.001 * (i % 30), i % 2 == 0);
    us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    REQUIRE(pose.header.t_ns > 0);
  }
  MESSAGE("median " << percentile(us, 0.5) << " us, 99 % " << percentile(us, 0.99) << " us");
  CHECK(percentile(us, 0.5) < 50);  // on a busy machine under a sanitizer; the target is 5
}
