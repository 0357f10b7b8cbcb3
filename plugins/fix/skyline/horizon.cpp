// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace odograph::skyline {
namespace {

constexpr int kN = Horizon::kDirections;
constexpr double kStep_rad = 2 * std::numbers::pi / kN;
constexpr int kBlock = Sector::kBlock, kBlocks = Sector::kBlocks;
constexpr float kOutOfSight = 1e9f;  // tangent of an elevation that no edge exceeds
constexpr float kSlack = 1.001f;     // of a bound, for rounding of floats
constexpr HorizonParameters kParameters;

struct Directions {
  std::array<float, kN> north, east;
  static const Directions& get() {
    static const Directions directions;
    return directions;
  }
  Directions() {
    for (int j = 0; j < kN; ++j) {
      const double azimuth = (j + 0.5) * kStep_rad;
      north[static_cast<size_t>(j)] = static_cast<float>(std::cos(azimuth));
      east[static_cast<size_t>(j)] = static_cast<float>(std::sin(azimuth));
    }
  }
};

/// The azimuth in steps, accurate to a third of one: sufficient to find the directions of an edge.
float steps_of(float north, float east) {
  const float a = std::abs(north), b = std::abs(east), low = std::min(a, b), high = std::max(a, b);
  const float q = high > 0 ? low / high : 0;
  float angle = q * (0.9724f - 0.1919f * q * q);
  if (b > a) angle = 1.5707963f - angle;
  if (north < 0) angle = 3.1415927f - angle;
  return (east < 0 ? -angle : angle) * static_cast<float>(1 / kStep_rad);
}

/// An edge relative to a place: its start (north, east, height above the place), its extent, and the directions that it
/// may occupy.
struct SeenEdge {
  float x, y, h, dx, dy, dz;
  int first = 0, last = 0;

  int first_block() const { return (first + kN) / kBlock; }
  int last_block() const { return (last + kN) / kBlock; }
  /// Computes the directions. False where the edge is nowhere above the place, or the place is on its line.
  bool find_directions() {
    const float x1 = x + dx, y1 = y + dy, h1 = h - dz;
    if (h <= 0 && h1 <= 0) return false;
    const float cross = x * y1 - y * x1;  // > 0: the azimuth increases from start to end
    const float begin = cross >= 0 ? steps_of(x, y) : steps_of(x1, y1);
    float end = cross >= 0 ? steps_of(x1, y1) : steps_of(x, y);
    if (end < begin - 1) end += kN;
    if (end - begin > 0.5f * kN + 1) return false;
    first = static_cast<int>(std::floor(begin - 1.1f)), last = static_cast<int>(std::ceil(end + 0.1f));
    return true;
  }
  /// Whether the edge is nowhere above an elevation of this tangent: bounded by the height of its upper end at the
  /// distance of its nearest point.
  bool is_below(float tangent) const {
    const float along = dx * dx + dy * dy;
    const float t = std::clamp(-(x * dx + y * dy) / along, 0.0f, 1.0f);
    const float nx = x + t * dx, ny = y + t * dy, most = kSlack * std::max(h, h - dz);
    return most * most < tangent * tangent * (nx * nx + ny * ny);
  }
  /// Calls `with` for each direction: its number, and height and distance of the edge there.
  template <class With>
  void for_each_direction(const With& with) const {
    const Directions& directions = Directions::get();
    for (int j = first; j <= last; ++j) {
      const auto k = static_cast<size_t>(j < 0 ? j + kN : j >= kN ? j - kN : j);
      // The ray (c, s) meets the edge at from + t (to - from), at the distance r.
      const float c = directions.north[k], s = directions.east[k];
      const float det = c * dy - s * dx;
      if (std::abs(det) < 1e-7f) continue;
      const float t = (s * x - c * y) / det;
      if (t < 0 || t > 1) continue;
      const float r = c * (x + t * dx) + s * (y + t * dy);
      if (r > 1e-3f) with(k, h - t * dz, r);
    }
  }
};

/// The highest edge in each direction, updated edge by edge.
class Envelope {
 public:
  Envelope(const Sector& sector, Horizon& out, City::EdgeIndices* edge_indices)
      : out_(out), edge_indices_(edge_indices) {
    // Directions outside the sector are treated as blocked: no edge exceeds them.
    for (int i = sector.blocks; i < kBlocks; ++i) {
      const int b = (sector.first + i) % kBlocks;
      lowest_of_[static_cast<size_t>(b)] = kOutOfSight;
      std::fill_n(highest_.data() + b * kBlock, kBlock, kOutOfSight);
    }
    out_.height_m.fill(0), out_.distance_m.fill(0);
    if (edge_indices_) edge_indices_->fill(-1);
  }

  float lowest() const { return lowest_; }
  /// Tangents of the elevations.
  const std::array<float, kN>& highest() const { return highest_; }
  /// Whether all of these blocks of directions are above this tangent.
  bool hides(float tangent, int block, int blocks) const {
    while (blocks > 0 && tangent < lowest_of_[static_cast<size_t>(block)])
      --blocks, block = block + 1 < kBlocks ? block + 1 : 0;
    return blocks == 0;
  }
  bool hides(const SeenEdge& e) const {
    float least = lowest_of_[static_cast<size_t>(e.first_block() % kBlocks)];
    for (int b = e.first_block() + 1; b <= e.last_block(); ++b)
      least = std::min(least, lowest_of_[static_cast<size_t>(b % kBlocks)]);
    return least > 0 && e.is_below(least);
  }
  void add(const SeenEdge& e, int number) {
    bool higher = false;
    e.for_each_direction([&](size_t k, float h, float r) {
      if (h <= highest_[k] * r) return;
      highest_[k] = h / r, out_.height_m[k] = h, out_.distance_m[k] = r;
      higher = true;
      if (edge_indices_) (*edge_indices_)[k] = number;
    });
    if (!higher) return;
    for (int b = e.first_block(); b <= e.last_block(); ++b) {
      const auto block = static_cast<size_t>(b % kBlocks);
      const auto* from = highest_.data() + block * kBlock;
      lowest_of_[block] = *std::min_element(from, from + kBlock);
    }
    lowest_ = *std::min_element(lowest_of_.begin(), lowest_of_.end());
  }
  void put_elevations() {
    for (size_t k = 0; k < highest_.size(); ++k)
      out_.elevation[k] = highest_[k] < kOutOfSight ? std::atan(highest_[k]) : 0;
  }

 private:
  Horizon& out_;
  City::EdgeIndices* edge_indices_;
  std::array<float, kN> highest_{};         // tangents
  std::array<float, kBlocks> lowest_of_{};  // min of them in each block of directions: an edge below it is hidden
  float lowest_ = 0;                        // min over all directions
};

}  // namespace

double Horizon::elevation_at(double azimuth_rad) const {
  double at = azimuth_rad / kStep_rad - 0.5;
  at -= kN * std::floor(at / kN);
  const auto j = static_cast<size_t>(at) % kN, k = (j + 1) % kN;
  const double part = at - std::floor(at);
  const auto a = static_cast<double>(elevation[j]), b = static_cast<double>(elevation[k]);
  if (std::abs(a - b) > kParameters.same_rad) return part < 0.5 ? a : b;
  return a + part * (b - a);
}

Sector Sector::between(double from_rad, double to_rad) {
  const int first = static_cast<int>(std::floor(from_rad / (kBlock * kStep_rad)));
  const int blocks = static_cast<int>(std::floor(to_rad / (kBlock * kStep_rad))) - first + 1;
  if (blocks >= kBlocks) return all();
  return {((first % kBlocks) + kBlocks) % kBlocks, std::max(1, blocks)};
}

bool trace_edge(const float from_n[3], const float to_n[3], const float p_n[3], int first, int end, Horizon& out) {
  const Directions& directions = Directions::get();
  const float x0 = from_n[0] - p_n[0], y0 = from_n[1] - p_n[1], h0 = p_n[2] - from_n[2];
  const float dx = to_n[0] - from_n[0], dy = to_n[1] - from_n[1], dz = to_n[2] - from_n[2];
  for (int j = first; j < end; ++j) {
    const auto k = static_cast<size_t>(j);
    const float c = directions.north[k], s = directions.east[k];
    const float det = c * dy - s * dx;
    const float t = std::abs(det) < 1e-7f ? 0.0f : std::clamp((s * x0 - c * y0) / det, 0.0f, 1.0f);
    const float x = x0 + t * dx, y = y0 + t * dy, r = std::sqrt(x * x + y * y), h = h0 - t * dz;
    if (!(r > 1e-3f && r < 1e7f && std::abs(h) < 1e7f)) return false;
    out.elevation[k] = std::atan(h / r), out.height_m[k] = h, out.distance_m[k] = r;
  }
  return true;
}

City City::with_roof_offsets(const std::unordered_map<int, double>& heights_m) const {
  const auto height_of = [&](int object) {
    const auto at = heights_m.find(object);
    return at == heights_m.end() ? 0.0 : at->second;
  };
  std::vector<Edge> edges;
  edges.reserve(edges_->size());
  const auto add = [&](Edge e, double up_m) {
    e.from.z() -= up_m, e.to.z() -= up_m;
    edges.push_back(e);
  };
  for (const Edge& e : *edges_) {
    const double up_m = height_of(e.object), also_m = e.also < 0 ? up_m : height_of(e.also);
    if (up_m == also_m) {
      add(e, up_m);
    } else {
      add({e.from, e.to, e.object}, up_m);
      add({e.from, e.to, e.also}, also_m);
    }
  }
  return City(std::move(edges));
}

void City::select_near_edges(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m) {
  std::vector<int> all(edges_->size());
  std::iota(all.begin(), all.end(), 0);
  near_ = near_of(all, p_n, radius_m, min_tan, lower_m);
}

/// Those of the edges that can appear above the elevation, the highest first.
std::vector<City::Near> City::near_of(const std::vector<int>& numbers, const Eigen::Vector3d& p_n, double radius_m,
                                      double min_tan, double lower_m) {
  std::vector<Near> near;
  around_ = p_n, radius_m_ = radius_m, lower_m_ = lower_m;
  for (const int i : numbers) {
    const Edge& e = (*edges_)[static_cast<size_t>(i)];
    const double up = p_n.z() + lower_m - std::min(e.from.z(), e.to.z());
    if (up <= 0) continue;
    const Eigen::Vector2d a = (e.from - p_n).head<2>(), d = (e.to - e.from).head<2>();
    if (d.squaredNorm() < 1e-8) continue;  // a vertical edge: the edges of the roof cover its upper end
    const double t = std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0);
    const double distance = (a + t * d).norm();
    if (up <= min_tan * (distance - radius_m)) continue;
    const Eigen::Vector3f from = (e.from - p_n).cast<float>(), along = (e.to - e.from).cast<float>();
    near.push_back({from.x(), from.y(), from.z(), along.x(), along.y(), along.z(),
                    static_cast<float>(up / std::max(distance - radius_m, 0.1)), i, 0, kBlocks,
                    e.object == Edge::kGround});
    if (distance <= 1.01 * radius_m) continue;
    // Max change of the azimuth of its points for places within the radius.
    const double turned = std::asin(radius_m / distance) + kStep_rad;
    const double begin = std::atan2(a.y(), a.x());
    const double across = std::remainder(std::atan2(a.y() + d.y(), a.x() + d.x()) - begin, 2 * std::numbers::pi);
    const double low = begin + std::min(0.0, across) - turned, high = begin + std::max(0.0, across) + turned;
    const int first = static_cast<int>(std::floor(low / (kBlock * kStep_rad)));
    const int last = static_cast<int>(std::floor(high / (kBlock * kStep_rad)));
    if (last - first + 1 >= kBlocks) continue;
    near.back().first_block = static_cast<int16_t>((first + 2 * kBlocks) % kBlocks);
    near.back().blocks = static_cast<int16_t>(last - first + 1);
  }
  // Edges with the highest bound first: most of the others are then hidden at once.
  std::stable_sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.bound > b.bound; });
  return near;
}

void City::horizon(const Eigen::Vector3d& p_n, Horizon& out, EdgeIndices& edge_indices) const {
  envelope(near_, p_n, out, &edge_indices, Sector::all());
  for (int& winner : edge_indices)
    if (winner >= 0) winner = near_[static_cast<size_t>(winner)].number;
}

void City::select_edges(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m,
                        const Spend& spend) {
  if (spend) spend(kEdgeWork * edges_->size());
  select_near_edges(p_n, radius_m, min_tan, lower_m);
  std::vector<char> seen(near_.size(), 0);
  Horizon there;
  EdgeIndices edge_indices;
  const int reach = kParameters.lattice;
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      if (spend) spend(work());
      envelope(near_, p_n + Eigen::Vector3d(a, b, 0) * (radius_m / reach), there, &edge_indices, Sector::all());
      for (const int winner : edge_indices)
        if (winner >= 0) seen[static_cast<size_t>(winner)] = 1;
    }
  visible_.clear();
  for (size_t i = 0; i < near_.size(); ++i)
    if (seen[i]) visible_.push_back(near_[i]);
}

/// Calls `visit` for each edge that may not be hidden, the highest first, with roofs raised by `raised_m`.
template <class Hiding, class Visit>
void City::visit_edges(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, double raised_m,
                       const Hiding& hiding, const Visit& visit) const {
  const Eigen::Vector3f shift = (p_n - around_).cast<float>();
  const bool bounded =
      (p_n - around_).head<2>().norm() <= radius_m_ && p_n.z() - around_.z() + std::max(0.0, raised_m) <= lower_m_;
  const auto up = static_cast<float>(raised_m);
  for (size_t i = 0; i < edges.size(); ++i) {
    const Near& e = edges[i];
    if (bounded) {
      const float highest_here = e.bound * kSlack;
      if (highest_here < hiding.lowest()) break;
      if (hiding.hides(highest_here, e.first_block, e.blocks)) continue;
    }
    SeenEdge seen{e.x - shift.x(), e.y - shift.y(), shift.z() - e.z + (e.ground ? 0 : up), e.dx, e.dy, e.dz};
    if (seen.find_directions() && !hiding.hides(seen)) visit(seen, i);
  }
}

void City::envelope(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, Horizon& out, EdgeIndices* edge_indices,
                    const Sector& sector) const {
  Envelope envelope(sector, out, edge_indices);
  visit_edges(edges, p_n, 0, envelope, [&](const SeenEdge& e, size_t i) { envelope.add(e, static_cast<int>(i)); });
  envelope.put_elevations();
}

void City::trace_roofs(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, double spread_m,
                       const Sector& sector, RoofTops& out) const {
  Horizon lowered;  // the skyline if all roofs are lower: whatever is below it even if higher is never seen
  EdgeIndices winners;
  Envelope lowest(sector, lowered, &winners);
  visit_edges(edges, p_n, -spread_m, lowest, [&](const SeenEdge& e, size_t i) { lowest.add(e, static_cast<int>(i)); });
  out.count.fill(0);
  const auto put = [&](size_t k, RoofTop top) {
    auto& tops = out.of[k];
    uint8_t& count = out.count[k];
    RoofTop* at =
        std::find_if(tops.data(), tops.data() + count, [&](const RoofTop& t) { return t.object == top.object; });
    if (at == tops.data() + count) {
      if (count < RoofTop::kMax) {
        tops[count++] = top;
        return;
      }
      at = std::min_element(tops.begin(), tops.end(), [](const RoofTop& a, const RoofTop& b) {
        return a.height_m * b.distance_m < b.height_m * a.distance_m;
      });
    }
    if (top.height_m * at->distance_m > at->height_m * top.distance_m) *at = top;
  };
  for (size_t k = 0; k < winners.size(); ++k)
    if (winners[k] >= 0 && edges[static_cast<size_t>(winners[k])].ground)
      put(k, {Edge::kGround, winners[k], lowered.height_m[k], lowered.distance_m[k]});
  const auto up = static_cast<float>(spread_m);
  visit_edges(edges, p_n, spread_m, lowest, [&](const SeenEdge& raised, size_t i) {
    if (edges[i].ground) return;
    const Edge& edge = (*edges_)[static_cast<size_t>(edges[i].number)];
    const int object = edge.object == Edge::kUnknown ? Edge::kGround - 1 - edges[i].number : edge.object;
    raised.for_each_direction([&](size_t k, float h, float r) {
      if (h <= lowest.highest()[k] * r) return;
      put(k, {object, static_cast<int>(i), h - up, r});
      if (edge.also >= 0) put(k, {edge.also, static_cast<int>(i), h - up, r});
    });
  });
}

std::vector<int> City::roofs_around(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m,
                                    double spread_m, const Spend& spend) {
  if (spend) spend(kEdgeWork * edges_->size());
  select_near_edges(p_n, radius_m, min_tan, lower_m + spread_m);
  std::vector<char> seen(near_.size(), 0);
  RoofTops there;
  const int reach = kParameters.roof_lattice;
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      if (spend) spend(2 * work());
      trace_roofs(near_, p_n + Eigen::Vector3d(a, b, 0) * (radius_m / reach), spread_m, Sector::all(), there);
      for (size_t k = 0; k < there.of.size(); ++k)
        for (uint8_t m = 0; m < there.count[k]; ++m) seen[static_cast<size_t>(there.of[k][m].edge)] = 1;
    }
  std::vector<int> roofs;
  for (size_t i = 0; i < near_.size(); ++i)
    if (seen[i]) roofs.push_back(near_[i].number);
  return roofs;
}

void City::select_roofs(const std::vector<int>& roofs, const Eigen::Vector3d& p_n, double radius_m, double min_tan,
                        double lower_m, double spread_m, const Spend& spend) {
  if (spend) spend(kEdgeWork * roofs.size());
  visible_ = near_of(roofs, p_n, radius_m, min_tan, lower_m + spread_m);
}

}  // namespace odograph::skyline
