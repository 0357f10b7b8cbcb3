// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/fix/skyline/fixer_parameters.hpp"
#include "plugins/fix/skyline/photograph_fixer.hpp"
#include "plugins/fix/skyline/picture_job.hpp"
#include "plugins/fix/skyline/place_finder.hpp"
#include "plugins/fix/skyline/roof_survey.hpp"
#include "plugins/fix/skyline/sky_detector.hpp"
#include "plugins/fix/skyline/skyline_database.hpp"
#include "plugins/fix/skyline/sliced_worker.hpp"
#include "plugins/fix/skyline/validate_match.hpp"
#include "plugins/fix/skyline/view_window.hpp"

namespace odograph::skyline {

/// A pose of the pipeline, as far as a fix needs it.
struct PipelinePose {
  int64_t t_ns = 0;
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();
  bool has_position = false, is_of_camera = false;  ///< the latter: and has an orientation
  bool is_metric = false, is_lost = false;
  double horizontal_sigma_m = 0, yaw_sigma_rad = 0, tilt_sigma_rad = 0;
  double scale = 1, scale_sigma = 0, path_m = 0;
  PhotographPrior photograph{};  ///< the same as prior of a photograph
};

/// A fix of the camera: the match with the covariance and the likelihood ratio to report.
struct Fix {
  int64_t t_ns;
  Match match;
  bool has_slant = true, has_height = false;
  std::string surveyed = {};  ///< how the model was corrected with it
};
/// What became of a picture.
using Outcome = std::variant<Fix, Rejection>;

/// Fixes from the skyline around a camera and a 3D city model: section 3.2 of Gakne & O'Keefe 2018. A picture waits for
/// its pose where the front-end, which waits for the IMU, emits it later. While a picture is processed no other is
/// accepted; its outcome comes at the frame by which the work is done. Not thread-safe.
class SkylineFixer {
 public:
  /// `config` with the paths of its files. Throws std::runtime_error where no fixer can be made of it.
  explicit SkylineFixer(const FixerConfig& config);

  std::vector<Outcome> add_pose(const PipelinePose& pose);
  /// A correction of n moves x to q x + p.
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  /// Continues the work on a picture, in proportion to the sensor time that passed: to be called once per frame.
  std::vector<Outcome> advance(int64_t t_ns);
  /// Whether a picture is being processed.
  bool busy() const { return worker_.busy(); }
  /// Whether the interval since the latest picture has passed. A picture may be added if so, while not busy().
  bool is_due(int64_t t_ns) const;
  std::vector<Outcome> add_picture(Picture picture);
  const City& city() const { return matcher_->city(); }
  const Georeference& georeference() const { return georeference_; }

 private:
  void begin(Picture picture);
  std::optional<double> displacement_from_start() const;
  void estimate_photograph(const Picture& picture);
  void process_picture(const Spend& spend);
  bool gathers() const { return job_.view && !job_.match && matcher_->refusal() == Refusal::few_edges; }
  void search_database(const std::vector<SkyEdge>& edges, const Spend& spend);
  void finish();
  std::optional<Rejection> validate_single_match();
  std::optional<Rejection> validate_path_match();
  void update_road_height(const Match& match);
  void emit(Fix fix);
  void refuse(Reason reason, std::string text) { outcomes_.emplace_back(Rejection{reason, std::move(text)}); }
  std::vector<Outcome> take_outcomes() { return std::exchange(outcomes_, {}); }

  FixerConfig config_;
  Georeference georeference_;
  SkylineDatabase database_;
  std::optional<PlaceFinder> place_finder_;
  std::optional<Matcher> matcher_;
  std::optional<PhotographFixer> photograph_fixer_;
  std::optional<RoofSurvey> survey_;
  SkyDetector sky_detector_;
  ViewWindow window_;
  PathMatchValidator path_validator_;
  std::vector<Outcome> outcomes_;
  bool placed_, fixed_once_ = false;
  bool joins_ = false;                      // the latest picture saw too little to be matched alone
  int failures_ = 0;                        // consecutive; each adds a metre to the prior's standard deviation
  double fixed_at_m_ = 0;                   // distance along the path at the last fix
  double up_m_ = 0, up_variance_;           // the camera's height above the pose's
  std::optional<Eigen::Vector3d> start_n_;  // first position of the pose
  std::optional<PipelinePose> pose_;
  std::optional<Picture> waiting_;
  PictureJob job_;
  int64_t last_ns_ = INT64_MIN, frame_ns_ = INT64_MIN;
  uint64_t slice_ = 0;   // of the newest frame
  SlicedWorker worker_;  // last member: its thread ends before its data are destroyed
};

}  // namespace odograph::skyline
