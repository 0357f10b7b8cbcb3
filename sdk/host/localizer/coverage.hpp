// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace odograph {

/// The time over which the track contains the displacement: everything up to a time, except for one gap before it.
class Coverage {
 public:
  void begin(int64_t t_ns) { until_ns_ = gap_from_ns_ = gap_to_ns_ = t_ns; }
  bool begun() const { return until_ns_ != INT64_MIN; }
  int64_t until_ns() const { return until_ns_; }

  /// The displacement over an interval has been added; a gap may precede it.
  void add(int64_t from_ns, int64_t to_ns) {
    if (from_ns > until_ns_) gap_from_ns_ = until_ns_, gap_to_ns_ = from_ns;
    until_ns_ = std::max(until_ns_, to_ns);
  }
  /// Fraction of an interval that is not covered, 0 to 1.
  double missing(int64_t from_ns, int64_t to_ns) const {
    if (to_ns <= from_ns) return 0;
    const double in_gap = length(std::max(from_ns, gap_from_ns_), std::min(to_ns, gap_to_ns_));
    const double after = length(std::max(from_ns, until_ns_), to_ns);
    return std::min(1.0, (in_gap + after) / static_cast<double>(to_ns - from_ns));
  }
  /// The missing part of an interval has been added.
  void fill(int64_t from_ns, int64_t to_ns) {
    if (to_ns > until_ns_)
      add(std::max(from_ns, until_ns_), to_ns);
    else if (to_ns > gap_from_ns_)
      gap_from_ns_ = std::min(to_ns, gap_to_ns_);
  }

 private:
  static double length(int64_t from_ns, int64_t to_ns) {
    return to_ns > from_ns ? static_cast<double>(to_ns - from_ns) : 0.0;
  }
  int64_t until_ns_ = INT64_MIN, gap_from_ns_ = INT64_MIN, gap_to_ns_ = INT64_MIN;
};

}  // namespace odograph
