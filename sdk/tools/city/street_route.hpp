// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// How routes through a city model are drawn.
struct StreetRouteParameters {
  double length_m = 300;
  double cell_m = 1.0;       ///< of the map of streets; narrow alleys are two metres wide
  double clearance_m = 3.0;  ///< least distance to a wall: half a car and a pavement
  double middle_m = 6.0;     ///< farther from the walls than this nothing draws a route to the middle of the street
  double built_up_m = 25.0;  ///< somewhere within this there is a wall: the route stays in town
  double border_m = 20.0;    ///< from the model's border: beyond it the model knows nothing
  double corner_tolerance_m = 0.8;  ///< by which the corners of the drawn line may leave the path found on the map
};

/// A route of about the wanted length through a model's streets: paths of least cost between places drawn by `seed`,
/// near the middle of the street, never through a building. Points are north, east and 0 in the model's n, m. Fails
/// where no such route is found.
Result<std::vector<Eigen::Vector3d>> draw_street_route(const CityModel& city, uint64_t seed,
                                                       const StreetRouteParameters& parameters = {});

/// Height of the ground, m above n's origin, at a place: of the model's terrain where it has some there, otherwise of
/// the lowest corner of the buildings within 40 m, otherwise 0.
double ground_up_m(const CityModel& city, const Eigen::Vector2d& north_east);

}  // namespace odograph
