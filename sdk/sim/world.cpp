// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include <embree3/rtcore.h>
#include <opencv2/imgproc.hpp>

#include "sdk/sim/random.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr int kTextureSize = 1024;

/// Value noise over several octaves: no repetition, corners at every distance.
cv::Mat noise_texture(Random& random) {
  cv::Mat sum(kTextureSize, kTextureSize, CV_32F, cv::Scalar(0));
  for (int cells = 8; cells <= 256; cells *= 2) {
    cv::Mat coarse(cells, cells, CV_32F), fine;
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) coarse.at<float>(y, x) = static_cast<float>(random.uniform(-1, 1));
    cv::resize(coarse, fine, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += fine * (cells <= 32 ? 18.0 : 14.0);
  }
  return sum + 120.0;
}

/// Rows of windows with sills and frames, each with its own brightness, some signs.
void draw_facade(cv::Mat& texture, Random& random) {
  const int storey = 128, window = 96;
  for (int y = 30; y + storey <= kTextureSize; y += storey)
    for (int x = 14; x + window <= kTextureSize; x += window) {
      if (random.uniform() < 0.12) continue;
      const cv::Rect pane(x, y, 44 + static_cast<int>(random.uniform(0, 18)), 70);
      const double grey = random.uniform(15, 110);
      cv::rectangle(texture, pane, grey, cv::FILLED);
      cv::rectangle(texture, pane, random.uniform(170, 240), 4);
      cv::line(texture, {pane.x + pane.width / 2, pane.y}, {pane.x + pane.width / 2, pane.y + pane.height},
               random.uniform(150, 220), 3);
      if (random.uniform() < 0.3)
        cv::rectangle(texture, {pane.x + 6, pane.y + pane.height + 8, pane.width - 10, 12}, random.uniform(20, 240),
                      cv::FILLED);
    }
}

}  // namespace

struct World::Scene {
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

World::World(const Scenario& scenario, uint64_t seed) : scene_(std::make_unique<Scene>()) {
  for (uint64_t i = 0; i < 4; ++i) add_texture(seed * 16 + i, true, 12.0);
  for (uint64_t i = 4; i < 6; ++i) add_texture(seed * 16 + i, false, 8.0);
  if (scenario.world == "room")
    build_room(scenario);
  else
    build_street(scenario);
  rtcCommitScene(scene_->scene);
}

World::~World() = default;

size_t World::add_texture(uint64_t seed, bool facade, double metres) {
  Random random(seed, 7);
  cv::Mat image = noise_texture(random);
  if (facade) draw_facade(image, random);
  Texture texture;
  texture.metres = metres;
  texture.levels.emplace_back();
  image.convertTo(texture.levels.back(), CV_8U);
  while (texture.levels.back().cols > 8) {
    cv::Mat half;
    cv::resize(texture.levels.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    texture.levels.push_back(half);
  }
  textures_.push_back(std::move(texture));
  return textures_.size() - 1;
}

void World::add_quad(const Vector3d& corner, const Vector3d& u, const Vector3d& v, size_t texture) {
  RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), 1));
  const Vector3d corners[4] = {corner, corner + u, corner + u + v, corner + v};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) vertices[3 * i + k] = static_cast<float>(corners[i][k]);
    indices[i] = static_cast<unsigned>(i);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  quads_.push_back({u, v, texture, 3.7 * static_cast<double>(quads_.size())});
}

void World::build_street(const Scenario& c) {
  const double far = c.straight_m + 25, height = 9;
  const Vector3d up(0, 0, -1);
  add_quad({-40, -60, 0}, {2 * far + 80, 0, 0}, {0, 120, 0}, 4);  // ground
  // Houses of changing depth along both sides of the first straight, leaving the crossing open.
  const double crossing = c.straight_m + c.turn_radius_m;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; - 15 + 9 * k < far; ++k) {
      const double north = -15 + 9 * k;
      if (std::abs(north + 4.5 - crossing) < 6.5 && side * c.turn_rad > 0) continue;
      const double east = side * (5.0 + 0.8 * (k % 3));
      add_quad({north, east, 0}, {8.6, 0, 0}, height * up, static_cast<size_t>(k + (side > 0)) % 4);
      add_quad({north, east, 0}, {0, side * 3, 0}, height * up, static_cast<size_t>(k + 1) % 4);
    }
  }
  // The house at the end, and both sides of the street turned into.
  add_quad({far, -30, 0}, {0, 60, 0}, height * up, 1);
  const Eigen::AngleAxisd turn(c.turn_rad, Vector3d::UnitZ());
  const double side = c.turn_rad < 0 ? -1.0 : 1.0;
  const Vector3d start(c.straight_m + c.turn_radius_m * std::sin(std::abs(c.turn_rad)),
                       side * c.turn_radius_m * (1 - std::cos(c.turn_rad)), 0);
  for (const double edge : {-5.5, 5.5})
    for (int k = 0; k < static_cast<int>(far / 9) + 2; ++k)
      add_quad(start + turn * Vector3d(5 + 9 * k, edge + 0.6 * (k % 2), 0), turn * Vector3d(8.6, 0, 0), height * up,
               static_cast<size_t>(k + 2) % 4);
  add_quad(start + turn * Vector3d(far, -20, 0), turn * Vector3d(0, 40, 0), height * up, 3);
}

void World::build_room(const Scenario& c) {
  const double reach = 2 * c.straight_m + std::abs(c.turn_rad) * c.turn_radius_m + 3;
  const Vector3d up(0, 0, -3.2);
  const double low = -3, high = reach, west = -reach, east = reach;
  add_quad({low, west, 0}, {high - low, 0, 0}, {0, east - west, 0}, 4);
  add_quad({low, west, up.z()}, {high - low, 0, 0}, {0, east - west, 0}, 5);
  add_quad({high, west, 0}, {0, east - west, 0}, up, 0);
  add_quad({low, west, 0}, {0, east - west, 0}, up, 1);
  add_quad({low, west, 0}, {high - low, 0, 0}, up, 2);
  add_quad({low, east, 0}, {high - low, 0, 0}, up, 3);
  for (int k = 0; k < 12; ++k) {  // pillars
    const double north = 2.0 + 3.1 * k, side = (k % 2 ? 1.0 : -1.0) * 2.2;
    if (north > high - 1) break;
    add_quad({north, side, 0}, {0.5, 0, 0}, up, static_cast<size_t>(k) % 4);
    add_quad({north, side, 0}, {0, side > 0 ? 0.5 : -0.5, 0}, up, static_cast<size_t>(k + 1) % 4);
  }
}

double World::shade(size_t index, double u_m, double v_m, double footprint_m) const {
  const Texture& texture = textures_[index];
  const double texel = texture.metres / kTextureSize;
  const double level = std::clamp(std::log2(std::max(1.0, footprint_m / texel)), 0.0,
                                  static_cast<double>(texture.levels.size()) - 1.001);
  const auto sample = [&](size_t l) {
    const cv::Mat& image = texture.levels[l];
    const int size = image.cols;
    const double scale = size / texture.metres;
    const double x = u_m * scale - 0.5, y = v_m * scale - 0.5;
    const double fx = std::floor(x), fy = std::floor(y);
    const int x0 = static_cast<int>(fx) & (size - 1), y0 = static_cast<int>(fy) & (size - 1);
    const int x1 = (x0 + 1) & (size - 1), y1 = (y0 + 1) & (size - 1);
    const double wx = x - fx, wy = y - fy;
    const auto *r0 = image.ptr<uint8_t>(y0), *r1 = image.ptr<uint8_t>(y1);
    return (1 - wy) * ((1 - wx) * r0[x0] + wx * r0[x1]) + wy * ((1 - wx) * r1[x0] + wx * r1[x1]);
  };
  const auto l = static_cast<size_t>(level);
  const double w = level - static_cast<double>(l);
  return (1 - w) * sample(l) + w * sample(l + 1);
}

cv::Mat World::render(const Eigen::Isometry3d& T_n_c, const Scenario& camera) const {
  cv::Mat image(camera.height, camera.width, CV_8U);
  const auto rows = [&](int from, int to) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int y = from; y < to; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vector3d ray_c((x - 0.5 * (camera.width - 1)) / camera.focal_px,
                             (y - 0.5 * (camera.height - 1)) / camera.focal_px, 1.0);
        const Vector3d ray = T_n_c.linear() * ray_c;
        RTCRayHit hit{};
        hit.ray.org_x = static_cast<float>(T_n_c.translation().x());
        hit.ray.org_y = static_cast<float>(T_n_c.translation().y());
        hit.ray.org_z = static_cast<float>(T_n_c.translation().z());
        hit.ray.dir_x = static_cast<float>(ray.x());
        hit.ray.dir_y = static_cast<float>(ray.y());
        hit.ray.dir_z = static_cast<float>(ray.z());
        hit.ray.tnear = 0.05f;
        hit.ray.tfar = 1e6f;
        hit.ray.mask = ~0u;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_->scene, &context, &hit);
        double grey = 215.0 - 25.0 * std::clamp(-ray.normalized().z(), 0.0, 1.0);  // sky
        if (hit.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
          const Quad& quad = quads_[hit.hit.geomID];
          const Vector3d normal = quad.u.cross(quad.v).normalized();
          const double slant = std::max(0.15, std::abs(normal.dot(ray.normalized())));
          const double depth = hit.ray.tfar;
          grey = shade(quad.texture, quad.offset_m + hit.hit.u * quad.u.norm(), hit.hit.v * quad.v.norm(),
                       depth / camera.focal_px / std::sqrt(slant));
          grey *= 0.75 + 0.25 * std::abs(normal.dot(Vector3d(0.48, 0.6, 0.64)));
        }
        image.at<uint8_t>(y, x) = static_cast<uint8_t>(std::clamp(grey, 0.0, 255.0));
      }
    }
  };
  std::thread half(rows, 0, camera.height / 2);
  rows(camera.height / 2, camera.height);
  half.join();
  return image;
}

}  // namespace odograph
