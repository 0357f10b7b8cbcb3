// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/projection.hpp"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <numbers>

#include <Eigen/Geometry>

namespace odograph {
namespace {

using Eigen::Vector3d;
using GeographicLib::Geocentric;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaxInPlane = 1e8;  // m: bound of the coordinates of a projection

/// RD New, EPSG 28992.
constexpr double kA_m = 6377397.155, kFlattening = 1 / 299.1528128;  // Bessel 1841
constexpr double kLatitude0 = 52.15616055555555 * kDegree, kLongitude0 = 5.38763888888889 * kDegree;
constexpr double kScale0 = 0.9999079, kFalseEasting_m = 155000, kFalseNorthing_m = 463000;

/// Amersfoort to WGS 84 (4), coordinate frame rotation: m, seconds of arc, parts per million.
const Vector3d kShift_m(565.4171, 50.3319, 465.5524);
constexpr double kSecond = kDegree / 3600;
const Vector3d kRotation_rad = kSecond * Vector3d(0.398957388243134, -0.343987817378283, 1.87740163998045);
constexpr double kScale = 1 + 4.0725e-6;

/// The conformal sphere of method 9809, in the notation of the guidance note.
struct Sphere {
  double e, R, n, c, chi0;
};

double eccentric(double e, double sine) { return std::pow((1 - e * sine) / (1 + e * sine), e); }

double conformal_sine(const Sphere& s, double latitude_rad) {
  const double sine = std::sin(latitude_rad);
  const double w = s.c * std::pow((1 + sine) / (1 - sine) * eccentric(s.e, sine), s.n);
  return (w - 1) / (w + 1);
}

Sphere make_sphere() {
  Sphere s{};
  const double e2 = kFlattening * (2 - kFlattening), sine = std::sin(kLatitude0), cosine = std::cos(kLatitude0);
  s.e = std::sqrt(e2);
  const double d = 1 - e2 * sine * sine;
  const double rho = kA_m * (1 - e2) / std::pow(d, 1.5), nu = kA_m / std::sqrt(d);
  s.R = std::sqrt(rho * nu);
  s.n = std::sqrt(1 + e2 * std::pow(cosine, 4) / (1 - e2));
  s.c = 1;
  const double chi00 = conformal_sine(s, kLatitude0);
  s.c = (s.n + sine) * (1 - chi00) / ((s.n - sine) * (1 + chi00));
  s.chi0 = std::asin(conformal_sine(s, kLatitude0));
  return s;
}

const Sphere& sphere() {
  static const Sphere s = make_sphere();
  return s;
}

struct Ellipsoidal {
  double latitude_rad, longitude_rad;
};

/// Forward projection.
GridPoint stereographic(const Ellipsoidal& p) {
  const Sphere& s = sphere();
  const double sine = conformal_sine(s, p.latitude_rad), cosine = std::sqrt(1 - sine * sine);
  const double dl = s.n * (p.longitude_rad - kLongitude0);
  const double B = 1 + sine * std::sin(s.chi0) + cosine * std::cos(s.chi0) * std::cos(dl);
  const double r = 2 * s.R * kScale0 / B;
  return {kFalseEasting_m + r * cosine * std::sin(dl),
          kFalseNorthing_m + r * (sine * std::cos(s.chi0) - cosine * std::sin(s.chi0) * std::cos(dl))};
}

/// Inverse projection: via the sphere around the projection's centre (Snyder 1987, eq. (20-14), (20-15)), then the
/// latitude on the ellipsoid by fixed-point iteration, which gains two digits per step.
Ellipsoidal from_stereographic(const GridPoint& g) {
  const Sphere& s = sphere();
  const double x = g.easting_m - kFalseEasting_m, y = g.northing_m - kFalseNorthing_m, rho = std::hypot(x, y);
  if (rho < 1e-9) return {kLatitude0, kLongitude0};
  const double angle = 2 * std::atan(rho / (2 * s.R * kScale0)), sin0 = std::sin(s.chi0), cos0 = std::cos(s.chi0);
  const double sine = std::cos(angle) * sin0 + y * std::sin(angle) * cos0 / rho;
  const double dl = std::atan2(x * std::sin(angle), rho * cos0 * std::cos(angle) - y * sin0 * std::sin(angle));
  const double w = (1 + sine) / (1 - sine), target = std::pow(w / s.c, 1 / s.n);
  double latitude = std::asin(sine);
  for (int i = 0; i < 12; ++i) {
    const double q = target / eccentric(s.e, std::sin(latitude));
    latitude = std::asin((q - 1) / (q + 1));
  }
  return {latitude, kLongitude0 + dl / s.n};
}

/// Small-angle rotation as the seven parameters define it: linear, about the coordinate frame.
Vector3d rotated(const Vector3d& p, double sign) { return p + sign * p.cross(kRotation_rad); }

const Geocentric& bessel() {
  static const Geocentric earth(kA_m, kFlattening);
  return earth;
}

}  // namespace

Geodetic rd_new_to_wgs84(const GridPoint& place) {
  const Ellipsoidal p = from_stereographic(place);
  Vector3d x;
  bessel().Forward(p.latitude_rad / kDegree, p.longitude_rad / kDegree, 0, x.x(), x.y(), x.z());
  const Vector3d wgs84 = kShift_m + kScale * rotated(x, 1);
  Geodetic g;
  double height_m = 0;
  Geocentric::WGS84().Reverse(wgs84.x(), wgs84.y(), wgs84.z(), g.latitude_deg, g.longitude_deg, height_m);
  return g;
}

GridPoint wgs84_to_rd_new(const Geodetic& place) {
  // The inverse assumes a height of 0 on the other ellipsoid; iteration of the exact forward transform removes the
  // error, by a factor of 1e-5 per step.
  GridPoint at;
  Geodetic wanted = place;
  for (int i = 0; i < 3; ++i) {
    Vector3d x;
    Geocentric::WGS84().Forward(wanted.latitude_deg, wanted.longitude_deg, 0, x.x(), x.y(), x.z());
    const Vector3d old = rotated((x - kShift_m) / kScale, -1);
    double latitude_deg = 0, longitude_deg = 0, height_m = 0;
    bessel().Reverse(old.x(), old.y(), old.z(), latitude_deg, longitude_deg, height_m);
    at = stereographic({latitude_deg * kDegree, longitude_deg * kDegree});
    const Geodetic back = rd_new_to_wgs84(at);
    wanted.latitude_deg += place.latitude_deg - back.latitude_deg;
    wanted.longitude_deg += place.longitude_deg - back.longitude_deg;
  }
  return at;
}

std::optional<Projection> Projection::of(int epsg) {
  if (is_geographic(epsg)) return Projection(Kind::geographic, 0, true);
  if (epsg > 32600 && epsg <= 32660) return Projection(Kind::utm, epsg - 32600, true);
  if (epsg > 32700 && epsg <= 32760) return Projection(Kind::utm, epsg - 32700, false);
  if (epsg >= 25828 && epsg <= 25838) return Projection(Kind::utm, epsg - 25800, true);
  if (epsg >= 5554 && epsg <= 5556) return Projection(Kind::utm, epsg - 5554 + 31, true);
  if (epsg == 28992 || epsg == 7415) return Projection(Kind::rd_new, 0, true);
  return std::nullopt;
}

Geodetic Projection::geodetic(const GridPoint& p) const {
  if (kind_ == Kind::rd_new) return rd_new_to_wgs84(p);
  if (kind_ == Kind::geographic) return {p.northing_m, p.easting_m};
  Geodetic g;
  GeographicLib::UTMUPS::Reverse(zone_, northern_, p.easting_m, p.northing_m, g.latitude_deg, g.longitude_deg);
  return g;
}

std::optional<GridPoint> Projection::grid(const Geodetic& g) const {
  if (kind_ == Kind::geographic) return GridPoint{g.longitude_deg, g.latitude_deg};
  if (kind_ == Kind::rd_new) {
    const GridPoint p = wgs84_to_rd_new(g);
    return std::abs(p.easting_m) < kMaxInPlane && std::abs(p.northing_m) < kMaxInPlane ? std::optional(p)
                                                                                       : std::nullopt;
  }
  int zone = 0;
  bool northern = true;
  GridPoint p;
  try {
    using GeographicLib::UTMUPS;
    UTMUPS::Forward(g.latitude_deg, g.longitude_deg, zone, northern, p.easting_m, p.northing_m, zone_);
    UTMUPS::Transfer(zone, northern, p.easting_m, p.northing_m, zone, northern_, p.easting_m, p.northing_m, zone);
  } catch (const std::exception&) {
    return std::nullopt;  // far outside the zone
  }
  return p;
}

bool is_geographic(int epsg) {
  return epsg == 4326 || epsg == 4258 || epsg == 4979 || epsg == 4937 || epsg == 6668 || epsg == 6697;
}

int epsg_of(const std::string& name) {
  constexpr std::string_view kSurveys = "ETRS89_UTM";
  if (const auto at = name.find(kSurveys); at != std::string::npos)
    return 25800 + std::atoi(name.c_str() + at + kSurveys.size());
  const auto begin = name.find("EPSG");
  if (begin == std::string::npos) return 0;
  const std::string first = name.substr(begin, name.find(',', begin) - begin);
  const auto digits = first.find_last_not_of("0123456789");
  return std::atoi(first.c_str() + digits + 1);
}

}  // namespace odograph
