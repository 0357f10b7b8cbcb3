// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include <odograph/plugin.hpp>
#include <odograph/terrain.h>

#include "plugins/fix/terrain/placement.hpp"

#include "sdk/math/time.hpp"

namespace {

using namespace odograph::terrain;

/// Heights from the ground: Antigny et al. 2019, eq. (4).
class TerrainFixer {
 public:
  std::string model;
  std::array<double, 3> model_origin = {0, 0, 0}, geodetic_origin = {0, 0, 0};
  bool geodetic = false;
  double grid_north = 0, geoid_height = 0, height = 1.70, hand = 0.9, hand_sigma = 0.15, model_sigma = 0.1;
  double interval = 1, correlation = 1, max_horizontal_sigma = 100;

  static constexpr odo::Description description{"fix/terrain", "1.0.0",
                                                "Heights from a terrain model and the height at which a phone is held",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<TerrainFixer>> parameters() {
    using P = TerrainFixer;
    return {
        odo::text("model", &P::model, "OBJ mesh, ESRI ASCII grid or GeoTIFF, beside the config"),
        odo::reals("model_origin", "m", -1e8, 1e8, &P::model_origin,
                   "easting, northing and height of n's origin in the model"),
        odo::real("grid_north", "rad", -3.2, 3.2, &P::grid_north, "the model's north, from true north to the east"),
        odo::boolean("geodetic", &P::geodetic,
                     "geodetic_origin replaces model_origin, by the model's reference system"),
        odo::reals("geodetic_origin", "", -1e5, 1e5, &P::geodetic_origin,
                   "latitude and longitude of n's origin in degrees, its ellipsoidal height in m"),
        odo::real("geoid_height", "m", -200, 200, &P::geoid_height, "ellipsoidal height of the model's zero height"),
        odo::real("height", "m", 0.5, 2.5, &P::height, "height of the walker"),
        odo::real("hand", "", 0, 1.5, &P::hand, "height of the phone as a fraction of the walker's height"),
        odo::real("hand_sigma", "m", 0.01, 2, &P::hand_sigma, "standard deviation of the phone's height: hands move"),
        odo::real("model_sigma", "m", 0.001, 100, &P::model_sigma, "standard deviation of the model's heights"),
        odo::real("interval", "s", 0.05, 3600, &P::interval, "minimum time between two fixes"),
        odo::real("correlation", "s", 0, 3600, &P::correlation,
                  "correlation time of a fix's error; its variance is increased accordingly"),
        odo::real("max_horizontal_sigma", "m", 0.01, 1e6, &P::max_horizontal_sigma,
                  "upper limit of the prior's horizontal standard deviation")};
  }

  void configured(odo::Output& host) {
    if (model.empty()) throw odo::Error(ODO_E_CONFIG, "model: expected a terrain model");
    const auto file = host.asset(model);
    if (!file) throw odo::Error(ODO_E_CONFIG, "model: no file '" + model + "' beside the config");
    try {
      terrain_.emplace(read_terrain(*file));
      placement_.emplace(Placement::Parameters{model_origin, grid_north, geodetic_origin, geodetic, geoid_height},
                         terrain_->reference());
      if (const std::string system = placement_->description(); !system.empty())
        host.report(ODO_SEVERITY_INFO, "reference_system", "the model is in " + system);
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
  }

  void reset() { last_ns_ = INT64_MIN; }

  /// Ground height, for anchors that stand above the ground.
  const void* extension(std::string_view id) const {
    return id == ODO_EXTENSION_TERRAIN && terrain_ ? &ground_ : nullptr;
  }

  void on(const odo_pose& pose, odo::Output& output) {
    constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_METRIC;
    if ((pose.header.flags & needed) != needed || (pose.header.flags & ODO_POSE_EXTRAPOLATED)) return;
    const double since_s = last_ns_ == INT64_MIN ? 1e9 : odograph::seconds(pose.header.t_ns - last_ns_);
    if (since_s < interval) return;
    const double held_m = hand * height, north = pose.p_n[0], east = pose.p_n[1];
    double down = 0;
    if (!placement_->ground_at(*terrain_, north, east, pose.p_n[2] + held_m, down)) return;
    const double horizontal =
        pose.header.flags & ODO_POSE_COVARIANCE
            ? std::min(max_horizontal_sigma, std::sqrt(std::max({0.0, pose.covariance[21], pose.covariance[28]})))
            : max_horizontal_sigma;
    const double by_place = rise_within(north, east, down, std::hypot(horizontal, placement_->accuracy_m()));
    auto fix = odo::make<odo_fix>(pose.header.t_ns);
    fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
    fix.p_n[2] = down - held_m;
    // Fixes with errors correlated over tau carry the information of white ones with 2 tau / interval times the
    // variance.
    const double alike = std::max(1.0, 2 * correlation / std::max(interval, std::min(since_s, correlation)));
    fix.covariance_n[8] = alike * (hand_sigma * hand_sigma + model_sigma * model_sigma + by_place * by_place);
    fix.integrity = 0.01;
    last_ns_ = pose.header.t_ns;
    output.emit(fix);
  }

 private:
  static int32_t ODO_CALL ground_at(void* user, double north_m, double east_m, double near_down_m, double* down_m,
                                    double* sigma_m) {
    const auto& self = *static_cast<const TerrainFixer*>(user);
    if (!self.placement_->ground_at(*self.terrain_, north_m, east_m, near_down_m, *down_m)) return ODO_E_NOT_FOUND;
    const double accuracy_m = self.placement_->accuracy_m();
    const double rise_m = accuracy_m > 0 ? self.rise_within(north_m, east_m, *down_m, accuracy_m) : 0.0;
    *sigma_m = std::hypot(self.model_sigma, rise_m);
    return ODO_OK;
  }

  /// Height sigma from a horizontal position error: rms difference of the ground one sigma away in four directions.
  double rise_within(double north, double east, double down, double sigma_m) const {
    double squares = 0;
    int n = 0;
    for (const auto& [dn, de] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      double other = 0;
      if (!placement_->ground_at(*terrain_, north + dn * sigma_m, east + de * sigma_m, down, other)) continue;
      squares += (other - down) * (other - down), ++n;
    }
    return n > 0 ? std::sqrt(2 * squares / n) : sigma_m;  // for both axes; unknown beyond the model
  }

  std::optional<Terrain> terrain_;
  std::optional<Placement> placement_;
  int64_t last_ns_ = INT64_MIN;
  odo_terrain ground_{sizeof(odo_terrain), 0, this, ground_at};
};

}  // namespace

ODO_PLUGIN(TerrainFixer)
