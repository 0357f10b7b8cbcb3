// SPDX-License-Identifier: Apache-2.0
//
// Life cycle of a plugin at its limits: reset, disabling, restart, save.
#include <odograph/scale_source.h>

#include "sdk/host/plugin_host/instance.hpp"
#include "tests/support/obeys.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("instance");

namespace {

constexpr int64_t kMs = 1'000'000, kSecond = 1000 * kMs;

PluginChoice choice_of(Isolation::Kind kind) {
  static const TestPlugins plugins{"obeys"};
  PluginChoice choice;
  choice.manifest = *read_manifest(fs::path(plugins.path()) / "obeys.odoplugin.json");
  choice.interface_id = ODO_INTERFACE_SCALE_SOURCE;
  choice.isolation.kind = kind;
  return choice;
}

struct Obedient {
  std::vector<Report> told;
  HostServices host{0, {"."}, [this](const Report& report) { told.push_back(report); }};
  std::unique_ptr<PluginInstance> plugin;

  explicit Obedient(const PluginChoice& choice) {
    auto made = required(PluginInstance::make(choice, LibraryCheck::none, 3, host));
    plugin = std::move(*made);
  }
  explicit Obedient(Isolation::Kind kind) : Obedient(choice_of(kind)) {}

  size_t give(const Order& o) { return plugin->process(o.header).size(); }
  int32_t fails(int64_t t_ns, int32_t status) {
    Order o = order(t_ns);
    o.status = status;
    give(o);
    return status;
  }
  void end(int64_t t_ns) {
    Order o = order(t_ns);
    o.ends = 1;
    give(o);
  }
  void learn(int64_t t_ns, uint32_t what) {
    Order o = order(t_ns);
    o.learn = what;
    give(o);
  }
  /// Its state and the number of its orders, including this one; {-1, -1} if it does not answer.
  std::pair<double, double> state(int64_t t_ns) {
    Order o = order(t_ns);
    o.emits = 1;
    const auto events = plugin->process(o.header);
    if (events.size() != 1) return {-1, -1};
    const auto& scale = as<odo_scale>(events[0].header());
    CHECK(scale.header.source == 3);
    return {scale.scale - 1, scale.displacement_m};
  }
};

constexpr auto kInside = Isolation::Kind::none, kProcess = Isolation::Kind::process;

}  // namespace

TEST_CASE(
    "five consecutive failures disable a plugin, a success restarts the count, and each failure resets the plugin") {
  for (const auto kind : {kInside, kProcess})
    for (const int32_t status : {ODO_E_ERROR, ODO_E_MEMORY, -1000, -1999}) {
      CAPTURE(status);
      Obedient one(kind);
      CHECK_FALSE(one.plugin->take_reset());
      for (int i = 0; i < 4; ++i) one.fails(i, status);
      CHECK(one.plugin->alive());
      CHECK(one.plugin->take_reset());
      CHECK_FALSE(one.plugin->take_reset());
      CHECK(one.state(10) == std::pair<double, double>{0, 1});  // it was reset, and this succeeded
      for (int i = 20; i < 24; ++i) one.fails(i, status);
      CHECK(one.plugin->alive());
      one.fails(24, status);
      CHECK_FALSE(one.plugin->alive());
      CHECK(one.plugin->faults() == 9);
      CHECK(one.told.front().key == "failed");
      CHECK(one.told.front().status == status);
    }
}

TEST_CASE("discarded samples never cause a reset, and a fatal status disables at once") {
  for (const int32_t status :
       {ODO_E_DISCARD, ODO_E_ARGUMENT, ODO_E_EXHAUSTED, ODO_E_UNSUPPORTED, ODO_E_STATE, ODO_E_DATA, ODO_E_IO, -999}) {
    CAPTURE(status);
    Obedient one(kInside);
    for (int i = 0; i < 12; ++i) one.fails(i, status);
    CHECK(one.plugin->alive());
    CHECK_FALSE(one.plugin->take_reset());
    CHECK(one.state(20).second == 13);
    CHECK(one.plugin->faults() == 12);
    REQUIRE(one.told.size() == 1);
    CHECK(one.told[0].key == "discarded");
    CHECK(one.told[0].severity == ODO_SEVERITY_WARNING);
  }
  Obedient one(kInside);
  one.fails(0, ODO_E_FATAL);
  CHECK_FALSE(one.plugin->alive());
}

TEST_CASE("a call emits at most 256 events, and the excess is reported once per call") {
  for (const auto kind : {kInside, kProcess}) {
    Obedient one(kind);
    Order o = order(0);
    uint64_t faults = 0;
    for (const uint32_t emits : {1u, 255u, 256u, 257u, 300u, 256u, 400u}) {
      CAPTURE(emits);
      o.emits = emits;
      CHECK(one.give(o) == std::min(emits, 256u));
      faults += emits > 256 ? 1 : 0;
      CHECK(one.plugin->faults() == faults);
    }
  }
}

TEST_CASE(
    "consecutive crashes restart at once, then after 0.1 s, and each wait is twice the previous one, up to 10 s") {
  Obedient one(kProcess);
  int64_t t = 100 * kSecond;
  for (const int64_t wait_ms : {0, 100, 200, 400, 800, 1600, 3200, 6400, 10000, 10000, 10000}) {
    CAPTURE(wait_ms);
    one.end(t);
    if (wait_ms > 0) {
      CHECK_FALSE(one.plugin->alive());
      one.give(order(t + wait_ms * kMs - 1));
      CHECK_FALSE(one.plugin->alive());
      CHECK_FALSE(one.plugin->recovering());
      one.give(order(t += wait_ms * kMs));
    }
    REQUIRE(one.plugin->alive());
    CHECK(one.plugin->take_reset());
    CHECK(one.plugin->recovering());
  }
  CHECK(one.plugin->faults() == 11);
}

TEST_CASE("a run of more than a second restarts the count of crashes, and the plugin is recovering for one call") {
  for (const int64_t ran : {kSecond, kSecond + 1}) {
    Obedient one(kProcess);
    one.end(10 * kSecond);
    REQUIRE(one.plugin->alive());
    one.give(order(11 * kSecond - 1));
    CHECK(one.plugin->recovering());
    one.give(order(11 * kSecond));
    CHECK_FALSE(one.plugin->recovering());
    one.end(10 * kSecond + ran);
    CHECK(one.plugin->alive() == (ran > kSecond));  // otherwise it is the second in a row and waits
  }
}

TEST_CASE("the third consecutive crash, and not an earlier one, activates the fallback with the same number") {
  PluginChoice choice = choice_of(kProcess);
  auto fallback = std::make_shared<PluginChoice>(choice_of(kInside));
  choice.fallback = fallback;
  Obedient one(choice);
  int64_t t = 0;
  for (int i = 0; i < 2; ++i) {
    one.end(t += kMs);
    one.give(order(t += 200 * kMs));
  }
  const auto took_place = [&] {
    return std::any_of(one.told.begin(), one.told.end(), [](const Report& r) { return r.key == "fallback"; });
  };
  CHECK_FALSE(took_place());
  one.plugin->take_reset();
  one.end(t += kMs);
  CHECK(took_place());
  CHECK(one.plugin->alive());
  CHECK(one.plugin->take_reset());
  CHECK(one.plugin->recovering());
  CHECK(one.state(t += kMs).second == 1);
  // In the host's process it is allowed five failures.
  for (int i = 0; i < 4; ++i) one.fails(t += kMs, ODO_E_ERROR);
  CHECK(one.plugin->alive());
  one.fails(t + kMs, ODO_E_ERROR);
  CHECK_FALSE(one.plugin->alive());
}

TEST_CASE("the state of an isolated plugin is kept every ten seconds and restored after a crash") {
  for (const int64_t until : {10 * kSecond - 1, 10 * kSecond, 15 * kSecond, 20 * kSecond - 1, 20 * kSecond}) {
    CAPTURE(until);
    Obedient one(kProcess);
    one.learn(0, 1);
    one.give(order(5 * kSecond));
    if (until >= 10 * kSecond) one.give(order(10 * kSecond));
    one.learn(until >= 10 * kSecond ? 11 * kSecond : 6 * kSecond, 2);
    one.give(order(until));
    one.end(30 * kSecond);
    REQUIRE(one.plugin->alive());
    const double learnt = one.state(30 * kSecond + 1).first;
    CHECK(learnt == (until < 10 * kSecond ? 0 : until < 20 * kSecond ? 1 : 2));
  }
}

TEST_CASE("a state loaded into an isolated plugin survives its crash, and one in process is saved as it is") {
  for (const auto kind : {kInside, kProcess}) {
    Obedient one(kind);
    CHECK(one.plugin->save().empty());
    const std::vector<uint8_t> seven = {7, 0, 0, 0}, short_one = {7, 0, 0};
    CHECK_FALSE(one.plugin->load(short_one));
    CHECK(one.plugin->load(seven));
    CHECK(one.plugin->save() == seven);
    if (kind == kInside) continue;
    one.end(kSecond);
    CHECK(one.state(kSecond + 1).first == 7);
  }
}

TEST_CASE("a requested reset is reported once and is not a fault") {
  for (const auto kind : {kInside, kProcess}) {
    Obedient one(kind);
    one.give(order(1)), one.give(order(2));
    one.plugin->reset();
    CHECK(one.plugin->take_reset());
    CHECK_FALSE(one.plugin->take_reset());
    CHECK(one.state(3).second == 1);
    CHECK(one.plugin->faults() == 0);
  }
}
