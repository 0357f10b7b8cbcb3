// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <odograph/types.h>

namespace odograph {

/// What becomes of a scale: it may count for a motion; it applies to past motions alone; or the motions of its group
/// are in metres.
enum class ScaleUse { used, late, pointless };

/// Combines the statements of one or several scale sources about a motion. A single statement is used unchanged; for
/// several about the same motion, the logarithms are averaged with inverse-variance weights (maximum-likelihood
/// estimate for independent log-normal scales). Not thread-safe.
class ScaleJoin {
 public:
  explicit ScaleJoin(size_t sources) : newest_(sources) {}

  /// Notes a statement made outside of a motion.
  ScaleUse note(size_t source, const odo_scale& scale);
  /// Starts a motion that is in metres or not; earlier statements valid for it count.
  void begin(const odo_vo_motion& motion, bool metric);
  /// Notes a source's answer to the motion, which replaces its earlier statement.
  ScaleUse answer(size_t source, const odo_scale& scale);
  /// The scale for the motion, or null if there is none or it needs none. Valid until the next motion.
  const odo_scale* joined();
  void reset();

  /// Time of the newest motion.
  int64_t motion_ns() const { return t_ns_; }
  uint32_t group() const { return group_; }

 private:
  bool holds(const odo_scale& scale) const;

  std::vector<std::optional<odo_scale>> newest_, found_;
  int64_t t_ns_ = INT64_MIN;  ///< of the newest motion
  uint32_t group_ = 0;
  bool metric_ = false;
  odo_scale joined_{};
};

}  // namespace odograph
