// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "plugins/fix/map/key_frame_chooser.hpp"
#include "plugins/fix/map/place_map.hpp"
#include "plugins/fix/map/worker.hpp"

namespace odograph::place_map {

/// A frame with its pose in the frame s of this session, which is n but for the corrections since it began.
struct Sight {
  Picture picture;
  Rigid T_s_c;
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
    double interval_s = 0.5;       ///< between two pictures that are looked up
    double delay_s = 0.5;          ///< from a picture to its result
    double apart_s = 10;           ///< of a picture and a key frame of this session, at least; docs/estimator.md
    double agreement_s = 5;        ///< within which two recognitions must agree
    double agreement_m = 0.05;     ///< m, besides three sigmas and ...
    double drift = 0.05;           ///< of the way between them
    double agreement_rad = 0.03;   ///< rad, besides three sigmas
    double again_m = 0.5;          ///< m of way, or ...
    double again_s = 5;            ///< s, until the same place counts again: its landmarks' errors are the same
    double max_scale_sigma = 0.1;  ///< relative, of a key frame's landmarks
    size_t most_waiting = 3;       ///< jobs in a live run; then pictures are passed over
  };

  PlaceSession(const PlaceMapParameters& map, const Parameters& parameters, bool is_live)
      : p_(parameters), map_parameters_(map), is_live_(is_live), own_(std::make_unique<PlaceMap>(map)) {}

  /// Takes a frame, whose picture is borrowed for the call; true if it becomes a key frame.
  bool see(Sight sight);
  /// The results that are due at that time. In a replay it waits for them.
  std::vector<Found> take(int64_t now_ns);
  /// The pose of a key frame was corrected.
  void move(int64_t t_ns, const Rigid& T_s_c);

  /// Waits until no job is left.
  PlaceMap& own() { return worker_.wait_for_all(), *own_; }
  const PlaceMap* loaded(uint64_t id);
  void load(uint64_t id, PlaceMap&& map);
  /// Where the frame of a loaded map is in s, once it was recognised.
  std::optional<Rigid> place_of(uint64_t map) const;

 private:
  struct Loaded {
    uint64_t id;
    std::unique_ptr<PlaceMap> map;
    std::optional<Rigid> T_s_m;
  };
  /// A picture that is looked up, and what was found.
  struct Query {
    Sight sight;
    uint64_t job = 0;
    std::vector<std::pair<uint64_t, Recognition>> found;  // with the id of the map
    std::vector<std::pair<int64_t, Rigid>> frames;        // time and pose of the key frame of each
  };
  struct Candidate {
    int64_t t_ns;
    uint64_t map, key_frame;
    Rigid T_m_c, T_s_c;
    double sigma_m, sigma_rad;
    bool accepted;
  };

  void look_up(Query& query) const;
  std::optional<Found> judge(const Query& query, size_t i);
  bool agree(const Candidate& one, const Candidate& other) const;

  Parameters p_;
  PlaceMapParameters map_parameters_;
  bool is_live_;
  KeyFrameChooser chooser_;
  int64_t asked_ns_ = INT64_MIN;
  std::vector<Loaded> loaded_;
  std::deque<std::unique_ptr<Query>> queries_;
  std::vector<Candidate> candidates_;  // the newest of each map
  std::vector<Candidate> used_;        // the last that counted, of each map
  std::unique_ptr<PlaceMap> own_;
  Worker worker_;  // last: it ends first
};

}  // namespace odograph::place_map
