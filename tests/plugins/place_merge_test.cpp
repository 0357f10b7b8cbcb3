// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/merge.hpp"

#include "tests/plugins/painted_wall.hpp"

using namespace odograph::place_map;

TEST_SUITE_BEGIN("place_merge");

TEST_CASE(
    "another map of a wall is placed by its key frames, one of another wall is not, nor one of a wall seen twice") {
  const Wall wall(1);
  // Levelled: z down.
  const auto levelled = [](double yaw_deg, const Vector3d& p) {
    return Rigid{Quaterniond(Eigen::AngleAxisd(yaw_deg * kDegree, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX())),
                 p};
  };
  const auto walked = [](PlaceMap& map, const Wall& seen, const Rigid& T_m_w, double aside, uint32_t epoch = 0) {
    for (const double x : {-0.4, 0.0, 0.4, 0.8}) add(map, seen, at({x + aside, 0, aside}), T_m_w, epoch);
  };
  const Rigid T_m_w = levelled(0, {0, 0, 0}), T_o_w = levelled(130, {7, -3, 1});
  PlaceMap map, other, foreign;
  walked(map, wall, T_m_w, 0), walked(other, wall, T_o_w, 0.1), walked(foreign, Wall(2), T_o_w, 0.1);
  const Placed placed = place_of(other, map);
  REQUIRE(placed.is_found);
  CHECK(placed.agreeing >= 3);
  const Rigid error = placed.T_m_o * (T_m_w * T_o_w.inverse()).inverse();
  CHECK((placed.T_m_o * Vector3d(7, -3, 1)).norm() < 0.03);
  CHECK(error.q.angularDistance(Quaterniond::Identity()) < 0.01);
  CHECK(!place_of(foreign, map).is_found);

  JoinedFrames frames;
  frames.add(map, {}), frames.add(other, placed.T_m_o);
  const auto joined = frames.take();
  CHECK(joined.size() == 4);  // each of the other is beside one of the map
  walked(map, wall, levelled(0, {20, 0, 0}), 0, 1);
  CHECK(!place_of(other, map).is_found);
}
