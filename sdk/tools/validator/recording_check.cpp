// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/recording_check.hpp"

#include <map>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

constexpr double kCheckLimit_s = 3600;  // for a recording of any length, including pictures
constexpr char kBetween = '\x1e';       // separates the child's results, one for each row of rows()

std::vector<Case> rows() {
  std::vector<Case> rows = {{.id = "given", .what = "receives messages that it accepts"},
                            {.id = "emitted", .what = "emits events"}};
  for (const Case& one : all_cases())
    if (one.any_input) rows.push_back(one);
  return rows;
}

/// Passed with the detail "fix 12, step 40", or not applicable.
template <class Range, class Header>
Verdict counted(const Range& messages, Header&& header) {
  std::map<std::string, size_t> counts;
  for (const auto& message : messages) ++counts[message_name(header(message).type)];
  std::string text;
  for (const auto& [name, count] : counts) text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  return text.empty() ? not_applicable("nothing") : Verdict(PluginCheck::Outcome::passed, text);
}

std::string verdicts(CaseFixture& fixture) try {
  const PluginDriver* driver = fixture.walked_instance();
  std::string text =
      encoded(counted(fixture.input, [](const AnyMessage& m) -> const odo_header& { return m.header(); }));
  text += kBetween;
  text += encoded(counted(driver->events, [](const SeenEvent& e) -> const odo_header& { return e.message.header(); }));
  for (const Case& one : rows())
    if (one.test) text += kBetween + encoded(one.run(fixture));
  return text;
} catch (const Verdict& verdict) {
  return encoded(verdict);
}

}  // namespace

std::vector<PluginCheck> check_on_recording(const std::filesystem::path& library, const CheckOptions& options,
                                            double call_limit_s) {
  const auto work = [&]() -> std::string {
    CaseFixture fixture(library, options.settings, 0);
    if (const std::string fault = fixture.load(); !fault.empty()) return encoded(fault);
    fixture.replay(options.recording);
    return verdicts(fixture);
  };
  const ChildResult result = run_in_child(options.limit_s > 0 ? options.limit_s : kCheckLimit_s, work, call_limit_s);
  std::vector<PluginCheck> checks;
  std::string left = result.text;
  for (const Case& row : rows()) {
    const size_t end = left.find(kBetween);
    const bool is_last = end == std::string::npos;
    Verdict verdict = decoded(left.substr(0, end));
    if (!result.finished) verdict.outcome = PluginCheck::Outcome::failed;
    checks.push_back({std::string("recording.") + row.id, row.what, verdict.outcome, verdict.detail,
                      checks.empty() ? result.seconds : 0});
    if (is_last) break;  // may also be the reason why the child ended or the plugin did not start
    left.erase(0, end + 1);
  }
  return checks;
}

}  // namespace odograph
