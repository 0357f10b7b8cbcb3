// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// Metric scale of a front-end's displacements, stated by the front-end or by scale sources. Errors of successive
/// statements are not independent: each counts only for the information it adds to the previous ones.
class ScaleUpdate {
 public:
  struct Parameters {
    double unknown_sigma = 1.0;     ///< of log-scale, prior, and upper clamp of a stated sigma
    double known_sigma = 0.15;      ///< of log-scale, below which steps have determined the scale
    double min_sigma = 1e-3;        ///< lower clamp of a stated sigma; empirical
    double lost_confidence = 0.25;  ///< ratio of stated information below which a front-end has lost its scale again
    double memory_s = 20;           ///< s for which a source repeats the same error
    int min_steps = 3;              ///< before steps determine the scale; empirical
  };

  /// Starts a scale group with unknown scale.
  void begin_group(Localizer& localizer);
  /// Takes the front-end's own statement, relative sigma. `is_walking`: the camera moves. A camera at rest is uncertain
  /// of its displacement, not its scale.
  void use_front_end(Localizer& localizer, double sigma, bool is_walking);
  /// Takes a scale source's statement at a time.
  UpdateResult use(Localizer& localizer, const odo_scale& scale);
  /// Adds the information gained from comparing steps with the front-end, 1/variance.
  void add_steps(double gained) { by_steps_ += gained, ++steps_; }

  bool known() const { return known_; }
  /// Accepts the scale from steps alone: at least min_steps, and a small enough sigma.
  void confirm_by_steps(const Localizer& localizer);
  /// Information on log-scale without the help of steps, 1/variance; 0: none.
  double own_information() const { return own_; }
  ScaleKnowledge knowledge(const Localizer& localizer) const;

 private:
  Parameters p_;
  bool known_ = false;
  double own_ = 0, stated_ = 0, by_steps_ = 0;
  int steps_ = 0;
  int64_t stated_ns_ = INT64_MIN;
};

}  // namespace odograph
