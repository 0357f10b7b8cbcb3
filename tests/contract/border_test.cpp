// SPDX-License-Identifier: Apache-2.0
//
// Boundaries of the host: null arguments, texts of numbers, services for plugins, saved anchors, bytes of recordings.
#include <odograph/anchor.h>
#include <odograph/odograph.h>

#include "sdk/host/core/anchors.hpp"
#include "sdk/host/messages/record_file.hpp"
#include "sdk/host/plugin_host/plugin_call.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "tests/support/session_app.hpp"

TEST_SUITE_BEGIN("border");

TEST_CASE("every number has a unique text, and so has a number of a newer list") {
  const std::map<int32_t, std::string> statuses = {{ODO_OK, "ok"},
                                                   {ODO_NOT_READY, "not ready yet"},
                                                   {ODO_END, "at the end"},
                                                   {ODO_PARTIAL, "done in part"},
                                                   {ODO_E_ARGUMENT, "bad argument"},
                                                   {ODO_E_DISCARD, "input discarded"},
                                                   {ODO_E_EXHAUSTED, "quota or buffer exhausted"},
                                                   {ODO_E_UNSUPPORTED, "not supported"},
                                                   {ODO_E_STRUCT_SIZE, "struct too small"},
                                                   {ODO_E_VERSION, "no common ABI version"},
                                                   {ODO_E_STATE, "called in the wrong state"},
                                                   {ODO_E_CONFIG, "configuration refused"},
                                                   {ODO_E_NOT_FOUND, "not found"},
                                                   {ODO_E_DATA, "damaged data"},
                                                   {ODO_E_IO, "input or output failed"},
                                                   {ODO_E_MEMORY, "out of memory"},
                                                   {ODO_E_ERROR, "error"},
                                                   {ODO_E_FATAL, "fatal error"}};
  for (int32_t s = -2200; s < 20; ++s) {
    const auto found = statuses.find(s);
    CHECK(std::string(odo_status_text(s)) == (found == statuses.end() ? "unknown status" : found->second));
  }
  const auto all = [](const char* (*text)(uint32_t), uint32_t count) {
    std::set<std::string> texts;
    for (uint32_t i = 0; i < count; ++i) texts.insert(text(i));
    CHECK(texts.size() == count);
    for (const uint32_t beyond : {count, count + 1, UINT32_MAX}) CHECK(std::string(text(beyond)) == "unknown");
  };
  all(odo_state_text, 4), all(odo_reason_text, 14), all(odo_mode_text, 8);
  CHECK(std::string(odo_state_text(ODO_LOST)) == "lost");
  CHECK(std::string(odo_reason_text(ODO_REASON_NO_SCALE)) == "no scale yet");
  CHECK(std::string(odo_reason_text(ODO_REASON_NO_GROUND)) == "no ground known there");
  CHECK(std::string(odo_mode_text(ODO_MODE_HANDLING)) == "handling");
}

TEST_CASE("a null pointer is a bad argument of every function, and a struct that is too small is reported as such") {
  RunningApp app(kWalk);
  odo_session* s = app.session;
  double p[3] = {0, 0, 0}, q[3] = {0, 0, 0};
  odo_pose pose{};
  odo_statistics statistics{};
  odo_error error{};
  odo_anchor anchor{};
  uint64_t id = 0;
  odo_header header{};
  const uint32_t type = ODO_TYPE_POSE;
  const auto on_event = [](void*, const odo_header*) {};
  const int64_t bad[] = {odo_session_push(s, nullptr),
                         odo_session_push_imu(nullptr, 0, p, p),
                         odo_session_push_imu(s, 0, nullptr, p),
                         odo_session_push_imu(s, 0, p, nullptr),
                         odo_session_get_pose(nullptr, 0, &pose),
                         odo_session_get_pose(s, 0, nullptr),
                         odo_session_get_smooth_pose(s, 0, nullptr),
                         odo_session_get_pose_of(s, 0, 0, 0, nullptr),
                         odo_session_set_callback(nullptr, &type, 1, on_event, nullptr),
                         odo_session_set_callback(s, nullptr, 1, on_event, nullptr),
                         odo_session_get_statistics(nullptr, &statistics),
                         odo_session_get_statistics(s, nullptr),
                         odo_session_last_error(nullptr, &error),
                         odo_session_last_error(s, nullptr),
                         odo_session_to_geodetic(nullptr, p, q),
                         odo_session_to_geodetic(s, nullptr, q),
                         odo_session_to_geodetic(s, p, nullptr),
                         odo_session_from_geodetic(nullptr, p, q),
                         odo_session_from_geodetic(s, nullptr, q),
                         odo_session_from_geodetic(s, p, nullptr),
                         odo_session_save(nullptr, p, 8),
                         odo_session_save(s, nullptr, 1),
                         odo_session_load(nullptr, p, 8),
                         odo_session_load(s, nullptr, 8),
                         odo_anchor_get(nullptr, 1, 0, 0, &anchor),
                         odo_anchor_get(s, 1, 0, 0, nullptr),
                         odo_anchor_list(nullptr, &id, 1),
                         odo_anchor_list(s, nullptr, 1),
                         odo_anchor_remove(nullptr, 1)};
  for (const int64_t status : bad) CHECK(status == ODO_E_ARGUMENT);
  header.struct_size = sizeof header - 1, pose.header.struct_size = sizeof header - 1;
  statistics.struct_size = ODO_STATISTICS_SIZE_MIN - 1, error.struct_size = ODO_ERROR_SIZE_MIN - 1;
  anchor.struct_size = ODO_ANCHOR_SIZE_MIN - 1;
  for (const int32_t status :
       {odo_session_push(s, &header), odo_session_get_pose(s, 0, &pose), odo_session_get_statistics(s, &statistics),
        odo_session_last_error(s, &error), odo_anchor_get(s, 1, 0, 0, &anchor)})
    CHECK(status == ODO_E_STRUCT_SIZE);
  CHECK(odo_session_get_pose_of(s, ODO_OF_CAMERA + 1, 0, 0, &pose) == ODO_E_STRUCT_SIZE);
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose_of(s, ODO_OF_CAMERA + 1, 0, 0, &pose) == ODO_E_ARGUMENT);
  CHECK(odo_session_get_pose_of(s, ODO_OF_PIPELINE, ODO_WORLD_SMOOTH + 1, 0, &pose) == ODO_E_ARGUMENT);
  CHECK(odo_session_set_callback(s, nullptr, 0, nullptr, nullptr) == ODO_OK);
  CHECK(odo_session_save(s, nullptr, 0) > 0);
  CHECK(odo_session_load(s, p, 8) == ODO_E_DATA);
  CHECK(odo_anchor_list(s, nullptr, 0) == 0);
  CHECK(odo_anchor_remove(s, 1) == ODO_E_NOT_FOUND);
}

namespace {

/// The hash that ends a saved state: FNV-1a.
void sign_state(std::string& blob) {
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i + 8 < blob.size(); ++i) hash = (hash ^ static_cast<unsigned char>(blob[i])) * 1099511628211u;
  std::memcpy(blob.data() + blob.size() - 8, &hash, sizeof hash);
}

}  // namespace

TEST_CASE("a saved state whose plugin's part is rejected is restored in part, and the plugin is named") {
  const std::string yaml = "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n";
  RunningApp before(yaml);
  odo_anchor_place place{
      .struct_size = sizeof place, .kind = ODO_ANCHOR_GEODETIC, .height_above = ODO_HEIGHT_ELLIPSOID};
  uint64_t id = 0;
  CHECK(odo_anchor_create(before.session, &place, &id) == ODO_OK);
  std::string blob = before.saved(), again = blob;
  sign_state(again);
  CHECK(again == blob);
  const size_t name = blob.find("step/odograph");
  REQUIRE(name != std::string::npos);
  uint32_t name_size = 0;
  std::memcpy(&name_size, blob.data() + name - 12, sizeof name_size);
  blob.replace(name + name_size, 8, 8, '\xff');
  sign_state(blob);
  App after(yaml);
  CHECK(after.load(blob) == ODO_PARTIAL);
  odo_error error = after.last_error();
  CHECK(contains(error.message, "saved state rejected by: step/odograph"));
  CHECK(odo_anchor_list(after.session, nullptr, 0) == 1);
}

TEST_CASE("a text without bytes is empty, whatever size it states") {
  const std::string yaml = "odograph: 1\n";
  odo_session_options o{};
  o.struct_size = sizeof o, o.run = ODO_RUN_REPLAY;
  o.config_text = {yaml.data(), yaml.size()}, o.config_path = o.asset_path = {nullptr, 9};
  odo_session* session = nullptr;
  CHECK(odo_session_create(&o, &session, nullptr) == ODO_OK);
  odo_session_destroy(session);
}

TEST_CASE("relative names in a config's text are searched in asset_path alone, those of a file beside it first") {
  const TemporaryFolder here, other;
  write_text(here / "lens.yaml", "width: 640\nheight: 480\nfx: 431.5\nfy: 432.5\ncx: 320\ncy: 240\n");
  const std::string camera = "camera: lens.yaml\n", search = "plugins: {search: [mine]}\n",
                    program = "plugins: {host: bin/host}\n", path = "attitude: {plugin: x.odoplugin.json}\n";
  const auto made = [](const std::string& yaml, const std::string& file, const std::string& assets) {
    odo_session_options o{};
    o.struct_size = sizeof o, o.run = ODO_RUN_REPLAY;
    o.config_text = {yaml.data(), yaml.size()}, o.config_path = {file.data(), file.size()};
    o.asset_path = {assets.data(), assets.size()};
    odo_session* session = nullptr;
    odo_error error{sizeof error, ODO_OK, {}};
    odo_session_create(&o, &session, &error);
    odo_session_destroy(session);
    return std::string(error.message);
  };
  const auto text = [&](const std::string& line, const std::string& assets) {
    return made("odograph: 1\n" + line, "", assets);
  };
  const fs::path before = fs::current_path();
  fs::current_path(here.path());
  for (const std::string& line : {camera, search, program, path}) {
    CAPTURE(line);
    CHECK(contains(text(line, ""), "no folder to search; expected an absolute path"));
  }
  const std::string both = other.path().string() + kPlatform.path_separator + here.path().string();
  CHECK(text(camera, here.path().string()) == "");
  CHECK(text(camera, both) == "");
  fs::rename(here / "lens.yaml", here / "moved.yaml");
  const std::string missing = text(camera, both);
  CHECK(contains(missing, "'lens.yaml' is in none of the folders searched: " + other.path().string() + ", " +
                              here.path().string()));
  const std::string file = write_text(other / "c.yaml", "odograph: 1\ncamera: moved.yaml\n").string();
  CHECK(made("", file, "") != "");  // not in the current folder either
  CHECK(made("", file, here.path().string()) == "");
  fs::current_path(before);
}

TEST_CASE("each plugin gets its own seed from the session's by SplitMix64, and files in the order of the folders") {
  const TemporaryFolder one, two;
  write_text(one / "both", "1"), write_text(two / "both", "2"), write_text(two / "second", "2");
  const HostServices host(0, {one.path(), two.path()}, nullptr), other(5, {}, nullptr);
  const auto service = [](const HostServices& h, const char* id) { return h.get_service(&h, id, std::strlen(id)); };
  const auto* random = static_cast<const odo_random_service*>(service(host, ODO_SERVICE_RANDOM));
  REQUIRE(random);
  constexpr uint64_t kFirst = 0xE220A8397B1DCDAFu;  // SplitMix64's first number for the seed 0
  CHECK(random->seed(&host, 0, kFirst) == kFirst);
  std::set<uint64_t> seeds;
  for (const HostServices* h : {&host, &other})
    for (uint32_t instance = 1; instance < 5; ++instance)
      for (uint64_t stream = 0; stream < 4; ++stream) seeds.insert(random->seed(h, instance, stream));
  CHECK(seeds.size() == 32);
  const auto* assets = static_cast<const odo_asset_service*>(service(host, ODO_SERVICE_ASSETS));
  REQUIRE(assets);
  const auto resolve = [&](const std::string& name, uint64_t capacity) {
    std::string path(300, '.');
    const odo_string text{name.data(), name.size()};
    const int64_t size = assets->resolve(&host, &text, path.data(), capacity);
    return std::pair{size, path.substr(0, path.find_last_not_of('.') + 1)};
  };
  const std::string first = fs::canonical(one / "both").string(), second = fs::canonical(two / "second").string();
  CHECK(resolve("both", 300) == std::pair{static_cast<int64_t>(first.size()), first});
  CHECK(resolve("second", 300).second == second);
  CHECK(resolve("both", 4) == std::pair{static_cast<int64_t>(first.size()), first.substr(0, 4)});
  CHECK(resolve("none", 300).first == ODO_E_NOT_FOUND);
  CHECK(service(host, ODO_SERVICE_REPORT));
  CHECK_FALSE(service(host, "odo.none/1"));
}

TEST_CASE("the call of a thread is named, innermost first, as far as the buffer permits") {
  char text[256];
  const auto now = [&](size_t capacity) { return std::string(text, current_plugin_call(text, capacity)); };
  for (const size_t length : {1u, 7u, 8u, 9u, 94u, 95u, 96u, 200u}) {
    const std::string id(length, 'x');
    const PluginCallScope outer("acme/outer", "reset");
    CHECK(now(256) == "acme/outer in reset");
    {
      const PluginCallScope inner(id, "process");
      CHECK(now(256) == id.substr(0, 95) + " in process");
      CHECK(now(3) == (id + " in process").substr(0, 3));
    }
    CHECK(now(256) == "acme/outer in reset");
    size_t told = 0;
    for_each_long_call(-1, [&](const LongCall& call) { told += call.what == "acme/outer in reset" ? 1 : 0; });
    for_each_long_call(60'000'000'000, [&](const LongCall&) { told += 100; });
    CHECK(told == 1);
  }
}

TEST_CASE("saved anchors are restored, and a blob with one number out of range changes nothing") {
  Geodesy geodesy;
  Anchors anchors(geodesy);
  odo_anchor_place place{};
  place.kind = ODO_ANCHOR_GEODETIC, place.height_above = ODO_HEIGHT_ELLIPSOID;
  place.q[0] = 1, place.latitude_rad = 0.8, place.longitude_rad = 0.1, place.height_m = 40, place.sigma_m = 0.5;
  place.name = {"door", 4};
  REQUIRE(anchors.add_geodetic(place) == 1);
  const auto blob = anchors.save();
  REQUIRE(blob.size() == 168);
  Anchors second(geodesy);
  REQUIRE(second.load(blob));
  CHECK(second.save() == blob);
  CHECK((*second.get(1, 0)->geodetic)[2] == 40);
  const auto taken = [&](size_t at, double value) {
    auto bad = blob;
    std::memcpy(bad.data() + at, &value, sizeof value);
    const bool loaded = second.load(bad);
    CHECK(second.ids().size() == (loaded ? 2 : 1));
    if (loaded) second.remove(second.ids().back());
    return loaded;
  };
  for (size_t at = 16; at < 104; at += 8)
    for (const double wild : {std::nan(""), std::numeric_limits<double>::infinity()}) CHECK_FALSE(taken(at, wild));
  for (const double sign : {-1, 1}) {
    CHECK(taken(16, sign * EIGEN_PI / 2));
    CHECK_FALSE(taken(16, sign * (EIGEN_PI / 2 + 1e-9)));
  }
  for (const auto& [w, good] : {std::pair{0.91, true}, {1.09, true}, {0.89, false}, {1.11, false}})
    CHECK(taken(40, w) == good);
  for (const uint32_t hangs : {0u, 1u, 2u, 3u}) {
    auto other = blob;
    std::memcpy(other.data() + 4, &hangs, sizeof hangs);
    CHECK(Anchors(geodesy).load(other) == (hangs == 1 || hangs == 2));
  }
  auto unended = blob;
  std::memset(unended.data() + 104, 'x', 64);
  CHECK_FALSE(second.load(unended));
  CHECK_FALSE(second.load(std::span(blob.data(), blob.size() - 1)));
  CHECK(second.load({}));
}

namespace {

/// CRC-32 of ISO 3309, bit by bit.
uint32_t crc32(const std::string& bytes) {
  uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320u : 0);
  }
  return ~crc;
}

std::string little_endian(uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}

std::string record(uint32_t type, const std::string& payload) {
  const std::string head = little_endian(type, 4) + little_endian(payload.size(), 4);
  return "ODOR" + head + little_endian(crc32(head + payload), 4) + payload;
}

}  // namespace

TEST_CASE("a recording is written byte for byte as its format specifies, and read back") {
  CHECK(crc32("123456789") == 0xCBF43926u);
  const TemporaryFolder folder;
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, 77);
  imu.accel_b[2] = 9.81;
  const std::string payload(reinterpret_cast<const char*>(&imu), sizeof imu);
  const std::string expected = "ODOREC1\n" + little_endian(2, 4) + little_endian(0, 4) + record(ODO_TYPE_IMU, payload) +
                               record(ODO_TYPE_IMU, payload) + record(0x1FFFF, little_endian(2, 8));
  auto writer = required(RecordWriter::create(folder / "a.odo"));
  for (int i = 0; i < 2; ++i) CHECK(writer->write(imu.header, {}));
  REQUIRE(writer->finish().ok());
  CHECK(read_text(folder / "a.odo") == expected);
  const auto lost = [&](const std::string& bytes) {
    auto reader = required(RecordReader::open(write_text(folder / "b.odo", bytes)));
    while (reader->next()) {
    }
    return reader->loss();
  };
  CHECK_FALSE(lost(expected).any());
  CHECK(lost(expected).records_read == 2);
  const std::string one_less = expected.substr(0, 16) + expected.substr(16 + 16 + sizeof imu);
  CHECK(lost(one_less).records_lost == 1);
  CHECK(lost(one_less).text() == "1 of 2 records are lost");
  const std::string unended = expected.substr(0, expected.size() - 24);
  CHECK(lost(unended).cut);
  for (const char other : {1, 3}) {
    std::string version = expected;
    version[8] = other;
    CHECK(RecordReader::open(write_text(folder / "c.odo", version)).failure().status == ODO_E_VERSION);
  }
}
