// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "sdk/sim/camera.hpp"

namespace odograph {
namespace {

using Eigen::Vector3f;

constexpr float kFar = 1e5f;

void aim(RTCRay& ray, const Vector3f& from, const Vector3f& to) {
  ray = {};
  ray.org_x = from.x(), ray.org_y = from.y(), ray.org_z = from.z();
  ray.dir_x = to.x(), ray.dir_y = to.y(), ray.dir_z = to.z();
  ray.tnear = 0.02f, ray.tfar = kFar, ray.mask = ~0u;
}

void aim(RTCRayHit& hit, const Vector3f& from, const Vector3f& to) {
  aim(hit.ray, from, to);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

Vector3f direction(const RTCRay& ray) { return {ray.dir_x, ray.dir_y, ray.dir_z}; }
Vector3f end(const RTCRay& ray) { return Vector3f(ray.org_x, ray.org_y, ray.org_z) + ray.tfar * direction(ray); }

}  // namespace

View::View(const World& world, const SimCamera& camera, const Scenario& scenario)
    : world_(world), camera_(camera), c_(scenario), scene_(rtcNewScene(world.device())) {
  const auto instance = [&](size_t mesh) {
    RTCGeometry geometry = rtcNewGeometry(world.device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, world.scenes()[mesh]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(mesh_of_instance_.size()));
    mesh_of_instance_.push_back(mesh);
    turn_of_instance_.push_back(Eigen::Matrix3f::Identity());
    return geometry;
  };
  rtcReleaseGeometry(instance(0));
  for (const auto& mover : world.movers()) movers_.push_back(instance(mover.mesh));
  rtcCommitScene(scene_);
  hits_.resize(static_cast<size_t>(camera.width()));
}

View::~View() {
  for (RTCGeometry geometry : movers_) rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene_);
}

void View::place_movers(double t_s) {
  for (size_t k = 0; k < movers_.size(); ++k) {
    const Eigen::Isometry3f T = world_.movers()[k].at(t_s).cast<float>();
    const Eigen::Matrix<float, 3, 4> top = T.matrix().topRows<3>();
    rtcSetGeometryTransform(movers_[k], 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, top.data());
    rtcCommitGeometry(movers_[k]);
    turn_of_instance_[k + 1] = T.linear();
  }
  rtcCommitScene(scene_);
}

float View::sky(const Vector3f& ray) const {
  const float up = std::max(-ray.z(), 0.0f);
  float grey = 225.0f - 55.0f * up;
  if (up > 0.02f) {  // clouds: a flat layer far above
    const auto& clouds = world_.textures().all[TextureSet::kLeaves];
    const float u = ray.x() / (up + 0.1f), v = ray.y() / (up + 0.1f);
    const float cloud = clouds.at(0.35f * u + 1.0f, 0.35f * v, 0.02f).grey - 80.0f;
    grey += std::clamp(cloud, -10.0f, 30.0f) * std::min(1.0f, 4 * up);
  }
  const float aside = std::acos(std::clamp(ray.dot(world_.sun()), -1.0f, 1.0f));
  return grey + 400.0f * std::exp(-std::pow(aside / 0.045f, 2.0f)) + 60.0f * std::exp(-aside / 0.2f);
}

float View::surface_grey(const RTCRayHit& hit, float before, bool* glass, Vector3f* normal) const {
  const size_t instance = hit.hit.instID[0];
  const auto& surface = world_.meshes()[mesh_of_instance_[instance]].surface(hit.hit.primID);
  *normal = turn_of_instance_[instance] * surface.normal;
  const Vector3f ray = direction(hit.ray);
  float facing = normal->dot(ray);
  if (facing > 0) *normal = -*normal;
  facing = std::max(0.12f, std::abs(facing));
  const float pixel = (hit.ray.tfar + before) / static_cast<float>(c_.camera.focal_px);
  const auto texel = world_.textures().all[surface.texture].at(
      surface.u0_m + hit.hit.u * surface.u_m, surface.v0_m + hit.hit.v * surface.v_m, pixel / std::sqrt(facing));
  *glass = texel.glass && c_.world.glass;
  return texel.grey * surface.brightness;
}

void View::shade_row(float* row, float* depth) {
  const auto width = static_cast<unsigned>(camera_.width());
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1M(scene_, &context, hits_.data(), width, sizeof(RTCRayHit));
  shadows_.clear(), shadow_pixels_.clear(), mirrors_.clear(), glass_pixels_.clear();
  const Vector3f sun = world_.sun();
  for (unsigned x = 0; x < width; ++x) {
    const RTCRayHit& hit = hits_[x];
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      row[x] = sky(direction(hit.ray));
      depth[x] = kFar;
      continue;
    }
    bool glass = false;
    Vector3f normal;
    const float grey = surface_grey(hit, 0, &glass, &normal);
    const float lit = std::max(0.0f, normal.dot(sun));
    // Ambient light comes from the sky: less from below.
    row[x] = grey * (0.80f - 0.15f * normal.z());
    depth[x] = hit.ray.tfar;
    const Vector3f point = end(hit.ray) + 0.01f * normal;
    if (glass) {
      const Vector3f ray = direction(hit.ray);
      glass_pixels_.push_back(static_cast<int>(x));
      aim(mirrors_.emplace_back(), point, ray - 2 * normal.dot(ray) * normal);
    }
    if (lit <= 0.01f) continue;
    const float sunlight = 0.65f * lit * grey;
    if (!c_.world.shadows || c_.world.type != "street") {
      row[x] += 0.5f * sunlight;
      continue;
    }
    row[x] += sunlight;
    aim(shadows_.emplace_back(), point, sun);
    shadow_pixels_.push_back(static_cast<int>(x));
    hits_[x].hit.Ng_x = sunlight;  // to take back where the sun does not reach
  }
  if (!shadows_.empty()) {
    rtcOccluded1M(scene_, &context, shadows_.data(), static_cast<unsigned>(shadows_.size()), sizeof(RTCRay));
    for (size_t k = 0; k < shadows_.size(); ++k)
      if (shadows_[k].tfar < 0) row[shadow_pixels_[k]] -= hits_[static_cast<size_t>(shadow_pixels_[k])].hit.Ng_x;
  }
  if (mirrors_.empty()) return;
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect1M(scene_, &context, mirrors_.data(), static_cast<unsigned>(mirrors_.size()), sizeof(RTCRayHit));
  for (size_t k = 0; k < mirrors_.size(); ++k) {
    const RTCRayHit& hit = mirrors_[k];
    const auto x = static_cast<size_t>(glass_pixels_[k]);
    bool glass = false;
    Vector3f normal;
    const bool nothing = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID;
    const float seen =
        nothing ? std::min(255.0f, sky(direction(hit.ray))) : 0.7f * surface_grey(hit, depth[x], &glass, &normal);
    row[x] = 0.55f * row[x] + 0.45f * seen;
  }
}

cv::Mat View::render(const Motion& phone, double t_s) {
  place_movers(t_s);
  cv::Mat grey(camera_.height(), camera_.width(), CV_32F), depth(grey.size(), CV_32F);
  for (int y = 0; y < camera_.height(); ++y) {
    const Eigen::Isometry3d T = SimCamera::pose(phone, t_s + camera_.row_offset_s(y));
    const Eigen::Matrix3f R = T.linear().cast<float>();
    const Vector3f origin = T.translation().cast<float>();
    for (int x = 0; x < camera_.width(); ++x) aim(hits_[static_cast<size_t>(x)], origin, R * camera_.ray(x, y));
    shade_row(grey.ptr<float>(y), depth.ptr<float>(y));
  }
  cv::Mat sharp;
  cv::GaussianBlur(grey, sharp, {3, 3}, 0.5);  // the lens, and edges that one ray a pixel leaves jagged
  return c_.camera.exposure_s > 0 ? blurred(sharp, depth, phone, t_s) : sharp;
}

cv::Mat View::blurred(const cv::Mat& grey, const cv::Mat& depth, const Motion& phone, double t_s) const {
  const auto state = phone.at(t_s);
  const Eigen::Matrix3d R_c_b = SimCamera::in_body().conjugate().toRotationMatrix();
  const Vector3f turn = (R_c_b * state.angular_velocity_b).cast<float>();
  const Vector3f move = (R_c_b * state.T_n_b.linear().transpose() * state.velocity_n).cast<float>();
  const auto reach = static_cast<float>(c_.camera.exposure_s * c_.camera.focal_px);
  cv::Mat out(grey.size(), CV_32F);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      const Vector3f& ray = camera_.ray(x, y);
      const Vector3f speed = -turn.cross(ray) - move / depth.at<float>(y, x);  // of the point, by its distance
      const float u = reach * (speed.x() - ray.x() / ray.z() * speed.z()) / ray.z();
      const float v = reach * (speed.y() - ray.y() / ray.z() * speed.z()) / ray.z();
      const float length = std::max(std::abs(u), std::abs(v));
      if (length < 0.75f) {
        out.at<float>(y, x) = grey.at<float>(y, x);
        continue;
      }
      const int taps = std::min(15, 2 * static_cast<int>(0.5f * length) + 3);
      float sum = 0;
      for (int k = 0; k < taps; ++k) {
        const float s = (static_cast<float>(k) + 0.5f) / static_cast<float>(taps) - 0.5f;
        const int px = std::clamp(static_cast<int>(std::lround(static_cast<float>(x) + s * u)), 0, grey.cols - 1);
        const int py = std::clamp(static_cast<int>(std::lround(static_cast<float>(y) + s * v)), 0, grey.rows - 1);
        sum += grey.at<float>(py, px);
      }
      out.at<float>(y, x) = sum / static_cast<float>(taps);
    }
  return out;
}

}  // namespace odograph
