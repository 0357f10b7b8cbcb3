// SPDX-License-Identifier: Apache-2.0
//
// The validator against faulty plugins: each is detected by the case that its file is named for.
#include <nlohmann/json.hpp>

#include "sdk/tools/validator/check.hpp"
#include "sdk/tools/validator/statement.hpp"
#include "sdk/tools/validator/write_manifest.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("faulty_plugins");

namespace {

const fs::path kFaultyPlugins = built("tests/faulty_plugins");

/// "events_size__zero.so" is for "events.size".
std::string case_of(const fs::path& library) {
  std::string name = library.stem().string();
  name.resize(name.find("__"));
  name[name.find('_')] = '.';
  return name;
}

std::vector<fs::path> plugins_of_kind(bool good) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(kFaultyPlugins))
    if (entry.path().extension() == ".so" && entry.path().filename().string().starts_with("good_") == good)
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<PluginCheck> check(const fs::path& library, const std::string& only, double limit_s = 0) {
  CheckOptions options;
  if (!only.empty()) options.only = {only};
  options.limit_s = limit_s;
  return check_plugin(library, options);
}

}  // namespace

TEST_CASE("there are at least 80 cases with unique ids, and most of them have a faulty plugin") {
  std::set<std::string> ids, covered;
  for (const auto& one : plugin_check_cases()) CHECK_MESSAGE(ids.insert(one.first).second, one.first);
  for (const fs::path& faulty : plugins_of_kind(false)) {
    CHECK_MESSAGE(ids.count(case_of(faulty)) == 1, case_of(faulty));
    covered.insert(case_of(faulty));
  }
  CHECK(ids.size() >= 80);
  CHECK(plugins_of_kind(false).size() >= 45);
  CHECK(covered.size() >= 80);
}

TEST_CASE("the documents state the correct numbers of cases and faulty plugins") {
  std::ifstream file(source("docs/plugins.md").string());
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  CHECK(contains(text, "runs " + std::to_string(plugin_check_cases().size()) + " cases"));
  CHECK(contains(text, "contain " + std::to_string(plugins_of_kind(false).size()) + " faulty plugins"));
}

TEST_CASE("each faulty plugin is detected by the case that it is named for") {
  for (const fs::path& faulty : plugins_of_kind(false)) {
    const auto checks = check(faulty, case_of(faulty), 3);
    CAPTURE(faulty.filename().string());
    const auto own = std::find_if(checks.begin(), checks.end(), [&](const auto& c) { return c.id == case_of(faulty); });
    REQUIRE(own != checks.end());
    CHECK(own->outcome == PluginCheck::Outcome::failed);
    CHECK_FALSE(own->detail.empty());
  }
}

TEST_CASE("a good plugin of each kind passes every case") {
  for (const fs::path& faulty : plugins_of_kind(true)) {
    const TemporaryFolder folder;
    const auto library = folder / faulty.filename().string();
    fs::copy_file(faulty, library);
    REQUIRE(write_manifest_beside(library).ok());
    for (const PluginCheck& one : check(library, "")) {
      CAPTURE(faulty.filename().string());
      CAPTURE(one.id);
      CHECK_MESSAGE(one.outcome != PluginCheck::Outcome::failed, one.detail);
    }
  }
}

TEST_CASE("the end of a plugin is reported with its place, also an exit with status 0") {
  const auto detail = [](const char* faulty) {
    return check(kFaultyPlugins / (std::string(faulty) + ".so"), "process.works", 4).front().detail;
  };
  CHECK(contains(detail("process_works__exit"), "ended the process with status 0 in process of"));
  CHECK(contains(detail("process_works__segfault"), "Segmentation fault in process of"));
  CHECK(contains(detail("process_works__hangs"), "took longer than 4 s in process of"));
  CHECK(contains(detail("process_works__throws"), "the fortieth sample is unlucky"));
}

TEST_CASE("the file's cases detect a missing library or manifest, another library's manifest and a false one") {
  const TemporaryFolder folder;
  const auto text = write_text(folder / "text.so", "no library");
  CHECK(check(text, "file.library").front().outcome == PluginCheck::Outcome::failed);
  const auto library = folder / "scale.so";
  fs::copy_file(kFaultyPlugins / "good_scale.so", library);
  CHECK(check(library, "file.manifest").front().outcome == PluginCheck::Outcome::failed);
  const auto manifest = required(write_manifest_beside(library));
  for (const PluginCheck& one : check(library, "file."))
    CHECK_MESSAGE((one.outcome == PluginCheck::Outcome::passed || one.id == "file.signature"), one.id);
  const std::string said = read_text(*manifest);
  auto lie = said;
  lie.replace(lie.find("1.0.0"), 5, "2.0.0");
  write_text(*manifest, lie);
  CHECK(check(library, "file.manifest_agrees").front().outcome == PluginCheck::Outcome::failed);
  write_text(*manifest, said);
  std::ofstream(library, std::ios::binary | std::ios::app) << "changed";
  CHECK(check(library, "file.hash").front().outcome == PluginCheck::Outcome::failed);
}

TEST_CASE("a plugin that ends the process has no manifest, and the reason is reported") {
  for (const char* faulty : {"entry_fills_table__exit", "entry_loads__exit_in_static"}) {
    const TemporaryFolder folder;
    const auto library = folder / "bad.so";
    fs::copy_file(kFaultyPlugins / (std::string(faulty) + ".so"), library);
    const auto manifest = write_manifest_beside(library);
    REQUIRE_FALSE(manifest.ok());
    CHECK(contains(manifest.failure().text, "the plugin ended the process with status 0 in loading"));
  }
}

TEST_CASE("a call that hangs is named and not made again: its other cases are not run") {
  using Outcome = PluginCheck::Outcome;
  struct Row {
    std::string faulty, call;
    int least;
  };
  for (const Row& row : {Row{"life_create_destroy__hangs", "create", 70}, {"process_works__hangs", "process", 55}}) {
    CAPTURE(row.faulty);
    CheckOptions options;
    options.limit_s = 2;
    size_t ended = 0;
    options.ended = [&](const auto& so_far) { CHECK(so_far.size() == ++ended); };
    const auto checks = check_plugin(kFaultyPlugins / (row.faulty + ".so"), options);
    CHECK(ended == plugin_check_cases().size());
    const auto names_call = [&](const PluginCheck& check) {
      return contains(check.detail, "took longer than 2 s in " + row.call);
    };
    const auto hung = std::find_if(checks.begin(), checks.end(), names_call);
    REQUIRE(hung != checks.end());
    CHECK(std::count_if(checks.begin(), checks.end(), names_call) == 1);
    int not_run = 0;
    for (const PluginCheck& check : checks)
      if (check.outcome == Outcome::not_run) {
        ++not_run;
        CHECK(check.detail == row.call + " hangs, see " + hung->id);
      }
    CHECK(not_run >= row.least);
    CHECK(contains(counts_as_text(checks), ", " + std::to_string(not_run) + " not run;"));
    CHECK(nlohmann::json::parse(check_as_json("a", checks))["not_run"] == not_run);
  }
}

TEST_CASE("the limits are longer on a slow machine, up to a multiple") {
  CheckOptions options;
  options.only = {"process.works"};
  const auto detail = [&](double call_s, double input_s) {
    options.parameters = {.call_s = call_s, .input_s = input_s, .most = 3};
    return check_plugin(kFaultyPlugins / "process_works__hangs.so", options).front().detail;
  };
  CHECK(contains(detail(0.5, 1e-9), "took longer than 1.5 s in process"));  // any machine is slower than this
  CHECK(contains(detail(0.5, 1e9), "took longer than 0.5 s in process"));   // and faster than that
  CHECK(CheckParameters().call_s * CheckParameters().most <= 60);           // the other minute is for other cases
}

TEST_CASE("a fault that several cases find is printed once; the others refer to it, the statement names them") {
  using Outcome = PluginCheck::Outcome;
  const std::vector<PluginCheck> checks = {{"a.one", "starts", Outcome::failed, "no model", 0},
                                           {"a.two", "works", Outcome::passed, "", 0},
                                           {"b.one", "lasts", Outcome::failed, "no model", 0},
                                           {"b.two", "stops", Outcome::failed, "too slow", 0},
                                           {"c.one", "ends", Outcome::failed, "no model", 0}};
  std::string text = counts_as_text(checks);
  CHECK(contains(text, "5 cases: 1 passed, 4 failed"));
  for (auto end = checks.begin(); end != checks.end();) text += last_as_text({checks.begin(), ++end}, false);
  CHECK(text.find("no model") == text.rfind("no model"));
  CHECK(contains(text, "c.one                          ends: the same fault as a.one\n"));
  CHECK(contains(text, "too slow"));
  const std::string statement = conformance_statement({}, checks);
  CHECK(contains(statement, "the same fault in 2 further cases: b.one, c.one\n"));
}

TEST_CASE("results are text, JSON and JUnit") {
  const auto checks = check(kFaultyPlugins / "scale_unit__millimetres.so", "scale.");
  std::string text = counts_as_text(checks);
  for (auto end = checks.begin(); end != checks.end();) text += last_as_text({checks.begin(), ++end}, true);
  CHECK(contains(text, "FAIL scale.unit"));
  CHECK(contains(text, "4 cases: 3 passed, 1 failed, 0 do not apply"));
  const auto json = nlohmann::json::parse(check_as_json("a/b.so", checks));
  CHECK(json["failed"] == 1);
  CHECK(json["cases"].size() == 4);
  const std::string junit = check_as_junit("<a>&.so", checks);
  CHECK(contains(junit, "<testsuite name=\"&lt;a&gt;&amp;.so\" tests=\"4\" failures=\"1\""));
  CHECK(contains(junit, "<testcase classname=\"scale\" name=\"unit\""));
}
