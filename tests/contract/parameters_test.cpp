// SPDX-License-Identifier: Apache-2.0
//
// A plugin's parameters from its table to its instance, the types of its kind, and texts of limited size.
#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/messages.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/config/manifest.hpp"
#include "sdk/host/config/overrides.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/host/plugin_host/wire.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("parameters");

namespace {

odo_string text(const char* s) { return {s, std::strlen(s)}; }

odo_parameter row(uint32_t type, const char* name, double min, double max, uint32_t count) {
  odo_parameter p{};
  p.struct_size = sizeof p, p.type = type, p.name = text(name), p.min = min, p.max = max, p.count = count;
  p.unit = text("m/s"), p.help = text("what it is"), p.default_text = text("0.5"), p.choices = text("a|b");
  return p;
}

}  // namespace

TEST_CASE("every column of a parameter table is written to the manifest and read back") {
  const odo_parameter rows[] = {row(ODO_PARAMETER_BOOL, "a", 0, 0, 0),    row(ODO_PARAMETER_INT, "b", -3, 7, 0),
                                row(ODO_PARAMETER_REAL, "c", 0.25, 8, 0), row(ODO_PARAMETER_STRING, "d", 0, 0, 0),
                                row(ODO_PARAMETER_CHOICE, "e", 0, 0, 0),  row(ODO_PARAMETER_REALS, "f", -1.5, 1.5, 4)};
  const SpecType types[] = {SpecType::boolean, SpecType::integer, SpecType::real,
                            SpecType::text,    SpecType::choice,  SpecType::reals};
  const odo_string interfaces[] = {text("odo.one/1"), text("odo.two/1")};
  odo_plugin plugin{};
  plugin.id = text("acme/all"), plugin.version = text("1.2.3"), plugin.summary = text("says \"all\"");
  plugin.abi_major = 4, plugin.abi_minor = 9;
  plugin.interfaces = interfaces, plugin.interface_count = 2;
  plugin.parameters = rows, plugin.parameter_count = 6, plugin.parameter_stride = sizeof(odo_parameter);
  const auto manifest =
      required(parse_manifest(write_manifest(plugin, "all.so", std::string(64, 'a')), "/x/all.odoplugin.json"));
  CHECK(manifest->id == "acme/all");
  CHECK(manifest->version == "1.2.3");
  CHECK(manifest->summary == "says \"all\"");
  CHECK((manifest->abi_major == 4 && manifest->abi_minor == 9));
  CHECK(manifest->interfaces == std::vector<std::string>{"odo.one/1", "odo.two/1"});
  CHECK(manifest->library == std::filesystem::absolute("/x/all.so"));
  CHECK(manifest->sha256 == std::string(64, 'a'));
  REQUIRE(manifest->parameters.size() == 6);
  const auto specs = required(parameter_specs(plugin));
  for (size_t i = 0; i < 6; ++i)
    for (const Spec* spec : {&manifest->parameters[i], &(*specs)[i]}) {
      CHECK(spec->name == std::string(rows[i].name.data, 1));
      CHECK(spec->type == types[i]);
      CHECK((spec->unit == "m/s" && spec->help == "what it is" && spec->fallback == "0.5" && spec->choices == "a|b"));
      CHECK((spec->min == rows[i].min && spec->max == rows[i].max));
      CHECK(spec->count == (i == 5 ? 4 : 1));
    }
  plugin.parameter_stride = ODO_PARAMETER_SIZE_MIN - 1;
  CHECK_FALSE(parameter_specs(plugin).ok());
  plugin.parameter_stride = 2 * sizeof(odo_parameter);  // wider rows of a newer plugin
  plugin.parameter_count = 3;
  const auto wide = required(parameter_specs(plugin));
  CHECK((*wide)[1].name == "c");
  CHECK((*wide)[2].name == "e");
}

TEST_CASE("a manifest with a path, or without two ABI numbers, is rejected") {
  const auto with = [](const std::string& abi, const std::string& library) {
    return parse_manifest("{odoplugin: 1, id: a/b, version: '1', summary: s, interfaces: [i], abi: " + abi +
                              ", library: " + library + ", sha256: x, parameters: []}",
                          "/x/m.json")
        .ok();
  };
  CHECK(with("[0, 1]", "a.so"));
  CHECK_FALSE(with("[0]", "a.so"));
  CHECK_FALSE(with("[0, 1, 2]", "a.so"));
  CHECK_FALSE(with("[0, 65536]", "a.so"));
  CHECK_FALSE(with("[0, 1]", "../a.so"));
  CHECK_FALSE(with("[0, 1]", "''"));
}

TEST_CASE("a manifest of a later version is read without its new items and without parameters of unknown types") {
  const auto read = [](const std::string& type) {
    return parse_manifest(
        "{odoplugin: 1, id: a/b, version: '1', summary: s, interfaces: [odo.attitude/7, odo.smell/1], "
        "abi: [0, 9], library: a.so, sha256: x, flags: 3, licence: {name: MIT, since: [1, 2]}, "
        "parameters: [{name: gain, type: real, default: '1', advanced: true, presets: {slow: 1}}, "
        "{name: odour, type: " +
            type + ", shape: [3, 3]}]}",
        "/x/m.json");
  };
  const auto known = required(read("string"));
  CHECK(known->id == "a/b");
  REQUIRE(known->parameters.size() == 2);
  CHECK(known->parameters[0].fallback == "1");
  const auto unknown = required(read("matrix"));
  REQUIRE(unknown->parameters.size() == 1);
  CHECK(unknown->parameters[0].name == "gain");
}

TEST_CASE("a default that is no number in the parameter's unit is a fault of the table and of the manifest") {
  odo_parameter gain = row(ODO_PARAMETER_REAL, "a", 0, 1, 0);
  odo_plugin plugin{};
  plugin.parameters = &gain, plugin.parameter_count = 1, plugin.parameter_stride = sizeof gain;
  CHECK(parameter_specs(plugin).ok());
  gain.default_text = text("fast");
  const auto specs = parameter_specs(plugin);
  REQUIRE_FALSE(specs.ok());
  CHECK(specs.failure().text == "parameter 'a': its default 'fast' is no number in m/s");
  const auto manifest = parse_manifest(
      "{odoplugin: 1, id: a/b, version: '1', summary: s, interfaces: [i], abi: [1, 0], library: a.so,\n"
      " parameters: [{name: gain, type: real, default: fast}]}",
      "/x/m.json");
  REQUIRE_FALSE(manifest.ok());
  CHECK(manifest.failure().text.find("/x/m.json:2:") == 0);
}

TEST_CASE("a file's hash is SHA-256 in lower case") {
  const TemporaryFolder folder;
  CHECK(*sha256_of(write_text(folder / "abc", "abc")) ==
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK_FALSE(sha256_of(folder.path()).ok());
  CHECK(is_sha256(std::string(64, 'f')));
  for (const size_t size : {63, 65}) CHECK_FALSE(is_sha256(std::string(size, 'f')));
  CHECK_FALSE(is_sha256(std::string(63, 'f') + "F"));
  CHECK_FALSE(is_sha256(std::string(63, 'f') + "g"));
}

TEST_CASE("a parameter of every type reaches the instance with its value") {
  PluginChoice choice;
  const auto add = [&](const char* name, SpecType type, const Value& value) {
    choice.parameters.emplace_back(Spec{.name = name, .type = type}, value);
  };
  add("a", SpecType::boolean, {.boolean = true}), add("b", SpecType::boolean, {.integer = 5});
  add("c", SpecType::integer, {.integer = -7}), add("d", SpecType::real, {.real = 2.5});
  add("e", SpecType::reals, {.reals = {1, 2, 3}}), add("f", SpecType::choice, {.text = "x"});
  add("g", SpecType::text, {.text = "words"});
  const auto values = values_of(choice);
  const uint32_t types[] = {ODO_PARAMETER_BOOL,  ODO_PARAMETER_BOOL,   ODO_PARAMETER_INT,   ODO_PARAMETER_REAL,
                            ODO_PARAMETER_REALS, ODO_PARAMETER_CHOICE, ODO_PARAMETER_STRING};
  REQUIRE(values.size() == 7);
  for (size_t i = 0; i < 7; ++i) {
    CHECK(values[i].type == types[i]);
    CHECK(values[i].struct_size == sizeof(odo_value));
    CHECK(std::string(values[i].name.data, values[i].name.size) == std::string(1, static_cast<char>('a' + i)));
    CHECK(values[i].count == (i == 3 ? 1 : i == 4 ? 3 : 0));
  }
  CHECK((values[0].integer == 1 && values[1].integer == 0 && values[2].integer == -7));
  CHECK((values[3].reals[0] == 2.5 && values[4].reals[2] == 3));
  CHECK(std::string(values[5].text.data, values[5].text.size) == "x");
  CHECK(std::string(values[6].text.data, values[6].text.size) == "words");
}

TEST_CASE("each kind has the inputs and outputs of the contract's header") {
  struct Kind {
    const char* id;
    std::set<uint32_t> inputs, outputs;
  };
  const Kind kinds[] = {
      {ODO_INTERFACE_ATTITUDE, {ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER, ODO_TYPE_IMU_NOISE}, {ODO_TYPE_ATTITUDE}},
      {ODO_INTERFACE_STEP_ESTIMATOR,
       {ODO_TYPE_IMU, ODO_TYPE_ATTITUDE, ODO_TYPE_BAROMETER, ODO_TYPE_SYSTEM_STEP, ODO_TYPE_FIX},
       {ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE}},
      {ODO_INTERFACE_VO_FRONTEND,
       {ODO_TYPE_CALIBRATION, ODO_TYPE_FRAME, ODO_TYPE_IMU, ODO_TYPE_IMU_NOISE, ODO_TYPE_ATTITUDE},
       {ODO_TYPE_VO_MOTION, ODO_TYPE_REFINED}},
      {ODO_INTERFACE_SCALE_SOURCE,
       {ODO_TYPE_VO_MOTION, ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE, ODO_TYPE_FIX},
       {ODO_TYPE_SCALE}},
      {ODO_INTERFACE_ABSOLUTE_FIXER,
       {ODO_TYPE_GNSS, ODO_TYPE_BAROMETER, ODO_TYPE_WAYPOINT, ODO_TYPE_RANGE, ODO_TYPE_EARTH_FIELD, ODO_TYPE_FRAME,
        ODO_TYPE_CALIBRATION, ODO_TYPE_POSE},
       {ODO_TYPE_FIX, ODO_TYPE_RELATIVE_POSE}},
      {"odo.nothing/1", {}, {}}};
  for (const Kind& kind : kinds) {
    const KindTypes types = kind_types(kind.id);
    CAPTURE(kind.id);
    CHECK(std::set<uint32_t>(types.inputs.begin(), types.inputs.end()) == kind.inputs);
    CHECK(std::set<uint32_t>(types.outputs.begin(), types.outputs.end()) == kind.outputs);
  }
}

TEST_CASE("values replace a config's by key, number and plugin, and their text parses to the same") {
  const auto config = *parse_yaml(
      "odograph: 1\nwalker: {height: 1.7}\nabsolute_fixers:\n  - plugin: fix/gnss\n  - {plugin: fix/waypoint}\n"
      "attitude: {plugin: attitude/vqf}\n",
      "f");
  const auto changed = [&](const std::string& path, const std::string& value) {
    const auto root = with_overrides(config, {{path, value}});
    REQUIRE_MESSAGE(root.ok(), (root.ok() ? "" : root.failure().text));
    const auto again = required(parse_yaml(yaml_text(*root), "again"));
    const YamlNode* node = node_at(*again, path);
    return node ? node->text : "nothing";
  };
  for (const char* path : {"walker.height", "absolute_fixers.0.parameters.x", "absolute_fixers.fix/waypoint.time_limit",
                           "attitude.attitude/vqf.parameters.tau", "coupling.fix_gate", "navigation.start.heading"})
    for (const char* value : {"7", "1.5 m", "'a: b'", "\"x, y\"", "'[1]'", "'#1'", "\"a\\nb\"", "'it''s'"})
      CHECK(changed(path, value) == parse_yaml(value, "v")->text);
  for (const char* path :
       {"walker.hight", "absolute_fixers.2.x", "absolute_fixers.fix/none.x", "odograph.x", "nothing"})
    CHECK_FALSE(with_overrides(config, {{path, "1"}}).ok());
  CHECK(node_at(config, "absolute_fixers.2") == nullptr);
  CHECK(node_at(config, "absolute_fixers.1")->find("plugin")->text == "fix/waypoint");
  CHECK(parse_override("a.b=c=d")->path == "a.b");
  CHECK(parse_override("a.b=c=d")->value == "c=d");
  CHECK(parse_override("a=")->value.empty());
  CHECK_FALSE(parse_override("=c").ok());
  CHECK_FALSE(parse_override("ab").ok());
}

TEST_CASE("a document at the limits of size, depth and count is read, and one beyond is rejected") {
  const auto reads = [](const std::string& text, YamlLimits limits) { return parse_yaml(text, "f", limits).ok(); };
  const std::string nested = "[[[1]]]", four = "a: [1, 2]";  // key, list, two values
  CHECK(reads(nested, {.depth = 3}));
  CHECK_FALSE(reads(nested, {.depth = 2}));
  CHECK(reads(four, {.nodes = 5}));  // including the map
  CHECK_FALSE(reads(four, {.nodes = 4}));
  CHECK(reads(four, {.bytes = four.size()}));
  CHECK_FALSE(reads(four, {.bytes = four.size() - 1}));
  const TemporaryFolder folder;
  const std::string file = write_text(folder / "f", four).string();
  CHECK(read_limited(file, {.bytes = four.size()}).ok());
  CHECK_FALSE(read_limited(file, {.bytes = four.size() - 1}).ok());
  const std::pair<const char*, bool> bytes[] = {{"\x7f", true},
                                                {"\x80", false},
                                                {"\xc2\x80", true},
                                                {"\xc1\xbf", false},
                                                {"\xdf\xbf", true},
                                                {"\xe0\xa0\x80", true},
                                                {"\xef\xbf\xbd", true},
                                                {"\xc3", false},
                                                {"\xe2\x82", false},
                                                {"\xf0\x9f\x99\x82", true},
                                                {"\xf4\x8f\xbf\xbd", true},
                                                {"\xf5\x80\x80\x80", false},
                                                {"\xf0\x9f\x99", false},
                                                {"\xe2\x28\xa1", false},
                                                {"\xe2\x82\xc0", false}};
  for (const auto& [text, good] : bytes) CHECK(reads(std::string("# ") + text, {}) == good);
  const auto tab = parse_yaml("a: 1\n \t b", "f");
  REQUIRE_FALSE(tab.ok());
  CHECK(tab.failure().text.find("f:2:2:") == 0);
}

TEST_CASE("data written to shared memory is read in order, and neither side passes the end") {
  std::vector<uint8_t> memory(64, 0xEE);
  wire::Writer out(std::span<uint8_t>(memory).first(40));
  out.put(uint32_t(7)), out.put(int64_t(-9)), out.put_text("abc"), out.put_bytes(nullptr, 0);
  CHECK(out.size() == 4 + 8 + 8 + 3 + 8);
  const size_t before = out.size();
  out.put_bytes("0123456789", 1);  // leaves 9 bytes
  CHECK((!out.full() && out.size() == 40));
  wire::Reader in(std::span<const uint8_t>(memory).first(out.size()));
  CHECK(in.get<uint32_t>() == 7);
  CHECK(in.get<int64_t>() == -9);
  CHECK(in.get_text() == "abc");
  CHECK(in.get_text().empty());
  CHECK_FALSE(in.empty());
  CHECK(in.get_text() == "0");
  CHECK((in.good() && in.empty()));
  CHECK(in.get<uint8_t>() == 0);
  CHECK_FALSE(in.good());
  out.rewind(before);
  out.put_bytes("0123456789", 2);  // one too many: nothing is written
  CHECK((out.full() && out.size() == before));
  CHECK(std::count(memory.begin() + 40, memory.end(), 0xEE) == 24);
  uint64_t size = 33;
  std::memcpy(memory.data(), &size, sizeof size);
  wire::Reader longer(std::span<const uint8_t>(memory).first(40));
  CHECK(longer.get_bytes().empty());
  CHECK_FALSE(longer.good());
}
