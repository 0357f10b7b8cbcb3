// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <odograph/base.h>

namespace odograph {

/// Result of one validator case.
struct PluginCheck {
  enum class Outcome { passed, failed, not_applicable, not_run };
  std::string id;    ///< "events.step_length"; stable, because scripts and tests refer to it
  std::string what;  ///< the required behaviour
  Outcome outcome = Outcome::passed;
  std::string detail;  ///< the fault, or why the case does not apply or was not run
  double seconds = 0;
};

/// Passes all messages of a recording in time order, each valid for the duration of the call.
using Messages = std::function<void(const std::function<void(const odo_header&)>& give)>;

/// Time limits of the check.
struct CheckParameters {
  /// Longest single call, s. The longest whole case of this project's plugins takes 0.6 s on two cores of an x86-64
  /// server (vo/odograph, process.flags).
  double call_s = 20;
  /// What it takes there to make 100 s of the cases' input in a child process, s, measured 0.04 to 0.07 s. All limits
  /// are multiplied by what it takes here over this, at least 1.
  double input_s = 0.05;
  double most = 3;  ///< of that factor: a minute for a call that hangs, and another one for the cases before it
};

struct CheckOptions {
  CheckParameters parameters;
  /// Parameters, name and value, for plugins without good defaults.
  std::vector<std::pair<std::string, std::string>> settings;
  /// Ed25519 public key that must have signed the manifest, 64 hexadecimal digits; empty: not checked.
  std::string signer;
  /// Only cases whose id has one of these prefixes; empty: all.
  std::vector<std::string> only;
  /// Upper bound for the time limit of a case, s, on any machine; 0: each case's own.
  double limit_s = 0;
  /// A recording that is passed to the plugin in the recording cases; may be empty.
  Messages recording;
  /// Called after each case with the results so far.
  std::function<void(const std::vector<PluginCheck>&)> ended;
};

/// Tests a plugin library. Each case runs in its own child process with a time limit, longer on a slow machine, so that
/// a crash, an exit or an endless loop counts as a failure of that case. Later cases end as not run where they would
/// make a call that did not return. If the library does not load, the first cases fail and the others are skipped.
/// [control] Forks: call only while single-threaded.
std::vector<PluginCheck> check_plugin(const std::filesystem::path& library, const CheckOptions& options);

/// All cases in order of execution: id and required behaviour.
std::vector<std::pair<std::string, std::string>> plugin_check_cases();

/// The ids of all cases that failed with the same fault as `check`, in order; of a case that did not fail its own
/// alone.
std::vector<std::string> cases_with_fault_of(const std::vector<PluginCheck>& checks, const PluginCheck& check);

/// The last result as a line of text; a fault that an earlier one has refers to it.
std::string last_as_text(const std::vector<PluginCheck>& checks, bool with_time);
/// The numbers of results as a line of text, the results as JSON, and as a JUnit test suite for CI systems.
std::string counts_as_text(const std::vector<PluginCheck>& checks);
std::string check_as_json(const std::string& library, const std::vector<PluginCheck>& checks);
std::string check_as_junit(const std::string& library, const std::vector<PluginCheck>& checks);

}  // namespace odograph
