// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plugins/fix/map/agreement.hpp"
#include "plugins/fix/map/key_frame_chooser.hpp"
#include "plugins/fix/map/place_map.hpp"
#include "plugins/fix/map/worker.hpp"

namespace odograph::place_map {

/// A frame with its pose.
struct Sight {
  Picture picture;
  Rigid T_n_c;
  bool is_placed = true;            ///< false: the position of T_n_c means nothing yet
  bool is_metric = true;            ///< false: its changes are reckoned, as after a restart of the front-end
  std::vector<Landmark> landmarks;  ///< in metres; none while the scale is not known
  double scale_sigma = 0;           ///< relative, which they have in common
  uint32_t epoch = 0;               ///< within which their ids are unique
};

/// A recognised place that two pictures agree on.
struct Found {
  uint64_t map = 0;                        ///< id of a loaded map; 0: this session's
  int64_t key_frame_ns = 0;                ///< of this session: time of the key frame
  int64_t t_ns = 0;                        ///< of the picture
  Rigid T_x_c;                             ///< in the camera of the key frame, or in the frame of the loaded map
  Eigen::Matrix<double, 6, 6> covariance;  ///< of (rotation, position), in the same frame
};

/// The map of this session and those of earlier ones. Key frames are added and pictures recognised on a thread of its
/// own; a result is given out at a fixed time after its picture. The owner's thread alone calls it.
class PlaceSession {
 public:
  struct Parameters {
    double interval_s = 0.5;        ///< between two pictures that are looked up
    double delay_s = 0.5;           ///< from a picture to its result
    double apart_s = 10;            ///< of a picture and a key frame of this session, at least; docs/estimator.md
    double agreement_s = 5;         ///< within which two recognitions must agree
    double drift = 0.02;            ///< sigma of the way between their pictures, relative, ...
    double drift_m = 0.01;          ///< m, at least, ...
    double drift_rad = 0.005;       ///< rad, and of its rotation: half a degree of a gyroscope in 5 s
    double reckoned_log_odds = 80;  ///< needed meanwhile, twice as much: this way excludes no neighbouring window
    double other_plane_rad = 0.35;  ///< between the normals of two planes: copies of one are parallel to it
    double unknown_distance_m = 1;  ///< sigma of the way before positions mean anything: some steps within seconds
    double reckoned_drift = 0.3;    ///< relative sigma of the way while the front-end starts again: by steps, ...
    double reckoned_m = 0.2;        ///< m, at least: a hand that moves without one
    double again_m = 0.5;           ///< m of way, or ...
    double again_s = 5;             ///< s, until the same place counts again: its landmarks' errors are the same
    double max_scale_sigma = 0.1;   ///< relative, of a key frame's landmarks
    size_t max_key_frames = 1024;   ///< of this session: as many as the host keeps
    size_t max_waiting = 3;         ///< jobs in a live run; then pictures are passed over
  };

  PlaceSession(const PlaceMapParameters& map, const Parameters& parameters, bool is_live)
      : p_(parameters), map_parameters_(map), is_live_(is_live), own_(std::make_unique<PlaceMap>(map)) {}

  /// Takes a frame, whose picture is borrowed for the call; true if it becomes a key frame.
  bool see(Sight sight);
  /// The results that are due at that time. In a replay it waits for them.
  std::vector<Found> take(int64_t now_ns);
  /// The pose of a key frame was corrected.
  void move(int64_t t_ns, const Rigid& T_n_c);
  /// n was corrected: what was at T_n_c is at `by` T_n_c. The host moves key frames by itself.
  void correct(const Rigid& by);

  /// The map of this session in n, or, once a loaded map was recognised, both in the frame of that. Waits until no job
  /// is left.
  struct Saved {
    uint64_t id = 0;  ///< 0: there is nothing to save
    std::vector<uint8_t> bytes;
    bool has_own = true;  ///< false: no loaded map was recognised, so that the first of them alone is kept
    size_t left_out = 0;  ///< loaded maps that are not in it
  };
  Saved save(size_t largest);
  /// Adds a map, whose frame is not known yet. The reason if it is damaged. Waits likewise.
  std::optional<std::string> load(uint64_t id, std::span<const uint8_t> bytes);

 private:
  struct Loaded {
    uint64_t id;
    std::unique_ptr<PlaceMap> map;
    std::optional<Rigid> T_n_m;
  };
  /// What one picture gave for one map.
  struct Sighting {
    uint64_t map;  ///< 0: this session's
    Recognition recognition;
    int64_t key_frame_ns;
    Rigid T_m_k, T_n_c;
    bool is_placed, is_metric;  ///< as in Sight
    bool is_sure;  ///< by itself, or since it agrees with one that is, or with the strong one of another plane
    std::vector<Eigen::Vector3d> normals;  ///< in m, of the planes of strong ones that agree
    Rigid T_m_c() const { return T_m_k * recognition.T_k_c; }
  };
  /// A picture that is looked up, and what was found.
  struct Query {
    Sight sight;
    uint64_t job = 0;
    std::vector<Sighting> found;
    Rigid correction;  ///< of n since
  };

  void look_up(Query& query) const;
  std::optional<Found> judge(Sighting now);
  void follow(const Sighting& before, const Sighting& now, Sighting& joined) const;
  Agreement compare(const Sighting& before, const Sighting& now) const;

  Parameters p_;
  PlaceMapParameters map_parameters_;
  bool is_live_;
  KeyFrameChooser chooser_;
  int64_t asked_ns_ = INT64_MIN;
  std::vector<Loaded> loaded_;
  std::deque<std::unique_ptr<Query>> queries_;
  std::vector<Sighting> recent_;  // of the last seconds
  std::vector<Sighting> used_;    // the last that counted, of each map
  std::unique_ptr<PlaceMap> own_;
  Worker worker_;  // last: it ends first
};

}  // namespace odograph::place_map
