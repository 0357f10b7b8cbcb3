// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_finder.hpp"
#include "plugins/fix/skyline/sky_network.hpp"

namespace odograph::skyline {

/// Tells sky from the rest where there are clouds, a sun and bright walls: a network judges every pixel, then one line
/// around the zenith is drawn that leaves as much as possible of what looks like sky above and of the rest below it, by
/// dynamic programming over the directions (as Ahmad et al. 2015 for mountains), and moved to the strongest edge nearby
/// in the full picture.
class RobustSkyFinder {
 public:
  /// What has no source named was chosen by hand, on renderings of Delft and photographs (docs/sky_network.md).
  struct Parameters {
    double farthest_rad = 1.52;    ///< from the optical axis: a fisheye's last degrees are its rim (seen on phones)
    double max_odds = 2.5;         ///< a pixel's log-odds count no more: the network is oversure of reflections
    double edge_odds = 2.0;        ///< what a line gains for each factor of e that an edge is above the sky's noise
    double below_rad = 0.14;       ///< what lies this much below a line must not be sky: eight degrees, two storeys
    double jump_per_rad = 40.0;    ///< cost of a step between neighbouring directions, up to
    double max_jump = 6.0;         ///< this: houses end at vertical walls
    double refine_px = 2.5;        ///< how far the edge of the full picture may lie from the line
    double first_edge_rad = 0.05;  ///< so far above the line a roof's edge may lie: three degrees
    double first_edge_part = 0.5;  ///< of the strongest edge there, to be taken for the roof's
    double sure_margin = 25.0;     ///< log-odds between a direction's line and its best other: weight 1 from here
    double other_rad = 0.05;       ///< three degrees: another line is one farther away than this
    double min_sky_part = 0.002;   ///< of the valid pixels: less sky is none
    double lowest_rad = 1.75;      ///< from the zenith, that a line is looked for: ten degrees below the horizon
    float edge_from = 0.5f;        ///< above the sky's noise, of 0.72 times the contrast's logarithm: less is no edge
    float min_fall = 30;           ///< of grey values over three pixels, of an edge: above a phone's noise by day
  };

  RobustSkyFinder(const Parameters& parameters, const CameraModel& camera, cv::Size size);

  /// As SkyFinder::find. `up_c` may lie outside the picture: directions whose line would be above the picture's border
  /// are told as such. Empty where the picture shows no sky.
  const std::vector<SkyEdge>& find(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Vector3d& up_c,
                                   const Eigen::Vector3d& north_c, const Chroma& chroma = {});
  /// The latest picture's log-odds, small.
  const cv::Mat& log_odds() const { return sky_->log_odds; }
  /// Of the latest picture, which was this one with its colour: its log-odds in full.
  void full_log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Mat& out) {
    network_.log_odds(grey, chroma, grey.size(), out);
  }

 private:
  struct Column {
    int first, last;  ///< samples within the picture: from first until before last
  };
  void sample(const Eigen::Vector3d& up_c, const Eigen::Vector3d& north_c);
  void unary();
  void draw_line();
  void tell(const cv::Mat& grey);

  Parameters p_;
  CameraModel camera_;
  SkyNetwork network_;
  const SkyView* sky_ = nullptr;  // of the latest picture
  cv::Mat cost_, from_;
  double step_rad_ = 0;
  int rows_ = 0;
  std::vector<Eigen::Vector3d> horizontal_;  // horizontal direction of each column, in c
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  std::vector<Column> columns_;
  std::vector<int> line_;
  std::vector<float> samples_, edges_at_;  // log-odds and what an edge is worth, column by column
  std::vector<SkyEdge> edges_;
};

}  // namespace odograph::skyline
