// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <locale>
#include <sstream>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/spec.hpp"
#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

struct Unit {
  const char* name;
  const char* si;
  double factor;
};

constexpr Unit kUnits[] = {
    {"m", "m", 1.0},
    {"mm", "m", 1e-3},
    {"cm", "m", 1e-2},
    {"km", "m", 1e3},
    {"s", "s", 1.0},
    {"ms", "s", 1e-3},
    {"us", "s", 1e-6},
    {"ns", "s", 1e-9},
    {"min", "s", 60.0},
    {"rad", "rad", 1.0},
    {"deg", "rad", kPi / 180},
    {"mrad", "rad", 1e-3},
    {"m/s", "m/s", 1.0},
    {"km/h", "m/s", 1 / 3.6},
    {"m/s^2", "m/s^2", 1.0},
    {"rad/s", "rad/s", 1.0},
    {"deg/s", "rad/s", kPi / 180},
    {"Hz", "Hz", 1.0},
    {"Pa", "Pa", 1.0},
    {"hPa", "Pa", 100.0},
    {"T", "T", 1.0},
    {"uT", "T", 1e-6},
    {"px", "px", 1.0},
};

}  // namespace

std::vector<std::string> compatible_units(const std::string& unit) {
  std::vector<std::string> names;
  for (const Unit& u : kUnits)
    if (unit == u.si) names.emplace_back(u.name);
  return names;
}

Result<double> parse_quantity(const std::string& text, const std::string& unit) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double number = 0.0;
  stream >> number;
  if (stream.fail() || !std::isfinite(number)) return Failure{ODO_E_CONFIG, "'" + text + "' is not a number"};
  std::string written;
  std::getline(stream >> std::ws, written);
  if (written.empty()) return number;
  for (const Unit& u : kUnits)
    if (written == u.name && unit == u.si) return number * u.factor;
  const auto known = compatible_units(unit);
  if (known.empty()) return Failure{ODO_E_CONFIG, "'" + written + "' stands after a number that has no unit"};
  return Failure{ODO_E_CONFIG, "unit '" + written + "' does not fit; expected one of " + join(known) + " (nearest: '" +
                                   nearest(written, known) + "')"};
}

}  // namespace odograph
