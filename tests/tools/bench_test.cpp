// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <csignal>

#include "sdk/host/config/overrides.hpp"
#include "sdk/tools/benchmarks/bench_case.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/validator/child.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("bench");

namespace {

const std::string kConfigFile = source("samples/configs/walk_gnss.yaml").string();

/// A benchmark without a pipeline: squares of numbers; appends a line to a file for each number measured.
struct Squares : Benchmark {
  explicit Squares(const TemporaryFolder& folder) : Benchmark("squares", "", kSeeds), log(folder / "log") {
    options.keep = (folder / "kept").string();
    options.seeds = 7, options.first_seed = 0;
  }
  Result<Json> measure(const BenchCase& one) const override {
    std::ofstream(log, std::ios::app) << one.seed << '\n';
    if (one.seed % 2 == 0) usleep(20000);  // later cases finish earlier
    return Json{{"square", static_cast<double>(one.seed * one.seed) / 3}, {"_samples", {one.seed, 2 * one.seed}}};
  }
  BenchReport report(const Rows&) const override { return {}; }

  Rows rows() {
    const auto found = required(rows_of(*this, *cases()));
    return *found;
  }
  size_t measured() const {
    std::ifstream file(log);
    return static_cast<size_t>(std::count(std::istreambuf_iterator<char>(file), {}, '\n'));
  }

  std::filesystem::path log;
};

/// A single run.
struct One : Benchmark {
  One(const TemporaryFolder& folder, std::function<Result<Json>(const BenchCase&)> call)
      : Benchmark("one", "", kRecordings), how(std::move(call)) {
    options.keep = (folder / "kept").string();
  }
  Result<Json> measure(const BenchCase& one) const override { return how(one); }
  BenchReport report(const Rows&) const override { return {}; }

  std::function<Result<Json>(const BenchCase&)> how;
};

std::string failure_of(const std::vector<Override>& overrides) {
  RunOptions options{.config = kConfigFile, .overrides = overrides};
  const auto config = config_of(options);
  return config ? "" : config.failure().text;
}

}  // namespace

TEST_CASE("rows come in case order and are bit-identical for any number of parallel runs") {
  std::string first;
  for (const size_t jobs : {1, 3, 20}) {
    const TemporaryFolder folder;
    Squares squares(folder);
    squares.options.jobs = jobs;
    const Rows rows = squares.rows();
    REQUIRE(rows.size() == 7);
    for (int i = 0; i < 7; ++i) CHECK(rows[static_cast<size_t>(i)]["seed"] == i);
    if (first.empty()) first = Json(rows).dump();
    CHECK(Json(rows).dump() == first);
  }
}

TEST_CASE("a row measured before is reused, unless its inputs have changed or a fresh one is requested") {
  const TemporaryFolder folder;
  Squares squares(folder);
  const Rows first = squares.rows();
  CHECK(squares.measured() == 7);
  CHECK(squares.rows() == first);
  CHECK(squares.measured() == 7);
  squares.depends = "another option";
  CHECK(squares.rows() == first);
  CHECK(squares.measured() == 14);
  squares.options.fresh = true;
  squares.rows();
  CHECK(squares.measured() == 21);
  squares.options.fresh = false, squares.options.seeds = 9;  // an interrupted run's results are reused
  CHECK(squares.rows().size() == 9);
  CHECK(squares.measured() == 23);
}

TEST_CASE("a kept row is identified by the bytes of its recording and by its config values") {
  const TemporaryFolder folder;
  std::ofstream(folder / "recording") << "one";
  const One bench(folder, [](const BenchCase&) -> Result<Json> { return Json{{"pid", getpid()}}; });
  BenchCase one{{{"recording", "r"}}, {folder / "recording"}};
  one.run.config = kConfigFile;
  const auto row = [&] { return (*rows_of(bench, {one}))[0]; };
  const Json first = row();
  CHECK(row() == first);
  std::ofstream(folder / "recording") << "two";
  const Json second = row();
  CHECK(second != first);
  one.run.overrides = {{"walker.height", "1.8 m"}};
  CHECK(row() != second);
}

TEST_CASE("a run that fails or ends its process fails the benchmark with the run's reason") {
  const TemporaryFolder folder;
  const One fails(folder, [](const BenchCase&) -> Result<Json> { return Failure{ODO_E_DATA, "no frames"}; });
  auto rows = rows_of(fails, {BenchCase{}});
  REQUIRE_FALSE(rows);
  CHECK(rows.failure().status == ODO_E_DATA);
  CHECK(rows.failure().text == "no frames");
  rows = rows_of(One(folder, [](const BenchCase&) -> Result<Json> { _exit(7); }), {BenchCase{}});
  REQUIRE_FALSE(rows);
  CHECK(contains(rows.failure().text, "the process of a run: the plugin ended the process with status 7"));
}

TEST_CASE("the cases are each recording with each variant and config, and a config may have its own values") {
  const TemporaryFolder folder;
  One bench(folder, nullptr);
  bench.offers |= kConfigs;
  bench.options.recordings = {"a.odo", "folder/b/"};
  bench.options.configs = {"walk.yaml", "walk.yaml?walker.height=1.8 m&coupling.bridge=1 s"};
  bench.options.set = {"walker.height=1.6 m"};
  bench.variants = {"as recorded", "worse"};
  const auto cases = required(bench.cases());
  REQUIRE(cases->size() == 8);
  CHECK(cases->at(5).labels.dump() ==
        R"({"recording":"b","sensors":"as recorded","config":"walk.yaml?walker.height=1.8 m&coupling.bridge=1 s"})");
  CHECK(cases->at(5).run.config == "walk.yaml");
  CHECK(cases->at(5).run.overrides.size() == 3);
  CHECK(cases->at(5).run.overrides[1].value == "1.8 m");  // its own comes after the common ones
  CHECK(cases->at(6).variant == 1);
  bench.options.set = {"walker"};
  CHECK(contains(bench.cases().failure().text, "PATH=VALUE"));
}

TEST_CASE("the rows of several recordings are followed by their summary") {
  Rows rows;
  for (const auto& [name, x] : {std::pair{"a", 1.0}, {"b", 3.0}}) {
    rows.push_back({{"recording", name}, {"config", "x/walk.yaml"}, {"_labels", {"recording", "config"}}});
    rows.back().update(row_of({{"error", "m", "x", 1, x}}));
  }
  CHECK(cases_text(rows, "figures", "", "median") ==
        "                   error\n"
        "recording  config      m\n"
        "a          walk      1.0\n"
        "b          walk      3.0\n"
        "median     walk      2.0\n");
  CHECK_FALSE(contains(cases_text({rows[0]}, "figures", "", "median"), "median"));
}

TEST_CASE("values replace those of a config, and those of list items by number or plugin") {
  RunOptions options{.config = kConfigFile};
  const auto plain = required(config_of(options));
  options.overrides = {{"walker.height", "180 cm"}, {"absolute_fixers.fix/gnss.parameters.correlation", "7 s"}};
  const auto changed = required(config_of(options));
  const auto parameter = [](const PluginChoice& plugin, const std::string& name) {
    for (const auto& [spec, value] : plugin.parameters)
      if (spec.name == name) return value.real;
    return -1.0;
  };
  CHECK(parameter(changed->fixers.at(0), "correlation") == 7);
  CHECK(parameter(plain->fixers.at(0), "correlation") != 7);
  options.overrides = {{"absolute_fixers.0.parameters.correlation", "7 s"}};
  CHECK(parameter(config_of(options)->fixers.at(0), "correlation") == 7);
  options.overrides = {{"coupling.fastest", "4 m/s"}, {"navigation.start.position", "[1 m, 2 m, 3 m]"}};
  const auto made = required(config_of(options));  // missing in the file
  CHECK(made->coupling.fastest_mps == 4);
  CHECK(made->start.position_m[2] == 3);
}

TEST_CASE("an error for a wrong path or value names the nearest key or the expected value") {
  CHECK(contains(failure_of({{"walker.heigth", "1.8 m"}}), "unknown key 'heigth'"));
  CHECK(contains(failure_of({{"walker.heigth", "1.8 m"}}), "nearest: 'height'"));
  CHECK(contains(failure_of({{"walkr.height", "1.8 m"}}), "nearest: 'walker'"));
  CHECK(contains(failure_of({{"absolute_fixers.fix/gnns.parameters.correlation", "0 s"}}), "nearest: 'fix/gnss'"));
  CHECK(contains(failure_of({{"absolute_fixers.fix/gnss.parameters.corelation", "0 s"}}), "nearest: 'correlation'"));
  CHECK(contains(failure_of({{"walker.height", "9 m"}}), "height"));
  CHECK(contains(failure_of({{"walker.height.more", "1"}}), "there is no 'more' in the value '1.70 m'"));
  CHECK_FALSE(parse_override("walker.height"));
  CHECK_FALSE(parse_override("=1"));
  CHECK(parse_override("a.b=c=d")->value == "c=d");
}

TEST_CASE("a document that is written again parses to the same values") {
  const std::string text =
      "a: 1.70 m\nb: \"1.70 m\"\nc: [1, two, 'three, four']\nd: {e: , f: \"#x\"}\ng: plain # comment\nh: "
      "\"q\\\"uote\"\n";
  const auto first = required(parse_yaml(text, "first"));
  const auto again = required(parse_yaml(yaml_text(*first), "again"));
  CHECK(yaml_text(*again) == yaml_text(*first));
  CHECK(node_at(*again, "c.2")->text == "three, four");
  CHECK(node_at(*again, "d.e")->kind == YamlNode::Kind::null);
  CHECK_FALSE(node_at(*again, "a")->quoted);
  CHECK(node_at(*again, "b")->quoted);
  CHECK(node_at(*again, "h")->text == "q\"uote");
  CHECK(node_at(*again, "c.9") == nullptr);
}

TEST_CASE(
    "at most the given number of children run in parallel, each is reported when it ends, and none starts after the "
    "stop") {
  std::vector<size_t> ended;
  const auto work = [](size_t i) -> std::string {
    usleep(i == 0 ? 300000 : 1000);
    return std::string(100000 * i, 'x');  // larger than a pipe's buffer
  };
  run_in_children(4, 2, work, [&](size_t i, const ChildResult& result) {
    CHECK(result.finished);
    CHECK(result.text.size() == 100000 * i);
    ended.push_back(i);
    return true;
  });
  CHECK(ended == std::vector<size_t>{1, 2, 3, 0});
  ended.clear();
  run_in_children(9, 2, work, [&](size_t i, const ChildResult&) {
    ended.push_back(i);
    return false;
  });
  CHECK(ended == std::vector<size_t>{1, 0});
  CHECK(run_in_child(0.1, [] { return usleep(3000000), std::string(); }).text == "took longer than 0.1 s");
}

#if defined(__linux__)
TEST_CASE("a child's own children end with it") {
  const auto killed_by_its_child = [] {
    run_in_child(10, [] { return kill(getppid(), SIGKILL), sleep(20), std::string(); });
    return std::string("not killed");
  };
  // The inner child holds the outer one's pipe open: its end is noticed once both have ended.
  const ChildResult outer = run_in_child(10, killed_by_its_child);
  CHECK_FALSE(outer.finished);
  CHECK(outer.text == "killed by Killed");
}
#endif
