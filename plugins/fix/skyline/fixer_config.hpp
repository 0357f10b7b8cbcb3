// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include <odograph/plugin.hpp>

namespace odograph::skyline {

/// Configuration of the fixer.
struct FixerConfig {
  std::string model, skylines;
  std::array<double, 3> model_origin = {0, 0, 0}, geodetic_origin = {0, 0, 0};
  bool geodetic = false;
  double geoid_height = 0;
  std::string sky = "robust", inclination = "pose";
  double interval = 0.5, min_agreement = 0.75, tilt_sigma = 0.6 * std::numbers::pi / 180, min_sigma = 0.2, radius = 40;
  double height_sigma = 1.0;
  bool start_known = true, join = false, photographs = false;
};

/// The table of its parameters. `Fixer` is a FixerConfig.
template <class Fixer>
std::vector<odo::Parameter<Fixer>> fixer_parameters() {
  return {
      odo::text<Fixer>("model", &Fixer::model, "CityJSON or CityGML file of the city, beside the config"),
      odo::reals<Fixer>("model_origin", "m", -1e8, 1e8, &Fixer::model_origin,
                        "easting, northing and height of n's origin in the model"),
      odo::boolean<Fixer>("geodetic", &Fixer::geodetic,
                          "geodetic_origin stands for model_origin; the model is geographic, UTM or RD New"),
      odo::reals<Fixer>("geodetic_origin", "", -1e5, 1e5, &Fixer::geodetic_origin,
                        "latitude and longitude of n's origin in degrees, its ellipsoidal height in m"),
      odo::real<Fixer>("geoid_height", "m", -200, 200, &Fixer::geoid_height,
                       "ellipsoidal height of the model's zero height"),
      odo::text<Fixer>(
          "skylines", &Fixer::skylines,
          "database of skylines (`odograph city build`), beside the config; without a model also its edges"),
      odo::choice<Fixer>("sky", "robust|flood_fill", &Fixer::sky,
                         "method of sky segmentation; flood_fill is the paper's"),
      odo::choice<Fixer>("inclination", "pose|vanishing_point", &Fixer::inclination,
                         "source of pitch and roll; vanishing_point is the paper's"),
      odo::real<Fixer>("interval", "s", 0, 3600, &Fixer::interval, "minimum time between two fixes"),
      odo::real<Fixer>("radius", "m", 2, 200, &Fixer::radius, "maximum search radius around the prior"),
      odo::real<Fixer>("min_agreement", "", 0.1, 1, &Fixer::min_agreement,
                       "minimum fraction of the directions with a roof's edge in which picture and model agree"),
      odo::real<Fixer>("tilt_sigma", "rad", 0.0001, 0.5, &Fixer::tilt_sigma,
                       "minimum standard deviation of the prior's inclination"),
      odo::real<Fixer>("height_sigma", "m", 0.01, 100, &Fixer::height_sigma,
                       "standard deviation of the prior's height at the start"),
      odo::boolean<Fixer>("start_known", &Fixer::start_known,
                          "the initial pose is known; otherwise the whole database is searched"),
      odo::boolean<Fixer>("join", &Fixer::join, "match a picture with too little skyline jointly with earlier ones"),
      odo::real<Fixer>("min_sigma", "m", 0.001, 100, &Fixer::min_sigma, "minimum standard deviation of a fix"),
      odo::boolean<Fixer>(
          "photographs", &Fixer::photographs,
          "each frame is a separate photograph, searched around the pose at its time within its covariance; "
          "pitch and roll are estimated")};
}

}  // namespace odograph::skyline
