// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <rapidcheck.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/config/overrides.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/simulation/scenario.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("config");

namespace {

std::string mistake(const std::string& yaml) {
  const auto config = read_pipeline_config(yaml, "f.yaml", {plugin_folder()});
  REQUIRE_FALSE(config.ok());
  CHECK(config.failure().status != ODO_OK);
  return config.failure().text;
}

}  // namespace

TEST_CASE("every setting of a config is read into its own field") {
  const auto config = required(read_pipeline_config(
      "odograph: 1\nplugins: {verify_hash: false}\n"
      "navigation:\n  origin: {latitude: 47 deg, longitude: 8 deg, height: 400 m}\n"
      "  start: {position: [1 m, 2 m, 3 m], heading: 0.4 rad}\n"
      "time_ordering: {max_wait: 0.31 s, max_gap: 2.5 s, queue: 777, frames: 5}\n"
      "vo_frontend: {plugin: vo/five_point, isolation: process, time_limit: 3 s, start_limit: 11 s, memory_limit: "
      "300}\n"
      "coupling: {type: localizer, orientation: gyroscope, vertical: scaled, fix_gate: 4.5, bridge: 7 s,\n"
      "           fastest: 13 m/s, odometry_covariance: 2.25}\n"
      "replay: {start_at_first_waypoint: true, align_heading_over: 17 m}\n",
      "f.yaml", {plugin_folder()}));
  const PipelineConfig& c = *config;
  CHECK(c.library_check == LibraryCheck::none);
  REQUIRE(c.origin);
  CHECK((*c.origin)[0] == doctest::Approx(47 * EIGEN_PI / 180).epsilon(1e-12));
  CHECK((*c.origin)[1] == doctest::Approx(8 * EIGEN_PI / 180).epsilon(1e-12));
  CHECK((*c.origin)[2] == 400);
  CHECK(c.start.position_m == std::array<double, 3>{1, 2, 3});
  CHECK(c.start.heading_rad == 0.4);
  CHECK(c.start.given);
  CHECK(c.start.heading_given);
  CHECK(c.ordering.max_wait_s == 0.31);
  CHECK(c.ordering.max_gap_s == 2.5);
  CHECK(c.ordering.queue == 777);
  CHECK(c.ordering.frames == 5);
  CHECK(c.coupling.type == CouplingType::localizer);
  CHECK(c.coupling.orientation == Orientation::gyroscope);
  CHECK(c.coupling.vertical == Vertical::scaled);
  CHECK(c.coupling.fix_gate_sigma == 4.5);
  CHECK(c.coupling.bridge_s == 7);
  CHECK(c.coupling.fastest_mps == 13);
  CHECK(c.coupling.odometry_covariance == 2.25);
  CHECK(c.replay.start_at_first_waypoint);
  CHECK(c.replay.align_heading_over_m == 17);
  REQUIRE(c.vo_frontends.size() == 1);
  CHECK(c.vo_frontends[0].isolation.kind == Isolation::Kind::process);
  CHECK(c.vo_frontends[0].isolation.time_s == 3);
  CHECK(c.vo_frontends[0].isolation.start_s == 11);
  CHECK(c.vo_frontends[0].isolation.memory_bytes == 300ULL << 20);
}

TEST_CASE("every broken config is reported with its location, the expected value and the nearest key") {
  struct Case {
    const char* what;
    std::string yaml;
    std::string place;
    std::vector<std::string> expected_texts;
  };
  std::string bomb =
      "odograph: 1\na: &a [x,x,x,x,x,x,x,x,x]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b,*b,*b,*b,*b]\n";
  std::string deep = "odograph: 1\nplugins: ";
  for (int i = 0; i < 200; ++i) deep += "[";
  deep += std::string(200, ']');
  std::string many = "odograph: 1\nplugins:\n  allow: [";
  for (int i = 0; i < 120000; ++i) many += "a,";
  many += "a]";
  const Case cases[] = {
      {"empty", "", "f.yaml:1:1:", {"empty", "expected", "odograph: 1"}},
      {"comments only", "# nothing\n", "f.yaml:1:1:", {"empty", "expected"}},
      {"unknown key",
       "odograph: 1\natitude:\n  plugin: attitude/vqf\n",
       "f.yaml:2:1:",
       {"unknown key 'atitude'", "expected", "nearest: 'attitude'"}},
      {"unknown nested key",
       "odograph: 1\ncoupling:\n  verticl: ignore\n",
       "f.yaml:3:3:",
       {"verticl", "nearest: 'vertical'"}},
      {"wrong type", "odograph: 1\nwalker: tall\n", "f.yaml:2:9:", {"'tall'", "expected a map", "height"}},
      {"a camera that is not there", "odograph: 1\ncamera: nowhere.yaml\n", "f.yaml:2:9:", {"camera:", "nowhere.yaml"}},
      {"not a number",
       "odograph: 1\nwalker:\n  height: tall\n",
       "f.yaml:3:11:",
       {"not a number", "expected a number in m"}},
      {"out of range", "odograph: 1\nwalker:\n  height: 17 m\n", "f.yaml:3:11:", {"out of range", "from 0.5 to 2.5"}},
      {"bad unit",
       "odograph: 1\nwalker:\n  height: 1.7 mm2\n",
       "f.yaml:3:11:",
       {"unit 'mm2'", "expected one of m, mm", "nearest: 'mm'"}},
      {"unit of another quantity",
       "odograph: 1\nwalker:\n  height: 1.7 s\n",
       "f.yaml:3:11:",
       {"unit 's'", "expected one of m"}},
      {"bad choice",
       "odograph: 1\ncoupling:\n  vertical: ignroe\n",
       "f.yaml:3:13:",
       {"'ignroe'", "one of ignore, scaled", "nearest: 'ignore'"}},
      {"removed choice of a plugin",
       "odograph: 1\nattitude: {plugin: attitude/vqf, isolation: thread}\n",
       "f.yaml:2:45:",
       {"attitude.isolation: 'thread' was removed, its successor is 'process'", "one of none, process"}},
      {"removed choice of all plugins",
       "odograph: 1\nplugins:\n  isolation: thread\n",
       "f.yaml:3:14:",
       {"plugins.isolation: 'thread' was removed, its successor is 'process'", "one of none, process"}},
      {"missing plugin",
       "odograph: 1\nattitude:\n  plugin: attitude/vqff\n",
       "f.yaml:3:11:",
       {"no plugin 'attitude/vqff'", "nearest: 'attitude/vqf'"}},
      {"plugin of another kind",
       "odograph: 1\nattitude:\n  plugin: fix/gnss\n",
       "f.yaml:3:11:",
       {"fix/gnss", "odo.attitude/1"}},
      {"no plugin named", "odograph: 1\nattitude:\n  parameters: {}\n", "f.yaml:3:3:", {"'plugin' is missing"}},
      {"unknown parameter",
       "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  parameters:\n    tau_ac: 3\n",
       "f.yaml:5:5:",
       {"unknown key 'tau_ac'", "nearest: 'tau_acc'"}},
      {"parameter out of range",
       "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  parameters:\n    tau_acc: -3 s\n",
       "f.yaml:5:14:",
       {"out of range", "from 0.1 to 60"}},
      {"parameter of the wrong length",
       "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  parameters:\n    forward_axis: [1, 0]\n",
       "f.yaml:5:19:",
       {"list of 2", "expected a list of 3 numbers"}},
      {"duplicate key",
       "odograph: 1\nwalker:\n  height: 1.7\n  height: 1.8\n",
       "f.yaml:4:3:",
       {"second time", "line 3", "expected it once"}},
      {"tab indentation", "odograph: 1\nwalker:\n\theight: 1.7\n", "f.yaml:3:1:", {"tab", "expected spaces"}},
      {"alias bomb", bomb, "f.yaml:2:", {"anchors", "expected"}},
      {"alias without anchor", "odograph: 1\nwalker: *w\n", "f.yaml:2:", {"expected"}},
      {"a node that contains itself", "odograph: 1\nwalker: &w\n  height: *w\n", "f.yaml:2:", {"anchors", "expected"}},
      {"too deep", deep, "f.yaml:2:", {"levels deep", "expected"}},
      {"too many nodes", many, "f.yaml:3:", {"values", "expected"}},
      {"tag", "odograph: !!int 1\n", "f.yaml:1:", {"tags", "expected"}},
      {"second document", "odograph: 1\n---\nodograph: 1\n", "f.yaml:3:", {"second document", "expected one"}},
      {"not UTF-8", "odograph: 1\n# \xff\xfe\n", "f.yaml:2:3:", {"UTF-8"}},
      {"NUL", std::string("odograph: 1\n\0", 13), "f.yaml:2:", {"NUL"}},
      {"unclosed quote", "odograph: 1\nwalker: \"tall\n", "f.yaml:", {"expected"}},
      {"a list at the top", "- odograph\n", "f.yaml:1:1:", {"a list", "expected a map", "odograph"}},
      {"a scalar at the top", "odograhp\n", "f.yaml:1:1:", {"expected a map", "did you mean 'odograph'"}},
      {"version missing", "walker:\n  height: 1.7\n", "f.yaml:1:1:", {"'odograph' is missing", "expected"}},
      {"another version", "odograph: 2\n", "f.yaml:1:11:", {"out of range"}},
      {"nothing behind a key", "odograph:\n", "f.yaml:", {"nothing", "expected a whole number"}},
      {"boolean in words", "odograph: 1\nplugins:\n  verify_hash: yes\n", "f.yaml:3:16:", {"'yes'", "true or false"}},
      {"steps without attitude",
       "odograph: 1\nstep_estimator:\n  plugin: step/renaudin2012\n",
       "f.yaml:3:3:",
       {"attitude"}},
      {"not allowed",
       "odograph: 1\nplugins:\n  allow: [fix/gnss]\nattitude:\n  plugin: attitude/vqf\n",
       "f.yaml:5:11:",
       {"allow list", "expected"}},
  };
  for (const Case& c : cases) {
    CAPTURE(std::string(c.what));
    const std::string text = mistake(c.yaml);
    CAPTURE(text);
    CHECK(text.compare(0, c.place.size(), c.place) == 0);
    for (const auto& part : c.expected_texts) CHECK(contains(text, part));
  }
}

TEST_CASE("a file of 100 MB is rejected without being read") {
  const TemporaryFolder folder;
  const auto path = folder / "large.yaml";
  write_text(path, "odograph: 1\n");
  std::filesystem::resize_file(path, 100'000'000);
  const auto config = read_pipeline_config_file(path.string(), {});
  REQUIRE_FALSE(config.ok());
  CHECK(contains(config.failure().text, "large.yaml:1:1: the file has 100000000 bytes; expected at most"));
}

TEST_CASE("one pass finds all mistakes of a file") {
  const std::string text = mistake("odograph: 1\nwalker:\n  height: 9\ncoupling:\n  vertical: up\nplugin: 3\n");
  CHECK(contains(text, "f.yaml:3:11:"));
  CHECK(contains(text, "f.yaml:5:13:"));
  CHECK(contains(text, "f.yaml:6:1:"));
}

TEST_CASE("the walker's height reaches the plugins unless they have their own") {
  const auto height = [](const std::string& parameters) {
    const auto config = required(read_pipeline_config(
        "odograph: 1\nwalker:\n  height: 182 cm\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n"
        "  plugin: step/renaudin2012\n" +
            parameters,
        "f.yaml", {plugin_folder()}));
    for (const auto& [spec, value] : config->step_estimators.front().parameters)
      if (spec.name == "walker_height") return value.real;
    return 0.0;
  };
  CHECK(height("") == doctest::Approx(1.82));
  CHECK(height("  parameters:\n    walker_height: 1.6\n") == doctest::Approx(1.6));
}

TEST_CASE("fix/terrain's height is the walker's unless given, and no other plugin's height is") {
  const auto height = [](const std::string& id, const std::string& parameters) {
    const auto config =
        required(read_pipeline_config("odograph: 1\nwalker: {height: 1.9 m}\nabsolute_fixers:\n  - plugin: " + id +
                                          "\n    parameters: {" + parameters + "}\n",
                                      "f.yaml", {plugin_folder()}));
    for (const auto& [spec, value] : config->fixers.front().parameters)
      if (spec.name == "height") return value;
    return Value();
  };
  CHECK(height("fix/terrain", "model: hill.obj").real == doctest::Approx(1.9));
  CHECK(height("fix/terrain", "model: hill.obj, height: 1.5 m").real == doctest::Approx(1.5));
  CHECK(height("fix/gnss", "sigma: 5 m").real == 0);  // whether its heights are used
}

TEST_CASE("a fallback plugin gets the walker's height as well") {
  const auto config = required(read_pipeline_config(
      "odograph: 1\nwalker:\n  height: 182 cm\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n"
      "  plugin: step/odograph\n  fallback: step/renaudin2012\n",
      "f.yaml", {plugin_folder()}));
  const auto& fallback = config->step_estimators.front().fallback;
  REQUIRE(fallback);
  double height_m = 0;
  for (const auto& [spec, value] : fallback->parameters)
    if (spec.name == "walker_height") height_m = value.real;
  CHECK(height_m == doctest::Approx(1.82));
}

TEST_CASE("the parser does not crash on random bytes and YAML-like text") {
  rc::check("random YAML", [] {
    const auto pieces = *rc::gen::container<std::vector<std::string>>(rc::gen::element<std::string>(
        "odograph: 1", "\n", "  ", "\t", "- ", "{", "}", "[", "]", ":", "&a", "*a", "!!x", "'", "\"", "#", "walker",
        "height", "1.7 m", "---", "? ", "|", ">", "\\", "\xff"));
    std::string text;
    for (const auto& piece : pieces) text += piece;
    (void)read_pipeline_config(text, "f.yaml", {});
  });
}

TEST_CASE("the sample configs are valid, and the schemas match the tables and the samples") {
  const std::pair<const char*, std::string> schemas[] = {
      {"pipeline.schema.json", json_schema(pipeline_spec(), "Odograph pipeline config")},
      {"camera.schema.json", json_schema(camera_spec(), "Odograph camera.yaml")},
      {"scenario.schema.json", json_schema(scenario_spec(), "Odograph simulation scenario")},
      {"odoplugin.schema.json", json_schema(manifest_spec(), "Odograph plugin manifest")}};
  for (const auto& schema : schemas) {
    CAPTURE(schema.first);
    CHECK(read_text(source("schemas") / schema.first) == schema.second);
  }
  for (const auto& entry : std::filesystem::directory_iterator(source("samples/configs"))) {
    if (entry.path().extension() != ".yaml") continue;
    CAPTURE(entry.path().string());
    const auto config = read_pipeline_config_file(entry.path().string(), {plugin_folder()});
    CHECK_MESSAGE(config.ok(), (config.ok() ? "" : config.failure().text));
  }
  for (const auto& entry : std::filesystem::directory_iterator(source("samples/scenarios")))
    CHECK(read_scenario(entry.path().string()).ok());
  // Every manifest of the build satisfies the schema.
  const auto schema_json = nlohmann::json::parse(schemas[3].second);
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
  int manifests = 0;
  for (const auto& entry : std::filesystem::directory_iterator(plugin_folder())) {
    if (entry.path().extension() != ".json") continue;
    const auto manifest = nlohmann::json::parse(read_text(entry.path()));
    valijson::Validator validator;
    CHECK(validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(manifest), nullptr));
    ++manifests;
  }
  CHECK(manifests >= 8);
}

TEST_CASE("a file named relative to a config is found from any folder, with and without replaced values") {
  const TemporaryFolder folder, elsewhere;
  write_text(folder / "lens.yaml", "width: 640\nheight: 480\nfx: 431.5\nfy: 432.5\ncx: 320\ncy: 240\n");
  const std::string yaml =
      "odograph: 1\ncamera: lens.yaml\nplugins:\n  search: [mine, ../theirs, /ours]\n  isolation: none\n"
      "  host: bin/host\n  allow: [vqf.odoplugin.json, attitude/vqf]\n";
  write_text(folder / "vqf.odoplugin.json", "{}");
  const std::string file = write_text(folder / "c.yaml", yaml).string();
  CHECK(*effective_config(file, {}) == yaml);
  const auto text = required(effective_config(file, {{"coupling.fix_gate", "4"}, {"time_ordering.queue", "77"}}));
  const auto root = required(parse_yaml(*text, "c.yaml"));
  const auto value = [&](const char* path) {
    const YamlNode* node = node_at(*root, path);
    return node ? node->text : "";
  };
  CHECK(value("camera") == (folder / "lens.yaml").string());
  CHECK(value("plugins.search.0") == (folder / "mine").string());
  CHECK(value("plugins.search.1") == (folder / "../theirs").string());
  CHECK(value("plugins.search.2") == "/ours");
  CHECK(value("plugins.host") == (folder / "bin/host").string());
  CHECK(value("plugins.allow.0") == (folder / "vqf.odoplugin.json").string());
  CHECK(value("plugins.allow.1") == "attitude/vqf");
  CHECK(value("plugins.isolation") == "none");
  CHECK(value("coupling.fix_gate") == "4");
  const auto config = required(read_pipeline_config_file(write_text(elsewhere / "c.yaml", *text).string(), {}));
  REQUIRE(config->camera);
  CHECK(config->camera->fx == 431.5);
  CHECK(config->ordering.queue == 77);
}

TEST_CASE("a camera file of a config that is not one is reported without quoting its content") {
  const TemporaryFolder folder;
  for (const std::string secret : {"root:x:0:0:root:/root:/bin/bash\ndaemon:x:1:1\n", "hunter2\n", "token: hunter2\n",
                                   "- hunter2\n- x\n", "-----BEGIN PRIVATE KEY-----\nhunter2\n"}) {
    write_text(folder / "secret", secret);
    const auto config =
        read_pipeline_config("odograph: 1\ncamera: " + (folder / "secret").string() + "\n", "f.yaml", {});
    REQUIRE_FALSE(config.ok());
    const std::string& text = config.failure().text;
    CHECK_MESSAGE(contains(text, "no camera's description; expected a map with width"), text);
    for (const char* part : {"root:x", "daemon", "hunter", "token", "BEGIN"})
      CHECK_MESSAGE(!contains(text, part), text);
  }
}
