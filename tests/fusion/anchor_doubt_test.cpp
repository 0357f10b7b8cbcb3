// SPDX-License-Identifier: Apache-2.0
//
// Covariance of an anchor, against numeric derivatives of its position and of its view.
// Reason why an anchor is not placed, and whether it is in front of the camera.
#include <random>

#include <Eigen/Eigenvalues>
#include <odograph/anchor.h>

#include "sdk/host/core/anchors.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/session_app.hpp"

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

TEST_SUITE_BEGIN("anchor_doubt");

namespace {

/// Returns the given covariance of the held and the present pose.
struct TwoPoses : KeptPoses {
  KeptPose held, now;
  Attachment keep_pose(int64_t) override { return {.pose_id = 1}; }
  std::vector<HandOver> take_hand_overs() override { return {}; }
  void release_pose(uint64_t) override {}
  uint64_t map_frame(uint32_t, uint64_t) const override { return 0; }
  bool kept_pose(uint64_t, KeptPose& out) const override { return out = held, true; }
  bool pose_now(KeptPose& out) const override { return out = now, true; }
  bool is_placed() const override { return true; }
};

struct Numbers {
  std::mt19937 generator;
  double operator()() { return static_cast<double>(generator()) / 2147483648.0 - 1; }
  Vector3d vector() { return Vector3d{(*this)(), (*this)(), (*this)()}; }
  Quaterniond rotation() { return Quaterniond{(*this)(), (*this)(), (*this)(), (*this)()}.normalized(); }
};

/// Derivatives by the errors of (held rotation, held position, present rotation, present position), by central
/// differences.
template <class What>
Eigen::Matrix<double, 3, 12> derivative(What what) {
  Eigen::Matrix<double, 3, 12> J;
  constexpr double h = 1e-6;
  for (int i = 0; i < 12; ++i)
    J.col(i) = (what(Vector12(h * Vector12::Unit(i))) - what(Vector12(-h * Vector12::Unit(i)))) / (2 * h);
  return J;
}

double largest(const Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvalues().maxCoeff();
}

}  // namespace

TEST_CASE("the covariance of an anchor on a held pose follows from the joint covariance of both poses") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Numbers number{std::mt19937(seed)};
    TwoPoses poses;
    KeptPose &held = poses.held, &now = poses.now;
    held.q_n_b = number.rotation(), now.q_n_b = number.rotation();
    held.p_n_b = 3 * number.vector(), now.p_n_b = 3 * number.vector();
    Matrix12 A;
    for (double& a : A.reshaped()) a = 0.1 * number();
    const Matrix12 P = A * A.transpose();
    held.own = P.topLeftCorner<6, 6>(), held.cross = P.topRightCorner<6, 6>();
    now.own = now.now = now.cross = held.now = P.bottomRightCorner<6, 6>();

    Geodesy geodesy;
    Anchors anchors(geodesy);
    odo_anchor_place place{};
    place.kind = ODO_ANCHOR_POSE;
    const Rigid T_n_a{number.rotation(), held.p_n_b + 4 * number.vector()};
    const uint64_t id = anchors.add_local(place, {0, {held.q_n_b, held.p_n_b}, T_n_a});
    anchors.update(poses, 0, nullptr);
    const auto known = required(anchors.get(id, 0));
    CHECK((known->T_n_a.p - T_n_a.p).norm() < 1e-12);

    const Vector3d p_held_a = held.q_n_b.conjugate() * (T_n_a.p - held.p_n_b);
    const auto where = [&](const Vector12& e) -> Vector3d {
      return held.p_n_b + e.segment<3>(3) + exp_rotation(e.head<3>()) * (held.q_n_b * p_held_a);
    };
    const auto seen = [&](const Vector12& e) -> Vector3d {
      return (exp_rotation(e.segment<3>(6)) * now.q_n_b).conjugate() * (where(e) - now.p_n_b - e.tail<3>());
    };
    const auto by_where = derivative(where), by_seen = derivative(seen);
    CHECK(known->position_variance == doctest::Approx(largest(by_where * P * by_where.transpose())).epsilon(1e-5));
    CHECK(known->view_variance == doctest::Approx(largest(by_seen * P * by_seen.transpose())).epsilon(1e-5));
    CHECK(known->yaw_variance == doctest::Approx(P(2, 2)));
  }
}

TEST_CASE(
    "a geodetic anchor has the covariance of its position, and in the view that of the present pose in addition") {
  Numbers number{std::mt19937(4)};
  TwoPoses poses;
  KeptPose& now = poses.now;
  now.q_n_b = number.rotation(), now.p_n_b = 3 * number.vector();
  Eigen::Matrix<double, 6, 6> A;
  for (double& a : A.reshaped()) a = 0.1 * number();
  now.own = now.now = A * A.transpose();
  Geodesy geodesy;
  geodesy.set_origin({0.8, 0.1, 300});
  Anchors anchors(geodesy);
  odo_anchor_place place{};
  place.kind = ODO_ANCHOR_GEODETIC, place.height_above = ODO_HEIGHT_ELLIPSOID, place.sigma_m = 0.7;
  place.latitude_rad = 0.8 + 2e-6, place.longitude_rad = 0.1 - 1e-6, place.height_m = 302;
  const uint64_t id = anchors.add_geodetic(place);
  anchors.update(poses, 0, nullptr);
  const auto known = required(anchors.get(id, 0));
  REQUIRE(known->T_n_a.p.norm() > 5);
  const Eigen::Matrix<double, 3, 6> by_seen =
      derivative([&](const Vector12& e) -> Vector3d {
        return (exp_rotation(e.segment<3>(6)) * now.q_n_b).conjugate() * (known->T_n_a.p - now.p_n_b - e.tail<3>());
      }).rightCols<6>();
  const Matrix3d own = 0.49 * Matrix3d::Identity();
  CHECK(known->position_variance == doctest::Approx(0.49));
  CHECK(known->view_variance == doctest::Approx(largest(by_seen * now.now * by_seen.transpose() + own)).epsilon(1e-5));
  CHECK(known->yaw_variance == 0);
}

namespace {

const std::string kLocalizer = "coupling: {type: localizer}\n",
                  kPlace = "start: {position: [0 m, 0 m, 0 m], heading: 0 rad}",
                  kOrigin = "origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}";

std::string navigation(const std::string& keys) { return "navigation: {" + keys + "}\n"; }

odo_anchor_place in_view(double z_m) {
  odo_anchor_place out{};
  out.struct_size = sizeof out;
  out.kind = ODO_ANCHOR_VIEW, out.t_ns = ODO_TIME_LATEST, out.p[2] = z_m;
  return out;
}

odo_anchor_place on_earth() {
  odo_anchor_place out{};
  out.struct_size = sizeof out;
  out.kind = ODO_ANCHOR_GEODETIC, out.height_above = ODO_HEIGHT_ELLIPSOID;
  out.latitude_rad = 0.8, out.longitude_rad = 0.1, out.height_m = 302;
  return out;
}

uint64_t add_anchor(const App& app, const odo_anchor_place& at) {
  uint64_t id = 0;
  REQUIRE(odo_anchor_create(app.session, &at, &id) == ODO_OK);
  return id;
}

odo_anchor anchor_of(const App& app, uint64_t id) {
  odo_anchor anchor{};
  anchor.struct_size = sizeof anchor;
  REQUIRE(odo_anchor_get(app.session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor) == ODO_OK);
  return anchor;
}

}  // namespace

TEST_CASE("n's origin and the phone's position in n are independent, and an anchor's reason names the missing one") {
  const double geodetic[3] = {0.8, 0.1, 300};
  double p_n[3];
  App origin(kWalk + kLocalizer + navigation(kOrigin)), start(kWalk + kLocalizer + navigation(kPlace)),
      both(kWalk + kLocalizer + navigation(kOrigin + ", " + kPlace));
  CHECK(odo_session_from_geodetic(origin.session, geodetic, p_n) == ODO_OK);  // conversion needs no position
  CHECK(odo_session_from_geodetic(start.session, geodetic, p_n) == ODO_NOT_READY);
  for (App* app : {&origin, &start, &both}) add_anchor(*app, on_earth()), app->walk(0, 500);
  CHECK(anchor_of(origin, 1).reason == ODO_REASON_NO_FIX);
  CHECK(anchor_of(start, 1).reason == ODO_REASON_NO_ORIGIN);
  CHECK(std::string(odo_reason_text(ODO_REASON_NO_ORIGIN)) == "no origin on the Earth yet");
  CHECK(anchor_of(both, 1).state != ODO_LOST);
}

TEST_CASE("an anchor is in front only on the side that the phone's camera faces") {
  App app(kWalk + kLocalizer + navigation(kPlace));
  app.walk(0, 500);
  // Without a camera the pose is the body's, whose z axis points out of the screen.
  const uint64_t faced = add_anchor(app, in_view(-3)), behind = add_anchor(app, in_view(3));
  CHECK(anchor_of(app, faced).flags == (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE | ODO_ANCHOR_IN_FRONT));
  CHECK(anchor_of(app, behind).flags == (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE));
}

TEST_CASE("a geodetic anchor made before the first sample has the correct position in both worlds, for any heading") {
  for (const char* heading : {"0 rad", "3.1 rad"}) {
    App app(kWalk + kLocalizer +
            navigation(kOrigin + ", start: {position: [0 m, 0 m, 0 m], heading: " + std::string(heading) + "}"));
    odo_anchor_place place = on_earth();
    place.latitude_rad += 20 / 6.4e6;  // 20 m to the north
    const uint64_t id = add_anchor(app, place);
    int placed = 0;
    for (int i = 0; i < 2000; i += 10) {
      app.walk(i, i + 10);
      odo_anchor worlds[2]{};
      for (odo_anchor& world : worlds) world.struct_size = sizeof world;
      odo_anchor_get(app.session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &worlds[0]);
      odo_anchor_get(app.session, id, ODO_WORLD_SMOOTH, ODO_TIME_LATEST, &worlds[1]);
      if (worlds[0].state == ODO_LOST) continue;
      ++placed;
      // In the smooth world the anchor is where the phone sees it, which follows the walker's first steps smoothly.
      odo_pose phone[2]{};
      phone[0].header.struct_size = phone[1].header.struct_size = sizeof(odo_pose);
      odo_session_get_pose(app.session, ODO_TIME_LATEST, &phone[0]);
      odo_session_get_smooth_pose(app.session, ODO_TIME_LATEST, &phone[1]);
      for (int k = 0; k < 3; ++k)
        CHECK(std::abs(worlds[1].p_n[k] - worlds[0].p_n[k] - (phone[1].p_n[k] - phone[0].p_n[k])) < 0.1);
      CHECK(std::abs(worlds[0].p_n[0] - 20) < 0.1);
    }
    CHECK(placed > 100);
  }
}
