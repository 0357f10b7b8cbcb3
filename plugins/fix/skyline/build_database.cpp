// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <unordered_map>

#include "plugins/fix/skyline/skyline_database.hpp"

namespace odograph::skyline {
namespace {

constexpr double kTile_m = 32;     // places of a tile share the edges that are visible from it
constexpr double kMargin_m = 0.5;  // margin of a tile's radius
constexpr auto kTick = std::chrono::milliseconds(50);

struct Run {
  int first, edge;  ///< direction; of the model, -1 for none
};
struct Tile {
  Eigen::Vector3d low, high;
  std::vector<uint32_t> places;
  // Results, place by place.
  std::vector<Run> runs;
  std::vector<uint16_t> run_counts;
  std::vector<SkylineDatabase::Signature> signatures;
};

std::vector<Tile> tiles_of(const std::vector<Eigen::Vector3d>& places) {
  std::vector<Tile> tiles;
  std::unordered_map<int64_t, size_t> known;
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d& p = places[i];
    const auto row = static_cast<int64_t>(std::floor(p.x() / kTile_m));
    const auto column = static_cast<int64_t>(std::floor(p.y() / kTile_m));
    const auto [at, is_new] = known.try_emplace((row << 32) ^ (column & 0xffffffff), tiles.size());
    if (is_new) tiles.push_back({p, p, {}, {}, {}, {}});
    Tile& tile = tiles[at->second];
    tile.low = tile.low.cwiseMin(p), tile.high = tile.high.cwiseMax(p);
    tile.places.push_back(static_cast<uint32_t>(i));
  }
  return tiles;
}

/// Merges the shortest runs into their predecessors until there are few enough.
void simplify(std::vector<Run>& runs) {
  while (runs.size() > SkylineDatabase::kMaxRuns) {
    size_t shortest = 1;
    int least = std::numeric_limits<int>::max();
    for (size_t k = 1; k < runs.size(); ++k) {
      const int length = (k + 1 < runs.size() ? runs[k + 1].first : Horizon::kDirections) - runs[k].first;
      if (length < least) least = length, shortest = k;
    }
    runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(shortest));
  }
}

void compute(City& city, const std::vector<Eigen::Vector3d>& places, double min_tan, Tile& tile) {
  // Covers its places from the highest down to the lowest.
  Eigen::Vector3d middle = 0.5 * (tile.low + tile.high);
  middle.z() = tile.low.z();
  const double radius_m = 0.5 * (tile.high - tile.low).head<2>().norm() + kMargin_m;
  city.select_near_edges(middle, radius_m, min_tan, tile.high.z() - tile.low.z());
  Horizon horizon;
  City::EdgeIndices edge_indices;
  std::vector<Run> runs;
  for (const uint32_t i : tile.places) {
    city.horizon(places[i], horizon, edge_indices);
    runs.clear();
    for (int j = 0; j < Horizon::kDirections; ++j) {
      const int edge = edge_indices[static_cast<size_t>(j)];
      if (runs.empty() || runs.back().edge != edge) runs.push_back({j, edge});
    }
    simplify(runs);
    tile.runs.insert(tile.runs.end(), runs.begin(), runs.end());
    tile.run_counts.push_back(static_cast<uint16_t>(runs.size()));
    tile.signatures.push_back(SkylineDatabase::signature_of(horizon));
  }
}

/// The output file; the destructor removes an unfinished one.
class Output {
 public:
  explicit Output(const std::string& name)
      : name_(name), part_(name + ".part"), file_(std::fopen(part_.c_str(), "wb")) {
    if (!file_) throw std::runtime_error(name + ": cannot be written");
  }
  ~Output() {
    if (file_) std::fclose(file_), std::remove(part_.c_str());
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void write(const void* data, size_t bytes) {
    if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) fail();
    at_ += bytes;
  }
  uint64_t align() {
    static constexpr char zero[8] = {};
    write(zero, (8 - at_ % 8) % 8);
    return at_;
  }
  void finish(const DatabaseHeader& header) {
    if (std::fseek(file_, 0, SEEK_SET) != 0 || std::fwrite(&header, sizeof header, 1, file_) != 1) fail();
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!closed || std::rename(part_.c_str(), name_.c_str()) != 0) {
      std::remove(part_.c_str());
      fail();
    }
  }

 private:
  [[noreturn]] void fail() { throw std::runtime_error(name_ + ": cannot be written; is the disk full?"); }

  std::string name_, part_;
  std::FILE* file_;
  uint64_t at_ = 0;
};

/// Computes all tiles on several threads; false where `progress` stopped it.
bool compute_all(const std::vector<Edge>& edges, const std::vector<Eigen::Vector3d>& places,
                 const DatabaseParameters& parameters, std::vector<Tile>& tiles,
                 const std::function<bool(size_t)>& progress) {
  std::atomic<size_t> next{0}, done{0};
  std::mutex mutex;
  std::condition_variable changed;
  size_t running = parameters.threads ? parameters.threads : std::max(1u, std::thread::hardware_concurrency());
  std::exception_ptr thrown;
  const auto work = [&] {
    try {
      City city(edges);
      for (size_t k = next++; k < tiles.size(); k = next++) {
        compute(city, places, std::tan(parameters.min_elevation_rad), tiles[k]);
        done += tiles[k].places.size();
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
      next = tiles.size();
    }
    const std::lock_guard lock(mutex);
    --running;
    changed.notify_all();
  };
  std::vector<std::thread> threads;
  for (size_t k = running; k > 0; --k) threads.emplace_back(work);
  bool stopped = false;
  {
    std::unique_lock lock(mutex);
    while (running > 0) {
      changed.wait_for(lock, kTick);
      lock.unlock();
      if (!stopped && progress && !progress(done)) stopped = true, next = tiles.size();
      lock.lock();
    }
  }
  for (std::thread& thread : threads) thread.join();
  if (thrown) std::rethrow_exception(thrown);
  return !stopped && (!progress || progress(done));  // report also the progress since the last tick
}

}  // namespace

bool build_database(const std::vector<Edge>& edges, const std::vector<Eigen::Vector3d>& places_n,
                    const DatabaseParameters& parameters, const std::string& file,
                    const std::function<bool(size_t done)>& progress) {
  Output out(file);
  auto tiles = tiles_of(places_n);
  if (!compute_all(edges, places_n, parameters, tiles, progress)) return false;
  DatabaseHeader header;
  for (int i = 0; i < 3; ++i) header.origin[i] = parameters.origin[i];
  header.spacing_m = parameters.spacing_m;
  out.write(&header, sizeof header);
  // Edges are numbered in order of their first use.
  std::vector<uint32_t> numbers(edges.size(), kNoEdge), encoded;
  std::vector<DatabaseEdge> seen;
  for (const Tile& tile : tiles) {
    size_t k = 0;
    for (const uint16_t count : tile.run_counts) {
      header.places++;
      for (size_t end = k + count; k < end; ++k) {
        const Run& run = tile.runs[k];
        uint32_t number = kNoEdge;
        if (run.edge >= 0) {
          uint32_t& known = numbers[static_cast<size_t>(run.edge)];
          if (known == kNoEdge) {
            known = static_cast<uint32_t>(seen.size());
            const Edge& e = edges[static_cast<size_t>(run.edge)];
            const Eigen::Vector3f a = e.from.cast<float>(), b = e.to.cast<float>();
            seen.push_back({{a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}});
          }
          number = known;
        }
        encoded.push_back(static_cast<uint32_t>(run.first) << 22 | number);
      }
    }
  }
  if (seen.size() >= kNoEdge || encoded.size() > std::numeric_limits<uint32_t>::max())
    throw std::runtime_error(file + ": too many edges or places for one database");
  header.edges = seen.size(), header.runs = encoded.size();
  header.edges_at = out.align();
  out.write(seen.data(), seen.size() * sizeof(DatabaseEdge));
  header.places_at = out.align();
  uint32_t first_run = 0;
  for (const Tile& tile : tiles)
    for (size_t k = 0; k < tile.places.size(); ++k) {
      const Eigen::Vector3f p = places_n[tile.places[k]].cast<float>();
      const DatabasePlace place{{p.x(), p.y(), p.z()}, first_run, tile.run_counts[k], 0};
      out.write(&place, sizeof place);
      first_run += tile.run_counts[k];
    }
  header.runs_at = out.align();
  out.write(encoded.data(), encoded.size() * sizeof(uint32_t));
  header.signatures_at = out.align();
  for (const Tile& tile : tiles) out.write(tile.signatures.data(), tile.signatures.size() * sizeof(tile.signatures[0]));
  header.file_bytes = out.align();
  header.checksum = checksum_of(header);
  out.finish(header);
  return true;
}

}  // namespace odograph::skyline
