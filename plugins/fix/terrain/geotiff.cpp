// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/terrain/geotiff.hpp"

#include <tiffio.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

namespace odograph::terrain {
namespace {

constexpr ttag_t kPixelScale = 33550, kTiepoint = 33922, kTransformation = 34264, kGeoKeys = 34735, kNoData = 42113;
constexpr uint16_t kRasterType = 1025, kPixelIsPoint = 2, kModelType = 1024, kModelGeographic = 2;
constexpr uint16_t kGeographicType = 2048, kProjectedType = 3072, kVerticalType = 4096, kVerticalUnits = 4099;
constexpr uint16_t kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003, kUserDefined = 32767;
constexpr double kFoot_m = 0.3048, kSurveyFoot_m = 1200.0 / 3937;
void declare_tags(TIFF* tiff) {
  static const TIFFFieldInfo fields[] = {
      {kPixelScale, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelPixelScale")},
      {kTiepoint, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelTiepoint")},
      {kTransformation, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelTransformation")},
      {kGeoKeys, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, const_cast<char*>("GeoKeyDirectory")},
      {kNoData, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("GDALNoData")}};
  TIFFMergeFieldInfo(tiff, fields, sizeof fields / sizeof *fields);
}

/// Decodes a height.
double value_at(const uint8_t* data, size_t index, uint16_t bits, uint16_t format) {
  const auto as = [&](auto value) {
    std::memcpy(&value, data + index * sizeof value, sizeof value);
    return static_cast<double>(value);
  };
  if (format == SAMPLEFORMAT_IEEEFP) return bits == 64 ? as(double{}) : as(float{});
  if (format == SAMPLEFORMAT_INT) return bits == 32 ? as(int32_t{}) : bits == 16 ? as(int16_t{}) : as(int8_t{});
  return bits == 32 ? as(uint32_t{}) : bits == 16 ? as(uint16_t{}) : as(uint8_t{});
}

struct Keys {
  Reference reference;
  bool point = false;
};

Keys keys_of(TIFF* tiff, const std::string& file) {
  Keys keys;
  uint16_t count = 0;
  const uint16_t* values = nullptr;
  if (!TIFFGetField(tiff, kGeoKeys, &count, &values)) return keys;
  for (uint16_t k = 4; k + 3 < count; k = static_cast<uint16_t>(k + 4)) {
    if (values[k + 1] != 0) continue;  // not stored inline: a text or a double
    const uint16_t value = values[k + 3];
    if (value == kUserDefined) continue;
    if (values[k] == kRasterType) keys.point = value == kPixelIsPoint;
    if (values[k] == kModelType) keys.reference.geographic = value == kModelGeographic;
    if (values[k] == kProjectedType || (values[k] == kGeographicType && keys.reference.epsg == 0))
      keys.reference.epsg = value;
    if (values[k] == kVerticalType) keys.reference.vertical_epsg = value;
    if (values[k] != kVerticalUnits) continue;
    if (value != kMetre && value != kFoot && value != kSurveyFoot)
      refuse(file, "heights are neither in metres nor in feet");
    keys.reference.height_unit_m = value == kMetre ? 1 : value == kFoot ? kFoot_m : kSurveyFoot_m;
  }
  return keys;
}

void read_heights(TIFF* tiff, const std::string& file, double missing, Grid& grid) {
  uint16_t bits = 0, format = SAMPLEFORMAT_UINT, samples = 1;
  TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  const bool known = bits == 16 || bits == 32 || (bits == 64 && format == SAMPLEFORMAT_IEEEFP) ||
                     (bits == 8 && format != SAMPLEFORMAT_IEEEFP);
  if (samples != 1 || !known || (format == SAMPLEFORMAT_IEEEFP && bits == 16))
    refuse(file, "expected one band of integers or floats");
  const bool tiled = TIFFIsTiled(tiff) != 0;
  uint32_t width = static_cast<uint32_t>(grid.columns), height = 1;
  if (tiled) TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width), TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
  const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFScanlineSize(tiff);
  if (width == 0 || height == 0 || size <= 0 || static_cast<uint64_t>(size) / width / (bits / 8) < height)
    refuse(file, "its tiles are damaged");
  std::vector<uint8_t> buffer(static_cast<size_t>(size));
  for (uint32_t top = 0; top < grid.rows; top += height)
    for (uint32_t left = 0; left < grid.columns; left += width) {
      const bool ok = tiled ? TIFFReadTile(tiff, buffer.data(), left, top, 0, 0) >= 0
                            : TIFFReadScanline(tiff, buffer.data(), top, 0) >= 0;
      if (!ok) refuse(file, "its heights are damaged");
      for (uint32_t y = top; y < std::min<size_t>(grid.rows, top + height); ++y)
        for (uint32_t x = left; x < std::min<size_t>(grid.columns, left + width); ++x) {
          const double value = value_at(buffer.data(), static_cast<size_t>(y - top) * width + (x - left), bits, format);
          grid.height_m[(grid.rows - 1 - y) * grid.columns + x] =
              value == missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
        }
    }
}

}  // namespace

Terrain read_geotiff(const std::string& file) {
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(nullptr);
  TIFFSetTagExtender(declare_tags);
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(file.c_str(), "r"), TIFFClose);
  if (!tiff) refuse(file, "is not a TIFF file");
  uint32_t columns = 0, rows = 0;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &columns);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &rows);
  if (columns < 2 || rows < 2 || columns > kMaxNodes / rows) refuse(file, "expected 2 x 2 to 100 million heights");
  uint16_t count = 0;
  const double* values = nullptr;
  if (TIFFGetField(tiff.get(), kTransformation, &count, &values)) refuse(file, "a rotated grid is not supported");
  if (!TIFFGetField(tiff.get(), kPixelScale, &count, &values) || count < 2 || !(values[0] > 0 && values[1] > 0))
    refuse(file, "has no georeference (ModelPixelScale)");
  Grid grid;
  grid.columns = columns, grid.rows = rows;
  grid.cell_east_m = values[0], grid.cell_north_m = values[1];
  if (!TIFFGetField(tiff.get(), kTiepoint, &count, &values) || count < 6)
    refuse(file, "has no georeference (ModelTiepoint)");
  Keys keys = keys_of(tiff.get(), file);
  // A tie point refers to the corner of its pixel, unless pixels are points.
  const double half = keys.point ? 0.0 : 0.5;
  grid.east_m = values[3] + (half - values[0]) * grid.cell_east_m;
  const double north_m = values[4] - (half - values[1]) * grid.cell_north_m;  // of the first row
  grid.north_m = north_m - static_cast<double>(rows - 1) * grid.cell_north_m;
  double missing = std::nan("");
  const char* text = nullptr;
  if (TIFFGetField(tiff.get(), kNoData, &text) && text) missing = std::strtod(text, nullptr);
  grid.height_m.resize(static_cast<size_t>(columns) * rows);
  read_heights(tiff.get(), file, missing, grid);
  keys.reference.middle = {grid.east_m + 0.5 * static_cast<double>(columns - 1) * grid.cell_east_m,
                           grid.north_m + 0.5 * static_cast<double>(rows - 1) * grid.cell_north_m};
  return Terrain(std::move(grid), keys.reference);
}

}  // namespace odograph::terrain
