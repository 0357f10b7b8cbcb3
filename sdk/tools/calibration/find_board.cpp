// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <apriltag/apriltag.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/calibration/board.hpp"
#include "sdk/tools/calibration/markers.hpp"

namespace odograph {
/// Layout of a printed board: the squares with markers, and the rotation of its markers in quarter turns.
struct BoardPrint {
  bool first_is_white = false;
  int quarters = 0;
};

namespace {

constexpr size_t kMinCorners = 8;
const cv::TermCriteria kFine(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-3);

float norm_of(const std::vector<cv::Point2f>& points, int a, int b) {
  return static_cast<float>(cv::norm(points[static_cast<size_t>(a)] - points[static_cast<size_t>(b)]));
}

/// The corner of a marker on the board, m.
cv::Point2d corner_on_board(const Board& board, const cv::Point& square, size_t corner, int quarters) {
  static constexpr double kSigns[4][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  const auto& sign = kSigns[(corner + static_cast<size_t>(quarters)) % 4];
  return {(square.x + 0.5) * board.square_m + 0.5 * sign[0] * board.marker_m,
          (square.y + 0.5) * board.square_m + 0.5 * sign[1] * board.marker_m};
}

/// Position of a board point predicted from the four corners of a marker in this print.
cv::Point2d by_marker(const Board& board, const SeenMarker& marker, const cv::Point& square, int quarters,
                      const cv::Point2d& on_board) {
  cv::Point2f from[4], to[4];
  for (size_t k = 0; k < 4; ++k) {
    from[k] = corner_on_board(board, square, k, quarters) / board.square_m;
    to[k] = marker.corners[k];
  }
  std::vector<cv::Point2d> point = {on_board / board.square_m}, pixel;
  cv::perspectiveTransform(point, pixel, cv::getPerspectiveTransform(from, to));
  return pixel.front();
}

/// Number of diagonal neighbours whose predictions of each other agree, or not. Adjacent markers are close enough to
/// neglect distortion.
struct Agreement {
  int yes = 0, no = 0;
  bool good() const { return yes > 4 * no; }
};

Agreement agreement(const Board& board, const std::vector<SeenMarker>& seen, const BoardPrint& print) {
  const auto squares = marker_squares(board, print.first_is_white);
  Agreement agreement;
  for (const SeenMarker& a : seen)
    for (const SeenMarker& b : seen) {
      if (a.id >= squares.size() || b.id >= squares.size()) continue;
      const cv::Point apart = squares[b.id] - squares[a.id];
      if (std::abs(apart.x) != 1 || std::abs(apart.y) != 1) continue;
      const cv::Point2d middle = 0.25 * (b.corners[0] + b.corners[1] + b.corners[2] + b.corners[3]);
      const cv::Point2d expected = by_marker(board, a, squares[a.id], print.quarters,
                                             (cv::Point2d(squares[b.id]) + cv::Point2d(0.5, 0.5)) * board.square_m);
      const double side_px = std::max(cv::norm(b.corners[0] - b.corners[2]), cv::norm(b.corners[1] - b.corners[3]));
      ++(cv::norm(expected - middle) < 0.4 * side_px ? agreement.yes : agreement.no);
    }
  return agreement;
}

/// The print that explains the detections better than any other; nothing if two are equally good.
std::optional<BoardPrint> print_of(const Board& board, const std::vector<SeenMarker>& seen) {
  std::optional<BoardPrint> best;
  int fewest = 0;
  for (const bool white : {false, true})
    for (int quarters = 0; quarters < 4; ++quarters) {
      const Agreement a = agreement(board, seen, {white, quarters});
      if (!a.good()) continue;
      if (best && a.no == fewest) return {};
      if (!best || a.no < fewest) best = BoardPrint{white, quarters}, fewest = a.no;
    }
  return best;
}

}  // namespace

struct BoardFinder::Markers {
  explicit Markers(const std::string& name) : family(name), detector(apriltag_detector_create()) {
    detector->quad_decimate = 1;
    apriltag_detector_add_family_bits(detector, family.raw(), 1);
  }
  ~Markers() { apriltag_detector_destroy(detector); }

  std::vector<SeenMarker> detect(const cv::Mat& grey) const {
    image_u8_t image = {grey.cols, grey.rows, static_cast<int>(grey.step), grey.data};
    zarray_t* found = apriltag_detector_detect(detector, &image);
    std::map<size_t, std::vector<SeenMarker>> by_id;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* detection;
      zarray_get(found, i, &detection);
      SeenMarker marker{.id = static_cast<size_t>(detection->id), .corners = {}};
      for (size_t k = 0; k < 4; ++k) marker.corners[k] = {detection->p[k][0], detection->p[k][1]};
      by_id[marker.id].push_back(marker);
    }
    apriltag_detections_destroy(found);
    std::vector<SeenMarker> seen;  // a number seen twice does not belong to the board only
    for (const auto& [id, markers] : by_id)
      if (markers.size() == 1) seen.push_back(markers.front());
    return seen;
  }

  MarkerFamily family;
  apriltag_detector_t* detector;
  std::optional<BoardPrint> print;  // as determined by the first unambiguous picture
};

BoardFinder::BoardFinder(const Board& board) : board_(board) {
  if (board.kind == Board::Kind::charuco) markers_ = std::make_unique<Markers>(board.family);
}
BoardFinder::~BoardFinder() = default;

std::optional<BoardView> BoardFinder::find(const cv::Mat& grey) {
  return board_.kind == Board::Kind::charuco ? find_charuco(grey) : find_checkerboard(grey);
}

std::optional<BoardView> BoardFinder::find_checkerboard(const cv::Mat& grey) const {
  const cv::Size size(board_.columns - 1, board_.rows - 1);
  BoardView view;
  if (!cv::findChessboardCornersSB(grey, size, view.pixels, cv::CALIB_CB_ACCURACY | cv::CALIB_CB_NORMALIZE_IMAGE))
    return {};
  // Half the shortest distance to a neighbour.
  float shortest = static_cast<float>(grey.cols);
  for (int i = 0; i < board_.inner_corners(); ++i) {
    if ((i + 1) % size.width) shortest = std::min(shortest, norm_of(view.pixels, i, i + 1));
    if (i + size.width < board_.inner_corners()) shortest = std::min(shortest, norm_of(view.pixels, i, i + size.width));
  }
  const int reach = std::clamp(static_cast<int>(0.4F * shortest), 2, 8);
  cv::cornerSubPix(grey, view.pixels, {reach, reach}, {-1, -1}, kFine);
  for (int y = 1; y < board_.rows; ++y)
    for (int x = 1; x < board_.columns; ++x)
      view.corners_m.emplace_back(static_cast<float>(x * board_.square_m), static_cast<float>(y * board_.square_m), 0);
  return view;
}

std::optional<BoardView> BoardFinder::find_charuco(const cv::Mat& grey) {
  const auto seen = markers_->detect(grey);
  if (seen.size() < 3) return {};
  if (!markers_->print) markers_->print = print_of(board_, seen);
  if (!markers_->print || !agreement(board_, seen, *markers_->print).good()) return {};
  const auto squares = marker_squares(board_, markers_->print->first_is_white);
  std::map<std::pair<int, int>, const SeenMarker*> in_square;
  for (const SeenMarker& marker : seen)
    if (marker.id < squares.size()) in_square[{squares[marker.id].x, squares[marker.id].y}] = &marker;
  BoardView view;
  for (int y = 1; y < board_.rows; ++y)
    for (int x = 1; x < board_.columns; ++x) {
      // Both white squares at an inner corner contain markers: average their predictions of the corner.
      std::vector<cv::Point2d> on_board, in_picture;
      double side_px = 0;
      for (const auto& [dx, dy] : {std::pair{-1, -1}, {0, -1}, {-1, 0}, {0, 0}}) {
        const auto found = in_square.find({x + dx, y + dy});
        if (found == in_square.end()) continue;
        for (size_t k = 0; k < 4; ++k) {
          on_board.push_back(corner_on_board(board_, {x + dx, y + dy}, k, markers_->print->quarters));
          in_picture.push_back(found->second->corners[k]);
          const double side = cv::norm(found->second->corners[k] - found->second->corners[(k + 1) % 4]);
          side_px = side_px > 0 ? std::min(side_px, side) : side;
        }
      }
      if (on_board.empty()) continue;
      const cv::Mat H = cv::findHomography(on_board, in_picture);
      if (H.empty()) continue;
      std::vector<cv::Point2d> corner = {{x * board_.square_m, y * board_.square_m}}, pixel;
      cv::perspectiveTransform(corner, pixel, H);
      // Not beyond the next marker's corner.
      const double gap_px = side_px * 0.5 * (board_.square_m - board_.marker_m) / board_.marker_m;
      const int reach = std::clamp(static_cast<int>(gap_px), 2, 8);
      const cv::Rect2d inside(reach + 2, reach + 2, grey.cols - 2 * reach - 5, grey.rows - 2 * reach - 5);
      if (!inside.contains(pixel.front())) continue;
      std::vector<cv::Point2f> refined = {pixel.front()};
      cv::cornerSubPix(grey, refined, {reach, reach}, {-1, -1}, kFine);
      if (cv::norm(refined.front() - cv::Point2f(pixel.front())) > reach) continue;
      view.corners_m.emplace_back(static_cast<float>(corner[0].x), static_cast<float>(corner[0].y), 0);
      view.pixels.push_back(refined.front());
    }
  const auto span = [&](auto coordinate) {
    const auto [low, high] =
        std::minmax_element(view.corners_m.begin(), view.corners_m.end(),
                            [&](const auto& a, const auto& b) { return coordinate(a) < coordinate(b); });
    return coordinate(*high) - coordinate(*low);
  };
  if (view.pixels.size() < kMinCorners || span([](const auto& p) { return p.x; }) < 1.5 * board_.square_m ||
      span([](const auto& p) { return p.y; }) < 1.5 * board_.square_m)
    return {};  // too few, or nearly collinear: the board's tilt is not observable
  return view;
}

}  // namespace odograph
