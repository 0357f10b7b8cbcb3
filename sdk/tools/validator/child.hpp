// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace odograph {

/// What became of work that ran in a process of its own.
struct ChildResult {
  bool finished = false;  ///< it came to its end and said so
  std::string text;       ///< what it returned; where it did not come to its end, what ended it and in which phase
  double seconds = 0;     ///< of this machine's clock
};

/// Runs foreign code in a child process, so that a crash, an exit, an endless loop or a full memory is a finding and
/// not the end of this program. After `limit_s` the child is killed. `work` calls `note_phase` for what it is about to
/// do. [control] One thread only: it forks.
ChildResult run_in_child(double limit_s, const std::function<std::string()>& work);

/// The same for many, numbered, so many side by side, each without a limit. `done` gets what became of each, as they
/// end, and says whether further ones are begun.
void run_in_children(size_t count, size_t side_by_side, const std::function<std::string(size_t number)>& work,
                     const std::function<bool(size_t number, const ChildResult& result)>& done);

/// In a child: what is done from here on, for the message if it ends here. At most 127 characters.
void note_phase(const std::string& phase);

}  // namespace odograph
