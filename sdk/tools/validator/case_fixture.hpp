// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "sdk/tools/validator/check.hpp"
#include "sdk/tools/validator/plugin_driver.hpp"
#include "sdk/tools/validator/test_input.hpp"

namespace odograph {

/// Outcome of a case. Cases return it; helpers throw one that ends the case.
struct Verdict {
  PluginCheck::Outcome outcome = PluginCheck::Outcome::passed;
  std::string detail;  ///< the fault, or why the case does not apply or was not run
  Verdict() = default;
  Verdict(PluginCheck::Outcome o, std::string d) : outcome(o), detail(std::move(d)) {}
  /// The case failed with this fault; it passed if the text is empty.
  Verdict(std::string fault)
      : outcome(fault.empty() ? PluginCheck::Outcome::passed : PluginCheck::Outcome::failed),
        detail(std::move(fault)) {}
  Verdict(const char* fault) : Verdict(std::string(fault)) {}
};
inline Verdict not_applicable(std::string reason) { return {PluginCheck::Outcome::not_applicable, std::move(reason)}; }
/// As text between processes. Any text that encoded() did not write is a fault: what ended the child.
std::string encoded(const Verdict& verdict);
Verdict decoded(const std::string& text);

/// Fixture of the cases, in the child process.
class CaseFixture {
 public:
  /// load() loads the library; cases about the file and the entry work without it.
  CaseFixture(std::filesystem::path library, std::vector<std::pair<std::string, std::string>> settings, double input_s);
  /// Empty, or why the library does not load.
  std::string load();

  std::filesystem::path path;
  HostServices host;
  std::vector<std::string> reports;  ///< the plugin's reports
  std::shared_ptr<PluginLibrary> library;
  std::string signer;  ///< public key that must have signed the manifest, in hex; empty: any or none
  std::string interface_id;
  PluginChoice choice;  ///< the parameters, which `values` points into
  std::vector<odo_value> values;
  TestInput all_input;
  std::vector<AnyMessage> input;  ///< the messages of it that the plugin receives

  const odo_plugin& table() const { return library->table(); }
  bool accepts(uint32_t type) const { return inputs_.has(type); }
  bool emits(uint32_t type) const { return outputs_.has(type); }
  bool serves(const char* interface) const { return interface_id == interface; }
  std::unique_ptr<PluginDriver> driver() const { return std::make_unique<PluginDriver>(table(), host, interface_id); }
  /// A started instance. Throws a Verdict if it does not start.
  std::unique_ptr<PluginDriver> start_instance() const;
  /// An instance that has processed the walk or, if set, the recording; shared by all cases of this process. Throws a
  /// Verdict if it does not start.
  const PluginDriver* walked_instance();
  /// Makes walked_instance() use the messages of a recording instead of the walk.
  void replay(Messages messages) { recording_ = std::move(messages); }
  /// The events of a new instance for some input. Throws a Verdict if it does not start or process fails.
  std::vector<std::vector<unsigned char>> run(const std::vector<AnyMessage>& messages,
                                              const MessageLayout& layout) const;

 private:
  std::vector<std::pair<std::string, std::string>> settings_;
  TypeSet inputs_, outputs_;
  Messages recording_;
  std::unique_ptr<PluginDriver> walked_;
};

struct Case {
  const char* id = "";
  const char* what = "";
  double limit_s = 0;
  double input_s = 0;  ///< length of the walk that it needs
  Verdict (*test)(CaseFixture&) = nullptr;
  bool loaded = true;      ///< it requires the loaded library
  bool any_input = false;  ///< it checks the events of any input, including a recording's

  /// The returned or thrown verdict.
  Verdict run(CaseFixture& fixture) const;
};

/// CASES begins a file of cases, which NAME_cases() returns in their order. CASE defines one of them, CASE_OF adds one
/// by its function; the last arguments are other members of Case.
#define CASES(name)                         \
  static std::vector<Case>& name##_list() { \
    static std::vector<Case> list;          \
    return list;                            \
  }                                         \
  std::vector<Case> name##_cases() { return name##_list(); }
#define CASE(name, id, what, limit_s, input_s, ...) \
  CASE_BY(CASE_NUMBER(case_, __COUNTER__), name, id, what, limit_s, input_s __VA_OPT__(, ) __VA_ARGS__)
#define CASE_BY(function, name, id, what, limit_s, input_s, ...)                  \
  static Verdict function(CaseFixture& fixture);                                  \
  CASE_OF(name, id, what, limit_s, input_s, function __VA_OPT__(, ) __VA_ARGS__); \
  static Verdict function([[maybe_unused]] CaseFixture& fixture)
#define CASE_OF(name, id_, what_, limit, input, function, ...)                 \
  [[maybe_unused]] static const bool CASE_NUMBER(added_, __COUNTER__) =        \
      (name##_list().push_back({.id = id_,                                     \
                                .what = what_,                                 \
                                .limit_s = limit,                              \
                                .input_s = input,                              \
                                .test = function __VA_OPT__(, ) __VA_ARGS__}), \
       true)
#define CASE_NUMBER(word, number) CASE_NUMBER_OF(word, number)
#define CASE_NUMBER_OF(word, number) word##number

/// Number of entries of a folder, as of /proc/self/fd.
inline size_t entries_of(const char* folder) {
  std::error_code error;
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder, error), {}));
}

std::vector<Case> entry_cases();
std::vector<Case> parameter_cases();
std::vector<Case> life_cases();
std::vector<Case> event_cases();
std::vector<Case> meaning_cases();
std::vector<Case> repeat_cases();
std::vector<Case> flag_cases();
std::vector<Case> frame_cases();
std::vector<Case> fault_cases();

std::vector<Case> all_cases();
/// The first difference from the other run's events, or "".
std::string difference(const std::vector<std::vector<unsigned char>>& one,
                       const std::vector<std::vector<unsigned char>>& other);

}  // namespace odograph
