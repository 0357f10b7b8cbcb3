// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <odograph/base.h>

namespace odograph {

/// What one case of the plugin validator found.
struct PluginCheck {
  enum class Outcome { passed, failed, not_applicable };
  std::string id;    ///< "events.step_length", stable: scripts and the zoo of bad plugins name it
  std::string what;  ///< what a good plugin does
  Outcome outcome = Outcome::passed;
  std::string detail;  ///< what was found; why it does not apply
  double seconds = 0;
};

/// Gives all messages of a recording, in the order of time, each valid for the duration of the call.
using Messages = std::function<void(const std::function<void(const odo_header&)>& give)>;

struct CheckOptions {
  /// Parameters, name and value, for plugins that have no good default.
  std::vector<std::pair<std::string, std::string>> settings;
  /// Only cases whose id begins with one of these; all where it is empty.
  std::vector<std::string> only;
  /// Longest that a case may take, s, where its own limit is longer; 0: each case's own.
  double limit_s = 0;
  /// A recording that the plugin is given besides, for the cases that are named recording; may be empty.
  Messages recording;
  /// Called before each case with its number, how many there are and its id.
  std::function<void(size_t, size_t, const std::string&)> progress;
};

/// Puts a plugin library to the test. Each case runs in a child process of its own with a time limit, so that a crash,
/// an exit or an endless loop is that case's finding. A library that does not load fails its first cases, and the
/// others are left out. [control] Forks: one thread only.
std::vector<PluginCheck> check_plugin(const std::filesystem::path& library, const CheckOptions& options);

/// All cases, id and what a good plugin does, in the order in which they run.
std::vector<std::pair<std::string, std::string>> plugin_check_cases();

/// The results for people, as JSON, and as a JUnit test suite for CI systems.
std::string check_as_text(const std::vector<PluginCheck>& checks, bool with_times);
std::string check_as_json(const std::string& library, const std::vector<PluginCheck>& checks);
std::string check_as_junit(const std::string& library, const std::vector<PluginCheck>& checks);

}  // namespace odograph
