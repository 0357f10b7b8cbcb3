// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "sdk/tools/city/georeferenced_city.hpp"
#include "sdk/tools/city/photograph_localizer.hpp"
#include "sdk/tools/table/table.hpp"

namespace odograph {

/// What a search used of the command line and of EXIF.
struct PhotographInputs {
  PhotographGuess guess;
  double focal_px;  ///< of the whole picture
};

/// A row of the table of located photographs: docs/photographs.md.
Json row_of_photograph(const std::filesystem::path& file, const GeoreferencedCity& city,
                       const std::optional<PhotographInputs>& prior, const PhotographPose& placed,
                       double above_ground_m);
/// The same in words.
std::string text_of_photograph(const Json& row);

/// The table, written row by row: an interrupted run leaves what it has done.
class PhotographCsv {
 public:
  PhotographCsv(const std::filesystem::path& file, bool geodetic);
  Result<bool> add(const Json& row);

 private:
  std::string name_;
  std::ofstream out_;
  std::vector<std::string> keys_;
};

}  // namespace odograph
