// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace odograph::steps {

/// Whether a walker goes up or down stairs, by the air's pressure: the slope of the height over the last ten seconds,
/// where it stands clear of what the pressure scatters about it. Stairs lift by a quarter of a metre a second and more,
/// ramps by less. No allocation.
class Climb {
 public:
  void add(int64_t t_ns, double pressure_pa);
  bool climbs() const { return climbs_; }
  /// When the climbing, or the level, began: the middle of the window that showed it.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = Climb(); }

 private:
  struct Height {
    int64_t t_ns;
    double m;
  };
  std::array<Height, 256> heights_{};
  size_t count_ = 0;
  bool climbs_ = false;
  int64_t since_ns_ = 0;
};

}  // namespace odograph::steps
