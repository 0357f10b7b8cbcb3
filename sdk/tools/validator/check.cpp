// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/check.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include "sdk/host/base/json_text.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"
#include "sdk/tools/validator/recording_check.hpp"

namespace odograph {

CaseFixture::CaseFixture(std::filesystem::path library_path, std::vector<std::pair<std::string, std::string>> settings,
                         double input_s)
    : path(std::move(library_path)),
      host(1, {std::filesystem::current_path()}, [this](const Report& report) { reports.push_back(report.text); }),
      all_input(input_s),
      settings_(std::move(settings)) {}

std::string CaseFixture::load() {
  note_phase("loading");
  const auto loaded = PluginLibrary::load(path, &host);
  note_phase("");
  if (!loaded) return loaded.failure().text;
  library = *loaded;
  const odo_plugin& t = table();
  interface_id = std::string(t.interfaces[0].data, t.interfaces[0].size);
  choice.manifest.parameters = *parameter_specs(t);
  for (Spec spec : choice.manifest.parameters) {
    for (const auto& [name, value] : settings_)
      if (spec.name == name) spec.fallback = value;
    Value value = default_value(spec);
    value.given = true;
    choice.parameters.emplace_back(spec, value);
  }
  values = values_of(choice);
  const KindTypes types = plugin_types(interface_id, t);
  for (const uint32_t type : types.inputs) inputs_.add(type);
  for (const uint32_t type : types.outputs) outputs_.add(type);
  input = all_input.of(types.inputs);
  return "";
}

std::unique_ptr<PluginDriver> CaseFixture::start_instance() const {
  auto made = driver();
  const int32_t status = made->start(values);
  if (status >= 0) return made;
  throw Verdict("it does not start: status " + std::to_string(status) + (reports.empty() ? "" : ", " + reports.back()));
}

std::vector<std::vector<unsigned char>> CaseFixture::run(const std::vector<AnyMessage>& messages,
                                                         const MessageLayout& layout) const {
  const auto made = start_instance();
  if (const int32_t status = made->process(messages, layout); status < 0)
    throw Verdict("process failed with status " + std::to_string(status));
  return made->bytes();
}

const PluginDriver* CaseFixture::walked_instance() {
  if (walked_) return walked_.get();
  walked_ = start_instance();
  if (!recording_) {
    walked_->process(input);
    return walked_.get();
  }
  input.clear();
  recording_([&](const odo_header& message) {
    if (!accepts(message.type)) return;
    input.emplace_back(message);
    walked_->process({input.back()});
  });
  return walked_.get();
}

std::string difference(const std::vector<std::vector<unsigned char>>& one,
                       const std::vector<std::vector<unsigned char>>& other) {
  for (size_t i = 0; i < std::min(one.size(), other.size()); ++i) {
    if (one[i] == other[i]) continue;
    const auto at =
        std::mismatch(one[i].begin(), one[i].end(), other[i].begin(), other[i].end()).first - one[i].begin();
    const auto& header = *reinterpret_cast<const odo_header*>(one[i].data());
    return "event " + std::to_string(i) + " (" + message_name(header.type) + ") differs at byte " + std::to_string(at);
  }
  if (one.size() != other.size()) return std::to_string(one.size()) + " events, then " + std::to_string(other.size());
  return "";
}

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const auto& part : {entry_cases(), parameter_cases(), life_cases(), event_cases(), flag_cases(), meaning_cases(),
                           repeat_cases(), frame_cases(), fault_cases()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

Verdict Case::run(CaseFixture& fixture) const {
  try {
    return test(fixture);
  } catch (const Verdict& verdict) {
    return verdict;
  }
}

std::string encoded(const Verdict& verdict) {
  return static_cast<char>(1 + static_cast<int>(verdict.outcome)) + verdict.detail;
}

Verdict decoded(const std::string& text) {
  const int outcome = text.empty() ? -1 : text[0] - 1;
  if (outcome < 0 || outcome > static_cast<int>(PluginCheck::Outcome::not_run))
    return {PluginCheck::Outcome::failed, text};
  return {static_cast<PluginCheck::Outcome>(outcome), text.substr(1)};
}

namespace {

/// How many times longer than the reference this machine takes; 1 if it is faster.
double slowness(const CheckParameters& parameters) {
  constexpr double kInput_s = 100;  // long enough to be slowed down by other programs as a case is
  const ChildResult made = run_in_child(parameters.most * parameters.input_s, [] {
    const TestInput input(kInput_s);
    return std::to_string(input.messages.size());
  });
  return std::max(1.0, std::min(made.seconds / parameters.input_s, parameters.most));
}

/// `hung` collects the calls that did not return, each with the reason not to make it again.
PluginCheck run_case(const Case& one, const std::filesystem::path& library, const CheckOptions& options, double slower,
                     std::map<std::string, std::string>& hung) {
  const auto work = [&]() -> std::string {
    for (const auto& [call, reason] : hung) avoid_call(call, encoded({PluginCheck::Outcome::not_run, reason}));
    CaseFixture fixture(library, options.settings, one.input_s);
    fixture.signer = options.signer;
    if (one.loaded)
      if (const std::string fault = fixture.load(); !fault.empty()) return encoded(fault);
    return encoded(one.run(fixture));
  };
  const double limit_s = options.limit_s > 0 ? std::min(options.limit_s, slower * one.limit_s) : slower * one.limit_s;
  const ChildResult result = run_in_child(limit_s, work, slower * options.parameters.call_s);
  const Verdict verdict = result.finished ? decoded(result.text) : Verdict(PluginCheck::Outcome::failed, result.text);
  if (!result.hung_call.empty()) hung.emplace(result.hung_call, result.hung_call + " hangs, see " + one.id);
  return {one.id, one.what, verdict.outcome, verdict.detail, result.seconds};
}

const char* word(PluginCheck::Outcome outcome) {
  constexpr const char* words[] = {"ok", "FAIL", "n/a", "not run"};
  return words[static_cast<int>(outcome)];
}

size_t count(const std::vector<PluginCheck>& checks, PluginCheck::Outcome outcome) {
  return static_cast<size_t>(
      std::count_if(checks.begin(), checks.end(), [&](const PluginCheck& c) { return c.outcome == outcome; }));
}

std::string xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n')
      out += c;
  }
  return out;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", seconds);
  return text;
}

}  // namespace

std::vector<PluginCheck> check_plugin(const std::filesystem::path& library, const CheckOptions& options) {
  std::vector<PluginCheck> checks;
  std::vector<Case> cases;
  for (const Case& one : all_cases()) {
    const std::string id = one.id;
    if (options.only.empty() ||
        std::any_of(options.only.begin(), options.only.end(), [&](const auto& begin) { return id.starts_with(begin); }))
      cases.push_back(one);
  }
  const auto path = std::filesystem::absolute(library);
  const auto add = [&](PluginCheck check) {
    checks.push_back(std::move(check));
    if (options.ended) options.ended(checks);
  };
  bool loads = true;
  const double slower = slowness(options.parameters);
  std::map<std::string, std::string> hung;
  for (const Case& one : cases) {
    if (one.loaded && !loads)
      add({one.id, one.what, PluginCheck::Outcome::not_applicable, "it does not load", 0});
    else
      add(run_case(one, path, options, slower, hung));
    if (checks.back().id == "entry.fills_table") loads = checks.back().outcome == PluginCheck::Outcome::passed;
  }
  const bool wanted =
      options.only.empty() || std::find(options.only.begin(), options.only.end(), "recording") != options.only.end();
  if (!options.recording || !loads || !wanted) return checks;
  if (hung.empty())
    for (PluginCheck& check : check_on_recording(path, options, slower * options.parameters.call_s))
      add(std::move(check));
  else
    add({"recording.given", "receives messages that it accepts", PluginCheck::Outcome::not_run, hung.begin()->second,
         0});
  return checks;
}

std::vector<std::pair<std::string, std::string>> plugin_check_cases() {
  std::vector<std::pair<std::string, std::string>> list;
  for (const Case& one : all_cases()) list.emplace_back(one.id, one.what);
  return list;
}

std::vector<std::string> cases_with_fault_of(const std::vector<PluginCheck>& checks, const PluginCheck& check) {
  std::vector<std::string> ids;
  const bool failed = check.outcome == PluginCheck::Outcome::failed;
  for (const PluginCheck& other : checks)
    if (other.id == check.id || (failed && other.outcome == check.outcome && other.detail == check.detail))
      ids.push_back(other.id);
  return ids;
}

std::string last_as_text(const std::vector<PluginCheck>& checks, bool with_time) {
  const PluginCheck& check = checks.back();
  const std::string first = cases_with_fault_of(checks, check).front();
  char line[160];
  std::snprintf(line, sizeof line, "%-4s %-30s ", word(check.outcome), check.id.c_str());
  std::string text = line + (with_time ? seconds_text(check.seconds) + " s  " : std::string()) + check.what;
  if (first != check.id)
    text += ": the same fault as " + first;
  else if (!check.detail.empty())
    text += ": " + check.detail;
  return text + '\n';
}

std::string counts_as_text(const std::vector<PluginCheck>& checks) {
  double seconds = 0;
  for (const PluginCheck& check : checks) seconds += check.seconds;
  const auto counted = [&](PluginCheck::Outcome outcome) { return std::to_string(count(checks, outcome)); };
  return std::to_string(checks.size()) + " cases: " + counted(PluginCheck::Outcome::passed) + " passed, " +
         counted(PluginCheck::Outcome::failed) + " failed, " + counted(PluginCheck::Outcome::not_applicable) +
         " do not apply, " + counted(PluginCheck::Outcome::not_run) + " not run; " + seconds_text(seconds) + " s\n";
}

std::string check_as_json(const std::string& library, const std::vector<PluginCheck>& checks) {
  JsonText json;
  json.open('{').key("library").string(library);
  json.key("passed").number(static_cast<double>(count(checks, PluginCheck::Outcome::passed)));
  json.key("failed").number(static_cast<double>(count(checks, PluginCheck::Outcome::failed)));
  json.key("not_run").number(static_cast<double>(count(checks, PluginCheck::Outcome::not_run)));
  json.key("cases").open('[');
  for (const PluginCheck& check : checks)
    json.open('{')
        .key("id")
        .string(check.id)
        .key("what")
        .string(check.what)
        .key("outcome")
        .string(word(check.outcome))
        .key("detail")
        .string(check.detail)
        .key("seconds")
        .number(check.seconds)
        .close('}');
  return json.close(']').close('}').text() + "\n";
}

std::string check_as_junit(const std::string& library, const std::vector<PluginCheck>& checks) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" + xml(library) + "\" tests=\"" +
                     std::to_string(checks.size()) + "\" failures=\"" +
                     std::to_string(count(checks, PluginCheck::Outcome::failed)) + "\" skipped=\"" +
                     std::to_string(count(checks, PluginCheck::Outcome::not_applicable) +
                                    count(checks, PluginCheck::Outcome::not_run)) +
                     "\">\n";
  for (const PluginCheck& check : checks) {
    const auto dot = check.id.find('.');
    text += "  <testcase classname=\"" + check.id.substr(0, dot) + "\" name=\"" + check.id.substr(dot + 1) +
            "\" time=\"" + seconds_text(check.seconds) + "\">";
    if (check.outcome == PluginCheck::Outcome::failed)
      text += "<failure message=\"" + xml(check.what + ": " + check.detail) + "\"/>";
    if (check.outcome == PluginCheck::Outcome::not_applicable || check.outcome == PluginCheck::Outcome::not_run)
      text += "<skipped message=\"" + xml(check.detail) + "\"/>";
    text += "</testcase>\n";
  }
  return text + "</testsuite>\n";
}

}  // namespace odograph
