// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/skyline_database.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace odograph::skyline {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");
constexpr int kN = Horizon::kDirections;
constexpr double kFarthestPlace_m = 1e7;  // max distance of a place or an edge from n's origin
constexpr int kMaxCells = 4'000'000;
constexpr double kCellsOfPlace = 16, kFewCells = 1024;  // a street leaves most of its bounding box empty

template <class T>
T read(const uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

bool is_near(const Eigen::Vector3d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthestPlace_m; }

/// Start of a part of the file; null where the part exceeds the file.
const uint8_t* part(const uint8_t* bytes, uint64_t size, uint64_t at, uint64_t count, uint64_t each) {
  if (at % 8 != 0 || at < sizeof(DatabaseHeader) || at > size || count > (size - at) / each) return nullptr;
  return bytes + at;
}

}  // namespace

uint64_t checksum_of(const DatabaseHeader& header) {
  uint64_t hash = 0xcbf29ce484222325u;
  const auto* bytes = reinterpret_cast<const uint8_t*>(&header);
  for (size_t i = 0; i < offsetof(DatabaseHeader, checksum); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

SkylineDatabase::~SkylineDatabase() {
  if (mapped_) munmap(mapped_, size_);
}

void SkylineDatabase::swap(SkylineDatabase& o) noexcept {
  std::swap(mapped_, o.mapped_), std::swap(size_, o.size_);
  std::swap(edge_data_, o.edge_data_), std::swap(place_data_, o.place_data_), std::swap(run_data_, o.run_data_);
  std::swap(signatures_, o.signatures_), std::swap(edges_, o.edges_), std::swap(places_, o.places_);
  std::swap(runs_, o.runs_), std::swap(origin_, o.origin_), std::swap(spacing_m_, o.spacing_m_);
  std::swap(low_north_m_, o.low_north_m_), std::swap(low_east_m_, o.low_east_m_), std::swap(cell_m_, o.cell_m_);
  std::swap(rows_, o.rows_), std::swap(columns_, o.columns_);
  first_of_cell_.swap(o.first_of_cell_), by_cell_.swap(o.by_cell_);
}

SkylineDatabase SkylineDatabase::open(const std::string& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a FIFO must not block
  if (fd < 0) throw std::runtime_error(file + ": no such file");
  struct stat what {};
  const bool regular = fstat(fd, &what) == 0 && S_ISREG(what.st_mode);
  const auto size = static_cast<size_t>(what.st_size);
  if (!regular || size < sizeof(DatabaseHeader)) {
    ::close(fd);
    throw std::runtime_error(file + (regular ? ": too short for a skyline database" : ": a device, not a file"));
  }
  void* mapped = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  ::close(fd);
  if (mapped == MAP_FAILED) throw std::runtime_error(file + ": cannot be mapped into memory");
  try {
    SkylineDatabase database = view({static_cast<const char*>(mapped), size}, file);
    database.mapped_ = mapped;
    return database;
  } catch (...) {
    munmap(mapped, size);
    throw;
  }
}

SkylineDatabase SkylineDatabase::view(std::string_view text, const std::string& name) {
  const auto wrong = [&](const std::string& what) { throw std::runtime_error(name + ": " + what); };
  const auto* bytes = reinterpret_cast<const uint8_t*>(text.data());
  if (text.size() < sizeof(DatabaseHeader)) wrong("too short for a skyline database");
  const auto h = read<DatabaseHeader>(bytes);
  if (h.magic != DatabaseHeader::kMagic) wrong("not a skyline database (`odograph city build` makes them)");
  if (h.version != DatabaseHeader::kVersion)
    wrong("a skyline database of version " + std::to_string(h.version) + "; this program reads version " +
          std::to_string(DatabaseHeader::kVersion));
  if (h.checksum != checksum_of(h)) wrong("damaged: its header's checksum differs");
  if (h.file_bytes != text.size())
    wrong("damaged: " + std::to_string(text.size()) + " bytes long, " + std::to_string(h.file_bytes) + " were written");
  if (h.directions != kN) wrong("has " + std::to_string(h.directions) + " directions a place; expected 720");
  SkylineDatabase d;
  d.size_ = text.size();
  d.edge_data_ = part(bytes, d.size_, h.edges_at, h.edges, sizeof(DatabaseEdge));
  d.place_data_ = part(bytes, d.size_, h.places_at, h.places, sizeof(DatabasePlace));
  d.run_data_ = part(bytes, d.size_, h.runs_at, h.runs, sizeof(uint32_t));
  d.signatures_ = part(bytes, d.size_, h.signatures_at, h.places, kSectors);
  if (!d.edge_data_ || !d.place_data_ || !d.run_data_ || !d.signatures_)
    wrong("damaged: a section extends beyond its end");
  if (h.edges >= kNoEdge || h.places > std::numeric_limits<uint32_t>::max())
    wrong("damaged: more edges than a run can refer to");
  d.edges_ = h.edges, d.places_ = h.places, d.runs_ = h.runs;
  d.origin_ = Eigen::Vector3d(h.origin[0], h.origin[1], h.origin[2]), d.spacing_m_ = h.spacing_m;
  if (!d.origin_.allFinite() || !(h.spacing_m >= 0 && h.spacing_m < kFarthestPlace_m)) wrong("damaged: invalid origin");
  for (size_t i = 0; i < d.places_; ++i)
    if (!is_near(d.place(i))) wrong("damaged: place " + std::to_string(i) + " is invalid");
  d.index();
  return d;
}

Eigen::Vector3d SkylineDatabase::place(size_t i) const {
  const auto p = read<DatabasePlace>(place_data_ + i * sizeof(DatabasePlace));
  return Eigen::Vector3d(static_cast<double>(p.p_n[0]), static_cast<double>(p.p_n[1]), static_cast<double>(p.p_n[2]));
}

bool SkylineDatabase::horizon(size_t i, Horizon& out) const {
  const auto p = read<DatabasePlace>(place_data_ + i * sizeof(DatabasePlace));
  if (p.first_run > runs_ || p.runs > runs_ - p.first_run || p.runs == 0 || p.runs > kMaxRuns) return false;
  int direction = 0;
  for (size_t k = 0; k < p.runs; ++k) {
    const auto run = read<uint32_t>(run_data_ + (p.first_run + k) * sizeof(uint32_t));
    const bool last = k + 1 == p.runs;
    const int end =
        last ? kN : static_cast<int>(read<uint32_t>(run_data_ + (p.first_run + k + 1) * sizeof(uint32_t)) >> 22);
    const uint32_t number = run & kNoEdge;
    if (static_cast<int>(run >> 22) != direction || end <= direction || end > kN) return false;
    if (number == kNoEdge) {
      for (; direction < end; ++direction) {
        const auto j = static_cast<size_t>(direction);
        out.elevation[j] = out.height_m[j] = out.distance_m[j] = 0;
      }
      continue;
    }
    if (number >= edges_) return false;
    const auto e = read<DatabaseEdge>(edge_data_ + number * sizeof(DatabaseEdge));
    if (!trace_edge(e.from, e.to, p.p_n, direction, end, out)) return false;
    direction = end;
  }
  return true;
}

SkylineDatabase::Signature SkylineDatabase::signature_of(const Horizon& skyline) {
  Signature signature{};
  for (size_t s = 0; s < kSectors; ++s) {
    float sum = 0;
    for (size_t k = 0; k < kSectorSize; ++k) sum += skyline.elevation[s * kSectorSize + k];
    const double mean = static_cast<double>(sum) / kSectorSize;
    signature[s] = static_cast<uint8_t>(std::clamp(std::lround(mean / (0.5 * std::numbers::pi) * 255), 0l, 255l));
  }
  return signature;
}

bool SkylineDatabase::edge(size_t number, Edge& out) const {
  if (number >= edges_) return false;
  const auto e = read<DatabaseEdge>(edge_data_ + number * sizeof(DatabaseEdge));
  const auto point = [](const float* p) {
    return Eigen::Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  };
  out = {point(e.from), point(e.to)};
  return is_near(out.from) && is_near(out.to);
}

std::vector<Edge> SkylineDatabase::edges() const {
  std::vector<Edge> edges;
  Edge one;
  for (size_t i = 0; i < edges_; ++i)
    if (edge(i, one)) edges.push_back(one);
  return edges;
}

std::vector<Edge> SkylineDatabase::edges_seen_from(size_t i) const {
  const auto p = read<DatabasePlace>(place_data_ + i * sizeof(DatabasePlace));
  if (p.first_run > runs_ || p.runs > runs_ - p.first_run || p.runs > kMaxRuns) return {};
  std::vector<Edge> edges;
  Edge one;
  for (size_t k = 0; k < p.runs; ++k)
    if (edge(read<uint32_t>(run_data_ + (p.first_run + k) * sizeof(uint32_t)) & kNoEdge, one)) edges.push_back(one);
  return edges;
}

/// Sorts the places into cells of a grid with a few places each.
void SkylineDatabase::index() {
  if (places_ == 0) return;
  Eigen::Vector3d low = place(0), high = low;
  for (size_t i = 1; i < places_; ++i) low = low.cwiseMin(place(i)), high = high.cwiseMax(place(i));
  low_north_m_ = low.x(), low_east_m_ = low.y();
  const Eigen::Vector3d extent = high - low;
  cell_m_ = std::max(1.0, 2 * spacing_m_);
  // Distant places must not lead to millions of empty cells.
  const double max_cells = std::min<double>(kMaxCells, kCellsOfPlace * static_cast<double>(places_) + kFewCells);
  while ((extent.x() / cell_m_ + 1) * (extent.y() / cell_m_ + 1) > max_cells) cell_m_ *= 2;
  rows_ = static_cast<int>(extent.x() / cell_m_) + 1, columns_ = static_cast<int>(extent.y() / cell_m_) + 1;
  const auto cell_of = [&](size_t i) {
    const Eigen::Vector3d p = place(i);
    const int row = std::min(rows_ - 1, static_cast<int>((p.x() - low_north_m_) / cell_m_));
    const int column = std::min(columns_ - 1, static_cast<int>((p.y() - low_east_m_) / cell_m_));
    return static_cast<size_t>(row * columns_ + column);
  };
  first_of_cell_.assign(static_cast<size_t>(rows_ * columns_) + 1, 0);
  for (size_t i = 0; i < places_; ++i) ++first_of_cell_[cell_of(i) + 1];
  for (size_t c = 1; c < first_of_cell_.size(); ++c) first_of_cell_[c] += first_of_cell_[c - 1];
  by_cell_.resize(places_);
  auto next = first_of_cell_;
  for (size_t i = 0; i < places_; ++i) by_cell_[next[cell_of(i)]++] = static_cast<uint32_t>(i);
}

size_t SkylineDatabase::nearest(double north_m, double east_m) const {
  const int row = std::clamp(static_cast<int>(std::clamp((north_m - low_north_m_) / cell_m_, -1.0, 1e6)), 0, rows_ - 1);
  const int column =
      std::clamp(static_cast<int>(std::clamp((east_m - low_east_m_) / cell_m_, -1.0, 1e6)), 0, columns_ - 1);
  // A point outside is moved to the grid's border. The k-th ring of cells around it is at least k - 1 cells away.
  const double out_n = north_m - std::clamp(north_m, low_north_m_, low_north_m_ + rows_ * cell_m_);
  const double out_e = east_m - std::clamp(east_m, low_east_m_, low_east_m_ + columns_ * cell_m_);
  const double outside = out_n * out_n + out_e * out_e;
  size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](int r, int c) {
    if (r < 0 || c < 0 || r >= rows_ || c >= columns_) return;
    const auto cell = static_cast<size_t>(r * columns_ + c);
    for (uint32_t k = first_of_cell_[cell]; k < first_of_cell_[cell + 1]; ++k) {
      const Eigen::Vector3d p = place(by_cell_[k]);
      const double d = (p.x() - north_m) * (p.x() - north_m) + (p.y() - east_m) * (p.y() - east_m);
      if (d < least) least = d, best = by_cell_[k];
    }
  };
  look(row, column);
  for (int ring = 1; ring <= std::max(rows_, columns_); ++ring) {
    const double reached = (ring - 1) * cell_m_;
    if (reached * reached > least - outside) break;
    const int top = std::max(0, row - ring), bottom = std::min(rows_ - 1, row + ring);
    const int left = std::max(0, column - ring), right = std::min(columns_ - 1, column + ring);
    for (int c = left; c <= right; ++c) look(row - ring, c), look(row + ring, c);
    for (int r = std::max(top, row - ring + 1); r <= std::min(bottom, row + ring - 1); ++r)
      look(r, column - ring), look(r, column + ring);
  }
  return best;
}

}  // namespace odograph::skyline
