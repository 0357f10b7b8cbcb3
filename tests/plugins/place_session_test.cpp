// SPDX-License-Identifier: Apache-2.0
//
// Pictures of a painted wall, one after another, in a session of fix/map: when a place counts, and what is saved.
#include "plugins/fix/map/place_session.hpp"

#include "plugins/fix/map/map_section.hpp"
#include "tests/plugins/painted_wall.hpp"

using namespace odograph::place_map;

TEST_SUITE_BEGIN("place_session");

namespace {

constexpr int64_t kHalf_s = 500'000'000;

PlaceSession new_places() { return {PlaceMapParameters(), PlaceSession::Parameters(), false}; }

/// `T_w_c`: where the picture is taken; `T_n_c`: where the session takes it to be.
Sight sight_of(const Wall& wall, int64_t t_ns, const Rigid& T_w_c, const Rigid& T_n_c, bool is_metric = true) {
  Sight out;
  out.picture = wall.picture(T_w_c);
  out.picture.t_ns = t_ns, out.T_n_c = T_n_c, out.is_placed = out.is_metric = is_metric, out.scale_sigma = 0.02;
  return out;
}

std::vector<uint8_t> map_of_wall(const Wall& wall) {
  PlaceMap map;
  add(map, wall, at({0, 0, 0}));
  return bytes_of(map);
}

}  // namespace

TEST_CASE("before the scale nothing is given out; the first metric picture is, though it was elsewhere before") {
  const Wall wall(1);
  PlaceSession places = new_places();
  REQUIRE(!places.load(7, map_of_wall(wall)));
  std::vector<Found> found;
  for (int64_t i = 0; i < 6; ++i) {
    const Rigid T = at({0.04 * static_cast<double>(i), 0, 0});
    const bool is_metric = i >= 3;
    places.see(sight_of(wall, i * kHalf_s, T, is_metric ? T : at({5.0 * static_cast<double>(i + 1), 0, 0}), is_metric));
    for (const Found& one : places.take((i + 1) * kHalf_s)) found.push_back(one);
  }
  REQUIRE(!found.empty());
  CHECK(found[0].t_ns == 3 * kHalf_s);
  CHECK(found[0].map == 7);
  CHECK((found[0].T_x_c.p - Vector3d(0.12, 0, 0)).norm() < 0.06);  // the mark of the requirement at 3 m
}

TEST_CASE(
    "while the front-end starts again the place is known, though the way since the picture before is a third off") {
  const Wall wall(1);
  for (const double factor : {1.3, 5.0}) {  // of the way
    PlaceSession places = new_places();
    REQUIRE(!places.load(7, map_of_wall(wall)));
    std::vector<Found> found;
    for (int64_t i = 0; i < 2; ++i) {
      const Rigid T = at({0.3 * static_cast<double>(i), 0, 0}), reckoned = at({factor * T.p.x() + 6, 0, 4});
      Sight one = sight_of(wall, i * kHalf_s, T, reckoned);
      one.is_metric = false;
      places.see(one);
      for (const Found& each : places.take((i + 1) * kHalf_s)) found.push_back(each);
    }
    REQUIRE(found.size() == (factor < 2 ? 1 : 0));
    if (!found.empty()) CHECK((found[0].T_x_c.p - Vector3d(0.3, 0, 0)).norm() < 0.06);
    CHECK(!places.save(1'000'000).has_own);  // what is reckoned says nothing of where the map is
  }
}

TEST_CASE("a reckoned way alone needs more evidence than a measured one, and does not stand in for it") {
  const Wall wall(1);
  for (const double needed : {1e6, 1.0}) {
    PlaceSession::Parameters p;
    p.reckoned_log_odds = needed;
    PlaceSession places(PlaceMapParameters(), p, false);
    REQUIRE(!places.load(7, map_of_wall(wall)));
    std::vector<int64_t> found;
    for (int64_t i = 0; i < 4; ++i) {
      const Rigid T = at({0.06 * static_cast<double>(i), 0, 0});
      Sight one = sight_of(wall, i * kHalf_s, T, T);
      one.is_metric = i >= 2;
      places.see(one);
      for (const Found& each : places.take((i + 1) * kHalf_s)) found.push_back(each.t_ns / kHalf_s);
    }
    CHECK(found == (needed > 1 ? std::vector<int64_t>{3} : std::vector<int64_t>{1, 2}));
    CHECK(places.save(1'000'000).has_own);
  }
}

TEST_CASE("pictures that the track puts elsewhere than the map does are no recognition; corrections of n carry over") {
  const Wall wall(1);
  for (const bool is_corrected : {false, true}) {
    PlaceSession places = new_places();
    REQUIRE(!places.load(7, map_of_wall(wall)));
    size_t found = 0;
    const Rigid moved = at({0, 0, 3});  // of n, after the first picture
    for (int64_t i = 0; i < 2; ++i) {
      const Rigid T = at({0.04 * static_cast<double>(i), 0, 0});
      places.see(sight_of(wall, i * kHalf_s, T, i > 0 ? moved * T : T));
      if (i == 0 && is_corrected) places.correct(moved);
      found += places.take((i + 1) * kHalf_s).size();
    }
    CHECK(found == (is_corrected ? 1 : 0));
  }
}

TEST_CASE("key frames are saved where they are in n: a correction moves those that come back with a new pose") {
  const Wall wall(1);
  PlaceSession places = new_places();
  const Rigid second = at({0.9, 0, 0}), corrected = at({1.9, 0, 0});
  for (const auto& [t_ns, T] : {std::pair(int64_t{0}, at({0, 0, 0})), std::pair(4 * kHalf_s, second)}) {
    Sight one = sight_of(wall, t_ns, T, T);
    one.landmarks = wall.landmarks(one.picture, T);
    REQUIRE(places.see(std::move(one)));
  }
  places.correct(at({1, 0, 0}));
  places.move(4 * kHalf_s, corrected);
  const auto saved = places.save(60'000'000);
  const auto frames = key_frames_of(saved.bytes);
  REQUIRE(std::holds_alternative<std::vector<KeyFrame>>(frames));
  const auto& kept = std::get<std::vector<KeyFrame>>(frames);
  REQUIRE(kept.size() == 2);
  CHECK(kept[0].T_m_k.p.norm() < 1e-6);
  CHECK((kept[1].T_m_k.p - corrected.p).norm() < 1e-6);
}
