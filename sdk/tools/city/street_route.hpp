// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// Parameters of random routes through a city model.
struct StreetRouteParameters {
  double length_m = 300;
  double cell_m = 1.0;              ///< of the map of streets; narrow alleys are two metres wide
  double clearance_m = 3.0;         ///< min distance to a wall: half a car and a pavement
  double middle_m = 6.0;            ///< distance to walls above which the cost does not attract the route to the middle
  double built_up_m = 25.0;         ///< max distance to the nearest wall: the route stays in town
  double border_m = 20.0;           ///< min distance from the model's border, beyond which there is no model
  double corner_tolerance_m = 0.8;  ///< max deviation of the simplified line from the path on the map
};

/// A route of about the given length through a model's streets: least-cost paths between random places (`seed`), near
/// the middle of the street, never through a building. Points are north, east and 0 in the model's n, m. Fails where no
/// such route is found.
Result<std::vector<Eigen::Vector3d>> draw_street_route(const CityModel& city, uint64_t seed,
                                                       const StreetRouteParameters& parameters = {});

/// Height of the ground, m above n's origin, at a place: the model's terrain where there is some, otherwise the lowest
/// corner of the buildings within 40 m, otherwise 0.
double ground_up_m(const CityModel& city, const Eigen::Vector2d& north_east);

}  // namespace odograph
