// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "plugins/fix/terrain/geotiff.hpp"
#include "plugins/fix/terrain/terrain.hpp"
#include "sdk/math/number_text.hpp"

namespace odograph::terrain {
namespace {

constexpr size_t kMaxVertices = 20'000'000;
constexpr uintmax_t kLargest_bytes = 2'000'000'000;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The words of a text file, in order.
class Words {
 public:
  Words(const std::string& file, std::istream& in) : file_(file), in_(in) {}
  bool next() { return static_cast<bool>(in_ >> word_); }
  const std::string& word() const { return word_; }
  double number() {
    if (!next()) refuse(file_, "ends too early");
    return number_of(word_);
  }
  double number_of(const std::string& word) const {
    const auto value = parse_number(word);
    if (!value) refuse(file_, "expected a number, found '" + word + "'");
    return *value;
  }

 private:
  const std::string& file_;
  std::istream& in_;
  std::string word_;
};

/// ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, NODATA_value; then rows from the north.
Terrain read_ascii_grid(const std::string& file, std::istream& in) {
  Words words(file, in);
  double columns = 0, rows = 0, east = 0, north = 0, cell = 0, missing = std::nan("");
  bool corner_east = false, corner_north = false, has_first = false;
  double first = 0;
  while (words.next()) {
    const std::string key = lower(words.word());
    if (key.empty() || !std::isalpha(static_cast<unsigned char>(key[0]))) {
      first = words.number_of(words.word()), has_first = true;
      break;
    }
    const double value = words.number();
    if (key == "ncols")
      columns = value;
    else if (key == "nrows")
      rows = value;
    else if (key == "xllcorner")
      east = value, corner_east = true;
    else if (key == "xllcenter")
      east = value;
    else if (key == "yllcorner")
      north = value, corner_north = true;
    else if (key == "yllcenter")
      north = value;
    else if (key == "cellsize")
      cell = value;
    else if (key == "nodata_value")
      missing = value;
    else
      refuse(file, "'" + key + "' is not a key of an ESRI ASCII grid");
  }
  if (!(columns >= 2 && rows >= 2 && columns * rows <= static_cast<double>(kMaxNodes)))
    refuse(file, "expected ncols and nrows of at least 2, and at most 100 million nodes");
  if (!(cell > 0) || !has_first) refuse(file, "expected a cellsize above 0, and heights");
  Grid grid;
  grid.columns = static_cast<size_t>(columns), grid.rows = static_cast<size_t>(rows);
  grid.cell_east_m = grid.cell_north_m = cell;
  grid.east_m = east + (corner_east ? 0.5 * cell : 0), grid.north_m = north + (corner_north ? 0.5 * cell : 0);
  grid.height_m.resize(grid.columns * grid.rows);
  for (size_t k = 0; k < grid.height_m.size(); ++k) {
    const double value = k == 0 ? first : words.number();
    const size_t row = grid.rows - 1 - k / grid.columns;
    grid.height_m[row * grid.columns + k % grid.columns] =
        value == missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
  }
  return Terrain(std::move(grid));
}

/// `v x y z` and `f a b c ...`; corners may have `/texture/normal`, and count from the end if negative.
Terrain read_obj(const std::string& file, std::istream& in) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream text(line);
    Words words(file, text);
    if (!words.next()) continue;
    if (words.word() == "v") {
      if (vertices.size() == kMaxVertices) refuse(file, "has more than 20 million vertices");
      const double x = words.number(), y = words.number(), z = words.number();
      vertices.emplace_back(x, y, z);
    } else if (words.word() == "f") {
      std::vector<uint32_t> corners;
      while (words.next()) {
        const double index = words.number_of(words.word().substr(0, words.word().find('/')));
        const double from_start = index < 0 ? static_cast<double>(vertices.size()) + index : index - 1;
        if (!(from_start >= 0 && from_start < static_cast<double>(vertices.size())))
          refuse(file, "a face refers to a vertex that does not exist");
        corners.push_back(static_cast<uint32_t>(from_start));
      }
      if (triangles.size() + corners.size() > kMaxVertices) refuse(file, "has more than 20 million triangles");
      for (size_t k = 2; k < corners.size(); ++k) triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  try {
    return Terrain(Mesh(std::move(vertices), triangles));
  } catch (const std::runtime_error& error) {
    refuse(file, error.what());
  }
}

}  // namespace

Terrain read_terrain(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) refuse(file, "is not a file");
  if (std::filesystem::file_size(file, error) > kLargest_bytes) refuse(file, "is larger than 2 GB");
  const std::string end = lower(std::filesystem::path(file).extension().string());
  if (end == ".tif" || end == ".tiff") return read_geotiff(file);
  std::ifstream in(file);
  if (!in) refuse(file, "cannot be read");
  if (end == ".asc") return read_ascii_grid(file, in);
  if (end == ".obj") return read_obj(file, in);
  refuse(file, "expected an ESRI ASCII grid (.asc), an OBJ mesh (.obj) or a GeoTIFF (.tif)");
}

}  // namespace odograph::terrain
