// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/place_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdk/math/rotation.hpp"

namespace odograph::place_map {

using Eigen::Vector3d;

namespace {

constexpr size_t kFewest = 8;  ///< landmarks of a key frame; fewer recognise nothing

KeptLandmark kept(const Landmark& landmark) {
  KeptLandmark out;
  out.id = landmark.id;
  Eigen::Vector3f::Map(out.p_k.data()) = landmark.p_c.cast<float>();
  const Vector3d ray = landmark.p_c.normalized();
  const double along = ray.dot(landmark.covariance * ray);
  out.along_sigma = static_cast<float>(std::sqrt(std::max(0.0, along)));
  out.across_sigma = static_cast<float>(std::sqrt(std::max(0.0, 0.5 * (landmark.covariance.trace() - along))));
  return out;
}

/// The descriptors of a pixel at a level, or the next coarser one that allows it, and one octave from there.
bool describe(const PictureLevels& levels, const Eigen::Vector2d& pixel, int level, const FeatureParameters& f,
              KeptLandmark& out) {
  size_t count = 0;
  while (level < f.levels && count < 2) {
    const auto descriptor = levels.describe(pixel, level);
    if (descriptor) out.descriptors[count] = *descriptor, out.levels[count++] = static_cast<int8_t>(level);
    level += descriptor ? f.second_level : 1;
  }
  return count > 0;
}

constexpr uint64_t kPaired = uint64_t{1} << 63;  ///< ids of landmarks that no front-end tracked

}  // namespace

uint64_t PlaceMap::add(const Picture& picture, std::span<const Landmark> landmarks, const Rigid& T_m_c, uint32_t epoch,
                       double scale_sigma) {
  const PictureLevels levels(picture, p_.features);
  KeyFrame frame;
  frame.epoch = epoch, frame.t_ns = picture.t_ns, frame.T_m_k = T_m_c;
  frame.down_k = picture.down_c.normalized(), frame.tilt_sigma_rad = picture.tilt_sigma_rad;
  frame.scale_sigma = scale_sigma;
  add_tracked(levels, landmarks, frame);
  if (frame.landmarks.size() < kFewest) return 0;
  CornerView view{last_id_ + 1, epoch, frame.down_k, levels.features(), {}, {}};
  add_rays(picture, landmarks, view);
  add_paired(levels, landmarks, view, frame);
  frame.id = ++last_id_;
  frames_.push_back(std::move(frame));
  index(frames_.size() - 1);
  recent_.insert(recent_.begin(), std::move(view));
  recent_.resize(std::min(recent_.size(), p_.paired_views));
  return last_id_;
}

void PlaceMap::add_tracked(const PictureLevels& levels, std::span<const Landmark> landmarks, KeyFrame& frame) const {
  for (const Landmark& landmark : landmarks) {
    if (frame.landmarks.size() >= p_.max_landmarks) break;
    KeptLandmark one = kept(landmark);
    if (!(static_cast<double>(one.along_sigma) < p_.max_sigma * landmark.p_c.norm())) continue;
    if (describe(levels, landmark.pixel, 0, p_.features, one)) frame.landmarks.push_back(one);
  }
}

void PlaceMap::add_rays(const Picture& picture, std::span<const Landmark> landmarks, CornerView& view) const {
  std::vector<cv::Point2f> pixels;
  for (const Landmark& landmark : landmarks)
    pixels.emplace_back(static_cast<float>(landmark.pixel.x()), static_cast<float>(landmark.pixel.y()));
  const std::vector<Vector3d> rays = rays_of(picture.lens, pixels, p_.features.max_off_axis_rad);
  for (size_t i = 0; i < landmarks.size(); ++i)
    if (!rays[i].isZero()) view.tracked.emplace_back(landmarks[i].id, rays[i]);
  std::sort(view.tracked.begin(), view.tracked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

void PlaceMap::add_paired(const PictureLevels& levels, std::span<const Landmark> landmarks, CornerView& view,
                          KeyFrame& frame) {
  view.ids.assign(view.features.size(), 0);
  std::vector<Vector3d> rays;  // of the landmarks that there are
  for (const KeptLandmark& one : frame.landmarks)
    rays.push_back(Eigen::Vector3f::Map(one.p_k.data()).cast<double>().normalized());
  for (CornerView& older : recent_) {
    const KeyFrame* before = find(older.key_frame);
    if (!before || older.epoch != view.epoch) continue;
    const auto motion =
        motion_between(view, landmarks, older, before->T_m_k.inverse() * frame.T_m_k, p_.pose, p_.pairs.min_common);
    if (!motion) continue;
    for (const PairedCorner& pair : pair_corners(view, older, *motion, p_.pairs)) {
      if (frame.landmarks.size() >= p_.max_landmarks) return;
      if (!(pair.along_sigma < p_.max_sigma * pair.p_c.norm()) || view.ids[pair.feature] != 0) continue;
      if (!is_as_far(pair.p_c, landmarks, p_.pairs)) continue;
      const Vector3d& ray = view.features[pair.feature].ray_c;
      if (std::any_of(rays.begin(), rays.end(),
                      [&](const Vector3d& other) { return (other - ray).norm() < p_.pairs.apart_rad; }))
        continue;
      KeptLandmark one;
      one.id = pair.id ? pair.id : kPaired | ++last_paired_;
      Eigen::Vector3f::Map(one.p_k.data()) = pair.p_c.cast<float>();
      one.across_sigma = static_cast<float>(pair.across_sigma), one.along_sigma = static_cast<float>(pair.along_sigma);
      const Feature& feature = view.features[pair.feature];
      if (!describe(levels, feature.pixel, feature.level, p_.features, one)) continue;
      view.ids[pair.feature] = older.ids[pair.older] = one.id;
      rays.push_back(ray);
      frame.landmarks.push_back(one);
    }
  }
}

void PlaceMap::index(size_t frame) {
  const auto& landmarks = frames_[frame].landmarks;
  for (size_t i = 0; i < landmarks.size(); ++i)
    for (size_t look = 0; look < 2; ++look) {
      if (landmarks[i].levels[look] < 0) continue;
      words_.add(landmarks[i].descriptors[look]);
      owners_.push_back({static_cast<uint32_t>(frame), static_cast<uint16_t>(i), static_cast<uint16_t>(look)});
    }
}

void PlaceMap::rebuild() {
  words_.clear(), owners_.clear();
  for (size_t i = 0; i < frames_.size(); ++i) index(i);
}

const KeyFrame* PlaceMap::find(uint64_t id) const {
  const auto at = std::lower_bound(frames_.begin(), frames_.end(), id,
                                   [](const KeyFrame& frame, uint64_t wanted) { return frame.id < wanted; });
  return at != frames_.end() && at->id == id ? &*at : nullptr;
}

void PlaceMap::set_pose(uint64_t id, const Rigid& T_m_k) {
  if (const KeyFrame* frame = find(id)) frames_[static_cast<size_t>(frame - frames_.data())].T_m_k = T_m_k;
}

void PlaceMap::remove(uint64_t id) {
  if (std::erase_if(frames_, [id](const KeyFrame& frame) { return frame.id == id; }) > 0) rebuild();
}

size_t PlaceMap::bytes() const {
  size_t sum = words_.bytes() + owners_.size() * sizeof(Owner);
  for (const KeyFrame& frame : frames_) sum += sizeof frame + frame.landmarks.size() * sizeof(KeptLandmark);
  return sum;
}

void PlaceMap::restore(std::vector<KeyFrame> frames) {
  frames_ = std::move(frames), recent_.clear();
  last_id_ = frames_.empty() ? 0 : frames_.back().id;
  last_paired_ = 0;  // ids of a later epoch
  rebuild();
}

uint32_t PlaceMap::next_epoch() const {
  uint32_t next = 0;
  for (const KeyFrame& frame : frames_) next = std::max(next, frame.epoch + 1);
  return next;
}

void PlaceMap::thin(size_t most) {
  if (const size_t size = bytes(); size > most && !frames_.empty()) keep(most / (size / frames_.size()));
}

void PlaceMap::keep(size_t wanted) {
  constexpr double kMetres_per_rad = 2;
  // Of each key frame the nearest newer one that remains.
  std::vector<std::pair<double, size_t>> nearest(frames_.size());
  std::vector<char> gone(frames_.size(), 0);
  const auto find_nearest = [&](size_t i) {
    nearest[i] = {std::numeric_limits<double>::infinity(), i};
    for (size_t k = i + 1; k < frames_.size(); ++k) {
      if (gone[k]) continue;
      const Rigid &a = frames_[i].T_m_k, &b = frames_[k].T_m_k;
      const double apart = (a.p - b.p).norm() + kMetres_per_rad * a.q.angularDistance(b.q);
      nearest[i] = std::min(nearest[i], std::pair(apart, k));
    }
  };
  for (size_t i = 0; i < frames_.size(); ++i) find_nearest(i);
  for (size_t left = frames_.size(); left > wanted; --left) {
    size_t least = frames_.size();
    for (size_t i = 0; i < frames_.size(); ++i)
      if (!gone[i] && (least == frames_.size() || nearest[i].first < nearest[least].first)) least = i;
    gone[least] = 1;
    for (size_t i = 0; i < least; ++i)
      if (!gone[i] && nearest[i].second == least) find_nearest(i);
  }
  std::vector<KeyFrame> kept;
  for (size_t i = 0; i < frames_.size(); ++i)
    if (!gone[i]) kept.push_back(std::move(frames_[i]));
  frames_ = std::move(kept);
  rebuild();
}

}  // namespace odograph::place_map
