// SPDX-License-Identifier: Apache-2.0
//
// Conventions of the ABI: the point of a fix, true north, one camera among several.
#include "sdk/math/rotation.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("conventions");

namespace {

constexpr double kDegree = EIGEN_PI / 180;
const std::string kMarks = kWalk + "absolute_fixers: [{plugin: fix/waypoint}]\n";

/// A walk with one surveyed mark at (10, 20, 0), which the point lever_b of the phone touches.
odo_pose pose_by_mark(const Vector3d* lever_b, Quaterniond& q_n_b) {
  RunningApp app(kMarks);
  app.walk(0, 300);
  auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, 4'000'000'000);
  mark.header.flags = ODO_WAYPOINT_VERTICAL | (lever_b ? ODO_WAYPOINT_LEVER : 0);
  mark.p_n[0] = 10, mark.p_n[1] = 20, mark.sigma_m = 0.01;
  if (lever_b) Vector3d::Map(mark.lever_b) = *lever_b;
  app.push(mark);
  app.run(300, 400);
  REQUIRE(app.statistics().fixes_accepted == 1);
  const auto fixes = app.all<odo_fix>(ODO_TYPE_FIX);
  CHECK(fixes.at(0).p_n[0] == 10);  // published as emitted by the fixer
  q_n_b = quaternion(app.pose(4'000'000'000).q_n);
  return app.pose(4'000'000'000);
}

/// The published attitudes of a phone at rest in a field to the north, with a config and before a message.
std::vector<odo_attitude> attitudes(const std::string& config, const odo_header* first, odo_pose* last = nullptr) {
  RunningApp app(
      "odograph: 1\nattitude: {plugin: attitude/vqf, parameters: {magnetometer: true}}\n"
      "step_estimator: {plugin: step/renaudin2012}\n" +
      config);
  if (first) odo_session_push(app.session, first);
  for (int i = 0; i < 400; ++i) {
    const int64_t t_ns = 1'000'000'000 + i * 10'000'000LL;
    auto field = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t_ns);
    field.field_b[1] = 2e-5, field.field_b[2] = -4e-5;  // the phone's top to magnetic north, screen up
    app.push(field);
    const double rate[3] = {0, 0, 0}, force[3] = {0, 0, 9.81};
    odo_session_push_imu(app.session, t_ns, rate, force);
  }
  app.flush();
  if (last) *last = app.pose(ODO_TIME_LATEST);
  return app.all<odo_attitude>(ODO_TYPE_ATTITUDE);
}

double heading_of_top(const odo_attitude& a) {
  const Vector3d y_n = quaternion(a.q_n_b) * Vector3d::UnitY();
  return std::atan2(y_n.y(), y_n.x());
}

}  // namespace

TEST_CASE("a position fix refers to its lever point, and without a lever to the body's origin") {
  const Vector3d lever_b(0.1, -0.2, 0.5), none = Vector3d::Zero();
  Quaterniond q_n_b, q;
  const Vector3d at_origin(pose_by_mark(nullptr, q).p_n), at_zero(pose_by_mark(&none, q).p_n);
  const Vector3d at_lever(pose_by_mark(&lever_b, q_n_b).p_n);
  CHECK(at_origin == at_zero);
  CHECK((at_origin - at_lever - q_n_b * lever_b).norm() < 1e-2);
}

TEST_CASE("north is true if the declination is known from the config or the app, and flagged magnetic otherwise") {
  const auto plain = attitudes("", nullptr), configured = attitudes("navigation: {declination: 12 deg}\n", nullptr);
  auto field = make_message<odo_earth_field>(ODO_TYPE_EARTH_FIELD, 1'000'000'000);
  field.header.flags = ODO_EARTH_FIELD_DECLINATION;
  field.declination_rad = -20 * kDegree;
  const auto by_app = attitudes("", &field.header);
  REQUIRE((plain.size() > 300 && configured.size() == plain.size() && by_app.size() == plain.size()));
  constexpr uint32_t north = ODO_ATTITUDE_MAGNETIC_NORTH | ODO_ATTITUDE_TRUE_NORTH;
  CHECK((plain.back().header.flags & north) == ODO_ATTITUDE_MAGNETIC_NORTH);
  CHECK((configured.back().header.flags & north) == ODO_ATTITUDE_TRUE_NORTH);
  CHECK((by_app.back().header.flags & north) == ODO_ATTITUDE_TRUE_NORTH);
  CHECK(std::abs(heading_of_top(plain.back())) < 0.01);
  CHECK(std::abs(heading_of_top(configured.back()) - heading_of_top(plain.back()) - 12 * kDegree) < 1e-9);
  CHECK(std::abs(heading_of_top(by_app.back()) - heading_of_top(plain.back()) + 20 * kDegree) < 1e-9);
}

TEST_CASE("a pose claims north only if true north was observed") {
  odo_pose magnetic{}, of_true{};
  attitudes("", nullptr, &magnetic);
  attitudes("coupling: {type: localizer}\nnavigation: {declination: 12 deg}\n", nullptr, &of_true);
  CHECK((magnetic.header.flags & ODO_POSE_NORTH) == 0);
  CHECK((of_true.header.flags & ODO_POSE_NORTH) != 0);
  CHECK((of_true.header.flags & ODO_POSE_COVARIANCE) != 0);
}

TEST_CASE("no plugin can emit inputs, the host's own events, reserved numbers or memory, whatever its table declares") {
  const TestPlugins plugins{"echo"};
  RunningApp app("odograph: 1\nvo_frontend: {plugin: test/echo}\n", ODO_RUN_REPLAY, plugins.path());
  const auto echoed = [&](uint32_t type, int64_t t_ns) {
    alignas(8) unsigned char bytes[sizeof(odo_header) + sizeof(odo_report)] = {};
    auto& head = *reinterpret_cast<odo_header*>(bytes);
    auto& event = *reinterpret_cast<odo_header*>(bytes + sizeof head);
    head.struct_size = sizeof bytes, head.type = ODO_TYPE_VENDOR(0, 1), head.t_ns = t_ns;
    event.struct_size = sizeof(odo_report), event.type = type, event.t_ns = t_ns;
    odo_session_push(app.session, &head);
    app.flush();
    return std::any_of(app.events.begin(), app.events.end(), [&](const std::string& e) {
      return reinterpret_cast<const odo_header*>(e.data())->type == type;
    });
  };
  int64_t t_ns = 1'000'000'000;
  CHECK(echoed(ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2), t_ns));
  for (const uint32_t type :
       {ODO_TYPE_IMU, ODO_TYPE_POSE, ODO_TYPE_CORRECTION, ODO_TYPE_REPORT, 0x5000u, ODO_TYPE_VENDOR(0, ODO_BORROWED)})
    CHECK_FALSE(echoed(type, t_ns += 1'000'000));
}

TEST_CASE("a vendor's message from the far future does not make later ones late") {
  App app(kWalk);
  app.walk(0, 100);
  auto far = make_message<odo_imu>(ODO_TYPE_IMU, int64_t(1) << 61);
  far.header.type = ODO_TYPE_VENDOR(0, 1);
  CHECK(app.push(far) == ODO_OK);
  app.flush();
  CHECK(app.run(100, 200) == ODO_OK);
  CHECK(app.statistics().late == 0);
}
