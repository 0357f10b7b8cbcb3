// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/place_map.hpp"

#include <algorithm>
#include <cmath>

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

double picture_area(const Picture& picture) {
  const double f = picture.lens.focal();
  return picture.grey.cols * picture.grey.rows / (f * f);
}

}  // namespace

uint64_t PlaceMap::add(const Picture& picture, std::span<const Landmark> landmarks, const Rigid& T_m_c,
                       uint32_t epoch) {
  const PictureLevels levels(picture, p_.features);
  KeyFrame frame;
  frame.epoch = epoch, frame.t_ns = picture.t_ns, frame.T_m_k = T_m_c;
  frame.down_k = picture.down_c.normalized(), frame.tilt_sigma_rad = picture.tilt_sigma_rad;
  for (const Landmark& landmark : landmarks) {
    if (frame.landmarks.size() >= p_.max_landmarks) break;
    KeptLandmark one = kept(landmark);
    if (!(static_cast<double>(one.along_sigma) < p_.max_sigma * landmark.p_c.norm())) continue;
    size_t count = 0;
    for (int level = 0; level < p_.features.levels && count < 2;) {
      const auto descriptor = levels.describe(landmark.pixel, level);
      if (descriptor) one.descriptors[count] = *descriptor, one.levels[count++] = static_cast<int8_t>(level);
      level += descriptor ? p_.features.second_level : 1;
    }
    if (count > 0) frame.landmarks.push_back(one);
  }
  if (frame.landmarks.size() < kFewest) return 0;
  frame.id = ++last_id_;
  frames_.push_back(std::move(frame));
  index(frames_.size() - 1);
  return last_id_;
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

std::vector<double> PlaceMap::votes(const std::vector<Feature>& features, const std::vector<char>& excluded) const {
  std::vector<double> votes(frames_.size(), 0.0);
  std::vector<int> nearest(frames_.size(), 257);  // of this feature
  std::vector<uint32_t> touched;
  for (const Feature& feature : features) {
    touched.clear();
    words_.look_up(feature.descriptor, [&](uint32_t number) {
      const Owner& owner = owners_[number];
      if (excluded[owner.frame]) return;
      const int distance =
          hamming(feature.descriptor, frames_[owner.frame].landmarks[owner.landmark].descriptors[owner.look]);
      if (distance > p_.vote_distance) return;
      int& best = nearest[owner.frame];
      if (best > 256) touched.push_back(owner.frame);
      best = std::min(best, distance);
    });
    // Inverse document frequency: a look that many key frames have tells little.
    const double rarity = std::log(1 + static_cast<double>(frames_.size()) / (1 + static_cast<double>(touched.size())));
    for (const uint32_t frame : touched) {
      votes[frame] += rarity * (1 - static_cast<double>(nearest[frame]) / (p_.vote_distance + 20));
      nearest[frame] = 257;
    }
  }
  return votes;
}

std::vector<size_t> PlaceMap::beside(size_t frame, const std::vector<char>& excluded) const {
  const KeyFrame& middle = frames_[frame];
  std::vector<std::pair<double, size_t>> near;
  for (size_t i = 0; i < frames_.size(); ++i) {
    if (i == frame || excluded[i] || frames_[i].epoch != middle.epoch) continue;
    const double distance = (frames_[i].T_m_k.p - middle.T_m_k.p).norm();
    const double turn = frames_[i].T_m_k.q.angularDistance(middle.T_m_k.q);
    if (distance < p_.neighbour_m && turn < p_.neighbour_rad)
      near.emplace_back(distance / p_.neighbour_m + turn / p_.neighbour_rad, i);
  }
  std::sort(near.begin(), near.end());
  std::vector<size_t> chosen;
  for (const auto& [far, i] : near) chosen.push_back(i);
  return chosen;
}

LocalMap PlaceMap::local_map(size_t frame, const std::vector<char>& excluded) const {
  LocalMap local;
  std::map<uint64_t, size_t> known;
  std::vector<size_t> sources = beside(frame, excluded);
  sources.resize(std::min(sources.size(), p_.neighbours));
  sources.insert(sources.begin(), frame);
  for (const size_t source : sources) {
    const KeyFrame& from = frames_[source];
    const Rigid T_k_s = source == frame ? Rigid() : frames_[frame].T_m_k.inverse() * from.T_m_k;
    for (const KeptLandmark& landmark : from.landmarks) {
      const Vector3d p_s = Eigen::Vector3f::Map(landmark.p_k.data()).cast<double>();
      const auto [at, is_new] = known.try_emplace(landmark.id, local.size());
      if (is_new)
        local.push_back({landmark.id, T_k_s * p_s, static_cast<double>(landmark.across_sigma),
                         static_cast<double>(landmark.along_sigma), T_k_s.q * p_s.normalized(), p_s.norm(), {}});
      for (size_t look = 0; look < 2; ++look)
        if (landmark.levels[look] >= 0)
          local[at->second].looks.push_back({landmark.descriptors[look], landmark.levels[look], p_s.norm()});
    }
  }
  return local;
}

std::vector<PlaceMap::Candidate> PlaceMap::candidates(const Picture& picture, const Excludes& excludes) const {
  const PictureLevels levels(picture, p_.features);
  const QueryView query{picture, levels.features(), picture_area(picture)};
  std::vector<char> excluded(frames_.size(), 0);
  if (excludes)
    for (size_t i = 0; i < frames_.size(); ++i) excluded[i] = excludes(frames_[i]) ? 1 : 0;
  const std::vector<double> score = votes(query.features, excluded);
  std::vector<size_t> order;
  for (size_t i = 0; i < frames_.size(); ++i)
    if (!excluded[i] && score[i] > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return score[a] > score[b]; });
  std::vector<Candidate> found;
  std::vector<char> covered(frames_.size(), 0);
  for (const size_t frame : order) {
    if (found.size() >= p_.candidates) break;
    if (covered[frame]) continue;
    std::vector<size_t> near = beside(frame, excluded);
    for (size_t i = 0; i < std::min(near.size(), p_.neighbours); ++i) covered[near[i]] = 1;
    const Gravity gravity{frames_[frame].down_k, picture.down_c.normalized(),
                          std::hypot(frames_[frame].tilt_sigma_rad, picture.tilt_sigma_rad)};
    found.push_back({frame, score[frame],
                     verify(query, local_map(frame, excluded), gravity, p_.pose, p_.verification, p_.features)});
  }
  const auto strength = [](const Candidate& c) { return c.verified ? c.verified->evidence.matched : -1; };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Candidate& a, const Candidate& b) { return strength(a) > strength(b); });
  return found;
}

std::optional<Recognition> PlaceMap::recognise(const Picture& picture, const Excludes& excludes) const {
  const auto found = candidates(picture, excludes);
  if (found.empty() || !found[0].verified) return std::nullopt;
  return std::nullopt;
}

}  // namespace odograph::place_map
