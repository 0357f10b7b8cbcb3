// SPDX-License-Identifier: Apache-2.0
//
// The simulated world of a city model: buildings with facades, and terrain.
#include <algorithm>
#include <cmath>

#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;
using Kind = CityModel::Kind;
using Set = TextureSet;

uint32_t texture_of(Kind kind, uint32_t facade) {
  switch (kind) {
    case Kind::wall: return facade;
    case Kind::roof:
    case Kind::road: return Set::kAsphalt;
    case Kind::paved: return Set::kPaving;
    case Kind::green: return Set::kLeaves;
    case Kind::water: return Set::kPaint;
  }
  return Set::kPaving;
}

/// Ray casting from above onto a selection of a model's faces.
class FromAbove {
 public:
  template <class Choice>
  FromAbove(RTCDevice device, const CityModel& city, Choice&& takes) {
    Mesh mesh;
    for (const auto& face : city.faces)
      if (takes(face)) mesh.add_triangle(face.corners.data(), {});
    scene_ = mesh.build(device);
  }
  ~FromAbove() { rtcReleaseScene(scene_); }
  FromAbove(const FromAbove&) = delete;
  FromAbove& operator=(const FromAbove&) = delete;

  /// The height of the uppermost face there.
  std::optional<double> up_at(const Eigen::Vector2d& north_east) const {
    constexpr float kHigh_m = 3000;
    RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(north_east.x()), hit.ray.org_y = static_cast<float>(north_east.y());
    hit.ray.org_z = -kHigh_m, hit.ray.dir_z = 1, hit.ray.tfar = 2 * kHigh_m, hit.ray.mask = ~0u;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return static_cast<double>(kHigh_m - hit.ray.tfar);
  }

 private:
  RTCScene scene_;
};

}  // namespace

void World::project_route_onto(const CityModel& city) {
  const FromAbove terrain(device_, city, [&](const auto& face) {
    return !city.objects[face.object].is_building && std::abs(face.normal.z()) > 0.5;
  });
  const FromAbove roofs(device_, city, [](const auto& face) { return face.kind == Kind::roof; });
  const auto steps = static_cast<size_t>(std::ceil(route_.length()));
  std::vector<std::optional<double>> found;
  for (size_t i = 0; i <= steps; ++i) found.push_back(terrain.up_at(route_.at(static_cast<double>(i)).north_east));
  // Where the model has no ground, use that of the nearest place with ground; then average over four metres, since
  // surveyed surfaces meet in small steps.
  std::vector<double> up;
  for (size_t i = 0; i <= steps; ++i)
    for (size_t d = 0; d <= steps && up.size() == i; ++d) {
      if (i >= d && found[i - d])
        up.push_back(*found[i - d]);
      else if (i + d <= steps && found[i + d])
        up.push_back(*found[i + d]);
      else if (d == steps)
        up.push_back(0);
    }
  std::vector<double> height;
  for (size_t i = 0; i <= steps; ++i) {
    double sum = 0, weight = 0;
    for (size_t k = i < 2 ? 0 : i - 2; k <= std::min(steps, i + 2); ++k) sum += up[k], weight += 1;
    height.push_back(sum / weight);
  }
  route_.set_heights(height);
  for (size_t i = 0; i <= steps && !blocked_at_m_; ++i) {
    const auto roof = roofs.up_at(route_.at(static_cast<double>(i)).north_east);
    if (roof && *roof > height[i] + 1.0) blocked_at_m_ = static_cast<double>(i);
  }
}

void World::build_city(const CityModel& city, uint64_t seed) {
  Mesh& m = meshes_[0];
  const double margin = 400;  // of bare ground around the model
  const Vector3d low = city.low - Vector3d(margin, margin, 0), size = city.high - city.low;
  m.add_quad({low.x(), low.y(), city.high.z() + 0.3}, {size.x() + 2 * margin, 0, 0}, {0, size.y() + 2 * margin, 0},
             Set::kPaving);
  Random random(seed, 62);
  std::vector<std::pair<uint32_t, float>> looks;
  for (size_t i = 0; i < city.objects.size(); ++i) {
    const auto facade = static_cast<uint32_t>(random.next() % Set::kFacades);
    looks.emplace_back(facade, static_cast<float>(random.uniform(0.8, 1.15)));
  }
  for (const auto& face : city.faces) {
    const auto& [facade, tone] = looks[face.object];
    const Vector3d n = face.normal;
    Mesh::Surface s{n.cast<float>(), {}, {}, {}, texture_of(face.kind, facade), face.kind == Kind::wall ? tone : 1.0f};
    if (face.kind == Kind::water) s.brightness = 0.6f;
    // Walls: along is horizontal, down follows the wall from the building's top. Others: map orientation.
    const Vector3d along = face.kind == Kind::wall ? Vector3d(n.cross(Vector3d::UnitZ()).normalized())
                                                   : Vector3d(Vector3d::UnitX() - n.x() * n).normalized();
    const Vector3d down =
        face.kind == Kind::wall ? Vector3d((Vector3d::UnitZ() - n.z() * n).normalized()) : Vector3d(n.cross(along));
    s.along = along.cast<float>(), s.down = down.cast<float>();
    // One origin for all faces of a plane; texture coordinates must not be negative.
    const Vector3d top(0, 0, -city.objects[face.object].top_up_m - 1.0);
    const Vector3d shift = face.kind == Kind::wall ? top - 960 * along : Vector3d(-960 * along - 960 * down);
    const double off = n.dot(face.corners[0] - shift);  // into the face's plane
    s.origin = (shift + off * n).cast<float>();
    m.add_triangle(face.corners.data(), s);
  }
}

/// Adds trees with round and with high crowns, and parked cars.
void World::plant(const std::vector<Scenario::World::Planted>& planted, uint64_t seed) {
  Mesh& m = meshes_[0];
  Random random(seed, 63);
  for (const auto& [foot, height] : planted) {
    if (height <= 0) {
      const double heading = random.uniform(0, 3.14);
      const auto tone = static_cast<float>(random.uniform(0.4, 1.6));
      m.add_box(foot - Vector3d(0, 0, 0.25), {4.3, 1.75, 0.65}, heading, Set::kPaint, tone);
      m.add_box(foot - Vector3d(0, 0, 0.9), {2.3, 1.6, 0.55}, heading, Set::kPaint, 0.4f);
      continue;
    }
    const double crown = std::clamp(0.28 * height, 0.9, 2.4);
    m.add_box(foot, {0.3, 0.3, height - crown}, 0, Set::kLeaves, 0.6f);
    for (const double part : {0.95, 0.7}) {
      const double east = random.normal(), north = random.normal();
      const Vector3d aside(north * 0.3 * crown, east * 0.3 * crown, -part * height);
      m.add_ball(foot + aside, crown, Set::kLeaves, random.next());
    }
  }
}

}  // namespace odograph
