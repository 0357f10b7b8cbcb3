// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "sdk/tools/simulation/camera.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;
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
    place_of_instance_.push_back(Eigen::Isometry3f::Identity());
    return geometry;
  };
  rtcReleaseGeometry(instance(0));
  for (const auto& mover : world.movers()) movers_.push_back(instance(mover.mesh));
  rtcCommitScene(scene_);
  const auto width = static_cast<size_t>(camera.width());
  hits_.resize(width), shadows_.resize(width), sunlight_.resize(width);
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
    place_of_instance_[k + 1] = T;
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
  const float aside2 = (ray - world_.sun()).squaredNorm();  // squared angle to the sun, approximated by the chord
  if (aside2 < 0.04f) grey += 400.0f * std::exp(-aside2 / (0.045f * 0.045f));
  return aside2 < 1.44f ? grey + 60.0f * std::exp(-std::sqrt(aside2) / 0.2f) : grey;
}

float View::surface_grey(const RTCRayHit& hit, float before, bool* glass, Vector3f* normal) const {
  const size_t instance = hit.hit.instID[0];
  const auto& surface = world_.meshes()[mesh_of_instance_[instance]].surface(hit.hit.primID);
  const Vector3f ray = direction(hit.ray);
  Vector3f at = end(hit.ray);
  if (instance == 0) {
    *normal = surface.normal;
    at -= surface.origin;
  } else {
    const auto& T = place_of_instance_[instance];
    *normal = T.linear() * surface.normal;
    at = T.linear().transpose() * (at - T.translation()) - surface.origin;
  }
  float facing = normal->dot(ray);
  if (facing > 0) *normal = -*normal;
  facing = std::max(0.12f, std::abs(facing));
  const float pixel = (hit.ray.tfar + before) / static_cast<float>(c_.camera.focal_px);
  const auto texel =
      world_.textures().all[surface.texture].at(surface.along.dot(at), surface.down.dot(at), pixel / std::sqrt(facing));
  *glass = texel.glass && c_.world.glass;
  return texel.grey * surface.brightness;
}

Tint View::tint_of(const RTCRayHit& hit, float grey) const {
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return sky_tint(-hit.ray.dir_z, grey);
  const auto& surface = world_.meshes()[mesh_of_instance_[hit.hit.instID[0]]].surface(hit.hit.primID);
  return surface_tint(surface.texture, surface.brightness);
}

/// Whether two rays of a row hit the same static face.
bool View::same_face(size_t a, size_t b) const {
  const auto &ha = hits_[a].hit, &hb = hits_[b].hit;
  return ha.geomID != RTC_INVALID_GEOMETRY_ID && hb.geomID == ha.geomID && ha.instID[0] == 0 && hb.instID[0] == 0 &&
         ha.primID == hb.primID;
}

/// Traces the pixels of a row. Casts every second ray; if both neighbours hit the same face, the pixel between them
/// intersects that face's plane, otherwise its ray is cast.
void View::look_along_row() {
  const size_t width = hits_.size();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1M(scene_, &context, hits_.data(), static_cast<unsigned>((width + 1) / 2), 2 * sizeof(RTCRayHit));
  undecided_.clear();
  for (size_t x = 1; x < width; x += 2) {
    if (x + 1 == width || !same_face(x - 1, x + 1)) {
      undecided_.push_back(&hits_[x]);
      continue;
    }
    RTCRayHit& hit = hits_[x];
    const auto& face = world_.meshes()[0].surface(hits_[x - 1].hit.primID);
    const Vector3f origin(hit.ray.org_x, hit.ray.org_y, hit.ray.org_z);
    const float distance = face.normal.dot(face.origin - origin) / face.normal.dot(direction(hit.ray));
    if (!(distance > 0 && distance < kFar)) {  // along the face
      undecided_.push_back(&hit);
      continue;
    }
    hit.hit = hits_[x - 1].hit;
    hit.ray.tfar = distance;
  }
  if (!undecided_.empty())
    rtcIntersect1Mp(scene_, &context, undecided_.data(), static_cast<unsigned>(undecided_.size()));
}

/// Removes sunlight from shaded pixels; every second ray first, as above.
void View::cast_shadows(float* row) {
  const size_t width = hits_.size();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const auto lit = [&](size_t x) { return sunlight_[x] > 0; };
  const auto cast = [&] {
    if (!towards_sun_.empty())
      rtcOccluded1Mp(scene_, &context, towards_sun_.data(), static_cast<unsigned>(towards_sun_.size()));
    towards_sun_.clear();
  };
  for (size_t x = 0; x < width; x += 2)
    if (lit(x)) towards_sun_.push_back(&shadows_[x]);
  cast();
  for (size_t x = 1; x < width; x += 2) {
    if (!lit(x)) continue;
    const bool sure = x + 1 < width && lit(x - 1) && lit(x + 1) && same_face(x - 1, x + 1) &&
                      (shadows_[x - 1].tfar < 0) == (shadows_[x + 1].tfar < 0);
    if (sure)
      shadows_[x].tfar = shadows_[x - 1].tfar;
    else
      towards_sun_.push_back(&shadows_[x]);
  }
  cast();
  for (size_t x = 0; x < width; ++x)
    if (lit(x) && shadows_[x].tfar < 0) row[x] -= sunlight_[x];
}

void View::cast_reflections(float* row, const float* depth, Tint* tint) {
  if (mirrors_.empty()) return;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1M(scene_, &context, mirrors_.data(), static_cast<unsigned>(mirrors_.size()), sizeof(RTCRayHit));
  for (size_t k = 0; k < mirrors_.size(); ++k) {
    const RTCRayHit& hit = mirrors_[k];
    const size_t x = glass_pixels_[k];
    bool glass = false;
    Vector3f normal;
    const bool nothing = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID;
    const float seen =
        nothing ? std::min(255.0f, sky(direction(hit.ray))) : 0.7f * surface_grey(hit, depth[x], &glass, &normal);
    const float own = 0.55f * row[x], reflected = 0.45f * seen;
    row[x] = own + reflected;
    if (tint) tint[x] = (own * tint[x] + reflected * tint_of(hit, seen)) / std::max(row[x], 1.0f);
  }
}

void View::shade_row(float* row, float* depth, uint16_t* instance, Tint* tint) {
  look_along_row();
  mirrors_.clear(), glass_pixels_.clear();
  const Vector3f sun = world_.sun();
  const bool shadows = c_.world.shadows && !c_.is_indoors();
  for (size_t x = 0; x < hits_.size(); ++x) {
    const RTCRayHit& hit = hits_[x];
    sunlight_[x] = 0;
    instance[x] = 0;
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
    instance[x] = static_cast<uint16_t>(hit.hit.instID[0]);
    const Vector3f point = end(hit.ray) + 0.01f * normal;
    if (glass) {
      const Vector3f ray = direction(hit.ray);
      glass_pixels_.push_back(x);
      aim(mirrors_.emplace_back(), point, ray - 2 * normal.dot(ray) * normal);
    }
    if (lit <= 0.01f) continue;
    const float sunlight = 0.65f * lit * grey;
    row[x] += shadows ? sunlight : 0.5f * sunlight;
    if (!shadows) continue;
    sunlight_[x] = sunlight;
    aim(shadows_[x], point, sun);
  }
  if (shadows) cast_shadows(row);
  for (size_t x = 0; tint && x < hits_.size(); ++x) tint[x] = tint_of(hits_[x], row[x]);
  cast_reflections(row, depth, tint);
}

cv::Mat View::sky_mask() const { return depth_ >= kFar; }

cv::Mat View::render(const Motion& phone, double t_s, double exposure_s) {
  place_movers(t_s);
  cv::Mat grey(camera_.height(), camera_.width(), CV_32F);
  depth_.create(grey.size(), CV_32F);
  instance_of_pixel_.create(grey.size(), CV_16U);
  if (c_.camera.colour) tint_.create(grey.size(), CV_32FC2);
  for (int y = 0; y < camera_.height(); ++y) {
    const Eigen::Isometry3d T = camera_.pose(phone, t_s + camera_.row_offset_s(y));
    const Eigen::Matrix3f R = T.linear().cast<float>();
    const Vector3f origin = T.translation().cast<float>();
    const bool still = !camera_.lens().moves();
    const SimLens::State lens = camera_.lens().at(t_s + camera_.row_offset_s(y));
    for (int x = 0; x < camera_.width(); ++x)
      aim(hits_[static_cast<size_t>(x)], origin, R * (still ? camera_.ray(x, y) : camera_.ray(x, y, lens)));
    shade_row(grey.ptr<float>(y), depth_.ptr<float>(y), instance_of_pixel_.ptr<uint16_t>(y),
              tint_.empty() ? nullptr : tint_.ptr<Tint>(y));
  }
  moving_part_ = static_cast<double>(cv::countNonZero(instance_of_pixel_)) / static_cast<double>(grey.total());
  if (!tint_.empty()) cv::GaussianBlur(tint_, tint_, {5, 5}, 1.2);  // a sensor resolves colour half as well as grey
  cv::Mat sharp;
  cv::GaussianBlur(grey, sharp, {3, 3}, 0.5);  // lens blur and antialiasing, because there is one ray per pixel
  return exposure_s > 0 ? blurred(sharp, phone, t_s, exposure_s) : sharp;
}

double View::visible_part(const KnownObject& object, const Vector3d& eye_n, double t_s) {
  place_movers(t_s);
  constexpr int kSide = 5;
  std::array<RTCRay, kSide * kSide> rays;
  const Vector3d u = object.corners[1] - object.corners[0], v = object.corners[3] - object.corners[0];
  for (int i = 0; i < kSide * kSide; ++i) {
    const int row = i / kSide, column = i % kSide;
    const Vector3d point = object.corners[0] + (column + 0.5) / kSide * u + (row + 0.5) / kSide * v;
    auto& ray = rays[static_cast<size_t>(i)];
    aim(ray, eye_n.cast<float>(), (point - eye_n).cast<float>());
    ray.tfar = 0.998f;  // ends just before the board
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1M(scene_, &context, rays.data(), kSide * kSide, sizeof(RTCRay));
  return static_cast<double>(std::count_if(rays.begin(), rays.end(), [](const RTCRay& r) { return r.tfar > 0; })) /
         (kSide * kSide);
}

cv::Mat View::blurred(const cv::Mat& grey, const Motion& phone, double t_s, double exposure_s) const {
  const auto state = phone.at(t_s);
  const Eigen::Matrix3d R_c_b = camera_.in_body().conjugate().toRotationMatrix();
  const Vector3f rotation = (R_c_b * state.angular_velocity_b).cast<float>();
  const Eigen::Matrix3d R_c_n = R_c_b * state.T_n_b.linear().transpose();
  std::vector<Vector3f> moves = {
      (R_c_n * state.velocity_n).cast<float>()};  // relative to static objects, and to each moving one
  for (const auto& mover : world_.movers()) {
    const Vector3d velocity = mover.speed_mps * Vector3d(std::cos(mover.heading), std::sin(mover.heading), 0);
    moves.push_back((R_c_n * (state.velocity_n - velocity)).cast<float>());
  }
  const auto reach = static_cast<float>(exposure_s * c_.camera.focal_px);
  cv::Mat out(grey.size(), CV_32F);
  const int right = grey.cols - 1, bottom = grey.rows - 1;
  const auto* pixels = grey.ptr<float>();
  for (int y = 0; y <= bottom; ++y) {
    const auto *row = grey.ptr<float>(y), *depths = depth_.ptr<float>(y);
    const auto* instances = instance_of_pixel_.ptr<uint16_t>(y);
    auto* to = out.ptr<float>(y);
    const Eigen::Vector2d lens = camera_.lens().at(t_s + camera_.row_offset_s(y)).rate_px_s * exposure_s;
    const auto lens_u = static_cast<float>(lens.x()), lens_v = static_cast<float>(lens.y());
    for (int x = 0; x <= right; ++x) {
      const Vector3f& move = moves[instances[x]];
      // Optical flow of a point at (X, Y, 1) z.
      const Vector3f& ray = camera_.ray(x, y);
      const float near = 1.0f / ray.z(), X = ray.x() * near, Y = ray.y() * near, inverse_z = near / depths[x];
      const float away = (rotation.y() * X - rotation.x() * Y) - inverse_z * move.z();
      const float u = reach * (rotation.z() * Y - rotation.y() - inverse_z * move.x() - X * away) + lens_u;
      const float v = reach * (rotation.x() - rotation.z() * X - inverse_z * move.y() - Y * away) + lens_v;
      const float length = std::max(std::abs(u), std::abs(v));
      if (length < 0.75f) {
        to[x] = row[x];
        continue;
      }
      const int taps = std::min(15, 2 * static_cast<int>(0.5f * length) + 3);
      const float step = 1.0f / static_cast<float>(taps);
      // Half a pixel is added, so that truncation yields the pixel index.
      float px = static_cast<float>(x) + 0.5f + (0.5f * step - 0.5f) * u;
      float py = static_cast<float>(y) + 0.5f + (0.5f * step - 0.5f) * v;
      float sum = 0;
      for (int k = 0; k < taps; ++k, px += step * u, py += step * v)
        sum += pixels[std::clamp(static_cast<int>(py), 0, bottom) * grey.cols +
                      std::clamp(static_cast<int>(px), 0, right)];
      to[x] = sum * step;
    }
  }
  return out;
}

}  // namespace odograph
