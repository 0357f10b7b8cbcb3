// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/finder.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph::known_object {

using Eigen::Vector3d;

namespace {

/// Angular difference of two poses: of the rotation, and of the position over the distance.
double apart_rad(const Pose& a, const Pose& b) {
  const double turned = Eigen::AngleAxisd(a.R_c_o.transpose() * b.R_c_o).angle();
  const Vector3d moved = a.R_c_o.transpose() * a.t_c_o - b.R_c_o.transpose() * b.t_c_o;  // of the camera, in o
  return std::max(turned, moved.norm() / std::max(0.1, a.t_c_o.norm()));
}

/// True if an object is seen at positions that do not overlap.
bool are_apart(const std::vector<Pose>& seen, const PlaneObject& object) {
  const double half_m = 0.5 * std::min(object.width_m, object.height_m);
  for (const Pose& a : seen)
    for (const Pose& b : seen) {
      const double angle = std::acos(std::clamp(a.t_c_o.normalized().dot(b.t_c_o.normalized()), -1.0, 1.0));
      if (angle > half_m / std::max(0.1, std::min(a.t_c_o.norm(), b.t_c_o.norm()))) return true;
    }
  return false;
}

/// Pose of the object propagated by the camera's motion.
Pose propagated(const Pose& pose, const RollingLens& lens, int64_t by_ns) {
  const double s = seconds(by_ns);
  Eigen::Matrix<double, 6, 1> motion;
  motion << -s * lens.rate_c, -s * lens.velocity_c;
  return pose.moved(motion);
}

}  // namespace

Finder::Finder(const Parameters& parameters, std::vector<PlaneObject> objects)
    : p_(parameters),
      objects_(std::move(objects)),
      search_(PictureSearch::Parameters{}, objects_),
      copy_search_(CopySearch::Parameters{}, objects_),
      tracked_(objects_.size()) {
  std::vector<std::string> families;
  for (const PlaneObject& object : objects_) {
    pyramids_.emplace_back(object);
    if (object.tag >= 0)
      families.push_back(object.family);
    else
      has_pictures_ = true;
  }
  if (!families.empty()) tags_ = std::make_unique<TagDetector>(families);
}

Finder::~Finder() = default;

void Finder::clear() {
  tracked_.assign(objects_.size(), {});
  searched_ns_ = INT64_MIN;
}

bool Finder::is_accepted(const Alignment& a) const {
  return a.correlation >= p_.min_correlation && a.agreeing_part >= p_.min_agreeing && a.side_px >= p_.min_side_px &&
         a.oblique_rad <= p_.max_oblique_rad;
}

bool Finder::resembles(const Alignment& a) const {
  return a.correlation >= p_.copy_correlation && a.agreeing_part >= p_.copy_agreeing && a.side_px >= p_.min_side_px;
}

/// Refines the best of the starts, and the second solution of the plane's pose from there.
Finder::Detection Finder::detect_at(size_t object, const Aligner::Frame& frame, const RollingLens& lens,
                                    const std::vector<Pose>& starts, bool fine) const {
  Sighting sighting;
  std::optional<Pose> resemblance;
  sighting.object = object;
  const auto add = [&](const Pose& start, bool from_near) {
    auto a = aligner_.align(frame, lens, pyramids_[object], start, from_near);
    if (!a) return;
    if (resembles(*a)) resemblance = a->pose;
    if (!is_accepted(*a)) return;
    for (Alignment& known : sighting.poses)
      if (apart_rad(known.pose, a->pose) < p_.same_pose_rad) {
        if (a->cost < known.cost) known = *a;
        return;
      }
    sighting.poses.push_back(*a);
  };
  for (const Pose& start : starts) add(start, fine);
  if (sighting.poses.empty()) return {std::nullopt, resemblance};
  const auto order = [&] {
    std::sort(sighting.poses.begin(), sighting.poses.end(),
              [](const Alignment& a, const Alignment& b) { return a.cost < b.cost; });
  };
  order();
  // The second solution of the plane: from the corners projected with the best pose.
  std::vector<cv::Point3d> corners_o;
  std::vector<cv::Point2d> seen;
  for (const Vector3d& corner : objects_[object].corners_o()) {
    const Vector3d p = sighting.poses[0].pose * corner;
    if (p.z() < 0.05) return {sighting, sighting.poses[0].pose};
    corners_o.emplace_back(corner.x(), corner.y(), 0);
    seen.emplace_back(p.x() / p.z(), p.y() / p.z());
  }
  const std::vector<Pose> both = plane_poses(corners_o, seen);
  for (const Pose& pose : both)
    if (apart_rad(pose, sighting.poses[0].pose) > p_.same_pose_rad) add(pose, true);
  order();
  if (sighting.poses.size() > 2) sighting.poses.resize(2);
  const Pose best = sighting.poses[0].pose;
  return {std::move(sighting), best};
}

/// Start poses for each candidate position of an object in the frame.
std::vector<std::vector<Pose>> Finder::start_poses(size_t object, const RollingLens& lens,
                                                   const std::vector<SeenTag>& tags,
                                                   const PictureSearch::Features* features) const {
  std::vector<std::vector<Pose>> places;
  const PlaneObject& o = objects_[object];
  if (o.tag < 0) {
    if (!features) return {};
    for (auto& place : search_.find(object, *features, lens.camera)) places.push_back(std::move(place.poses));
    return places;
  }
  const auto corners = o.corners_o();
  for (const SeenTag& tag : tags) {
    if (tag.number != o.tag || tag.family != o.family) continue;
    std::vector<cv::Point3d> points_o;
    for (const Vector3d& corner : corners) points_o.emplace_back(corner.x(), corner.y(), 0);
    std::vector<cv::Point2d> normalised;
    lens.camera.undistort({tag.corners.begin(), tag.corners.end()}, normalised);
    places.push_back(plane_poses(points_o, normalised));
  }
  return places;
}

bool Finder::is_unique(Sighting& sighting, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens) const {
  sighting.clear.fill(true);
  for (const Alignment& a : sighting.poses) {
    const CopySearch::Result around = copy_search_.search(sighting.object, grey, mask, lens, a.pose);
    if (around.has_copy) return false;
    for (size_t side = 0; side < kSides; ++side) sighting.clear[side] = sighting.clear[side] && around.clear[side];
  }
  return true;
}

std::vector<Sighting> Finder::find(int64_t t_ns, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                                   const std::vector<char>& possible) {
  const auto wanted = [&](size_t k) { return k >= possible.size() || possible[k]; };
  bool any = false;
  for (size_t k = 0; k < objects_.size(); ++k) any = any || wanted(k);
  if (!any) return {};
  const Aligner::Frame frame(grey, mask, aligner_.parameters());
  const bool due = searched_ns_ == INT64_MIN || seconds(t_ns - searched_ns_) >= p_.search_interval_s;
  std::vector<SeenTag> tags;
  if (tags_) tags = tags_->find(grey);
  std::optional<PictureSearch::Features> features;
  if (has_pictures_ && due) {
    searched_ns_ = t_ns;
    features = search_.look(grey, mask, lens.camera);
  }
  std::vector<Sighting> found;
  for (size_t k = 0; k < objects_.size(); ++k) {
    if (!wanted(k)) continue;
    const bool searched = objects_[k].tag >= 0 || features;
    std::optional<Sighting> seen;
    std::vector<Pose> resemblance;  // every position that resembles it
    for (const auto& starts : start_poses(k, lens, tags, features ? &*features : nullptr)) {
      Detection here = detect_at(k, frame, lens, starts, false);
      if (here.resemblance) resemblance.push_back(*here.resemblance);
      if (here.sighting && (!seen || here.sighting->poses[0].cost < seen->poses[0].cost))
        seen = std::move(here.sighting);
    }
    TrackedObject& last = tracked_[k];
    if (are_apart(resemblance, objects_[k])) last.copy_ns = t_ns;
    if (!seen && last.t_ns != INT64_MIN && t_ns - last.t_ns <= p_.max_track_age_ns)
      seen = detect_at(k, frame, lens, {propagated(last.pose, lens, t_ns - last.t_ns)}, false).sighting;
    if (seen && !is_unique(*seen, grey, mask, lens)) last.copy_ns = t_ns;
    const bool has_copies = last.copy_ns != INT64_MIN && seconds(t_ns - last.copy_ns) < p_.copy_memory_s;
    if (!seen || has_copies) {
      if (searched) last.t_ns = INT64_MIN;
      continue;
    }
    seen->t_ns = t_ns;
    last.t_ns = t_ns, last.pose = seen->poses[0].pose;
    found.push_back(std::move(*seen));
  }
  return found;
}

}  // namespace odograph::known_object
