// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

using Eigen::Vector3d;

void Mesh::add(const std::array<Vector3d, 4>& corners, const Surface& surface) {
  for (const Vector3d& corner : corners)
    for (const double x : corner) vertices_.push_back(static_cast<float>(x));
  surfaces_.push_back(surface);
}

void Mesh::add_quad(const Vector3d& corner, const Vector3d& u, const Vector3d& v, uint32_t texture, float brightness) {
  // Different texture offset for each face.
  const double start = std::fmod(3.71 * static_cast<double>(surfaces_.size()), 97.0);
  const Vector3d along = u.normalized();
  add({corner, corner + u, corner + u + v, corner + v},
      {u.cross(v).normalized().cast<float>(), (corner - start * along).cast<float>(), along.cast<float>(),
       v.normalized().cast<float>(), texture, brightness});
}

void Mesh::add_picture(const Vector3d& corner, const Vector3d& u, const Vector3d& v, uint32_t texture) {
  add({corner, corner + u, corner + u + v, corner + v},
      {u.cross(v).normalized().cast<float>(), corner.cast<float>(), u.normalized().cast<float>(),
       v.normalized().cast<float>(), texture, 1.0f});
}

void Mesh::add_box(const Vector3d& foot, const Vector3d& size, double heading, uint32_t texture, float brightness) {
  const Eigen::AngleAxisd rotation(heading, Vector3d::UnitZ());
  const Vector3d x = rotation * Vector3d(size.x(), 0, 0), y = rotation * Vector3d(0, size.y(), 0), up(0, 0, -size.z());
  const Vector3d corner = foot - 0.5 * (x + y) + up;
  add_quad(corner, x, -up, texture, brightness);
  add_quad(corner + y, x, -up, texture, brightness);
  add_quad(corner, y, -up, texture, brightness);
  add_quad(corner + x, y, -up, texture, brightness);
  add_quad(corner, x, y, texture, brightness);
}

void Mesh::add_ball(const Vector3d& middle, double radius, uint32_t texture, uint64_t seed) {
  constexpr int kAround = 10, kUp = 6;
  Random random(seed, 3);
  Vector3d grid[kUp + 1][kAround + 1];
  for (int j = 0; j <= kUp; ++j)
    for (int i = 0; i < kAround; ++i) {
      const double polar = kPi * j / kUp, azimuth = 2 * kPi * i / kAround, r = radius * random.uniform(0.75, 1.15);
      grid[j][i] = middle + r * Vector3d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                         -0.9 * std::cos(polar));
    }
  for (int j = 0; j <= kUp; ++j) grid[j][kAround] = grid[j][0];
  for (int j = 0; j < kUp; ++j)
    for (int i = 0; i < kAround; ++i) {
      const std::array<Vector3d, 4> corners = {grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]};
      const Vector3d normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
      const Vector3d along = normal.unitOrthogonal(), start = random.uniform(0, 3) * along;
      add(corners, {normal.cast<float>(), (corners[0] - start).cast<float>(), along.cast<float>(),
                    normal.cross(along).cast<float>(), texture, static_cast<float>(random.uniform(0.8, 1.2))});
    }
}

RTCScene Mesh::build(RTCDevice device) const {
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), vertices_.size() / 3));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                                                 4 * sizeof(unsigned), surfaces_.size()));
  std::copy(vertices_.begin(), vertices_.end(), vertices);
  for (size_t i = 0; i < 4 * surfaces_.size(); ++i) indices[i] = static_cast<unsigned>(i);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace odograph
