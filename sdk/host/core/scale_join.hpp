// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <odograph/types.h>

namespace odograph {

/// The scale that holds for a motion, of what one or several scale sources say. One source's word is taken as it is; of
/// several that speak of the same motion the logarithms are averaged, weighted with the inverse of their variances (the
/// maximum-likelihood estimate for independent log-normal scales). One thread at a time.
class ScaleJoin {
 public:
  explicit ScaleJoin(size_t sources) : newest_(sources) {}

  /// What a source said outside of a motion. Whether it may hold for motions to come.
  bool note(size_t source, const odo_scale& scale);
  /// A motion begins; what was said before and holds for it counts.
  void begin(const odo_vo_motion& motion);
  /// A source's answer to the motion: it stands above what that source said before. Whether it holds for the motion, or
  /// may hold for motions to come.
  bool answer(size_t source, const odo_scale& scale);
  /// The scale for the motion, or null where nobody can tell. Valid until the next motion.
  const odo_scale* joined();
  void reset();

  /// Of the newest motion.
  int64_t motion_ns() const { return t_ns_; }
  uint32_t group() const { return group_; }

 private:
  bool holds(const odo_scale& scale) const;

  std::vector<std::optional<odo_scale>> newest_, found_;
  int64_t t_ns_ = INT64_MIN;  ///< of the newest motion
  uint32_t group_ = 0;
  odo_scale joined_{};
};

}  // namespace odograph
