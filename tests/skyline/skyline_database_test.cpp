// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <opencv2/core.hpp>

#include "plugins/fix/skyline/skyline_database.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline_database");

namespace {

/// The edges of random upright boxes.
std::vector<Edge> a_town(int houses, double extent_m, uint64_t seed) {
  cv::RNG random(seed);
  std::vector<std::vector<Vector3d>> rings;
  for (int k = 0; k < houses; ++k) {
    const double n = random.uniform(-extent_m, extent_m), e = random.uniform(-extent_m, extent_m);
    const double a = random.uniform(3.0, 12.0), b = random.uniform(3.0, 12.0), h = random.uniform(4.0, 25.0);
    const Vector3d corners[] = {{n - a, e - b, -h}, {n + a, e - b, -h}, {n + a, e + b, -h}, {n - a, e + b, -h}};
    rings.emplace_back(corners, corners + 4);
    for (int i = 0; i < 4; ++i) {
      Vector3d foot = corners[i], next = corners[(i + 1) % 4];
      foot.z() = next.z() = 0;
      rings.push_back({corners[i], corners[(i + 1) % 4], next, foot});
    }
  }
  return edges_of(rings);
}

std::vector<Vector3d> a_grid(double extent_m, double spacing_m) {
  std::vector<Vector3d> places;
  for (double n = -extent_m; n <= extent_m; n += spacing_m)
    for (double e = -extent_m; e <= extent_m; e += spacing_m) places.emplace_back(n + 0.37, e - 0.21, -1.5);
  return places;
}

DatabaseParameters parameters(unsigned threads) {
  DatabaseParameters p;
  p.origin = Vector3d(-199.5, 5.25, 262);
  p.spacing_m = 10;
  p.threads = threads;
  return p;
}

/// Fraction of the directions above two degrees in which a database and the model differ.
double wrong_part(const SkylineDatabase& database, const std::vector<Edge>& edges) {
  City city(edges);
  Horizon there, exact;
  size_t wrong = 0, all = 0;
  for (size_t i = 0; i < database.size(); ++i) {
    city.select_near_edges(database.place(i), 0.1, 0.0175);
    city.horizon(database.place(i), exact);
    REQUIRE(database.horizon(i, there));
    for (size_t j = 0; j < Horizon::kDirections; ++j) {
      if (exact.elevation[j] < 0.035f) continue;
      const bool same = std::abs(there.elevation[j] - exact.elevation[j]) < 1e-4f &&
                        std::abs(there.height_m[j] - exact.height_m[j]) < 0.02f &&
                        std::abs(there.distance_m[j] - exact.distance_m[j]) < 0.02f;
      wrong += !same, ++all;
    }
  }
  REQUIRE(all > 1000);
  return static_cast<double>(wrong) / static_cast<double>(all);
}

std::string refusal(const std::string& bytes) {
  return reason_of([&] { (void)SkylineDatabase::view(bytes, "town.skylines"); });
}

/// Bytes with a changed header and a valid checksum.
template <class Change>
std::string with_header(std::string bytes, Change&& change) {
  DatabaseHeader h;
  std::memcpy(&h, bytes.data(), sizeof h);
  change(h);
  h.checksum = checksum_of(h);
  std::memcpy(bytes.data(), &h, sizeof h);
  return bytes;
}

}  // namespace

TEST_CASE("a database says of each place elevation, height and distance as the model has them") {
  const TemporaryFolder folder;
  const std::string file = folder / "town.skylines";
  const auto edges = a_town(60, 120, 3);
  const auto places = a_grid(60, 10);
  size_t told = 0;
  REQUIRE(build_database(edges, places, parameters(2), file, [&](size_t done) {
    told = done;
    return true;
  }));
  CHECK(told == places.size());
  const auto database = SkylineDatabase::open(file);
  CHECK(database.size() == places.size());
  CHECK(database.origin() == Vector3d(-199.5, 5.25, 262));
  CHECK(database.spacing_m() == 10);
  CHECK(wrong_part(database, edges) < 0.002);  // where a direction meets a corner
  // The database's edges alone give the same skylines.
  CHECK(wrong_part(database, database.edges()) < 0.002);
  Horizon horizon;
  REQUIRE(database.horizon(7, horizon));
  const auto signature = SkylineDatabase::signature_of(horizon);
  for (size_t s = 0; s < signature.size(); ++s) CHECK(std::abs(int(signature[s]) - int(database.signature(7)[s])) <= 1);
}

TEST_CASE("a database is the same bytes on any number of threads") {
  const TemporaryFolder folder;
  const auto edges = a_town(40, 100, 5);
  const auto places = a_grid(80, 10);
  for (const unsigned threads : {1u, 4u})
    REQUIRE(build_database(edges, places, parameters(threads), folder / ("t" + std::to_string(threads)), {}));
  CHECK(read_text(folder / "t1") == read_text(folder / "t4"));
}

TEST_CASE("a place takes at most a kilobyte, however many roofs are seen from it") {
  const TemporaryFolder folder;
  const std::string file = folder / "town.skylines";
  std::vector<Edge> edges;
  cv::RNG random(9);
  for (int k = 0; k < 60'000; ++k) {  // splinters: hardly two directions show the same one
    const double azimuth = random.uniform(0.0, 6.283), r = random.uniform(50.0, 150.0), up = random.uniform(5.0, 40.0);
    const Vector3d p(r * std::cos(azimuth), r * std::sin(azimuth), -up);
    edges.push_back({p, p + Vector3d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.3}});
  }
  const auto places = a_grid(20, 4);
  REQUIRE(build_database(edges, places, parameters(2), file, {}));
  const auto database = SkylineDatabase::open(file);
  const double shared = 128 + 24.0 * static_cast<double>(database.edges().size());
  CHECK((static_cast<double>(database.bytes()) - shared) / static_cast<double>(database.size()) <= 1024);
  Horizon horizon;
  for (size_t i = 0; i < database.size(); ++i) CHECK(database.horizon(i, horizon));
}

TEST_CASE("the nearest place is the nearest of all") {
  const TemporaryFolder folder;
  const std::string file = folder / "town.skylines";
  std::vector<Vector3d> places;
  cv::RNG random(4);
  for (int k = 0; k < 500; ++k) places.push_back({random.uniform(-300.0, 300.0), random.uniform(-40.0, 40.0), -1.5});
  REQUIRE(build_database(a_town(10, 60, 1), places, parameters(1), file, {}));
  const auto database = SkylineDatabase::open(file);
  for (int k = 0; k < 300; ++k) {
    const double n = random.uniform(-500.0, 500.0), e = random.uniform(-500.0, 500.0);
    const auto distance = [&](size_t i) { return (database.place(i) - Vector3d(n, e, -1.5)).norm(); };
    double least = 1e9;
    for (size_t i = 0; i < database.size(); ++i) least = std::min(least, distance(i));
    CHECK(distance(database.nearest(n, e)) == doctest::Approx(least));
  }
}

TEST_CASE("a build that is stopped leaves no file; one that cannot be written says so") {
  const TemporaryFolder folder;
  const auto edges = a_town(10, 60, 1);
  const auto places = a_grid(60, 2);
  CHECK_FALSE(build_database(edges, places, parameters(2), folder / "x", [](size_t) { return false; }));
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK_THROWS_WITH(build_database(edges, places, parameters(1), folder / "no/x", {}),
                    ((folder / "no/x").string() + ": cannot be written").c_str());
}

TEST_CASE("damaged and hostile databases are refused in words, or their places are") {
  const TemporaryFolder folder;
  const std::string file = folder / "town.skylines";
  REQUIRE(build_database(a_town(30, 80, 2), a_grid(30, 10), parameters(1), file, {}));
  const std::string good = read_text(file);
  CHECK(refusal(good).empty());
  CHECK(refusal(good.substr(0, 50)) == "town.skylines: too short for a skyline database");
  CHECK(contains(refusal("{" + good), "not a skyline database"));
  CHECK(refusal(good.substr(0, good.size() - 8)).find("bytes long") != std::string::npos);
  std::string flipped = good;
  flipped[40] = static_cast<char>(flipped[40] ^ 1);
  CHECK(contains(refusal(flipped), "checksum"));
  using H = DatabaseHeader;
  CHECK(refusal(with_header(good, [](H& h) { h.version = 7; })).find("version 7; this program reads version 1") !=
        std::string::npos);
  CHECK(refusal(with_header(good, [](H& h) { h.directions = 360; })).find("360 directions") != std::string::npos);
  for (const auto change : {+[](H& h) { h.places = UINT64_MAX / 20; }, +[](H& h) { h.runs = UINT64_MAX; },
                            +[](H& h) { h.edges_at = UINT64_MAX - 7; }, +[](H& h) { h.places_at += 1; },
                            +[](H& h) { h.signatures_at = h.file_bytes + 8; }, +[](H& h) { h.runs_at = 0; }})
    CHECK(contains(refusal(with_header(good, change)), "beyond its end"));
  CHECK(refusal(with_header(good, [](H& h) { h.origin[1] = NAN; })).find("origin") != std::string::npos);
  CHECK_THROWS(SkylineDatabase::open("/dev/zero"));
  CHECK_THROWS(SkylineDatabase::open(folder.path()));
  // Any byte behind the header may be corrupt: nothing is read beyond the file, and the results are finite.
  cv::RNG random(8);
  size_t refused = 0;
  for (int k = 0; k < 400; ++k) {
    std::string bad = good;
    for (int n = 0; n < 8; ++n) {
      const int span = static_cast<int>(bad.size() - sizeof(DatabaseHeader));
      bad[sizeof(DatabaseHeader) + static_cast<size_t>(random.uniform(0, span))] =
          static_cast<char>(random.uniform(0, 256));
    }
    if (!refusal(bad).empty()) {
      ++refused;
      continue;
    }
    const auto database = SkylineDatabase::view(bad, "town.skylines");
    Horizon horizon;
    (void)database.edges();
    (void)database.nearest(3, 4);
    for (size_t i = 0; i < database.size(); ++i) {
      if (!database.horizon(i, horizon))
        ++refused;
      else
        CHECK(
            std::all_of(horizon.elevation.begin(), horizon.elevation.end(), [](float e) { return std::isfinite(e); }));
    }
  }
  CHECK(refused > 100);
}
