// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "sdk/tools/validator/check.hpp"
#include "sdk/tools/validator/subject.hpp"
#include "sdk/tools/validator/test_input.hpp"

namespace odograph {

/// What the cases work with, in the child process.
class Bench {
 public:
  /// The library is loaded by `load`, or not at all for cases about the file and the entry.
  Bench(std::filesystem::path library, std::vector<std::pair<std::string, std::string>> settings, double input_s);
  /// Empty, or why the library does not load.
  std::string load();

  std::filesystem::path path;
  HostServices host;
  std::vector<std::string> reports;  ///< what the plugin reported
  std::shared_ptr<PluginLibrary> library;
  std::string interface_id;
  PluginChoice choice;  ///< the parameters, which `values` point into
  std::vector<odo_value> values;
  TestInput all_input;
  std::vector<AnyMessage> input;  ///< of it what the plugin is given

  const odo_plugin& table() const { return library->table(); }
  bool wants(uint32_t type) const { return inputs_.has(type); }
  bool gives(uint32_t type) const { return outputs_.has(type); }
  bool serves(const char* interface) const { return interface_id == interface; }
  std::unique_ptr<Subject> subject() const { return std::make_unique<Subject>(table(), host, interface_id); }
  /// An instance that has been started; null, and `why` says it, when it could not be.
  std::unique_ptr<Subject> started(std::string& why) const;
  /// An instance that has been given the walk or, in place of it, the recording: the same for all cases of this
  /// process. Null, and `why` says it, when it does not start.
  const Subject* walked(std::string& why);
  /// From here on `walked` gives the messages of a recording, one after the other.
  void replay(Messages messages) { recording_ = std::move(messages); }
  /// The events of a new instance for some input.
  std::vector<std::vector<unsigned char>> run(const std::vector<AnyMessage>& messages, const Handling& handling,
                                              std::string& why) const;

 private:
  std::vector<std::pair<std::string, std::string>> settings_;
  TypeSet inputs_, outputs_;
  Messages recording_;
  std::unique_ptr<Subject> walked_;
};

/// One case: "" passes, a text that starts with '~' says why it does not apply, any other what is wrong.
struct Case {
  const char* id;
  const char* what;
  double limit_s;
  double input_s;  ///< how long a walk it needs
  bool loaded;     ///< it works with the loaded library
  std::string (*test)(Bench&);
  bool any_input = false;  ///< it judges the events of any input, a recording's too
};

std::vector<Case> entry_cases();
std::vector<Case> parameter_cases();
std::vector<Case> life_cases();
std::vector<Case> event_cases();
std::vector<Case> meaning_cases();
std::vector<Case> repeat_cases();
std::vector<Case> frame_cases();
std::vector<Case> fault_cases();

std::vector<Case> all_cases();
/// What a case's answer comes to.
PluginCheck judged(const Case& one, const std::string& answer);

/// What the first event differs in from the other run's, or "".
std::string difference(const std::vector<std::vector<unsigned char>>& one,
                       const std::vector<std::vector<unsigned char>>& other);

}  // namespace odograph
