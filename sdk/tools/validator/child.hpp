// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <string>

namespace odograph {

/// Outcome of work in a child process.
struct ChildResult {
  bool finished = false;  ///< it completed and reported so
  std::string text;       ///< its result; if it did not complete, what ended it and in which phase
  double seconds = 0;     ///< wall clock
  std::string hung_call;  ///< the call that did not return; empty if it completed or ended otherwise
};

/// Runs foreign code in a child process, so that a crash, an exit, an endless loop or memory exhaustion becomes a
/// result instead of ending this program. The child is killed after `limit_s`, or when one call has taken
/// `call_limit_s`. `work` calls `note_phase` before each phase. It may run children of its own; on Linux a child ends
/// with its parent. [control] Forks: call only while single-threaded.
ChildResult run_in_child(double limit_s, const std::function<std::string()>& work,
                         double call_limit_s = std::numeric_limits<double>::infinity());

/// Runs many numbered jobs, `side_by_side` in parallel, without a time limit. `done` receives each outcome as it ends,
/// and returns whether to start further jobs.
void run_in_children(size_t count, size_t side_by_side, const std::function<std::string(size_t number)>& work,
                     const std::function<bool(size_t number, const ChildResult& result)>& done);

/// In a child: names the current call of foreign code ("process"; empty: none) and what else identifies the phase, for
/// the message if the child ends in it. At most 15 and 111 characters.
void note_phase(const std::string& call, const std::string& where = "");
/// In a child: from now on note_phase() of this call ends the child with `text` as its result.
void avoid_call(const std::string& call, const std::string& text);

}  // namespace odograph
