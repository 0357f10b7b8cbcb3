// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "plugins/fix/known_object/alignment.hpp"
#include "plugins/fix/known_object/picture_search.hpp"
#include "plugins/fix/known_object/copy_search.hpp"
#include "plugins/fix/known_object/tags.hpp"

namespace odograph::known_object {

/// An object in a frame. A plane seen with little perspective has two poses; SightingValidator decides between them.
struct Sighting {
  size_t object = 0;
  int64_t t_ns = 0;
  std::vector<Alignment> poses;      ///< one or two, the better one first
  std::array<bool, kSides> clear{};  ///< this side was in the frame and has no copy of the object
};

/// Finds known objects in frames: tags in every frame, pictures at each search, then by tracking. An object seen at two
/// positions at once is rejected for a while. Not thread-safe.
class Finder {
 public:
  struct Parameters {
    double search_interval_s = 0.5;          ///< between two searches for pictures; set by the config
    int64_t max_track_age_ns = 350'000'000;  ///< max age of a pose for tracking: two missed frames at 10 Hz
    double min_correlation = 0.8;            ///< of the whole object; bench
    double min_agreeing = 0.9;               ///< share of its parts; bench
    double min_side_px = 18;        ///< square root of its area: smaller objects have no visible pattern; bench
    double same_pose_rad = 0.01;    ///< two poses closer than this are one
    double max_oblique_rad = 1.22;  ///< 70 degrees
    /// Correlation above which a second position makes the object ambiguous: boards with the same half, and true copies
    /// with shadow and noise; the object's other pose and other boards of its layout reach 0.4; bench
    double copy_correlation = 0.75, copy_agreeing = 0.5;
    double copy_memory_s = 30;  ///< time for which such an object is rejected; empirical: the time to walk past both
  };
  Finder(const Parameters& parameters, std::vector<PlaneObject> objects);
  ~Finder();

  /// `grey` 8-bit of the lens's size; `mask` may be empty; `possible`: for each object, whether it may be in view.
  std::vector<Sighting> find(int64_t t_ns, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                             const std::vector<char>& possible);
  void clear();
  const std::vector<PlaneObject>& objects() const { return objects_; }

 private:
  struct TrackedObject {
    int64_t t_ns = INT64_MIN;
    Pose pose;
    int64_t copy_ns = INT64_MIN;  ///< last time it was seen at two positions
  };
  /// Result of `detect_at` for one position: a sighting, or a mere resemblance.
  struct Detection {
    std::optional<Sighting> sighting;
    std::optional<Pose> resemblance;
  };
  Detection detect_at(size_t object, const Aligner::Frame& frame, const RollingLens& lens,
                      const std::vector<Pose>& starts, bool fine) const;
  bool is_accepted(const Alignment& alignment) const;
  bool resembles(const Alignment& alignment) const;
  /// True if there is no second copy around a sighting; also sets its clear sides.
  bool is_unique(Sighting& sighting, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens) const;
  std::vector<std::vector<Pose>> start_poses(size_t object, const RollingLens& lens, const std::vector<SeenTag>& tags,
                                             const PictureSearch::Features* features) const;

  Parameters p_;
  std::vector<PlaneObject> objects_;
  std::vector<Pyramid> pyramids_;
  Aligner aligner_{Aligner::Parameters{}};
  PictureSearch search_;
  CopySearch copy_search_;
  std::unique_ptr<TagDetector> tags_;
  std::vector<TrackedObject> tracked_;
  int64_t searched_ns_ = INT64_MIN;
  bool has_pictures_ = false;
};

}  // namespace odograph::known_object
