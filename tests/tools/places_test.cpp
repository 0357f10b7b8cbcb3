// SPDX-License-Identifier: Apache-2.0
//
// fix/map in whole sessions: loops, and the map of one session in a later one. The oracle is the simulator's truth.
#include <cmath>
#include <cstring>

#include <odograph/anchor.h>
#include <odograph/map.h>

#include "tests/support/runs.hpp"
#include "tests/support/session_app.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("places");

namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;

/// Two rounds of a furnished room, 45 s.
const Recording& two_rounds() {
  static const TemporaryFolder folder;  // pictures are read from there later
  static const Recording recording = [] {
    const auto scenario = required(read_scenario(
        write_text(folder / "room.yaml",
                   "odograph_scenario: 1\nworld: {type: room}\ncamera: {width: 480, height: 360, focal: 380, "
                   "pitch: -15 deg}\nwalker: {gait: viewing, speed: 0.8 m/s, stand: 3 s}\nroute:\n  points: [[0, 0, "
                   "0], [5, 0, 0], [5, 4, 0], [0, 4, 0], [0, 0, 0], [5, 0, 0], [5, 4, 0], [0, 4, 0], [0, 0, 0]]\n")
            .string()));
    return recorded(*scenario, 7, folder / "room.odo");
  }();
  return recording;
}

RunOptions with_map(const TemporaryFolder& folder, const std::string& plugin = "plugin: fix/map") {
  return options_of(write_text(folder / "map.yaml",
                               "odograph: 1\nwalker: {height: 1.70 m}\nattitude: {plugin: attitude/vqf}\n"
                               "step_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: vo/odograph}\n"
                               "absolute_fixers:\n  - {" +
                                   plugin + "}\ncoupling: {type: localizer}\n"));
}

template <class Message>
size_t accepted(const std::vector<Message>& places) {
  return static_cast<size_t>(std::count_if(places.begin(), places.end(), [](const Message& place) {
    return (place.header.flags & ODO_FLAG_ACCEPTED) != 0;
  }));
}

template <class Message>
std::string bytes(const std::vector<Message>& messages) {
  return {reinterpret_cast<const char*>(messages.data()), messages.size() * sizeof(Message)};
}

Eigen::Isometry3d pose(const StampedPose& x) { return Eigen::Translation3d(x.p) * x.q; }

/// With the checksum of what it is now: the FNV-1a of all but the last eight bytes.
std::string with_checksum(std::string map) {
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i + 8 < map.size(); ++i) hash = (hash ^ static_cast<uint8_t>(map[i])) * 1099511628211u;
  std::memcpy(map.data() + map.size() - 8, &hash, sizeof hash);
  return map;
}
constexpr size_t kVersion_at = 8;  // of a map, and of its section behind "ODOPLACE"

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("a second round closes loops where the truth has been before, and a replay gives the same bytes") {
  const TemporaryFolder folder;
  const RunOptions run = with_map(folder);
  const RunResult first = run_of(two_rounds(), run), again = run_of(two_rounds(), run);
  CHECK(first.key_frames.size() > 20);
  REQUIRE(accepted(first.loops) > 8);
  CHECK(bytes(first.loops) == bytes(again.loops));
  REQUIRE(first.track.size() == again.track.size());
  for (size_t i = 0; i < first.track.size(); ++i)
    REQUIRE((first.track[i].p == again.track[i].p && first.track[i].q.coeffs() == again.track[i].q.coeffs()));
  double nees = 0;
  for (const odo_relative_pose& loop : first.loops) {
    const auto from = pose_at(two_rounds().truth, loop.t_from_ns, 0.1),
               to = pose_at(two_rounds().truth, loop.header.t_ns, 0.1);
    REQUIRE((from && to));
    CHECK(loop.header.t_ns - loop.t_from_ns > 10 * kSecond_ns);
    // The truth is the camera's, whose distance from the body is some centimetres: the same in both but for rotation.
    const double distance_m = (to->p - from->p).norm(), seen_m = Vector3d(loop.p_b0_b1).norm();
    const double sigma_m = std::sqrt(std::max({loop.covariance[21], loop.covariance[28], loop.covariance[35]}));
    CHECK(std::abs(distance_m - seen_m) < 0.05 + 5 * sigma_m);
    nees += std::pow((distance_m - seen_m) / std::hypot(sigma_m, 0.01), 2) / static_cast<double>(first.loops.size());
  }
  CHECK(nees < 3);
}

TEST_CASE("yesterday's map: the place is recognised, and a thing put down there is there again") {
  const TemporaryFolder folder;
  RunOptions run = with_map(folder);
  run.map = (folder / "room.map").string();
  const Vector3d ahead(0.1, 0.2, 1.5);
  int64_t placed_ns = 0;
  run.at_frame = [&](odo_session* session, const RunResult& so_far) {
    if (placed_ns != 0 || so_far.track.empty() || so_far.track.back().t_ns < so_far.track[0].t_ns + 10 * kSecond_ns)
      return;
    odo_anchor_place place{};
    place.struct_size = sizeof place, place.kind = ODO_ANCHOR_VIEW, place.t_ns = so_far.track.back().t_ns;
    Vector3d::Map(place.p) = ahead;
    place.name = {"a cup", 5};
    uint64_t id = 0;
    if (odo_anchor_create(session, &place, &id) == ODO_OK) placed_ns = place.t_ns;
  };
  const RunResult yesterday = run_of(two_rounds(), run);
  REQUIRE(yesterday.save_failures.empty());
  REQUIRE(placed_ns != 0);
  const std::string map = contents(run.map);
  CHECK(map.size() < 2'000'000);

  const auto cup_from = pose_at(two_rounds().truth, placed_ns, 0.1);
  REQUIRE(cup_from.has_value());
  const Vector3d cup = pose(*cup_from) * ahead;
  double worst_rad = 0, first_s = 0;
  int looks = 0, lost = 0;
  run.at_frame = [&](odo_session* session, const RunResult& so_far) {
    if (so_far.track.empty()) return;
    const int64_t t_ns = so_far.track.back().t_ns;
    uint64_t id = 0;
    REQUIRE(odo_anchor_list(session, &id, 1) == 1);  // it appears with the map
    odo_anchor anchor{};
    anchor.struct_size = sizeof anchor;
    REQUIRE(odo_anchor_get(session, id, ODO_WORLD_CORRECTED, t_ns, &anchor) == ODO_OK);
    CHECK(std::string(anchor.name) == "a cup");
    if (so_far.map_poses.empty()) {
      lost += anchor.state == ODO_LOST;
      CHECK(anchor.state == ODO_LOST);
      return;
    }
    const double now_s = 1e-9 * static_cast<double>(t_ns - so_far.track[0].t_ns);
    if (looks == 0) first_s = now_s;
    const auto truth = pose_at(two_rounds().truth, t_ns, 0.1);
    if (!truth || !(anchor.flags & ODO_ANCHOR_VIEW_POSE)) return;
    const Vector3d there = pose(*truth).inverse() * cup, seen(anchor.p_view);
    if (there.norm() < 0.7) return;
    ++looks;
    if (now_s > first_s + 3) worst_rad = std::max(worst_rad, std::atan2(seen.cross(there).norm(), seen.dot(there)));
  };
  const RunResult today = run_of(two_rounds(), run);
  CHECK(lost > 0);
  CHECK(looks > 100);
  CHECK(accepted(today.map_poses) > 20);
  CHECK(first_s < 6);                                    // of which the front-end's start takes two or three
  CHECK(worst_rad < 0.05);                               // 19 px of 380, at 1.5 m and more
  CHECK(contents(run.map).size() < map.size() * 3 / 2);  // what was known is not stored twice

  // What was recognised before it was saved keeps its frame: the cup is there on the third day too.
  run.at_frame = nullptr;
  const RunResult third = run_of(two_rounds(), run);
  CHECK(accepted(third.map_poses) > 20);
}

TEST_CASE("an isolated plugin gives the same places, and its map crosses in pieces") {
  const TemporaryFolder folder;
  RunOptions here = with_map(folder);
  here.map = (folder / "here.map").string();
  const RunResult inside = run_of(two_rounds(), here);
  RunOptions apart = with_map(folder, "plugin: fix/map, isolation: process");
  apart.map = (folder / "apart.map").string();
  const RunResult isolated = run_of(two_rounds(), apart);
  CHECK(bytes(inside.loops) == bytes(isolated.loops));
  CHECK(contents(here.map) == contents(apart.map));
  const RunResult again = run_of(two_rounds(), apart);
  CHECK(accepted(again.map_poses) > 20);
}

TEST_CASE(
    "a damaged map, one of a later format and one of another plugin are refused with words, and nothing is lost") {
  const TemporaryFolder folder;
  RunOptions run = with_map(folder);
  run.map = (folder / "room.map").string();
  run_of(two_rounds(), run);
  const std::string map = contents(run.map);
  REQUIRE(map.size() > 1000);
  const auto refused = [&](std::string damaged, const char* words) {
    write_text(run.map, damaged);
    const auto result = replay(two_rounds(), run);
    REQUIRE_FALSE(result.ok());
    CHECK_MESSAGE(result.failure().text.find(words) != std::string::npos, result.failure().text);
    CHECK(contents(run.map) == damaged);  // it is not overwritten
  };
  std::string flipped = map;
  flipped[map.size() / 2] = static_cast<char>(flipped[map.size() / 2] ^ 1);
  refused(flipped, "damaged");
  refused(map.substr(0, map.size() / 2), "damaged");
  refused("", "damaged");
  std::string later = map;
  ++later[kVersion_at];
  refused(with_checksum(later), "not a map that this version reads");
  later = map;
  ++later[later.find("ODOPLACE") + kVersion_at];
  refused(with_checksum(later), "later format");
  write_text(run.map, map);
  RunOptions without = options_of(write_text(folder / "none.yaml", "odograph: 1\nattitude: {plugin: attitude/vqf}\n"));
  without.map = run.map;
  const auto result = replay(two_rounds(), without);
  REQUIRE_FALSE(result.ok());
  CHECK_MESSAGE(result.failure().text.find("fix/map, which this config does not have") != std::string::npos,
                result.failure().text);
}

TEST_CASE("a map is refused as a whole, with words, and nothing has changed") {
  const std::string map = contents(source("tests/fuzz/seeds/map/two_views"));
  REQUIRE(with_checksum(map) == map);
  const char* const config = "odograph: 1\nattitude: {plugin: attitude/vqf}\nabsolute_fixers: {plugin: fix/map}\n";
  const auto refused = [&](std::string other, size_t at, const char* words) {
    other[at] = static_cast<char>(other[at] ^ 3);
    other = with_checksum(other);
    const RunningApp app(config);
    CHECK(odo_map_load(app.session, other.data(), other.size()) == ODO_E_DATA);
    const std::string said = app.last_error().message;
    CHECK_MESSAGE(said.find(words) != std::string::npos, said);
    CHECK(odo_map_save(app.session, nullptr, 0) == 0);
    CHECK(odo_anchor_list(app.session, nullptr, 0) == 0);
  };
  refused(map, kVersion_at, "not a map that this version reads");
  refused(map, map.find("ODOPLACE") + kVersion_at, "later format");
  refused(map, map.find("ODOPLACE") + 100, "damaged");
  refused(map, map.find("fix/map"), "which this config does not have");
  refused(map, map.find("cup") + 63, "anchors");  // the end of its name is no zero
  const RunningApp app(config);
  CHECK(odo_map_load(app.session, map.data(), map.size()) == ODO_OK);
  CHECK(odo_anchor_list(app.session, nullptr, 0) == 2);
  std::string saved(map.size(), 0);
  CHECK(odo_map_save(app.session, saved.data(), saved.size()) == static_cast<int64_t>(map.size()));
  CHECK(saved == map);
}

TEST_CASE("an anchor of this session is not saved with a loaded map in which its place is not known") {
  const std::string map = contents(source("tests/fuzz/seeds/map/two_views"));
  const RunningApp app(kWalk + "absolute_fixers: {plugin: fix/map}\n");
  CHECK(odo_map_load(app.session, map.data(), map.size()) == ODO_OK);
  CHECK(app.run(0, 500) == ODO_OK);
  odo_anchor_place place{};
  place.struct_size = sizeof place, place.kind = ODO_ANCHOR_POSE, place.t_ns = ODO_TIME_LATEST,
  place.name = {"a mug", 5};
  uint64_t id = 0;
  CHECK(odo_anchor_create(app.session, &place, &id) == ODO_OK);
  CHECK(odo_anchor_list(app.session, nullptr, 0) == 3);
  CHECK(odo_map_save(app.session, nullptr, 0) == static_cast<int64_t>(map.size()));
}
