// SPDX-License-Identifier: Apache-2.0
//
// Defaults of configs, camera.yaml and manifests: every key, every unit, every limit.
#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/config/manifest.hpp"
#include "sdk/host/config/overrides.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/config/table.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("config_limits");

namespace {

PipelineConfig read(const std::string& yaml) {
  auto config = required(read_pipeline_config("odograph: 1\n" + yaml, "f.yaml", {plugin_folder()}, {"/folder"}));
  return std::move(*config);
}

const std::string kLens = "width: 640\nheight: 480\nfx: 431.5\nfy: 432.5\ncx: 320.25\ncy: 240.75\n";

Result<odo_calibration> lens(const std::string& more, double* fps = nullptr) {
  const TemporaryFolder folder;
  return read_camera_yaml(write_text(folder / "camera.yaml", kLens + more), fps);
}

const PluginResolver kNoPlugins = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
  return Failure{ODO_E_CONFIG, "no plugins here"};
};

bool accepts(const Spec& spec, const std::string& value) {
  const auto node = parse_yaml("key: " + value, "t");
  Spec one = spec;
  one.name = "key";
  return node.ok() && validate(*node, table::map("root", "", {one}), "t", kNoPlugins).ok();
}

}  // namespace

TEST_CASE("omitted keys of a config have the struct's defaults") {
  const PipelineConfig c = read("attitude: {plugin: attitude/vqf}\n");
  const CouplingConfig coupling;
  const OrderingConfig ordering;
  const Isolation isolation;
  CHECK(c.library_check == LibraryCheck::hash);
  CHECK_FALSE(c.origin);
  CHECK_FALSE(c.camera);
  CHECK_FALSE(c.start.given);
  CHECK_FALSE(c.start.heading_given);
  CHECK(c.ordering.max_wait_s == ordering.max_wait_s);
  CHECK(c.ordering.max_gap_s == ordering.max_gap_s);
  CHECK(c.ordering.queue == ordering.queue);
  CHECK(c.ordering.frames == ordering.frames);
  CHECK(c.coupling.type == coupling.type);
  CHECK(c.coupling.orientation == coupling.orientation);
  CHECK(c.coupling.vertical == coupling.vertical);
  CHECK(c.coupling.fix_gate_sigma == coupling.fix_gate_sigma);
  CHECK(c.coupling.bridge_s == coupling.bridge_s);
  CHECK(c.coupling.fastest_mps == coupling.fastest_mps);
  CHECK(c.coupling.odometry_covariance == coupling.odometry_covariance);
  CHECK_FALSE(c.replay.start_at_first_waypoint);
  CHECK(c.replay.align_heading_over_m == 0);
  REQUIRE(c.attitudes.size() == 1);
  CHECK(c.attitudes[0].isolation.kind == isolation.kind);
  CHECK(c.attitudes[0].isolation.time_s == isolation.time_s);
  CHECK(c.attitudes[0].isolation.start_s == isolation.start_s);
  CHECK(c.attitudes[0].isolation.memory_bytes == isolation.memory_bytes);
  CHECK(c.attitudes[0].isolation.program.empty());
  CHECK_FALSE(c.attitudes[0].fallback);
}

TEST_CASE("each choice in a config selects its value" * doctest::skip(!kCameraPlugins)) {
  const std::pair<const char*, std::function<bool(const PipelineConfig&)>> choices[] = {
      {"type: paper", [](const auto& c) { return c.coupling.type == CouplingType::paper; }},
      {"type: localizer", [](const auto& c) { return c.coupling.type == CouplingType::localizer; }},
      {"orientation: vo", [](const auto& c) { return c.coupling.orientation == Orientation::vo; }},
      {"orientation: gyroscope", [](const auto& c) { return c.coupling.orientation == Orientation::gyroscope; }},
      {"orientation: attitude", [](const auto& c) { return c.coupling.orientation == Orientation::attitude; }},
      {"vertical: ignore", [](const auto& c) { return c.coupling.vertical == Vertical::ignore; }},
      {"vertical: scaled", [](const auto& c) { return c.coupling.vertical == Vertical::scaled; }},
  };
  for (const auto& choice : choices) {
    const std::string text = choice.first;
    CHECK_MESSAGE(choice.second(read("coupling: {" + text + "}\n")), text);
  }
  const std::map<std::string, Isolation::Kind> kinds = {{"none", Isolation::Kind::none},
                                                        {"process", Isolation::Kind::process}};
  for (const auto& [general, kind] : kinds)
    for (const auto& [own, own_kind] : kinds) {
      const std::string plugins = "plugins: {isolation: " + general + ", host: bin/host}\nattitude: ";
      const PipelineConfig a = read(plugins + "{plugin: attitude/vqf}\n");
      const PipelineConfig b = read(plugins + "{plugin: attitude/vqf, isolation: " + own + "}\n");
      CHECK(a.attitudes[0].isolation.kind == kind);
      CHECK(b.attitudes[0].isolation.kind == own_kind);
      CHECK(a.attitudes[0].isolation.program == std::filesystem::path("/folder/bin/host"));
    }
}

TEST_CASE("a start without heading, an origin without height, and plugins of each kind are read into their own fields" *
          doctest::skip(!kCameraPlugins)) {
  const PipelineConfig a =
      read("navigation: {start: {position: [1, -2, 3]}, origin: {latitude: 0.5, longitude: -1}}\n");
  CHECK(a.start.given);
  CHECK_FALSE(a.start.heading_given);
  CHECK(a.start.position_m == std::array<double, 3>{1, -2, 3});
  REQUIRE(a.origin);
  CHECK(*a.origin == std::array<double, 3>{0.5, -1, 0});
  CHECK_FALSE(read("navigation: {start: {heading: 1}}\n").origin);
  const PipelineConfig b = read(
      "attitude: [{plugin: attitude/vqf}, {plugin: attitude/magyq}]\nstep_estimator: {plugin: step/odograph}\n"
      "vo_frontend: {plugin: vo/five_point, fallback: vo/five_point, time_limit: 7 s}\n"
      "scale_source: {plugin: scale/step_length}\nabsolute_fixers: [{plugin: fix/gnss}, {plugin: fix/waypoint}]\n");
  const auto ids = [](const std::vector<PluginChoice>& choices) {
    std::string all;
    for (const PluginChoice& each : choices) all += each.manifest.id + " ";
    return all;
  };
  CHECK(ids(b.attitudes) == "attitude/vqf attitude/magyq ");
  CHECK(ids(b.step_estimators) == "step/odograph ");
  CHECK(ids(b.vo_frontends) == "vo/five_point ");
  CHECK(ids(b.scale_sources) == "scale/step_length ");
  CHECK(ids(b.fixers) == "fix/gnss fix/waypoint ");
  REQUIRE(b.vo_frontends[0].fallback);
  CHECK(b.vo_frontends[0].fallback->isolation.time_s == 7);
  CHECK(b.vo_frontends[0].fallback->interface_id == b.vo_frontends[0].interface_id);
  for (const char* alone : {"step_estimator: {plugin: step/odograph}", "scale_source: {plugin: scale/step_length}",
                            "plugins: {allow: []}", "plugins: {signers: []}"})
    CHECK_FALSE(read_pipeline_config(std::string("odograph: 1\n") + alone, "f", {plugin_folder()}).ok());
}

TEST_CASE("a camera has a mount if either part of it is given, and any other item only if it is given") {
  const auto plain = required(lens(""));
  CHECK(plain->header.flags == 0);
  CHECK(plain->model == ODO_CAMERA_PINHOLE);
  CHECK((plain->width == 640 && plain->height == 480 && plain->header.source == 0 && plain->distortion_count == 0));
  CHECK((plain->fx == 431.5 && plain->fy == 432.5 && plain->cx == 320.25 && plain->cy == 240.75));
  const auto q = lens("q_b_c: [0.5, -0.5, 0.5, 0.5]\n"), p = lens("p_b_c: [1 cm, -2, 3]\n"),
             both = lens("q_b_c: [0.6, 0, 0, 0.8]\np_b_c: [1, 2, 3]\n");
  for (const auto* each : {&q, &p, &both}) {
    REQUIRE(each->ok());
    CHECK((**each).header.flags == ODO_CALIBRATION_EXTRINSICS);
  }
  CHECK((q->q_b_c[0] == 0.5 && q->q_b_c[1] == -0.5 && q->q_b_c[2] == 0.5 && q->q_b_c[3] == 0.5));
  CHECK((q->p_b_c[0] == 0 && q->p_b_c[1] == 0 && q->p_b_c[2] == 0));
  CHECK((p->q_b_c[0] == 0 && p->q_b_c[1] == 1 && p->q_b_c[2] == 0 && p->q_b_c[3] == 0));  // a rear camera
  CHECK((p->p_b_c[0] == 0.01 && p->p_b_c[1] == -2 && p->p_b_c[2] == 3));
  CHECK((both->q_b_c[3] == doctest::Approx(0.8) && both->p_b_c[2] == 3));
  const auto offset = lens("time_offset: -12.5 ms\n"), rows = lens("row_time: 10 us\n");
  CHECK(offset->header.flags == ODO_CALIBRATION_TIME_OFFSET);
  CHECK((offset->time_offset_ns == -12'500'000 && offset->line_time_ns == 0));
  CHECK(rows->header.flags == ODO_CALIBRATION_LINE_TIME);
  CHECK((rows->line_time_ns == 10'000 && rows->time_offset_ns == 0));
  CHECK(lens("model: kannala_brandt\n")->model == ODO_CAMERA_KANNALA_BRANDT);
  double fps = 0;
  CHECK((lens("", &fps).ok() && fps == 30));
  CHECK((lens("fps: 25\n", &fps).ok() && fps == 25));
}

TEST_CASE("a camera's quaternion of norm near 1 is normalised, and its distortion has 0, 4, 5 or 8 coefficients") {
  for (const auto& [w, good] : {std::pair{1.009, true}, {0.991, true}, {0.989, false}, {0.0, false}}) {
    const auto c = lens("q_b_c: [" + std::to_string(std::min(w, 1.0)) + ", 0, 0, " +
                        std::to_string(w > 1 ? std::sqrt(w * w - 1) : 0.0) + "]\n");
    const double scalar = w;
    CAPTURE(scalar);
    REQUIRE(c.ok() == good);
    if (good) CHECK(std::hypot(c->q_b_c[0], c->q_b_c[3]) == doctest::Approx(1).epsilon(1e-12));
  }
  CHECK_FALSE(lens("q_b_c: [1, 0, 0, 0.15]\n").ok());
  std::string list = "distortion: [";
  for (uint32_t count = 0; count <= 9; ++count) {
    const auto c = lens(list + "]\n");
    const bool good = count == 0 || count == 4 || count == 5 || count == 8;
    CAPTURE(count);
    REQUIRE(c.ok() == good);
    if (good) CHECK(c->distortion_count == count);
    for (uint32_t i = 0; good && i < 8; ++i) CHECK(c->distortion[i] == (i < count ? 0.25 * (i + 1) : 0));
    list += (count ? ", " : "") + std::to_string(0.25 * (count + 1));
  }
}

TEST_CASE("every unit has its factor, and is accepted for its own quantity only") {
  const double degree = std::acos(-1.0) / 180;
  struct Unit {
    const char *name, *si;
    double factor;
  };
  const Unit units[] = {{"m", "m", 1},
                        {"mm", "m", 1e-3},
                        {"cm", "m", 1e-2},
                        {"km", "m", 1e3},
                        {"s", "s", 1},
                        {"ms", "s", 1e-3},
                        {"us", "s", 1e-6},
                        {"ns", "s", 1e-9},
                        {"min", "s", 60},
                        {"rad", "rad", 1},
                        {"deg", "rad", degree},
                        {"mrad", "rad", 1e-3},
                        {"m/s", "m/s", 1},
                        {"km/h", "m/s", 1 / 3.6},
                        {"m/s^2", "m/s^2", 1},
                        {"rad/s", "rad/s", 1},
                        {"deg/s", "rad/s", degree},
                        {"Hz", "Hz", 1},
                        {"Pa", "Pa", 1},
                        {"hPa", "Pa", 100},
                        {"T", "T", 1},
                        {"uT", "T", 1e-6},
                        {"px", "px", 1}};
  for (const Unit& unit : units)
    for (const Unit& other : units) {
      const auto value = parse_quantity("-2.5 " + std::string(unit.name), other.si);
      CAPTURE(unit.name);
      CAPTURE(other.si);
      REQUIRE(value.ok() == (std::string(unit.si) == other.si));
      if (value.ok()) CHECK(*value / (-2.5 * unit.factor) == doctest::Approx(1).epsilon(1e-14));
    }
  for (const Unit& unit : units) CHECK(compatible_units(unit.si).front() == unit.si);
  CHECK(*parse_quantity("-2.5e-3", "") == -0.0025);
  for (const char* none : {"", "nan", "1e999"}) CHECK_FALSE(parse_quantity(none, "m").ok());
  CHECK_FALSE(parse_quantity("1 m", "").ok());
  CHECK_FALSE(parse_quantity("1 m 2", "m").ok());
  CHECK(compatible_units("").empty());
}

TEST_CASE("numbers are accepted at their limits and rejected beyond, integers too, and quoted ones always") {
  using namespace table;
  for (const auto& [value, good] : std::map<std::string, bool>{
           {"-1", true}, {"2.5", true}, {"-1.000001", false}, {"2.500001", false}, {"1e1", false}, {"x", false}}) {
    const std::string written = value;
    CAPTURE(written);
    CHECK(accepts(real("k", "m", -1, 2.5, "0", ""), value) == good);
    CHECK(accepts({.type = SpecType::reals, .min = -1, .max = 2.5, .count = 2}, "[0, " + value + "]") == good);
    CHECK(accepts({.type = SpecType::list, .children = {real("k", "", -1, 2.5, "0", "")}}, "[1, " + value + "]") ==
          good);
    if (value != "x") CHECK(accepts(real("k", "m", 0, 0, "0", ""), value));  // no bounds
  }
  for (const auto& [value, good] : std::map<std::string, bool>{
           {"0", true}, {"7", true}, {"8", false}, {"-1", false}, {"1.0", false}, {"\"3\"", false}, {"3 m", false}})
    CHECK(accepts(integer("k", 0, 7, "0", ""), value) == good);
  CHECK(accepts(real("k", "m", 0, 3, "0", ""), "200 cm"));
  CHECK_FALSE(accepts(real("k", "m", 0, 3, "0", ""), "400 cm"));
  for (const auto& [value, good] :
       std::map<std::string, bool>{{"true", true}, {"false", true}, {"\"true\"", false}, {"True", false}, {"1", false}})
    CHECK(accepts(boolean("k", "true", ""), value) == good);
  CHECK(accepts(choice("k", "a|b", "a", ""), "b"));
  CHECK_FALSE(accepts(choice("k", "a|b", "a", ""), "a|b"));
  CHECK_FALSE(accepts({.type = SpecType::reals, .count = 2}, "[1, 2, 3]"));
  CHECK_FALSE(accepts({.type = SpecType::reals, .count = 2}, "[1]"));
  for (const auto type : {SpecType::real, SpecType::integer, SpecType::boolean, SpecType::choice, SpecType::text})
    CHECK_FALSE(accepts({.type = type}, "null"));
}

TEST_CASE("a default equals the value of its text for every type") {
  CHECK(default_value({.type = SpecType::boolean, .fallback = "true"}).boolean);
  CHECK_FALSE(default_value({.type = SpecType::boolean, .fallback = "false"}).boolean);
  CHECK(default_value({.type = SpecType::integer, .fallback = "-12"}).integer == -12);
  CHECK(default_value({.type = SpecType::real, .unit = "m", .fallback = "3 cm"}).real == 0.03);
  CHECK(default_value({.type = SpecType::real}).real == 0);
  CHECK(default_value({.type = SpecType::text, .fallback = "x"}).text == "x");
  CHECK(default_value({.type = SpecType::reals, .fallback = "[1, -2.5, 3]", .count = 3}).reals ==
        std::vector<double>{1, -2.5, 3});
  CHECK(default_value({.type = SpecType::reals, .fallback = "[1]", .count = 2}).reals == std::vector<double>{1, 0});
  CHECK_FALSE(default_value({.type = SpecType::real}).given);
}
