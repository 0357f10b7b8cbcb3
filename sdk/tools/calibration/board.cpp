// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/calibration/board.hpp"

#include <sstream>

#include "sdk/tools/calibration/markers.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {

std::optional<std::string> invalid_reason(const Board& board) {
  if (board.columns < 3 || board.rows < 3 || board.columns > 100 || board.rows > 100)
    return "a board has 3 to 100 squares a side";
  if (!(board.square_m > 1e-4 && board.square_m < 10)) return "a square's side is from 0.1 mm to 10 m";
  if (board.kind == Board::Kind::checkerboard) return {};
  if (!(board.marker_m > 0.3 * board.square_m && board.marker_m < 0.95 * board.square_m))
    return "a marker's side is from 0.3 to 0.95 of its square's";
  const MarkerFamily family(board.family);
  if (!family) return "no such markers: '" + board.family + "'; expected 36h11, 25h9 or 16h5";
  const size_t needed = marker_squares(board, false).size();
  if (needed > family.count())
    return std::to_string(needed) + " markers are needed, " + board.family + " has " + std::to_string(family.count());
  return {};
}

std::vector<cv::Point> marker_squares(const Board& board, bool first_is_white) {
  std::vector<cv::Point> squares;
  for (int y = 0; y < board.rows; ++y)
    for (int x = 0; x < board.columns; ++x)
      if (((x + y) % 2 == 0) == first_is_white) squares.emplace_back(x, y);
  return squares;
}

namespace {

/// All black rectangles of the board, m.
std::vector<cv::Rect2d> black_parts(const Board& board, bool first_is_white) {
  std::vector<cv::Rect2d> parts;
  const double s = board.square_m;
  for (int y = 0; y < board.rows; ++y)
    for (int x = 0; x < board.columns; ++x)
      if (((x + y) % 2 == 0) != first_is_white) parts.emplace_back(x * s, y * s, s, s);
  if (board.kind == Board::Kind::checkerboard) return parts;
  const MarkerFamily family(board.family);
  const auto squares = marker_squares(board, first_is_white);
  for (size_t id = 0; id < squares.size(); ++id) {
    const cv::Mat cells = family.picture(id);
    const double cell = board.marker_m / cells.cols, edge = 0.5 * (s - board.marker_m);
    for (int y = 0; y < cells.rows; ++y)
      for (int x = 0; x < cells.cols;) {
        int end = x;
        while (end < cells.cols && cells.at<uint8_t>(y, end) == 0) ++end;
        if (end > x)
          parts.emplace_back(squares[id].x * s + edge + x * cell, squares[id].y * s + edge + y * cell, (end - x) * cell,
                             cell);
        x = std::max(end, x + 1);
      }
  }
  return parts;
}

}  // namespace

cv::Mat board_picture(const Board& board, int square_px, bool first_is_white) {
  const double scale = square_px / board.square_m, margin = 0.5 * square_px;
  cv::Mat picture((board.rows + 1) * square_px, (board.columns + 1) * square_px, CV_8U, cv::Scalar(255));
  for (const cv::Rect2d& part : black_parts(board, first_is_white)) {
    const cv::Point from(cvRound(part.x * scale + margin), cvRound(part.y * scale + margin));
    const cv::Point to(cvRound(part.br().x * scale + margin), cvRound(part.br().y * scale + margin));
    picture(cv::Rect(from, to)).setTo(0);
  }
  return picture;
}

std::string board_svg(const Board& board) {
  const double margin = 500 * board.square_m;
  const double width = 1000 * board.columns * board.square_m + 2 * margin;
  const double height = 1000 * board.rows * board.square_m + 2 * margin;
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "mm\" height=\"" << height
      << "mm\" viewBox=\"0 0 " << width << ' ' << height << "\" shape-rendering=\"crispEdges\">\n<rect width=\""
      << width << "\" height=\"" << height << "\" fill=\"white\"/>\n<path fill=\"black\" d=\"";
  for (const cv::Rect2d& part : black_parts(board, false))
    svg << text("M%.4f %.4fh%.4fv%.4fh%.4fz\n", 1000 * part.x + margin, 1000 * part.y + margin, 1000 * part.width,
                1000 * part.height, -1000 * part.width);
  svg << "\"/>\n</svg>\n";
  return svg.str();
}

}  // namespace odograph
