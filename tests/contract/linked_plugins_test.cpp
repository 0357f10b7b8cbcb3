// SPDX-License-Identifier: Apache-2.0
//
// Registered plugins that are linked into the program: the test program's own.
#include <odograph/odograph.h>
#include <odograph/plugin.hpp>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "tests/support/session_app.hpp"

extern "C" {
int32_t ODO_CALL twin_entry_1(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL twin_entry_2(const struct odo_host* host, struct odo_plugin* out);
}

namespace {

struct Linked {
  double gain = 1;
  static constexpr odo::Description description{"linked/one", "1.2.3", "Says how often it is called.",
                                                ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<Linked>> parameters() {
    return {odo::real("gain", "m", 0.5, 2, &Linked::gain, "Does nothing.")};
  }
  void on(const odo_imu& imu, odo::Output& output) {
    auto attitude = odo::make<odo_attitude>(imu.header.t_ns);
    attitude.q_n_b[0] = 1;
    output.report(ODO_SEVERITY_INFO, "called", "gain " + std::to_string(gain));
    output.emit(attitude);
    ++calls;
  }
  std::vector<uint8_t> save() const { return {calls}; }
  void load(const uint8_t* data, size_t size) { calls = size == 1 ? data[0] : 99; }
  uint8_t calls = 0;
};

}  // namespace

ODO_PLUGIN_NAMED(Linked, linked_entry)

namespace {

/// linked/one with a reset that returns a status, and counts of its calls.
struct Counted {
  static inline odo_plugin inner{};
  static inline int creations = 0, resets = 0;
  static inline int32_t reset_status = ODO_OK;

  static int32_t ODO_CALL entry(const odo_host* host, odo_plugin* out) {
    const int32_t status = linked_entry(host, out);
    inner = *out;
    out->create = [](const odo_host* h, uint32_t number, const odo_string* kind, odo_instance** instance) {
      return ++creations, inner.create(h, number, kind, instance);
    };
    out->reset = [](odo_instance*) { return ++resets, reset_status; };
    return status;
  }
};

std::string id_of(odo_plugin_entry entry) {
  const odograph::HostServices host(0, {}, nullptr);
  odo_plugin table{};
  table.struct_size = sizeof table;
  REQUIRE(entry(&host, &table) == ODO_OK);
  return std::string(odo::view(table.id));
}

}  // namespace

TEST_SUITE_BEGIN("linked_plugins");

TEST_CASE("a registered plugin is found by its id without a file, and its parameters are checked") {
  REQUIRE(odo_register_plugin(linked_entry, nullptr) == ODO_OK);
  RunningApp app("odograph: 1\nattitude: {plugin: linked/one, parameters: {gain: 2 m}}\n");
  app.run(0, 20);
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size() == 20);
  CHECK(contains(app.said(), "linked/one: gain 2.0"));
  CHECK(contains(App("odograph: 1\nattitude: {plugin: linked/one, parameters: {gain: 3 m}}\n").message,
                 "expected a number in m from 0.5 to 2"));
  CHECK(contains(App("odograph: 1\nattitude: {plugin: linked/on}\n").message, "(nearest: 'linked/one')"));
  CHECK(contains(App("odograph: 1\nscale_source: {plugin: linked/one}\n").message, "plugin 'linked/one' serves"));
}

TEST_CASE("saved state belongs to the plugin's id, and a new version of the plugin keeps it") {
  REQUIRE(odo_register_plugin(linked_entry, nullptr) == ODO_OK);
  const std::string yaml = "odograph: 1\nattitude: {plugin: linked/one}\n";
  App first(yaml);
  first.run(0, 20);
  const std::string blob = first.saved();
  CHECK(contains(blob, "linked/one\x14"));
  CHECK_FALSE(contains(blob, ODO_INTERFACE_ATTITUDE));
  const App second(yaml);
  CHECK(second.load(blob) == ODO_OK);
  CHECK(second.saved() == blob);
}

TEST_CASE("a plugin is created again where its reset fails, and only there") {
  HostServices host(0, {}, nullptr);
  PluginChoice choice;
  choice.manifest.id = "linked/one", choice.manifest.entry = Counted::entry;
  choice.manifest.abi_major = ODO_ABI_MAJOR, choice.manifest.abi_minor = ODO_ABI_MINOR;
  choice.interface_id = ODO_INTERFACE_ATTITUDE;
  auto plugin = required(PluginInstance::make(choice, LibraryCheck::hash, 1, host));
  (*plugin)->reset();
  CHECK((Counted::creations == 1 && Counted::resets == 1));
  Counted::reset_status = ODO_E_ERROR;
  (*plugin)->reset();
  CHECK((Counted::creations == 2 && Counted::resets == 2));
  CHECK((*plugin)->alive());
}

TEST_CASE("a registered plugin cannot be isolated, and the allow list applies to its id") {
  REQUIRE(odo_register_plugin(linked_entry, nullptr) == ODO_OK);
  for (const char* config : {"attitude: {plugin: linked/one, isolation: process}\n",
                             "plugins: {isolation: process}\nattitude: {plugin: linked/one}\n",
                             "attitude: {plugin: attitude/magyq, fallback: linked/one, isolation: process}\n"}) {
    const App app(std::string("odograph: 1\n") + config);
    CHECK(app.status == ODO_E_CONFIG);
    const std::string cannot = "cannot run in a process of its own";  // without processes no plugin can
    CHECK(contains(app.message,
                   kPlatform.processes ? "plugin 'linked/one' is linked into the app and " + cannot : cannot));
  }
  CHECK(contains(App("odograph: 1\nplugins: {allow: [a/b]}\nattitude: {plugin: linked/one}\n").message,
                 "is not on the allow list"));
  const std::string key(64, 'a');  // with an empty signer list
  const App app("odograph: 1\nplugins: {allow: [linked/one], signers: [{key: " + key +
                "}]}\nattitude: {plugin: linked/one}\n");
  CHECK_MESSAGE(app.status == ODO_OK, app.message);
}

TEST_CASE("plugins with the same class name share nothing, linked or loaded") {
  CHECK(id_of(twin_entry_1) == "twin/one");
  CHECK(id_of(twin_entry_2) == "twin/two");
  for (const auto& [number, id] : {std::pair{"3", "twin/three"}, {"4", "twin/four"}}) {
    const auto library = built("tests/same_class") / (std::string("twin_") + number + ODOGRAPH_LIBRARY);
    std::string why;
    void* handle = open_library(library, why);
    REQUIRE_MESSAGE(handle, why);
    const auto entry = reinterpret_cast<odo_plugin_entry>(library_symbol(handle, ODO_PLUGIN_ENTRY_SYMBOL));
    REQUIRE((entry != nullptr));
    CHECK(id_of(entry) == id);
  }
}
