// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A flat calibration board. Its frame has the origin at the outer corner of the first square, x along the columns, y
/// along the rows, z into the board; metres.
struct Board {
  enum class Kind { checkerboard, charuco };
  Kind kind = Kind::charuco;
  int columns = 10, rows = 7;    ///< squares
  double square_m = 0.025;       ///< side of a square
  double marker_m = 0.019;       ///< side of a marker's black border (ChArUco)
  std::string family = "36h11";  ///< the markers' dictionary: AprilTag 36h11, 25h9 or 16h5 (ChArUco)

  int inner_corners() const { return (columns - 1) * (rows - 1); }
};

/// Describes the first fault of a board; nothing if it is usable.
std::optional<std::string> invalid_reason(const Board& board);

/// The squares that contain markers, in the order of marker numbers: row by row, white squares only. The first square
/// is black, as printed by OpenCV 4.6 and later; boards of older versions with an even number of rows start with white.
std::vector<cv::Point> marker_squares(const Board& board, bool first_is_white);

/// Draws the board in grey, `square_px` per square, with a white margin of half a square. `first_is_white`: as in old
/// prints.
cv::Mat board_picture(const Board& board, int square_px, bool first_is_white = false);
/// The board for printing, true to size (millimetres), as SVG.
std::string board_svg(const Board& board);

/// A detected board: inner corners on the board (m, z = 0) and in the picture (px, pixel centres at integers).
struct BoardView {
  std::string name;
  std::vector<cv::Point3f> corners_m;
  std::vector<cv::Point2f> pixels;
};

/// Detects a board in pictures. Not thread-safe: use one per thread.
class BoardFinder {
 public:
  explicit BoardFinder(const Board& board);
  ~BoardFinder();
  BoardFinder(const BoardFinder&) = delete;
  BoardFinder& operator=(const BoardFinder&) = delete;

  /// Checkerboard: all inner corners or nothing (Duda & Frese, BMVC 2018, through OpenCV). ChArUco: the corners next to
  /// decoded markers, at least eight, or nothing.
  std::optional<BoardView> find(const cv::Mat& grey);

 private:
  std::optional<BoardView> find_checkerboard(const cv::Mat& grey) const;
  std::optional<BoardView> find_charuco(const cv::Mat& grey);

  struct Markers;  // wraps the AprilTag detector
  Board board_;
  std::unique_ptr<Markers> markers_;
};

}  // namespace odograph
