// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_finder.hpp"
#include "plugins/fix/skyline/sky_network.hpp"

namespace odograph::skyline {

/// Finds the sky's edge under clouds, sun and bright walls. A network estimates the log-odds of sky of every pixel.
/// Dynamic programming over the directions then finds the closed line around the zenith with as much sky above it and
/// as little below it as possible (as Ahmad et al. 2015 for mountains), which is moved to the strongest edge nearby in
/// the full picture.
class RobustSkyFinder {
 public:
  /// Unless a source is named, chosen empirically on renderings of Delft and photographs (docs/sky_network.md).
  struct Parameters {
    double farthest_rad = 1.52;    ///< from the optical axis: a fisheye's last degrees are its rim (seen on phones)
    double max_odds = 2.5;         ///< limit of a pixel's log-odds: the network is overconfident about reflections
    double edge_odds = 2.0;        ///< gain of a line for each factor of e by which an edge exceeds the sky's noise
    double below_rad = 0.14;       ///< range below a line that must not be sky: eight degrees, two storeys
    double jump_per_rad = 40.0;    ///< cost of a step between neighbouring directions,
    double max_jump = 6.0;         ///< its limit: houses end at vertical walls
    double refine_px = 2.5;        ///< max distance of the edge in the full picture from the line
    double first_edge_rad = 0.05;  ///< max distance of a roof's edge above the line: three degrees
    double first_edge_part = 0.5;  ///< min strength of the roof's edge over the strongest there
    double sure_margin = 25.0;     ///< log-odds of a line over the best alternative for a weight of 1
    double other_rad = 0.05;       ///< min distance of an alternative line: three degrees
    double min_sky_part = 0.002;   ///< min fraction of sky in the valid pixels
    double lowest_rad = 1.75;      ///< max angle of a line from the zenith: ten degrees below the horizon
    float edge_from = 0.5f;        ///< min contrast (0.72 times its logarithm) of an edge above the sky's noise
    float min_fall = 30;  ///< min difference of an edge in grey values over three pixels: above a phone's noise by day
  };

  RobustSkyFinder(const Parameters& parameters, const CameraModel& camera, cv::Size size);

  /// As SkyFinder::find. `up_c` may lie outside the picture: directions whose line is above the picture's border are
  /// marked `above`. Empty where the picture shows no sky.
  const std::vector<SkyEdge>& find(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Vector3d& up_c,
                                   const Eigen::Vector3d& north_c, const Chroma& chroma = {});
  /// The latest picture's log-odds at reduced size.
  const cv::Mat& log_odds() const { return sky_->log_odds; }
  /// Log-odds of the latest picture at full size; `grey` and `chroma` must be that picture's.
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
  void extract_edges(const cv::Mat& grey);

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
  std::vector<float> samples_, edges_at_;  // log-odds and gains of edges, column by column
  std::vector<SkyEdge> edges_;
};

}  // namespace odograph::skyline
