// SPDX-License-Identifier: Apache-2.0
// Throws in its constructor, with its own C++ runtime: the wrapper must convert it to a status.
#include <odograph/plugin.hpp>

struct Thrower {
  static constexpr odo::Description description{"test/create_throws", "1.0.0", "Throws.", ODO_INTERFACE_SCALE_SOURCE};
  static inline bool armed = false;
  Thrower() {
    if (armed) throw std::runtime_error("the constructor has a bad day");
    armed = true;  // the table is built from one object with its defaults
  }
  static std::vector<odo::Parameter<Thrower>> parameters() { return {}; }
};

ODO_PLUGIN(Thrower)
