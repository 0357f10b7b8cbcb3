// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A flat calibration board. Its frame: origin in the outer corner of the first square, x along the columns, y along
/// the rows, z into the board; metres.
struct Board {
  enum class Kind { checkerboard, charuco };
  Kind kind = Kind::charuco;
  int columns = 10, rows = 7;    ///< squares
  double square_m = 0.025;       ///< side of a square
  double marker_m = 0.019;       ///< side of a marker's black border (ChArUco)
  std::string family = "36h11";  ///< the markers' dictionary: AprilTag 36h11, 25h9 or 16h5 (ChArUco)

  int inner_corners() const { return (columns - 1) * (rows - 1); }
};

/// What is wrong with a board, in words; nothing if it can be used.
std::optional<std::string> mistake_in(const Board& board);

/// The squares that hold markers, in the order of the markers' numbers: row by row, white squares only. The first
/// square is black, as OpenCV 4.6 and later print it; boards of older versions with an even number of rows begin white.
std::vector<cv::Point> marker_squares(const Board& board, bool first_is_white);

/// The board in grey, `square_px` a square, with a white margin of half a square. `first_is_white`: as old prints.
cv::Mat board_picture(const Board& board, int square_px, bool first_is_white = false);
/// The board to print, in true size (millimetres), as SVG.
std::string board_svg(const Board& board);

/// A board seen in a picture: inner corners, on the board (m, z = 0) and in the picture (px, a pixel's centre is
/// whole).
struct BoardView {
  std::string name;
  std::vector<cv::Point3f> corners_m;
  std::vector<cv::Point2f> pixels;
};

/// Finds a board in pictures. Not thread-safe: one for each thread.
class BoardFinder {
 public:
  explicit BoardFinder(const Board& board);
  ~BoardFinder();
  BoardFinder(const BoardFinder&) = delete;
  BoardFinder& operator=(const BoardFinder&) = delete;

  /// Checkerboard: all inner corners or nothing (Duda & Frese, BMVC 2018, by OpenCV). ChArUco: the corners beside a
  /// marker that was read, eight or more, or nothing.
  std::optional<BoardView> find(const cv::Mat& grey);

 private:
  std::optional<BoardView> find_checkerboard(const cv::Mat& grey) const;
  std::optional<BoardView> find_charuco(const cv::Mat& grey);

  struct Markers;  // AprilTag's detector
  Board board_;
  std::unique_ptr<Markers> markers_;
};

}  // namespace odograph
