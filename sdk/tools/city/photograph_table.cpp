// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/photograph_table.hpp"

#include <array>
#include <cmath>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

double degrees(double rad) { return std::fmod(rad / kRad_per_deg + 360, 360); }

/// Names of the coordinates in the table.
std::array<std::string, 2> axes_of(bool geodetic) {
  return geodetic ? std::array<std::string, 2>{"latitude_deg", "longitude_deg"}
                  : std::array<std::string, 2>{"easting_m", "northing_m"};
}

/// As RFC 4180 quotes text.
std::string csv_field(const Json& value) {
  if (!value.is_string()) return value.dump();
  std::string quoted = "\"";
  for (const char c : value.get<std::string>()) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

}  // namespace

Json row_of_photograph(const std::filesystem::path& file, const GeoreferencedCity& city,
                       const std::optional<PhotographInputs>& prior, const PhotographPose& placed,
                       double above_ground_m) {
  Json row = {{"picture", file.string()}, {"placed", placed.placed}};
  const auto axes = axes_of(city.is_geodetic());
  if (prior) {
    const PhotographGuess& guess = prior->guess;
    const Coordinates at = city.coordinates({guess.north_m, guess.east_m, 0});
    for (const size_t i : {0u, 1u}) row["prior_" + axes[i]] = at[i];
    row["prior_sigma_m"] = guess.sigma_m;
    if (guess.heading_rad) row["prior_heading_deg"] = degrees(*guess.heading_rad);
    if (guess.heading_rad) row["prior_heading_sigma_deg"] = guess.heading_sigma_rad / kRad_per_deg;
    row["focal_px"] = prior->focal_px;
  }
  if (!placed.placed) {
    row["reason"] = placed.why;
    return row;
  }
  const Coordinates at = city.coordinates(placed.p_n);
  for (const size_t i : {0u, 1u}) row[axes[i]] = at[i];
  row["sigma_m"] = placed.sigma_m();
  row["height_m"] = -placed.p_n.z();
  row["above_ground_m"] = above_ground_m;
  row["heading_deg"] = degrees(placed.heading_rad());
  row["heading_sigma_deg"] = placed.heading_sigma_rad / kRad_per_deg;
  row["pitch_deg"] = placed.pitch_rad() / kRad_per_deg;
  row["roll_deg"] = placed.roll_rad() / kRad_per_deg;
  row["agreement"] = placed.agreement;
  row["risk"] = placed.integrity;
  return row;
}

std::string text_of_photograph(const Json& row) {
  const auto number = [&](const char* key) { return row[key].get<double>(); };
  const std::string name = row["picture"].get<std::string>();
  if (!row["placed"].get<bool>()) return name + ": not placed: " + row["reason"].get<std::string>();
  const bool grid = row.contains("easting_m");
  const std::string place = grid ? text("easting %.2f, northing %.2f", number("easting_m"), number("northing_m"))
                                 : text("%.7f, %.7f", number("latitude_deg"), number("longitude_deg"));
  return name + ": " + place +
         text(
             " (sigma %.1f m), looks to %.1f deg (sigma %.1f), %+.1f deg up, rolled by %+.1f; agreement %.2f, risk "
             "%.2f",
             number("sigma_m"), number("heading_deg"), number("heading_sigma_deg"), number("pitch_deg"),
             number("roll_deg"), number("agreement"), number("risk"));
}

PhotographCsv::PhotographCsv(const std::filesystem::path& file, bool geodetic) : name_(file.string()), out_(file) {
  const auto axes = axes_of(geodetic);
  keys_ = {"picture",
           "placed",
           axes[0],
           axes[1],
           "sigma_m",
           "height_m",
           "above_ground_m",
           "heading_deg",
           "heading_sigma_deg",
           "pitch_deg",
           "roll_deg",
           "agreement",
           "risk",
           "drawing",
           "reason",
           "prior_" + axes[0],
           "prior_" + axes[1],
           "prior_sigma_m",
           "prior_heading_deg",
           "prior_heading_sigma_deg",
           "focal_px"};
  for (size_t k = 0; k < keys_.size(); ++k) out_ << (k ? "," : "") << keys_[k];
  out_ << '\n';
}

Result<bool> PhotographCsv::add(const Json& row) {
  for (size_t k = 0; k < keys_.size(); ++k) {
    out_ << (k ? "," : "");
    if (row.contains(keys_[k])) out_ << csv_field(row[keys_[k]]);
  }
  out_ << '\n';
  return out_.flush() ? Result<bool>(true) : Failure{ODO_E_IO, name_ + ": cannot be written"};
}

}  // namespace odograph
