// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace {

constexpr double kPath_m = 0.5, kPathWidth_m = 0.32;
constexpr size_t kMaxPath = 800;     // of the session's 1024 anchors
constexpr double kMap_m = 20;        // radius
constexpr double kGrid_m = 9;        // from the phone
constexpr double kGroundTau = 0.02;  // the ground tracks the phone's mean height, per picture
const cv::Scalar kColours[] = {{80, 190, 255}, {120, 220, 120}, {255, 170, 90}, {200, 130, 255}, {90, 235, 235}};
const cv::Scalar kPathColour(250, 190, 60), kGridColour(255, 255, 255);

template <class T>
T sized() {
  T out;
  std::memset(&out, 0, sizeof out);
  return out;
}

odo_pose empty_pose() {
  odo_pose pose = sized<odo_pose>();
  pose.header.struct_size = sizeof pose;
  return pose;
}

Point position(const odo_pose& pose) { return {pose.p_n[0], pose.p_n[1], pose.p_n[2]}; }
Point into_camera(const odo_pose& pose, const Point& p_n) { return rotate_back(pose.q_n, p_n - position(pose)); }

bool has_position(const odo_pose& pose) {
  constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_METRIC;
  return (pose.header.flags & needed) == needed;
}

}  // namespace

uint64_t Scene::anchor(uint32_t kind, const std::string& name, const Point& p, int64_t t_ns) const {
  odo_anchor_place place = sized<odo_anchor_place>();
  place.struct_size = sizeof place;
  place.kind = kind;
  place.t_ns = t_ns;
  place.p[0] = p.x, place.p[1] = p.y, place.p[2] = p.z;
  place.name.data = name.data(), place.name.size = name.size();
  uint64_t id = 0;
  odo_anchor_create(session_, &place, &id);
  return id;
}

/// An anchor where the ray of a pixel meets a surface or a landmark; 0 if nothing is known there yet.
uint64_t Scene::touch(const std::string& name, double column, double row, int64_t t_ns) const {
  odo_ray ray = sized<odo_ray>();
  odo_hit hit = sized<odo_hit>();
  uint32_t count = 0;
  ray.struct_size = sizeof ray, hit.struct_size = sizeof hit;
  ray.kind = ODO_RAY_PIXEL, ray.t_ns = t_ns;
  ray.pixel[0] = column, ray.pixel[1] = row;
  ray.wanted = ODO_HIT_SURFACE | ODO_HIT_POINT;
  if (odo_session_hit_test(session_, &ray, &hit, 1, &count) != ODO_OK || count == 0) return 0;
  odo_anchor_place place = sized<odo_anchor_place>();
  place.struct_size = sizeof place;
  place.kind = ODO_ANCHOR_HIT, place.t_ns = hit.t_ns, place.surface = hit.surface;
  place.sigma_m = hit.sigma_m;
  std::copy(hit.q_n, hit.q_n + 4, place.q);
  std::copy(hit.p_n, hit.p_n + 3, place.p);
  place.name.data = name.data(), place.name.size = name.size();
  uint64_t id = 0;
  odo_anchor_create(session_, &place, &id);
  std::printf("%s: %.2f m ahead, +- %.0f cm\n", name.c_str(), hit.distance_m, 100 * hit.sigma_m);
  return id;
}

void Scene::put_up(int64_t t_ns, double seconds) {
  if (!placed_) {
    placed_ = true;
    for (const Options::Place& at : options_.places) {
      odo_anchor_place place = sized<odo_anchor_place>();
      place.struct_size = sizeof place;
      place.kind = ODO_ANCHOR_GEODETIC;
      place.latitude_rad = at.latitude_deg * CV_PI / 180, place.longitude_rad = at.longitude_deg * CV_PI / 180;
      place.height_m = at.height_m, place.height_above = ODO_HEIGHT_ELLIPSOID;
      place.name.data = at.name.data(), place.name.size = at.name.size();
      uint64_t id = 0;
      if (odo_anchor_create(session_, &place, &id) == ODO_OK)
        shown_.push_back({id, at.name, static_cast<int>(shown_.size())});
    }
  }
  odo_pose pose = empty_pose();
  if (odo_session_get_pose(session_, t_ns, &pose) != ODO_OK || !has_position(pose)) return;
  const double ground = pose.p_n[2] + options_.height_m;
  ground_down_ = started_ ? ground_down_ + kGroundTau * (ground - ground_down_) : ground;
  const Point foot(pose.p_n[0], pose.p_n[1], ground_down_);
  if ((!started_ || length(foot - last_path_) > kPath_m) && path_.size() < kMaxPath) {
    path_.push_back(anchor(ODO_ANCHOR_POSE, "", foot, t_ns));
    last_path_ = foot;
  }
  started_ = true;
  for (size_t i = 0; i < options_.drops.size(); ++i) {
    const Options::Drop& drop = options_.drops[i];
    const bool due = seconds >= drop.at_s;
    const bool done = std::any_of(shown_.begin(), shown_.end(), [&](const Shown& s) { return s.name == drop.name; });
    if (!due || done) continue;
    const uint64_t id = drop.touched ? touch(drop.name, drop.p[0], drop.p[1], t_ns)
                                     : anchor(ODO_ANCHOR_VIEW, drop.name, {drop.p[0], drop.p[1], drop.p[2]}, t_ns);
    if (id != 0) shown_.push_back({id, drop.name, static_cast<int>(shown_.size())});
  }
}

void Scene::draw(Canvas& canvas, int64_t t_ns) const {
  odo_pose pose = empty_pose();
  const bool known = odo_session_get_smooth_pose(session_, t_ns, &pose) == ODO_OK && has_position(pose);
  if (known) {
    draw_grid(canvas, pose, ground_down_);
    canvas.finish();  // the ground is below everything else
    const auto path = path_points(t_ns);
    draw_path(canvas, pose, path);
    canvas.finish();
    draw_anchors(canvas, pose, ground_down_, t_ns);
    canvas.finish();
    draw_map(canvas, pose, path, t_ns);
  }
  draw_state(canvas, pose, known);
}

/// Grid lines at integer metres of n around the phone, fading with the distance; every fifth is stronger.
void Scene::draw_grid(Canvas& canvas, const odo_pose& pose, double ground_down) const {
  const int north = static_cast<int>(std::floor(pose.p_n[0])), east = static_cast<int>(std::floor(pose.p_n[1]));
  const int reach = static_cast<int>(kGrid_m);
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j < reach; ++j) {
      const auto piece = [&](double n0, double e0, double n1, double e1, bool strong) {
        const double off_m = std::hypot((n0 + n1) / 2 - pose.p_n[0], (e0 + e1) / 2 - pose.p_n[1]);
        const double fade = std::max(0.0, 1 - off_m / kGrid_m);
        canvas.line(into_camera(pose, {n0, e0, ground_down}), into_camera(pose, {n1, e1, ground_down}), kGridColour,
                    (strong ? 0.9 : 0.55) * fade, strong ? 4 : 2);
      };
      piece(north + i, east + j, north + i, east + j + 1, (north + i) % 5 == 0);
      piece(north + j, east + i, north + j + 1, east + i, (east + i) % 5 == 0);
    }
  }
}

/// Present positions of the anchors along the path, in n.
std::vector<Point> Scene::path_points(int64_t t_ns) const {
  std::vector<Point> points;
  for (const uint64_t id : path_) {
    odo_anchor a = sized<odo_anchor>();
    a.struct_size = sizeof a;
    if (odo_anchor_get(session_, id, ODO_WORLD_SMOOTH, t_ns, &a) != ODO_OK || !(a.flags & ODO_ANCHOR_VIEW_POSE))
      continue;
    points.push_back({a.p_n[0], a.p_n[1], a.p_n[2]});
  }
  return points;
}

void Scene::draw_path(Canvas& canvas, const odo_pose& pose, const std::vector<Point>& points) const {
  for (size_t i = 1; i < points.size(); ++i) {
    const Point along = points[i] - points[i - 1];
    const double norm = std::hypot(along.x, along.y);
    if (norm <= 0) continue;
    const Point side(-along.y / norm * kPathWidth_m / 2, along.x / norm * kPathWidth_m / 2, 0);
    const auto corner = [&](const Point& p) { return into_camera(pose, p); };
    canvas.polygon({corner(points[i - 1] + side), corner(points[i] + side), corner(points[i] - side),
                    corner(points[i - 1] - side)},
                   kPathColour, 0.55);
  }
}

void Scene::draw_anchors(Canvas& canvas, const odo_pose& pose, double ground_down, int64_t t_ns) const {
  const Point up = rotate_back(pose.q_n, {0, 0, -1});
  for (const Shown& shown : shown_) {
    odo_anchor a = sized<odo_anchor>();
    a.struct_size = sizeof a;
    if (odo_anchor_get(session_, shown.id, ODO_WORLD_SMOOTH, t_ns, &a) != ODO_OK) continue;
    if (!(a.flags & ODO_ANCHOR_IN_FRONT) || a.state == ODO_LOST) continue;
    const cv::Scalar colour = kColours[static_cast<size_t>(shown.colour) % std::size(kColours)];
    const Point tip(a.p_view[0], a.p_view[1], a.p_view[2]);
    const Point foot = into_camera(pose, {a.p_n[0], a.p_n[1], ground_down});
    canvas.ring(foot, up, 0.38, colour, a.state == ODO_TRACKING ? 0.85 : 0.4);
    canvas.line(foot, tip, colour, 0.9, 4);
    char below[64];
    std::snprintf(below, sizeof below, "%.1f m", length(tip));
    canvas.label(tip, shown.name, below, colour);
  }
}

void Scene::draw_map(Canvas& canvas, const odo_pose& pose, const std::vector<Point>& path, int64_t t_ns) const {
  const Point ahead = rotate(pose.q_n, {0, 0, 1});
  const double norm = std::max(1e-6, std::hypot(ahead.x, ahead.y)), c = ahead.x / norm, s = ahead.y / norm;
  const auto on_map = [&](const Point& p) {
    const double north = p.x - pose.p_n[0], east = p.y - pose.p_n[1];
    return cv::Point2d(c * east - s * north, c * north + s * east);
  };
  std::vector<cv::Point2d> line;
  for (const Point& p : path) line.push_back(on_map(p));
  line.emplace_back(0, 0);
  std::vector<Canvas::Mark> marks;
  for (const Shown& shown : shown_) {
    odo_anchor a = sized<odo_anchor>();
    a.struct_size = sizeof a;
    if (odo_anchor_get(session_, shown.id, ODO_WORLD_SMOOTH, t_ns, &a) != ODO_OK || !(a.flags & ODO_ANCHOR_VIEW_POSE))
      continue;
    marks.push_back(
        {on_map({a.p_n[0], a.p_n[1], a.p_n[2]}), kColours[static_cast<size_t>(shown.colour) % std::size(kColours)]});
  }
  canvas.map(line, marks, kMap_m, kPathColour);
}

void Scene::draw_state(Canvas& canvas, const odo_pose& pose, bool known) const {
  char text[160];
  const bool tracking = pose.state == ODO_TRACKING;
  const double sigma_m = std::sqrt(std::max({0.0, pose.covariance[21], pose.covariance[28]}));
  if (known)
    std::snprintf(text, sizeof text, "%s%s%s    walked %.1f m    position +- %.2f m    %zu anchors",
                  odo_state_text(pose.state), tracking ? "" : ": ", tracking ? "" : odo_reason_text(pose.reason),
                  pose.distance_m, sigma_m, shown_.size() + path_.size());
  else
    std::snprintf(text, sizeof text, "%s: %s", odo_state_text(pose.state), odo_reason_text(pose.reason));
  canvas.status(text, !known || pose.state == ODO_LOST ? cv::Scalar(80, 80, 240)
                      : tracking                       ? cv::Scalar(110, 220, 110)
                                                       : cv::Scalar(70, 190, 250));
}
