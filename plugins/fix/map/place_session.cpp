// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/place_session.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph::place_map {
namespace {

double seconds_between(int64_t from_ns, int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

double angle_of(const Eigen::Quaterniond& q) { return 2 * std::atan2(q.vec().norm(), std::abs(q.w())); }

/// Covariance in the map's frame of a pose that is known in a key frame's.
Eigen::Matrix<double, 6, 6> in_map(const Rigid& T_m_k, const Eigen::Matrix<double, 6, 6>& covariance) {
  Eigen::Matrix<double, 6, 6> by = Eigen::Matrix<double, 6, 6>::Zero();
  by.topLeftCorner<3, 3>() = by.bottomRightCorner<3, 3>() = T_m_k.q.toRotationMatrix();
  return by * covariance * by.transpose();
}

}  // namespace

bool PlaceSession::see(Sight sight) {
  const int64_t t_ns = sight.picture.t_ns;
  const bool scaled = !sight.landmarks.empty() && sight.scale_sigma < p_.max_scale_sigma;
  const bool is_key = scaled && chooser_.choose(t_ns, sight.T_s_c, sight.landmarks);
  const bool asks = asked_ns_ == INT64_MIN || seconds_between(asked_ns_, t_ns) >= p_.interval_s;
  const bool busy = is_live_ && worker_.waiting() >= p_.most_waiting;
  if (is_key || (asks && !busy)) sight.picture.grey = sight.picture.grey.clone();
  if (asks && !busy) {
    asked_ns_ = t_ns;
    auto query = std::make_unique<Query>();
    query->sight = sight;  // with the same pixels
    Query* asked = query.get();
    query->job = worker_.add([this, asked] { look_up(*asked); });
    queries_.push_back(std::move(query));
  }
  if (!is_key) return false;
  auto key = std::make_shared<Sight>(std::move(sight));
  worker_.add([this, key] { own_->add(key->picture, key->landmarks, key->T_s_c, key->epoch); });
  return true;
}

void PlaceSession::look_up(Query& query) const {
  const int64_t t_ns = query.sight.picture.t_ns;
  std::set<uint64_t> seen;
  for (const Landmark& landmark : query.sight.landmarks) seen.insert(landmark.id);
  // A landmark that is tracked from the key frame on is in the track already.
  const auto excludes = [&](const KeyFrame& frame) {
    if (seconds_between(frame.t_ns, t_ns) < p_.apart_s) return true;
    return frame.epoch == query.sight.epoch &&
           std::any_of(frame.landmarks.begin(), frame.landmarks.end(),
                       [&](const KeptLandmark& landmark) { return landmark.id != 0 && seen.count(landmark.id) != 0; });
  };
  const auto look = [&](uint64_t id, const PlaceMap& map, const PlaceMap::Excludes& without) {
    const auto found = map.recognise(query.sight.picture, without);
    if (!found) return;
    const KeyFrame* frame = map.find(found->key_frame);
    query.found.emplace_back(id, *found);
    query.frames.emplace_back(frame->t_ns, frame->T_m_k);
  };
  look(0, *own_, excludes);
  for (const Loaded& loaded : loaded_) look(loaded.id, *loaded.map, {});
}

std::vector<Found> PlaceSession::take(int64_t now_ns) {
  std::vector<Found> out;
  while (!queries_.empty() && seconds_between(queries_.front()->sight.picture.t_ns, now_ns) >= p_.delay_s) {
    Query& query = *queries_.front();
    const bool done = worker_.is_done(query.job);
    if (!done && is_live_) break;  // a later frame takes it
    if (!done) worker_.wait(query.job);
    const bool late = is_live_ && seconds_between(query.sight.picture.t_ns, now_ns) > 2 * p_.delay_s;
    for (size_t i = 0; i < query.found.size() && !late; ++i)
      if (const auto found = judge(query, i)) out.push_back(*found);
    queries_.pop_front();
  }
  return out;
}

bool PlaceSession::agree(const Candidate& one, const Candidate& other) const {
  if (seconds_between(one.t_ns, other.t_ns) > p_.agreement_s) return false;
  const Rigid by_map = one.T_m_c.inverse() * other.T_m_c, by_track = one.T_s_c.inverse() * other.T_s_c;
  const double way_m = by_track.p.norm();
  const double most_m = 3 * std::hypot(one.sigma_m, other.sigma_m) + p_.agreement_m + p_.drift * way_m;
  const double most_rad = 3 * std::hypot(one.sigma_rad, other.sigma_rad) + p_.agreement_rad;
  return (by_map.p - by_track.p).norm() < most_m && angle_of(by_map.q.conjugate() * by_track.q) < most_rad;
}

/// One recognition is none: it needs a second one of the same map to which the track leads.
std::optional<Found> PlaceSession::judge(const Query& query, size_t i) {
  const auto& [map, recognition] = query.found[i];
  const auto& [key_frame_ns, T_m_k] = query.frames[i];
  Candidate now{query.sight.picture.t_ns,
                map,
                recognition.key_frame,
                T_m_k * recognition.T_k_c,
                query.sight.T_s_c,
                std::sqrt(recognition.covariance.diagonal().tail<3>().maxCoeff()),
                std::sqrt(recognition.covariance.diagonal().head<3>().maxCoeff()),
                false};
  const auto of_map = [&](const Candidate& other) { return other.map == map; };
  const auto before = std::find_if(candidates_.begin(), candidates_.end(), of_map);
  const bool agrees = before != candidates_.end() && agree(*before, now);
  if (before != candidates_.end()) candidates_.erase(before);
  candidates_.push_back(now);
  if (!agrees) return std::nullopt;

  const auto last = std::find_if(used_.begin(), used_.end(), of_map);
  const bool again = last != used_.end() && last->key_frame == now.key_frame &&
                     (last->T_s_c.p - now.T_s_c.p).norm() < p_.again_m &&
                     seconds_between(last->t_ns, now.t_ns) < p_.again_s;
  if (again) return std::nullopt;
  if (last != used_.end()) used_.erase(last);
  used_.push_back(now);
  for (Loaded& loaded : loaded_)
    if (loaded.id == map) loaded.T_s_m = now.T_s_c * now.T_m_c.inverse();
  if (map == 0) return Found{0, key_frame_ns, now.t_ns, recognition.T_k_c, recognition.covariance};
  return Found{map, 0, now.t_ns, now.T_m_c, in_map(T_m_k, recognition.covariance)};
}

void PlaceSession::move(int64_t t_ns, const Rigid& T_s_c) {
  worker_.add([this, t_ns, T_s_c] {
    for (const KeyFrame& frame : own_->key_frames())
      if (frame.t_ns == t_ns) return own_->set_pose(frame.id, T_s_c);
  });
}

const PlaceMap* PlaceSession::loaded(uint64_t id) {
  worker_.wait_for_all();
  for (const Loaded& loaded : loaded_)
    if (loaded.id == id) return loaded.map.get();
  return nullptr;
}

void PlaceSession::load(uint64_t id, PlaceMap&& map) {
  worker_.wait_for_all();
  std::erase_if(loaded_, [id](const Loaded& loaded) { return loaded.id == id; });
  loaded_.push_back({id, std::make_unique<PlaceMap>(std::move(map)), std::nullopt});
}

std::optional<Rigid> PlaceSession::place_of(uint64_t map) const {
  for (const Loaded& loaded : loaded_)
    if (loaded.id == map) return loaded.T_s_m;
  return std::nullopt;
}

}  // namespace odograph::place_map
