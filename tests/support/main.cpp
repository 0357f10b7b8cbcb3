// SPDX-License-Identifier: Apache-2.0
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdlib>
#include <iostream>

#include "tests/support/support.hpp"

namespace {

constexpr int kSkipped = 77;  // shown as "Skipped" by ctest
bool skipped = false;
unsigned cases = 0;

std::string setting(const char* name, const char* from_build) {
  const char* here = std::getenv(name);
  return here != nullptr ? here : from_build;
}

struct CaseCounter : doctest::IReporter {
  explicit CaseCounter(const doctest::ContextOptions&) {}
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats& run) override { cases = run.numTestCasesPassingFilters; }
  void test_case_start(const doctest::TestCaseData&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("case counter", 1, CaseCounter);

}  // namespace

std::filesystem::path source(const std::string& name) { return std::filesystem::path(ODOGRAPH_SOURCE) / name; }
std::filesystem::path built(const std::string& name) { return std::filesystem::path(ODOGRAPH_BUILD) / name; }

void skip(const std::string& why) {
  skipped = true;
  std::cout << "SKIPPED: " << why << std::endl;
}

std::filesystem::path data_or_skip(const std::string& name) {
  const auto path = std::filesystem::path(setting("ODOGRAPH_DATA", ODOGRAPH_DATA)) / name;
  if (std::filesystem::exists(path)) return path;
  if (setting("ODOGRAPH_REQUIRE_DATA", ODOGRAPH_REQUIRE_DATA) == "ON")
    FAIL("no real recordings at ", path.string(), ", and ODOGRAPH_REQUIRE_DATA is on");
  skip("no real recordings at " + path.string());
  return {};
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  const int failed = context.run();
  if (failed != 0 || context.shouldExit()) return failed;
  if (cases == 0) {
    std::cerr << "no test case of that name" << std::endl;
    return 1;
  }
  return skipped ? kSkipped : 0;
}
