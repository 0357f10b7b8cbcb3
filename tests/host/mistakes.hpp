// SPDX-License-Identifier: Apache-2.0
//
// Mistakes of an app, each with the report that names it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/mistaken_app.hpp"

namespace odograph {

struct Mistake {
  const char* name;
  const char* key;     ///< of the report
  const char* remedy;  ///< in its text
  Input input;
};

/// A table of them.
struct Mistakes {
  std::vector<Mistake> all;
  Input& add(const char* name, const char* key, const char* remedy) {
    return all.emplace_back(Mistake{name, key, remedy, {}}).input;
  }
  Input& with_camera(const char* name, const char* key, const char* remedy) {
    Input& input = add(name, key, remedy);
    input.camera = true;
    return input;
  }
  void units();
  void axes();
  void cameras();
  void pictures();
  void clocks();
  void sampling();
  void others();
};

/// Positions of a walk on a circle of 7 m in 31 s, clockwise; with latitude and longitude exchanged, the longitude
/// times `sign`.
std::function<void(App&, int64_t)> circle(bool exchanged, double sign);
/// Of a walk on a circle of 30 m at 2 m/s, with its velocity times a factor.
std::function<void(App&, int64_t)> walk(double velocity, bool east_first);

}  // namespace odograph
