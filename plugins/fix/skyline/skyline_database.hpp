// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plugins/fix/skyline/horizon.hpp"

namespace odograph::skyline {

/// The skylines of many places: eq. (2) of Gakne & O'Keefe 2018. In the file a skyline is a list of runs: a range of
/// azimuths and the edge of the model that is highest there. Elevation, height and distance of each of the 720
/// directions are computed from the edge's geometry, to the precision of 32-bit floats. Format:
/// docs/skyline_database.md.
class SkylineDatabase {
 public:
  static constexpr int kSectors = 48;  ///< of a signature: 7.5 degrees each
  static constexpr int kSectorSize = Horizon::kDirections / kSectors;
  static constexpr size_t kMaxRuns = 239;  ///< of a place: 1,024 bytes with record and signature
  using Signature = std::array<uint8_t, kSectors>;

  SkylineDatabase() = default;
  ~SkylineDatabase();
  SkylineDatabase(SkylineDatabase&& other) noexcept { swap(other); }
  SkylineDatabase& operator=(SkylineDatabase&& other) noexcept {
    swap(other);
    return *this;
  }
  /// Maps a file into memory. Throws std::runtime_error, with file and reason, where it is not a database, has another
  /// version, is truncated or has an inconsistent header. The runs of a place are checked by horizon() only.
  static SkylineDatabase open(const std::string& file);
  /// The same over bytes that must outlive it; `name` replaces the file in messages.
  static SkylineDatabase view(std::string_view bytes, const std::string& name);

  size_t size() const { return places_; }
  size_t bytes() const { return size_; }
  /// Easting, northing and height of n's origin in the model's reference system.
  const Eigen::Vector3d& origin() const { return origin_; }
  double spacing_m() const { return spacing_m_; }
  /// In n (north, east, down; m) with that origin.
  Eigen::Vector3d place(size_t i) const;
  /// The skyline of a place; false where the file is damaged there. Thread: any.
  bool horizon(size_t i, Horizon& out) const;
  /// Mean elevation of each sector; 255 is the zenith.
  const uint8_t* signature(size_t i) const { return signatures_ + i * kSectors; }
  static Signature signature_of(const Horizon& skyline);
  /// The place that is horizontally nearest to a point of n. size() must not be 0. Thread: any.
  size_t nearest(double north_m, double east_m) const;
  /// The model's edges that are visible from a place; none where the file is damaged there.
  std::vector<Edge> edges_seen_from(size_t i) const;
  /// The model's edges that are visible from any place.
  std::vector<Edge> edges() const;

 private:
  void swap(SkylineDatabase& other) noexcept;
  void index();
  bool edge(size_t number, Edge& out) const;

  void* mapped_ = nullptr;
  size_t size_ = 0;
  const uint8_t *edge_data_ = nullptr, *place_data_ = nullptr, *run_data_ = nullptr, *signatures_ = nullptr;
  size_t edges_ = 0, places_ = 0, runs_ = 0;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double spacing_m_ = 0;
  // Places sorted by grid cells, for nearest().
  double low_north_m_ = 0, low_east_m_ = 0, cell_m_ = 1;
  int rows_ = 0, columns_ = 0;
  std::vector<uint32_t> first_of_cell_, by_cell_;
};

struct DatabaseParameters {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< as SkylineDatabase::origin
  double spacing_m = 0;                              ///< between places, stored in the file
  double min_elevation_rad = 0.0175;                 ///< lower roofs are ignored: a degree
  unsigned threads = 0;                              ///< 0: as many as the machine has cores
};

/// Computes the skylines of places in n and writes them; the bytes do not depend on the number of threads. `progress`
/// is called on the caller's thread with the number of places done, finally with all, and may return false to stop.
/// Throws std::runtime_error where the file cannot be written. Returns false where it was stopped; no file remains
/// then.
bool build_database(const std::vector<Edge>& edges, const std::vector<Eigen::Vector3d>& places_n,
                    const DatabaseParameters& parameters, const std::string& file,
                    const std::function<bool(size_t done)>& progress);

/// Layout of the file, little-endian; each part is aligned to eight bytes.
struct DatabaseHeader {
  static constexpr std::array<char, 8> kMagic = {'O', 'D', 'O', 'S', 'K', 'Y', 'L', '\n'};
  static constexpr uint32_t kVersion = 1;
  std::array<char, 8> magic = kMagic;
  uint32_t version = kVersion, directions = Horizon::kDirections;
  double origin[3] = {0, 0, 0}, spacing_m = 0;
  uint64_t edges = 0, places = 0, runs = 0;  ///< counts
  uint64_t edges_at = 0, places_at = 0, runs_at = 0, signatures_at = 0, file_bytes = 0;
  uint64_t checksum = 0;  ///< FNV-1a of the preceding fields
};
static_assert(sizeof(DatabaseHeader) == 120);
struct DatabaseEdge {
  float from[3], to[3];  ///< in n
};
struct DatabasePlace {
  float p_n[3];
  uint32_t first_run;
  uint16_t runs, reserved;
};
static_assert(sizeof(DatabasePlace) == 20);
/// A run: first direction in the upper 10 bits, edge number below; kNoEdge where no edge is visible.
constexpr uint32_t kNoEdge = (1u << 22) - 1;
uint64_t checksum_of(const DatabaseHeader& header);

}  // namespace odograph::skyline
