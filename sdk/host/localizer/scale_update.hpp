// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// What makes a front-end's displacements metres: its own statement, or scale sources. Neither states independent
/// errors: a statement counts for as much as it says more than was said before.
class ScaleUpdate {
 public:
  struct Parameters {
    double unknown_sigma = 1.0;     ///< of log-scale before anything is known; none is stated worse
    double known_sigma = 0.15;      ///< of log-scale, at which steps have told it
    double min_sigma = 1e-3;        ///< lower clamp of a stated sigma; by hand
    double lost_confidence = 0.25;  ///< share of its information below which a front-end has doubted its scale anew
    double memory_s = 20;           ///< s for which a source repeats the same error
    int min_steps = 3;              ///< before steps tell it; by hand
  };

  /// Another scale group: nothing is known of its scale.
  void begin_group(Localizer& localizer);
  /// A front-end's own statement, relative sigma. `walks`: the camera moves; a camera at rest doubts its displacement,
  /// not its scale.
  void use_own(Localizer& localizer, double sigma, bool walks);
  /// A scale source's statement at a time.
  UpdateResult use(Localizer& localizer, const odo_scale& scale);
  /// Steps have been compared with the front-end: what they gained, 1/variance.
  void add_steps(double gained) { by_steps_ += gained, ++steps_; }

  bool known() const { return known_; }
  /// Steps alone may tell it: three at least, and well enough.
  void know_by_steps(const Localizer& localizer);
  /// Of log-scale, without the help of steps, 1/variance; 0: nothing.
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
