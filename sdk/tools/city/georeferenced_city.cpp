// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/georeferenced_city.hpp"

#include <algorithm>
#include <limits>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFarthest_m = 5000;  // of the buildings from n's origin: its plane is 2 m above the ellipsoid there
constexpr double kEverywhere_m = std::numeric_limits<double>::infinity();

}  // namespace

Result<GeoreferencedCity> GeoreferencedCity::load(const fs::path& model, const PhotographOrigin& origin,
                                                  std::optional<Coordinates> origin_deg) {
  auto localizer = PhotographLocalizer::make(model, origin);
  if (!localizer) return localizer.failure();
  GeoreferencedCity city;
  city.localizer_ = std::move(*localizer);
  city.origin_ = origin;
  if (origin_deg) {
    city.geodesy_ = std::make_unique<Geodesy>();
    city.geodesy_->set_origin({(*origin_deg)[0] * kRad_per_deg, (*origin_deg)[1] * kRad_per_deg, 0});
  }
  city.low_n_ = Vector3d::Constant(1e300), city.high_n_ = -city.low_n_;
  for (const auto& ends : city.localizer_->edges_near({0, 0}, kEverywhere_m)) {
    ++city.edges_;
    for (const Vector3d& p : ends) city.low_n_ = city.low_n_.cwiseMin(p), city.high_n_ = city.high_n_.cwiseMax(p);
  }
  if (city.edges_ == 0) return Failure{ODO_E_DATA, model.string() + ": no building in it"};
  return city;
}

/// Reads the model again about its middle where the given origin is far away: n is a plane.
Result<GeoreferencedCity> GeoreferencedCity::load_near(const fs::path& model, const PhotographOrigin& origin) {
  Coordinates middle{};
  {
    auto city = load(model, origin, origin.geodetic_deg);
    if (!city) return city;
    const Vector3d middle_n = 0.5 * (city->low_n_ + city->high_n_);
    if (middle_n.head<2>().norm() < kFarthest_m) return city;
    middle = city->coordinates(middle_n);
  }
  PhotographOrigin nearer;
  if (origin.geodetic_deg)
    nearer.geodetic_deg = middle;
  else
    nearer.model = {middle[0], middle[1], 0};
  return load(model, nearer, nearer.geodetic_deg);
}

Result<GeoreferencedCity> GeoreferencedCity::geodetic(const fs::path& model, std::optional<Coordinates> near) {
  auto city = load_near(model, {.geodetic_deg = near.value_or(Coordinates{0, 0})});
  if (city) return city;
  const auto readable = own(model);  // then only its reference system is missing
  if (!readable) return city;
  return Failure{ODO_E_UNSUPPORTED, city.failure().text + "; its buildings span " + readable->span()};
}

Result<GeoreferencedCity> GeoreferencedCity::with_zero_at(const fs::path& model, const Coordinates& zero_deg) {
  return load(model, {}, zero_deg);
}

Result<GeoreferencedCity> GeoreferencedCity::own(const fs::path& model, std::optional<Coordinates> near) {
  const Coordinates at = near.value_or(Coordinates{0, 0});
  return load_near(model, {.model = {at[0], at[1], 0}});
}

Vector3d GeoreferencedCity::p_n(const Coordinates& place) const {
  if (!geodesy_) return {place[1] - origin_.model.y(), place[0] - origin_.model.x(), 0};
  const auto n = geodesy_->from_geodetic({place[0] * kRad_per_deg, place[1] * kRad_per_deg, 0});
  return Vector3d(n.data());
}

Coordinates GeoreferencedCity::coordinates(const Vector3d& p_n) const {
  if (!geodesy_) return {origin_.model.x() + p_n.y(), origin_.model.y() + p_n.x()};
  const auto g = geodesy_->to_geodetic({p_n.x(), p_n.y(), p_n.z()});
  return {g[0] / kRad_per_deg, g[1] / kRad_per_deg};
}

std::string GeoreferencedCity::span() const {
  Coordinates low = {1e300, 1e300}, high = {-1e300, -1e300};
  for (const auto& ends : localizer_->edges_near({0, 0}, kEverywhere_m))
    for (const Vector3d& p : ends) {
      const Coordinates at = coordinates(p);
      for (size_t i = 0; i < 2; ++i) low[i] = std::min(low[i], at[i]), high[i] = std::max(high[i], at[i]);
    }
  if (is_geodetic())
    return text("latitudes %.5f to %.5f and longitudes %.5f to %.5f", low[0], high[0], low[1], high[1]);
  return text("eastings %.1f to %.1f and northings %.1f to %.1f", low[0], high[0], low[1], high[1]);
}

/// The distance of a place from the box around the buildings; heights count where the Earth is in between.
double GeoreferencedCity::distance_m(const Coordinates& place) const {
  const Vector3d at = p_n(place), any_height(0, 0, 1e4);
  return (at - at.cwiseMax(low_n_ - any_height).cwiseMin(high_n_ + any_height)).norm();
}

std::optional<std::string> GeoreferencedCity::why_not_at(const Coordinates& place) const {
  if (localizer_->ground(p_n(place).head<2>())) return std::nullopt;
  const double off_m = distance_m(place);
  if (off_m == 0) return "the model has no building within 60 m of the place";
  const bool exchanged = off_m > kFarthest_m && distance_m({place[1], place[0]}) < kFarthest_m;
  return "the place is " + (off_m < 10e3 ? text("%.0f m", off_m) : text("%.0f km", off_m / 1e3)) +
         " from the model, whose buildings span " + span() + (exchanged ? "; are the two numbers exchanged?" : "");
}

}  // namespace odograph
