// SPDX-License-Identifier: Apache-2.0
//
// Files of maps: two sessions in one room, whose starts are apart, and one in another room. The oracle is the
// simulator's truth.
#include "sdk/tools/replay/map_file.hpp"

#include <odograph/anchor.h>

#include "sdk/host/core/saved_parts.hpp"
#include "tests/support/runs.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("map_file");

namespace {

/// A round of a furnished room with something put down, and its map.
struct Session {
  Recording recording;
  std::string map;
  Vector3d put_w = Vector3d::Zero();  ///< where it is, in the world
};

const TemporaryFolder& folder() {
  static const TemporaryFolder made;  // pictures are read from there
  return made;
}

RunOptions with_map(const std::string& map) {
  RunOptions run = options_of(
      write_text(folder() / "map.yaml",
                 "odograph: 1\nwalker: {height: 1.70 m}\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: "
                 "step/odograph}\nvo_frontend: {plugin: vo/odograph}\nabsolute_fixers:\n  - {plugin: fix/map}\n"
                 "coupling: {type: localizer}\n"));
  run.map = map;
  return run;
}

void put_down(odo_session* session, int64_t t_ns, const Vector3d& p, const std::string& name) {
  odo_anchor_place place{};
  place.struct_size = sizeof place, place.kind = ODO_ANCHOR_VIEW, place.t_ns = t_ns;
  Vector3d::Map(place.p) = p;
  place.name = {name.data(), name.size()};
  uint64_t id = 0;
  REQUIRE(odo_anchor_create(session, &place, &id) == ODO_OK);
}

/// Besides the thing of that name, each session puts down "door".
Session walked(const std::string& name, const std::string& points, uint64_t seed) {
  const auto scenario = required(read_scenario(
      write_text(folder() / (name + ".yaml"),
                 "odograph_scenario: 1\nworld: {type: room}\ncamera: {width: 480, height: 360, focal: 380, pitch: -15 "
                 "deg}\nwalker: {gait: viewing, speed: 0.8 m/s, stand: 3 s}\nroute:\n  points: " +
                     points + "\n")
          .string()));
  Session session{recorded(*scenario, seed, folder() / (name + ".odo")), (folder() / (name + ".map")).string()};
  RunOptions run = with_map(session.map);
  const Vector3d ahead(0.1, 0.2, 1.5);
  bool done = false;
  run.at_frame = [&](odo_session* live, const RunResult& so_far) {
    if (done || so_far.track.empty() || so_far.track.back().t_ns < so_far.track[0].t_ns + 8'000'000'000) return;
    done = true;
    const int64_t t_ns = so_far.track.back().t_ns;
    put_down(live, t_ns, ahead, name), put_down(live, t_ns, {0, 0, 1}, "door");
    const auto truth = pose_at(session.recording.truth, t_ns, 0.1);
    REQUIRE(truth.has_value());
    session.put_w = truth->q * ahead + truth->p;
  };
  REQUIRE(run_of(session.recording, run).save_failures.empty());
  REQUIRE(done);
  return session;
}

const Session& first() {
  static const Session made = walked("cup", "[[0, 0, 0], [5, 0, 0], [5, 4, 0], [0, 4, 0], [0, 0, 0]]", 7);
  return made;
}
const Session& second() {
  static const Session made = walked("vase", "[[5, 4, 0], [0, 4, 0], [0, 0, 0], [5, 0, 0], [5, 4, 0]]", 7);
  return made;
}

MapFile map_of(const std::string& path) {
  auto map = required(MapFile::read(path, {plugin_folder()}));
  return std::move(*map);
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const MapFile::Anchor& anchor_of(const MapFile& map, const std::string& name) {
  const auto at = std::find_if(map.anchors().begin(), map.anchors().end(),
                               [&](const MapFile::Anchor& anchor) { return anchor.name == name; });
  REQUIRE(at != map.anchors().end());
  return *at;
}

size_t recognised(const Recording& recording, const std::string& map) {
  const RunResult run = run_of(recording, with_map(map));
  return static_cast<size_t>(std::count_if(run.map_poses.begin(), run.map_poses.end(), [](const odo_map_pose& place) {
    return (place.header.flags & ODO_FLAG_ACCEPTED) != 0;
  }));
}

}  // namespace

TEST_CASE("the maps of two sessions become one, in which what both put down is where the truth has it") {
  MapFile map = map_of(first().map);
  const MapFile other = map_of(second().map);
  const size_t before = map.views().size();
  const auto joint = required(map.join(other));
  CHECK(joint->agreeing > other.views().size());
  CHECK(joint->sigma_m < 0.1);
  CHECK(joint->doubled == std::vector<std::string>{"door"});
  CHECK(map.views().size() > before);
  CHECK(map.views().size() < before + other.views().size());  // what both saw alike is there once
  REQUIRE(map.anchors().size() == 3);
  const MapFile::Anchor &cup = anchor_of(map, "cup"), &vase = anchor_of(map, "vase");
  const double seen_m = (cup.p_m - vase.p_m).norm(), true_m = (first().put_w - second().put_w).norm();
  CHECK(true_m > 3);
  CHECK(std::abs(seen_m - true_m) < 0.3);
  CHECK(std::abs(cup.p_m.z() - vase.p_m.z() - (first().put_w.z() - second().put_w.z())) < 0.1);
  CHECK(vase.sigma_m >= joint->sigma_m);

  const std::string path = (folder() / "both.map").string();
  REQUIRE(map.write(path).ok());
  const MapFile again = map_of(path);
  CHECK(again.bytes().size() == map.bytes().size());
  REQUIRE(again.views().size() == map.views().size());
  for (size_t i = 0; i < map.views().size(); ++i) CHECK(again.views()[i].p_m == map.views()[i].p_m);
  CHECK(anchor_of(again, "vase").p_m == vase.p_m);
  CHECK(recognised(second().recording, path) > 10);
}

TEST_CASE("the map of another room is not joined, and nothing changes") {
  const Session other = walked("lamp", "[[5, 4, 0], [0, 4, 0], [0, 0, 0], [5, 0, 0], [5, 4, 0]]", 8);
  MapFile map = map_of(first().map);
  const auto before = map.bytes();
  const auto joint = map.join(map_of(other.map));
  REQUIRE_FALSE(joint.ok());
  CHECK(joint.failure().status == ODO_E_NOT_FOUND);
  CHECK_MESSAGE(joint.failure().text.find("lamp.map: not found in ") != std::string::npos, joint.failure().text);
  CHECK(map.bytes() == before);
}

TEST_CASE("a thinned map has the size that was asked for and is still recognised") {
  MapFile map = map_of(first().map);
  const uint64_t half = map.bytes().size() / 2;
  REQUIRE(map.thin(half).ok());
  CHECK(map.bytes().size() <= half);
  CHECK(map.bytes().size() > half * 8 / 10);
  CHECK(map.anchors().size() == 2);
  const std::string path = (folder() / "half.map").string();
  REQUIRE(map.write(path).ok());
  CHECK(recognised(second().recording, path) > 5);
  const auto refused = map.thin(1000);
  REQUIRE_FALSE(refused.ok());
  CHECK_MESSAGE(refused.failure().text.find("a single key frame") != std::string::npos, refused.failure().text);
}

TEST_CASE("damaged, foreign and later map files are refused with words") {
  const std::string whole = contents(first().map), path = (folder() / "wrong.map").string();
  const auto refused = [&](const std::string& bytes, const std::string& words) {
    write_text(path, bytes);
    const auto map = MapFile::read(path, {plugin_folder()});
    REQUIRE_FALSE(map.ok());
    CHECK_MESSAGE(map.failure().text.find(words) != std::string::npos, map.failure().text);
  };
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
  for (const std::string& bytes : {flipped, whole.substr(0, whole.size() / 2), std::string(), std::string(100, 'x')})
    refused(bytes, "wrong.map: the data is not a map that this version reads, or it is damaged");
  // The container is whole, what is in it is not.
  const auto maps = required(maps_of({reinterpret_cast<const uint8_t*>(whole.data()), whole.size()}));
  const auto with = [&](const std::function<void(SavedMap&, std::vector<uint8_t>&)>& change) {
    SavedMap map = maps->front();
    std::vector<uint8_t> data(map.data.begin(), map.data.end());
    change(map, data);
    map.data = data;
    const auto bytes = bytes_of({&map, 1});
    return std::string(bytes.begin(), bytes.end());
  };
  refused(with([](SavedMap&, std::vector<uint8_t>& data) { data[data.size() / 2] ^= 1; }),
          "a map was rejected by fix/map: it is damaged or of a later format (is damaged");
  refused(with([](SavedMap&, std::vector<uint8_t>& data) { data[16] = 9; }), "(has version 9");
  refused(with([](SavedMap&, std::vector<uint8_t>& data) { data.resize(4); }), "rejected by fix/map");
  refused(with([](SavedMap& map, std::vector<uint8_t>&) { map.plugin = "vendor/maps"; }),
          "a map of vendor/maps, which is not there");
  refused(with([](SavedMap& map, std::vector<uint8_t>&) { map.plugin = "fix/gnss"; }), "a map of fix/gnss, which");
  refused(with([](SavedMap& map, std::vector<uint8_t>&) { map.plugin = "fix/map\n    isolation: process"; }),
          "whose name is none");
  refused(with([](SavedMap& map, std::vector<uint8_t>&) { map.anchors = map.anchors.first(100); }),
          "the anchors of a map are damaged");
  CHECK(MapFile::read((folder() / "none.map").string()).failure().text.find("no such file") != std::string::npos);
}
