// SPDX-License-Identifier: Apache-2.0
#include <tiffio.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "plugins/fix/terrain/placement.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::terrain;

TEST_SUITE_BEGIN("terrain");

namespace {

void write(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

double height_at(const Terrain& terrain, double east, double north, double expected = 0) {
  double height = 0;
  return terrain.height_at(east, north, expected, height) ? height : std::nan("");
}

std::string why(const std::filesystem::path& file) {
  return reason_of([&] { read_terrain(file.string()); });
}

/// Heights 100 + east - 2 north of the first node, in whole metres, from the tie point on; rows from the north.
void write_geotiff(const std::filesystem::path& file, double east, double north, double cell, uint16_t epsg,
                   bool geographic, bool tiled) {
  static const TIFFFieldInfo fields[] = {
      {33550, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelPixelScale")},
      {33922, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelTiepoint")},
      {34735, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, const_cast<char*>("GeoKeyDirectory")},
      {42113, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("GDALNoData")}};
  constexpr uint32_t kSize = 40;
  TIFF* tiff = TIFFOpen(file.c_str(), "w");
  REQUIRE(tiff != nullptr);
  TIFFMergeFieldInfo(tiff, fields, 4);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kSize), TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kSize);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1), TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, tiled ? 16 : 32);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, tiled ? SAMPLEFORMAT_INT : SAMPLEFORMAT_IEEEFP);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  const double scale[3] = {cell, cell, 0}, tie[6] = {0, 0, 0, east, north, 0};
  TIFFSetField(tiff, 33550, 3, scale), TIFFSetField(tiff, 33922, 6, tie);
  const uint16_t keys[] = {1,
                           1,
                           0,
                           3,
                           1024,
                           0,
                           1,
                           static_cast<uint16_t>(geographic ? 2 : 1),
                           1025,
                           0,
                           1,
                           1,
                           static_cast<uint16_t>(geographic ? 2048 : 3072),
                           0,
                           1,
                           epsg};
  TIFFSetField(tiff, 34735, 16, keys);
  TIFFSetField(tiff, 42113, "-999");
  const auto value = [](uint32_t row, uint32_t column) {
    if (row == 39 && column == 39) return -999.0;
    return 100.0 + column - 2.0 * (kSize - 1 - row);
  };
  if (tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 32), TIFFSetField(tiff, TIFFTAG_TILELENGTH, 32);
    for (uint32_t top = 0; top < kSize; top += 32)
      for (uint32_t left = 0; left < kSize; left += 32) {
        std::vector<int16_t> tile(32 * 32, 0);
        for (uint32_t y = top; y < std::min(kSize, top + 32); ++y)
          for (uint32_t x = left; x < std::min(kSize, left + 32); ++x)
            tile[(y - top) * 32 + x - left] = static_cast<int16_t>(value(y, x));
        TIFFWriteTile(tiff, tile.data(), left, top, 0, 0);
      }
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 7);
    for (uint32_t y = 0; y < kSize; ++y) {
      std::vector<float> row(kSize);
      for (uint32_t x = 0; x < kSize; ++x) row[x] = static_cast<float>(value(y, x));
      TIFFWriteScanline(tiff, row.data(), y, 0);
    }
  }
  TIFFClose(tiff);
}

}  // namespace

TEST_CASE(
    "an ESRI ASCII grid is bilinear, with corner and centre keys and unknown heights, and damaged ones are rejected") {
  const TemporaryFolder folder;
  const auto file = folder / "g.asc";
  write(file, "ncols 3\nnrows 2\nxllcenter 100\nyllcenter 200\ncellsize 10\nNODATA_value -9\n1 2 -9\n5 6 7\n");
  const Terrain terrain = read_terrain(file.string());
  CHECK(height_at(terrain, 100, 200) == doctest::Approx(5));
  CHECK(height_at(terrain, 105, 205) == doctest::Approx(3.5));
  CHECK(std::isnan(height_at(terrain, 115, 205)));  // beside an unknown node
  CHECK(std::isnan(height_at(terrain, 99, 205)));
  write(file, "ncols 3\nnrows 2\nxllcorner 95\nyllcorner 195\ncellsize 10\n1 2 3\n5 6 7\n");
  CHECK(height_at(read_terrain(file.string()), 105, 205) == doctest::Approx(3.5));
  write(file, "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n5 six 7\n");
  CHECK(contains(why(file), "expected a number, found 'six'"));
  write(file, "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n5 6\n");
  CHECK(contains(why(file), "ends too early"));
  write(file, "ncols 3000000\nnrows 3000000\nxllcorner 0\nyllcorner 0\ncellsize 10\n1\n");
  CHECK(contains(why(file), "100 million"));
  CHECK(contains(why(folder / "none.asc"), "is not a file"));
}

TEST_CASE(
    "an OBJ mesh has slopes, walls that are not ground and the nearest of two floors, and invalid faces are rejected") {
  const TemporaryFolder folder;
  const auto file = folder / "m.obj";
  write(file,
        "# ground that rises to the east by 1 in 10, a bridge over it, a wall\n"
        "v 0 0 0\nv 100 0 10\nv 100 50 10\nv 0 50 0\nf 1/1 2/2 3/3 4/4\n"
        "v 40 0 12\nv 60 0 12\nv 60 50 12\nv 40 50 12\nf -4 -3 -2 -1\n"
        "v 20 0 30\nv 20 50 30\nv 20 50 0\nf 9 10 11\n");
  const Terrain terrain = read_terrain(file.string());
  CHECK(height_at(terrain, 20, 25) == doctest::Approx(2));
  CHECK(height_at(terrain, 33, 7) == doctest::Approx(3.3));
  CHECK(height_at(terrain, 50, 25, 5.5) == doctest::Approx(5));
  CHECK(height_at(terrain, 50, 25, 11) == doctest::Approx(12));
  CHECK(std::isnan(height_at(terrain, 101, 25)));
  write(file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  CHECK(contains(why(file), "a vertex that does not exist"));
  write(file, "v 0 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\n");
  CHECK(contains(why(file), "no ground: all triangles are upright"));
}

TEST_CASE("GeoTIFF in strips and tiles is placed by its reference system") {
  const TemporaryFolder folder;
  const double latitude = 48.7758, longitude = 9.1829;
  int zone = 0;
  bool north = true;
  double east_m = 0, north_m = 0;
  GeographicLib::UTMUPS::Forward(latitude, longitude, zone, north, east_m, north_m);
  // The tie point is the outer corner of the north-west pixel; the origin is node (19, 20 from the south).
  write_geotiff(folder / "utm.tif", east_m - 195, north_m + 195, 10, 32632, false, false);
  write_geotiff(folder / "tiles.tif", east_m - 195, north_m + 195, 10, 25832, false, true);
  for (const char* name : {"utm.tif", "tiles.tif"}) {
    CAPTURE(name);
    const Terrain terrain = read_terrain((folder / name).string());
    CHECK(height_at(terrain, east_m, north_m) == doctest::Approx(100 + 19 - 2 * 20));
    CHECK(height_at(terrain, east_m + 5, north_m) == doctest::Approx(100 + 19.5 - 2 * 20));
    CHECK(std::isnan(height_at(terrain, east_m + 199, north_m - 195)));
    const Placement placement({.geodetic_origin = {latitude, longitude, 300}, .geodetic = true, .geoid_height_m = 48},
                              terrain.reference());
    double down = 0;
    REQUIRE(placement.ground_at(terrain, 0, 0, 0, down));
    CHECK(down == doctest::Approx(300 - (79 + 48)).epsilon(1e-6));
    // 50 m true east: grid convergence there is 0.14 degrees.
    REQUIRE(placement.ground_at(terrain, 0, 50, 0, down));
    CHECK(down == doctest::Approx(300 - (79 + 5 + 48)).epsilon(1e-3));
  }
  const double cell = 1e-4;
  write_geotiff(folder / "degrees.tif", longitude - 19.5 * cell, latitude + 19.5 * cell, cell, 4326, true, false);
  const Terrain terrain = read_terrain((folder / "degrees.tif").string());
  const Placement placement({.geodetic_origin = {latitude, longitude, 300}, .geodetic = true}, terrain.reference());
  double down = 0;
  REQUIRE(placement.ground_at(terrain, 0, 0, 0, down));
  CHECK(down == doctest::Approx(300 - 79).epsilon(1e-6));
  write_geotiff(folder / "other.tif", 0, 0, 10, 31255, false, false);
  const Terrain other = read_terrain((folder / "other.tif").string());
  CHECK(Placement({.geodetic = true}, other.reference()).accuracy_m() > 1);  // its zero is near Trieste
  // Heights and coordinates in US feet: 2263 by latitude and longitude, whose datum is taken as WGS 84.
  const double feet = 3937.0 / 1200;
  write_geotiff(folder / "feet.tif", 307868.958 * feet - 195, 90987.680 * feet + 195, 10, 2263, false, false);
  const Terrain new_york = read_terrain((folder / "feet.tif").string());
  const std::array<double, 2> roon{40 + 59 / 60.0 + 9.55699 / 3600, -73 - 54 / 60.0 - 23.37124 / 3600};
  const Placement placed({.geodetic_origin = {roon[0], roon[1], 0}, .geodetic = true}, new_york.reference());
  REQUIRE(placed.ground_at(new_york, 0, 0, 0, down));
  CHECK(down == doctest::Approx(-79 / feet).epsilon(1e-4));
  CHECK(placed.accuracy_m() == 0);
  CHECK(contains(placed.description(), "EPSG:2263"));
  CHECK_THROWS_WITH_AS(Placement({}, new_york.reference()), doctest::Contains("are in the unit US survey foot"),
                       std::runtime_error);
  write(folder / "broken.tif", "II*");
  CHECK(contains(why(folder / "broken.tif"), "is not a TIFF file"));
}

TEST_CASE("a model's own coordinates have its origin, its north and its zero height") {
  const TemporaryFolder folder;
  write(folder / "g.asc", "ncols 2\nnrows 2\nxllcenter 1000\nyllcenter 2000\ncellsize 100\n10 20\n10 20\n");
  const Terrain terrain = read_terrain((folder / "g.asc").string());
  double down = 0;
  const Placement straight({.model_origin = {1000, 2000, 12}}, {});
  REQUIRE(straight.ground_at(terrain, 50, 30, 0, down));
  CHECK(down == doctest::Approx(12 - 13));
  CHECK_FALSE(straight.ground_at(terrain, 50, -30, 0, down));
  const Placement turned({.model_origin = {1000, 2000, 12}, .grid_north_rad = -EIGEN_PI / 2}, {});  // to the west
  REQUIRE(turned.ground_at(terrain, 30, -50, 0, down));
  CHECK(down == doctest::Approx(12 - 13));
}

TEST_CASE("eq. (4): a phone is at 0.9 of the walker's height above the ground, for walkers of 1.50 and 1.90 m") {
  // Ground 2 m above n's origin: down = -(2 + 0.9 * 1.50) = -3.35 m and -(2 + 0.9 * 1.90) = -3.71 m.
  const TemporaryFolder folder;
  write(folder / "flat.obj", "v -50 -50 2\nv 50 -50 2\nv 50 50 2\nv -50 50 2\nf 1 2 3 4\n");
  Scenario s;
  s.route = {{0, 0, 2}, {10, 0, 2}};
  const Recording recording = recorded_sensors(s, 2);
  for (const auto& walker : {std::pair{"1.50", -3.35}, {"1.90", -3.71}}) {
    write(folder / "p.yaml", std::string("odograph: 1\nwalker: {height: ") + walker.first +
                                 " m}\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n"
                                 "absolute_fixers:\n  - plugin: fix/terrain\n    parameters: {model: flat.obj}\n");
    const RunResult result = run_of(recording, folder / "p.yaml");
    REQUIRE(result.fixes.size() >= 5);
    for (const RunResult::Fix& fix : result.fixes)
      CHECK(fix.fix.p_n[2] == doctest::Approx(walker.second).epsilon(1e-9));
  }
}

TEST_CASE("heights on slopes, a kerb and stairs are within 0.3 m of the truth, with terrain and horizontal fixes") {
  // n's origin is the model's. Without `origin` it would be the first fix, and the model would have that error.
  const TemporaryFolder folder;
  const std::vector<std::pair<double, double>> profile = {{-40, 0}, {0, 0},   {40, 3}, {80, 1},
                                                          {110, 6}, {116, 9}, {200, 9}};
  {  // strips 200 m wide
    std::ofstream mesh(folder / "hill.obj");
    for (const auto& [north, up] : profile)
      mesh << "v -100 " << north << ' ' << up << "\nv 100 " << north << ' ' << up << '\n';
    for (size_t k = 0; k + 1 < profile.size(); ++k)
      mesh << "f " << 2 * k + 1 << ' ' << 2 * k + 2 << ' ' << 2 * k + 4 << ' ' << 2 * k + 3 << '\n';
  }
  write(folder / "p.yaml",
        "odograph: 1\nnavigation:\n  origin: {latitude: 0.8238 rad, longitude: -0.0271 rad, height: 20 m}\n"
        "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\ncoupling:\n  type: "
        "localizer\n"
        "absolute_fixers:\n  - plugin: fix/gnss\n    parameters: {min_sigma: 1 m, correlation: 0 s}\n  - plugin: "
        "fix/terrain\n"
        "    parameters: {model: hill.obj, hand: 0.75, max_horizontal_sigma: 3 m}\n");
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {40, 0, 3}, {80, 0, 1}, {110, 0, 6}, {116, 0, 9}, {140, 0, 9}};
  s.events = {{20, "cross", 5}};
  s.gnss = {.sigma_m = 0.7, .canyon_sigma_m = 0.7, .correlation_s = 5, .availability = 1};
  std::vector<double> rms;
  double all_squares = 0, all = 0, treads_on_slopes = 0, steps_on_slopes = 0;
  for (const uint64_t seed : {2, 3, 4, 5, 6}) {
    const Recording recording = recorded_sensors(s, seed);
    const RunResult result = run_of(recording, folder / "p.yaml");
    double squares = 0, n = 0;
    size_t at = 0;
    const auto& truth = recording.true_states;
    for (const odo_step& step : result.steps) {
      const auto then = std::lower_bound(truth.begin(), truth.end(), step.t_start_ns,
                                         [](const TrueState& a, int64_t t) { return a.t_ns < t; });
      if (then == truth.end() || then->p.x() > 109) continue;
      steps_on_slopes += 1, treads_on_slopes += step.mode == ODO_MODE_STAIRS;
    }
    for (const StampedPose& pose : result.track) {
      if (pose.t_ns < truth.front().t_ns + 10'000'000'000) continue;
      while (at + 1 < truth.size() && truth[at].t_ns < pose.t_ns) ++at;
      squares += std::pow(pose.p.z() - truth[at].p.z(), 2), n += 1;
    }
    rms.push_back(std::sqrt(squares / n));
    all_squares += squares, all += n;
  }
  CHECK(std::sqrt(all_squares / all) < 0.20);         // 0.19
  CHECK(percentile(rms, 0.5) < 0.18);                 // 0.16
  CHECK(percentile(rms, 1.0) < 0.30);                 // 0.294
  CHECK(treads_on_slopes / steps_on_slopes < 0.014);  // 8 of 745
  MESSAGE("heights: " << percentile(rms, 0.5) << " m rms in the median, " << percentile(rms, 1.0) << " m the worst, "
                      << std::sqrt(all_squares / all) << " m over all; treads on slopes: " << treads_on_slopes << " of "
                      << steps_on_slopes << " steps");
}
