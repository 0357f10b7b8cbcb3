// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <odograph/plugin.hpp>

namespace {

/// Position fixes straight from the receiver. What the receiver says of its accuracy is multiplied, because phones are
/// optimistic between houses; a floor keeps a single fix from ruling.
class Gnss {
 public:
  double sigma = 10.0, sigma_factor = 1.5, min_sigma = 2.0;
  int64_t min_satellites = 0;
  bool height = false;

  static constexpr odo::Description description{"fix/gnss", "1.0.0", "Position fixes from a GNSS receiver",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Gnss>> parameters() {
    return {
        odo::real("sigma", "m", 0.01, 1000, &Gnss::sigma, "standard deviation of a position that comes without one"),
        odo::real("sigma_factor", "", 0.1, 100, &Gnss::sigma_factor,
                  "the receiver's own standard deviation is multiplied by this"),
        odo::real("min_sigma", "m", 0.001, 1000, &Gnss::min_sigma, "smallest standard deviation believed"),
        odo::integer("min_satellites", 0, 100, &Gnss::min_satellites,
                     "positions from fewer are ignored (where the number is known)"),
        odo::boolean("height", &Gnss::height, "use the height too")};
  }

  void on(const odo_gnss& sample, odo::Output& output) {
    if ((sample.header.flags & ODO_GNSS_POSITION) == 0) return;
    if (sample.satellites > 0 && sample.satellites < min_satellites) return;
    auto fix = odo::make<odo_fix>(sample.header.t_ns);
    fix.header.flags = ODO_FIX_GEODETIC | ODO_FIX_NORTH | ODO_FIX_EAST;
    if (height && (sample.header.flags & ODO_GNSS_HEIGHT)) fix.header.flags |= ODO_FIX_DOWN;
    fix.latitude_rad = sample.latitude_rad;
    fix.longitude_rad = sample.longitude_rad;
    fix.height_m = (sample.header.flags & ODO_GNSS_HEIGHT) ? sample.height_m : 0.0;
    for (int i = 0; i < 3; ++i) {
      const bool given = (sample.header.flags & ODO_GNSS_COVARIANCE) && sample.covariance_n[4 * i] > 0;
      const double variance = given ? sample.covariance_n[4 * i] * sigma_factor * sigma_factor : sigma * sigma;
      fix.covariance_n[4 * i] = std::max(min_sigma * min_sigma, variance);
    }
    fix.integrity = 0.05;
    output.emit(fix);
  }
};

}  // namespace

ODO_PLUGIN(Gnss)
