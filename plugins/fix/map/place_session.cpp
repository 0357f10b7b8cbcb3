// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/place_session.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>

#include "plugins/fix/map/map_section.hpp"
#include "plugins/fix/map/merge.hpp"

namespace odograph::place_map {
namespace {

double seconds_between(int64_t from_ns, int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

/// Not 0.
uint64_t fnv1a(std::span<const uint8_t> bytes) {
  uint64_t hash = 14695981039346656037u;
  for (const uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  return hash != 0 ? hash : 1;
}

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
  const bool is_key = scaled && chooser_.choose(t_ns, sight.T_n_c, sight.landmarks);
  const bool asks = asked_ns_ == INT64_MIN || seconds_between(asked_ns_, t_ns) >= p_.interval_s;
  const bool busy = is_live_ && worker_.waiting() >= p_.max_waiting;
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
  worker_.add([this, key] {
    own_->add(key->picture, key->landmarks, key->T_n_c, key->epoch, key->scale_sigma);
    if (own_->key_frames().size() > p_.max_key_frames) own_->keep(p_.max_key_frames - p_.max_key_frames / 16);
  });
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
  const QueryView view = view_of(query.sight.picture, map_parameters_.features);
  const auto look = [&](uint64_t id, const PlaceMap& map, const PlaceMap::Excludes& without) {
    const auto found = map.best_of(view, map.candidates(view, without));
    if (!found || !map.is_plausible(*found)) return;
    const KeyFrame* frame = map.find(found->key_frame);
    Sighting& sighting = query.found.emplace_back(Sighting{id,
                                                           *found,
                                                           frame->t_ns,
                                                           frame->T_m_k,
                                                           query.sight.T_n_c,
                                                           query.sight.is_placed,
                                                           query.sight.is_metric,
                                                           map.is_accepted(*found),
                                                           {}});
    if (map.is_strong(*found)) sighting.normals.push_back(frame->T_m_k.q * found->normal_k);
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
    for (Sighting& sighting : query.found) {
      sighting.T_n_c = query.correction * sighting.T_n_c;
      if (const auto found = late ? std::nullopt : judge(sighting)) out.push_back(*found);
    }
    queries_.pop_front();
  }
  return out;
}

Agreement PlaceSession::compare(const Sighting& before, const Sighting& now) const {
  Rigid way = before.T_n_c.inverse() * now.T_n_c;
  const bool is_metric = before.is_metric && now.is_metric, is_placed = before.is_placed && now.is_placed;
  if (!is_placed) way.p.setZero();
  Eigen::Matrix<double, 6, 6> drift = Eigen::Matrix<double, 6, 6>::Zero();
  drift.diagonal().head<3>().setConstant(std::pow(p_.drift_rad, 2));
  const double known_m =
      std::hypot(is_metric ? p_.drift_m : p_.reckoned_m, (is_metric ? p_.drift : p_.reckoned_drift) * way.p.norm());
  const double sigma_m = is_placed ? known_m : p_.unknown_distance_m;
  drift.diagonal().tail<3>().setConstant(sigma_m * sigma_m);
  return agree(before.recognition, before.T_m_k, now.recognition, now.T_m_k, way, drift);
}

/// What follows from the agreement with one before. Strong ones of two planes together have depth.
void PlaceSession::follow(const Sighting& before, const Sighting& now, Sighting& joined) const {
  joined.is_sure = joined.is_sure || before.is_sure;
  const double parallel = std::cos(p_.other_plane_rad);
  for (const Eigen::Vector3d& other : before.normals) {
    for (const Eigen::Vector3d& normal : now.normals)
      joined.is_sure = joined.is_sure || std::abs(normal.dot(other)) < parallel;
  }
  if (joined.normals.empty()) joined.normals = before.normals;
}

/// One recognition is none: more of the recent ones of the same map must fit the track than sure ones contradict it.
/// One of them must be sure, or two together; from then on plausible ones continue it.
std::optional<Found> PlaceSession::judge(Sighting now) {
  const auto of_map = [&](const Sighting& other) { return other.map == now.map; };
  std::erase_if(recent_, [&](const Sighting& before) {
    return seconds_between(before.recognition.t_ns, now.recognition.t_ns) > p_.agreement_s;
  });
  int fit = 0, contradict = 0;
  bool is_measured = false;  // the way to one that fits
  Sighting joined = now;
  for (const Sighting& before : recent_) {
    if (before.map != now.map) continue;
    const Agreement agreement = compare(before, now);
    const bool both = before.is_metric && now.is_metric;
    if (agreement == Agreement::yes) follow(before, now, joined), ++fit, is_measured = is_measured || both;
    if (agreement == Agreement::no && before.is_sure && both) ++contradict;
  }
  const bool agrees = fit > contradict;
  if (agrees) now = joined;
  recent_.push_back(now);
  const bool is_backed = is_measured || now.recognition.log_odds > p_.reckoned_log_odds;
  if (!agrees || !now.is_sure || !now.is_placed || !is_backed) return std::nullopt;

  const auto last = std::find_if(used_.begin(), used_.end(), of_map);
  const bool again = last != used_.end() && (last->is_metric || !now.is_metric) &&
                     last->recognition.key_frame == now.recognition.key_frame &&
                     (last->T_n_c.p - now.T_n_c.p).norm() < p_.again_m &&
                     seconds_between(last->recognition.t_ns, now.recognition.t_ns) < p_.again_s;
  if (again) return std::nullopt;
  std::erase_if(used_, of_map);
  used_.push_back(now);
  for (Loaded& loaded : loaded_)
    if (loaded.id == now.map && now.is_metric) loaded.T_n_m = now.T_n_c * now.T_m_c().inverse();
  const Recognition& seen = now.recognition;
  if (now.map == 0) return Found{0, now.key_frame_ns, seen.t_ns, seen.T_k_c, seen.covariance};
  return Found{now.map, 0, seen.t_ns, now.T_m_c(), in_map(now.T_m_k, seen.covariance)};
}

void PlaceSession::move(int64_t t_ns, const Rigid& T_n_c) {
  worker_.add([this, t_ns, T_n_c] {
    for (const KeyFrame& frame : own_->key_frames())
      if (frame.t_ns == t_ns) return own_->set_pose(frame.id, T_n_c);
  });
}

void PlaceSession::correct(const Rigid& by) {
  for (std::vector<Sighting>* sightings : {&recent_, &used_})
    for (Sighting& sighting : *sightings) sighting.T_n_c = by * sighting.T_n_c;
  for (const auto& query : queries_) query->correction = by * query->correction;
  for (Loaded& loaded : loaded_)
    if (loaded.T_n_m) loaded.T_n_m = by * *loaded.T_n_m;
}

PlaceSession::Saved PlaceSession::save(size_t largest) {
  worker_.wait_for_all();
  Saved saved;
  const auto recognised =
      std::find_if(loaded_.begin(), loaded_.end(), [](const Loaded& l) { return l.T_n_m.has_value(); });
  saved.has_own = loaded_.empty() || recognised != loaded_.end();
  for (const Loaded& loaded : loaded_) saved.left_out += loaded.T_n_m ? 0 : 1;
  if (!saved.has_own) {
    --saved.left_out, saved.id = loaded_[0].id, saved.bytes = bytes_of(*loaded_[0].map);
    return saved;
  }
  // From n to the frame in which it is saved.
  const Rigid T_m_n = loaded_.empty() ? Rigid() : recognised->T_n_m->inverse();
  JoinedFrames frames;
  for (const Loaded& loaded : loaded_)
    if (loaded.T_n_m) frames.add(*loaded.map, T_m_n * *loaded.T_n_m);
  frames.add(*own_, T_m_n);
  PlaceMap whole(map_parameters_);
  whole.restore(frames.take());
  if (whole.key_frames().empty()) return saved;
  whole.thin(largest);
  saved.bytes = bytes_of(whole);
  saved.id = loaded_.empty() ? fnv1a(saved.bytes) : recognised->id;
  return saved;
}

std::optional<std::string> PlaceSession::load(uint64_t id, std::span<const uint8_t> bytes) {
  auto frames = key_frames_of(bytes);
  if (const auto* reason = std::get_if<std::string>(&frames)) return *reason;
  worker_.wait_for_all();
  auto map = std::make_unique<PlaceMap>(map_parameters_);
  map->restore(std::move(std::get<std::vector<KeyFrame>>(frames)));
  std::erase_if(loaded_, [id](const Loaded& loaded) { return loaded.id == id; });
  loaded_.push_back({id, std::move(map), std::nullopt});
  return std::nullopt;
}

}  // namespace odograph::place_map
