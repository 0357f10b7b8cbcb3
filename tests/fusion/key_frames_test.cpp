// SPDX-License-Identifier: Apache-2.0
//
// Loops and maps in the filter. A walk along a closed path whose heading drifts is the oracle: its true errors are
// known, and the stated ones must fit them.
#include <array>
#include <random>

#include <Eigen/LU>

#include "sdk/host/fusion/key_frames.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/support/support.hpp"

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("key_frames");

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// A walker and the filter that follows him: metre by metre, with a heading that drifts and a scale that is off.
class DriftingWalk {
 public:
  DriftingWalk(uint32_t seed, double heading_sigma_rad, double scale_sigma, double start_heading_sigma_rad = 1e-4)
      : random_(seed) {
    for (const StateIndex i : {kNorth, kEast, kDown}) filter_.set(i, 0, 1e-8);
    filter_.set(kHeading, 0, squared(start_heading_sigma_rad));
    filter_.set(kLogScale, 0, squared(scale_sigma));
    log_scale_ = scale_sigma * normal_(random_);
    step_variance_ = squared(heading_sigma_rad) / 400;  // over 400 m
  }

  void walk(double direction_rad, int metres) {
    for (int i = 0; i < metres; ++i) {
      const Vector3d d_n(std::cos(direction_rad), std::sin(direction_rad), 0);
      true_p_ += d_n;
      const double drift = std::sqrt(step_variance_) * normal_(random_);
      heading_error_ += drift;
      // The filter's displacement is turned by the heading's error and scaled.
      const Vector3d seen_n =
          std::exp(-log_scale_ + filter_.x()[kLogScale]) * (about_down(heading_error_ + filter_.x()[kHeading]) * d_n);
      filter_.add_variance(kHeading, step_variance_);
      filter_.move(seen_n, {{kHeading, across(seen_n)}, {kLogScale, seen_n}}, 1e-6 * Matrix3d::Identity());
      point_.q_o_b = about_down(heading_error_);
      point_.p_o_b += about_down(heading_error_) * d_n;
      point_.path_m += 1, point_.t_ns += 1'000'000'000;
      point_.heading_drift_rad2 += step_variance_;
    }
  }

  /// What a map plugin sees between the true pose then and now.
  odo_relative_pose seen_from(int64_t t_ns, const Vector3d& true_then, double sigma_m, double sigma_rad) {
    auto loop = make_message<odo_relative_pose>(ODO_TYPE_RELATIVE_POSE, point_.t_ns);
    loop.header.flags = ODO_RELATIVE_POSE_TRANSLATION | ODO_RELATIVE_POSE_ROTATION;
    loop.t_from_ns = t_ns;
    put_quaternion(about_down(sigma_rad * normal_(random_)), loop.q_b0_b1);
    Vector3d::Map(loop.p_b0_b1) = true_p_ - true_then + sigma_m * noise();
    for (int i = 0; i < 6; ++i) loop.covariance[7 * i] = squared(i < 3 ? sigma_rad : sigma_m);
    return loop;
  }
  odo_map_pose seen_in_map(uint64_t map, double sigma_m, double sigma_rad) {
    const odo_relative_pose seen = seen_from(0, Vector3d::Zero(), sigma_m, sigma_rad);
    auto place = make_message<odo_map_pose>(ODO_TYPE_MAP_POSE, point_.t_ns);
    place.map = map;
    std::copy(seen.q_b0_b1, seen.q_b0_b1 + 4, place.q_m_b);
    std::copy(seen.p_b0_b1, seen.p_b0_b1 + 3, place.p_m_b);
    std::copy(seen.covariance, seen.covariance + 36, place.covariance);
    return place;
  }

  Vector3d noise() {
    Vector3d out;
    for (double& x : out) x = normal_(random_);
    return out;
  }
  KeyFrames::Context context() const { return {point_, point_, 0, {}}; }
  Vector3d error() const { return filter_.p_n() - true_p_; }
  double heading_error() const { return heading_error_ + filter_.x()[kHeading]; }
  double nees() const {
    const Eigen::Vector4d e(heading_error(), error().x(), error().y(), error().z());
    Matrix4d P;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) P(i, j) = filter_.P()(kPose[i], kPose[j]);
    return e.head<3>().dot(P.topLeftCorner<3, 3>().inverse() * e.head<3>()) / 3;
  }

  PoseFilter filter_;
  TrackPoint point_;
  Vector3d true_p_ = Vector3d::Zero();

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double heading_error_ = 0, log_scale_ = 0, step_variance_ = 0;
};

void square(
    DriftingWalk& walk, int side_m, const std::function<void()>& at_corner = [] {}) {
  for (int side = 0; side < 4; ++side) walk.walk(side * 90 * kDegree, side_m), at_corner();
}

}  // namespace

TEST_CASE("a loop closed at five and at fifteen degrees of heading error leaves a true sigma, and the error shrinks") {
  for (const double degrees : {5.0, 15.0}) {
    CAPTURE(degrees);
    double nees = 0, before_m = 0, after_m = 0, middle_before_m = 0, middle_after_m = 0, middle_nees = 0;
    int used = 0, seeds = 200;
    for (int seed = 1; seed <= seeds; ++seed) {
      DriftingWalk walk(static_cast<uint32_t>(seed), degrees * kDegree, 0.03);
      KeyFrames frames;
      const Attachment start{walk.filter_.keep_pose(walk.point_, walk.point_), {}, Matrix4d::Zero()};
      uint64_t middle = 0;
      int corner = 0;
      square(walk, 100, [&] {
        if (++corner == 2) middle = walk.filter_.keep_pose(walk.point_, walk.point_);
      });
      const auto middle_error = [&](double* nees_of) {
        KeptPose kept;
        REQUIRE(walk.filter_.kept_pose(middle, 0, kept));
        const Vector3d e = kept.p_n_b - Vector3d(100, 100, 0);
        if (nees_of) *nees_of += e.head<2>().dot(kept.own.block<2, 2>(3, 3).inverse() * e.head<2>()) / 2;
        return e.norm();
      };
      before_m += walk.error().norm(), middle_before_m += middle_error(nullptr);
      // It is recognised twice a second for a while: the first time widened, then as precisely as stated.
      bool accepted = false;
      for (int again = 0; again < 4; ++again) {
        accepted =
            frames.use(walk.filter_, walk.seen_from(0, Vector3d::Zero(), 0.05, 0.01), start, walk.context()).accepted ||
            accepted;
        walk.walk(0, 1);
      }
      used += accepted;
      nees += walk.nees(), after_m += walk.error().norm();
      middle_after_m += middle_error(&middle_nees);
    }
    MESSAGE(degrees << " degrees: error " << before_m / seeds << " -> " << after_m / seeds << " m, the middle "
                    << middle_before_m / seeds << " -> " << middle_after_m / seeds << " m, NEES " << nees / seeds
                    << ", the middle " << middle_nees / seeds << ", used " << used);
    CHECK(used > 0.9 * seeds);  // beyond half a radian, 1.9 sigma of 15 degrees, it is refused: 6 %
    CHECK(nees / seeds == Between{0.3, 3});
    CHECK(middle_nees / seeds == Between{0.3, 3});
    CHECK(after_m < 0.1 * before_m);
    CHECK(middle_after_m < 0.8 * middle_before_m);
  }
}

TEST_CASE("loops do not turn n: with an unknown heading they do the same to all poses as with a known one") {
  const auto walked = [](double start_heading_sigma_rad) {
    DriftingWalk walk(7, 8 * kDegree, 0.03, start_heading_sigma_rad);
    KeyFrames frames;
    const Attachment start{walk.filter_.keep_pose(walk.point_, walk.point_), {}, Matrix4d::Zero()};
    std::vector<uint64_t> kept;
    square(walk, 60, [&] { kept.push_back(walk.filter_.keep_pose(walk.point_, walk.point_)); });
    for (int again = 0; again < 5; ++again) {
      CHECK(frames.use(walk.filter_, walk.seen_from(0, Vector3d::Zero(), 0.02, 0.003), start, walk.context()).accepted);
      walk.walk(0, 1);
    }
    std::vector<Vector3d> places{walk.filter_.p_n()};
    for (const uint64_t id : kept) {
      KeptPose pose;
      REQUIRE(walk.filter_.kept_pose(id, 0, pose));
      places.push_back(pose.p_n_b);
    }
    KeptPose first;
    REQUIRE(walk.filter_.kept_pose(start.pose_id, 0, first));
    CHECK(first.own(2, 2) == doctest::Approx(squared(start_heading_sigma_rad)).epsilon(1e-3));
    CHECK(first.q_n_b.angularDistance(Quaterniond::Identity()) < 1e-6);
    return places;
  };
  const auto known = walked(1e-4), unknown = walked(kUnknownHeading_rad);
  CHECK((known[0] - Vector3d(5, 0, 0)).norm() < 0.5);
  for (size_t i = 0; i < known.size(); ++i) CHECK((known[i] - unknown[i]).norm() < 1e-3);
}

TEST_CASE("a wrong loop is refused, and so is one that turns the track by more than half a radian") {
  DriftingWalk walk(3, 2 * kDegree, 0.01);
  KeyFrames frames;
  const Attachment start{walk.filter_.keep_pose(walk.point_, walk.point_), {}, Matrix4d::Zero()};
  square(walk, 50);
  const Vector3d before = walk.filter_.p_n();
  odo_relative_pose elsewhere = walk.seen_from(0, Vector3d::Zero(), 0.05, 0.01);
  elsewhere.p_b0_b1[0] += 40;
  CHECK_FALSE(frames.use(walk.filter_, elsewhere, start, walk.context()).accepted);
  odo_relative_pose turned = walk.seen_from(0, Vector3d::Zero(), 0.05, 0.01);
  put_quaternion(about_down(0.6), turned.q_b0_b1);
  walk.filter_.add_variance(kHeading, 1);
  CHECK_FALSE(frames.use(walk.filter_, turned, start, walk.context()).accepted);
  CHECK((walk.filter_.p_n() - before).norm() == 0);
}

TEST_CASE("key frames keep their place when their pose is handed over, with the error that this adds") {
  double nees = 0;
  constexpr int kSeeds = 40;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DriftingWalk walk(static_cast<uint32_t>(seed), 3 * kDegree, 0.02);
    KeyFrames frames;
    struct Kept {
      int64_t t_ns;
      Vector3d true_p;
    };
    std::vector<Kept> kept;
    int handed = 0;
    const auto keep = [&] {
      if (const auto hand_over = walk.filter_.crowded())
        frames.hand_over(*hand_over), walk.filter_.release_pose(hand_over->from), ++handed;
      auto message = make_message<odo_key_frame>(ODO_TYPE_KEY_FRAME, walk.point_.t_ns);
      message.id = 1;
      frames.add(message, {walk.filter_.keep_pose(walk.point_, walk.point_), {}, Matrix4d::Zero()}, walk.filter_);
      kept.push_back({walk.point_.t_ns, walk.true_p_});
    };
    for (int i = 0; i < 120; ++i) walk.walk(i < 60 ? 0 : 1.5, 3), keep();
    CHECK(handed == 120 - PoseFilter::kMostKept);
    for (const Kept& k : kept) {
      const auto body = frames.find(0, k.t_ns);
      REQUIRE(body.has_value());
      KeptPose pose;
      REQUIRE(walk.filter_.kept_pose(body->pose_id, 0, pose));
      const Vector3d lever = pose.q_n_b * body->T_kept_x.p;
      const Vector3d e = pose.p_n_b + lever - k.true_p;
      Eigen::Matrix<double, 2, 3> by;  // of the (heading, north, east) of the kept pose
      by << -lever.y(), 1, 0, lever.x(), 0, 1;
      const Eigen::Matrix2d R = pose.q_n_b.toRotationMatrix().topLeftCorner<2, 2>();
      const Eigen::Matrix2d P = by * pose.own.block<3, 3>(2, 2) * by.transpose() +
                                R * body->covariance.block<2, 2>(1, 1) * R.transpose() +
                                1e-6 * Eigen::Matrix2d::Identity();
      nees += e.head<2>().dot(P.inverse() * e.head<2>()) / 2 / static_cast<double>(kept.size());
    }
  }
  CHECK(nees / kSeeds == Between{0.5, 2});
}

TEST_CASE("a map's place is a state: fixes and the map agree, its own error stays, and the fifth map takes a place") {
  DriftingWalk walk(5, 5 * kDegree, 0.02);
  KeyFrames frames;
  walk.filter_.add_variance(kNorth, 9);  // where n is
  walk.walk(0, 50);
  odo_map_pose place = walk.seen_in_map(1, 0.02, 0.005);
  place.map_sigma_m = 0.05, place.map_sigma_rad = 0.01;
  place.p_m_b[0] += 1000;  // far from n's origin
  const Vector3d first = walk.error(), from = walk.true_p_;
  const double heading = walk.heading_error();
  const double before_m = walk.filter_.sigma(kNorth);
  REQUIRE(frames.use(walk.filter_, place, false, walk.context()).accepted);
  CHECK(walk.filter_.sigma(kNorth) ==
        doctest::Approx(before_m));  // the first one tells where the map is, not where we are
  walk.walk(1.5, 60), walk.walk(-2, 30);
  // With the map, n stays turned and shifted as it was when the map was recognised first.
  const auto beyond_m = [&] {
    const Vector3d since = walk.true_p_ - from;
    return (walk.error() - first - (about_down(heading) * since - since)).norm();
  };
  const double drifted_m = beyond_m();
  const auto again = [&] {
    odo_map_pose seen = walk.seen_in_map(1, 0.02, 0.005);
    seen.map_sigma_m = 0.05, seen.map_sigma_rad = 0.01, seen.p_m_b[0] += 1000;
    return frames.use(walk.filter_, seen, false, walk.context()).accepted;
  };
  for (int i = 0; i < 100; ++i) again();
  CHECK(drifted_m > 0.5);
  CHECK(beyond_m() < 0.2);  // three times the sigma of the map and of the first recognition
  // Relative to the map it is never better known than the map itself: the position in n is that of the first
  // recognition, in whose error the map had its share already.
  CHECK(walk.filter_.sigma(kEast) > 0.05);
  for (uint64_t map = 2; map <= 5; ++map)
    CHECK(frames.use(walk.filter_, walk.seen_in_map(map, 0.02, 0.005), false, walk.context()).accepted);
  CHECK(walk.filter_.whole_covariance().rows() == kStates + 4 * 4);
}

TEST_CASE("after a drift that nothing foretold the map is where it is seen again, not for ever where it was") {
  DriftingWalk walk(5, 5 * kDegree, 0.02);
  KeyFrames frames;
  walk.walk(0, 20);
  double turned_rad = 0;
  const auto seen = [&] {
    odo_map_pose place = walk.seen_in_map(1, 0.02, 0.005);
    put_quaternion(about_down(turned_rad) * quaternion(place.q_m_b), place.q_m_b);
    place.map_sigma_m = 0.03, place.map_sigma_rad = 0.01;
    return frames.use(walk.filter_, place, false, walk.context()).accepted;
  };
  REQUIRE(seen());
  walk.walk(1, 5);
  walk.true_p_ += Vector3d(2, -1, 0.5), turned_rad = 0.2;  // 20 m from where the map began
  for (int i = 0; i < 5; ++i) CHECK(!seen());
  for (int i = 0; i < 10; ++i) CHECK(seen());
  KeptPose map;
  REQUIRE(walk.filter_.kept_pose(frames.map_frame(0, 1), 0, map));
  const Vector3d body_in_map = map.q_n_b.conjugate() * (walk.filter_.p_n() - map.p_n_b);
  CHECK((body_in_map - walk.true_p_).norm() < 0.1);
}

TEST_CASE("without a place of its own n becomes the frame of the map") {
  DriftingWalk walk(6, 5 * kDegree, 0.02);
  KeyFrames frames;
  walk.walk(0, 30);
  odo_map_pose place = walk.seen_in_map(1, 1e-3, 1e-4);
  const Quaterniond turn = about_down(1.2);
  put_quaternion(turn, place.q_m_b);  // the map was made with another north
  Vector3d::Map(place.p_m_b) = Vector3d(7, -3, 0.5);
  REQUIRE(frames.use(walk.filter_, place, true, walk.context()).accepted);
  CHECK((walk.filter_.p_n() - Vector3d(7, -3, 0.5)).norm() < 1e-9);
  CHECK((walk.filter_.q_n_o() * walk.point_.q_o_b).angularDistance(turn) < 1e-9);
  CHECK(walk.filter_.sigma(kNorth) < 0.01);
  REQUIRE(frames.use(walk.filter_, place, true, walk.context()).accepted);  // known now: an update
  CHECK((walk.filter_.p_n() - Vector3d(7, -3, 0.5)).norm() < 1e-6);
}
