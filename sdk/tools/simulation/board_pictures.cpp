// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/board_pictures.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/simulation/lens_model.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

constexpr int kSide = 4;        // samples per pixel, in each direction
constexpr int kSquare_px = 80;  // of the print

}  // namespace

BoardCamera::BoardCamera(const Board& board, const odo_calibration& lens)
    : board_(board), lens_(lens), print_(board_picture(board, kSquare_px)) {
  const int width = static_cast<int>(lens.width), height = static_cast<int>(lens.height);
  std::vector<cv::Point2d> pixels;
  for (int y = 0; y < kSide * height; ++y)
    for (int x = 0; x < kSide * width; ++x) pixels.emplace_back((x + 0.5) / kSide - 0.5, (y + 0.5) / kSide - 0.5);
  rays_ = rays_of(lens, pixels);
}

bool BoardCamera::is_whole(const Eigen::Isometry3d& T_c_board) const {
  for (int y = 0; y <= board_.rows; ++y)
    for (int x = 0; x <= board_.columns; ++x) {
      const Eigen::Vector3d p = T_c_board * Eigen::Vector3d(x * board_.square_m, y * board_.square_m, 0);
      if (!cv::Rect2d(2, 2, lens_.width - 5, lens_.height - 5).contains(project(lens_, p))) return false;
    }
  return true;
}

Eigen::Isometry3d BoardCamera::pose(uint64_t seed, uint64_t picture) const {
  Random random(seed, 100 + picture);
  Eigen::Isometry3d T = any_pose(random);
  for (int i = 0; i < 1000 && board_.kind == Board::Kind::checkerboard && !is_whole(T); ++i) T = any_pose(random);
  return T;
}

Eigen::Isometry3d BoardCamera::any_pose(Random& random) const {
  const double width = board_.columns * board_.square_m, height = board_.rows * board_.square_m;
  const double tilt = random.uniform(0.0, 0.87), towards = random.uniform(-M_PI, M_PI);
  const Eigen::Vector3d axis(std::cos(towards), std::sin(towards), 0);
  const double part = random.uniform(0.35, 1.1);  // of the picture's width
  const double depth = lens_.fx * width / (part * lens_.width);
  const double x = random.uniform(0.12, 0.88) * lens_.width, y = random.uniform(0.12, 0.88) * lens_.height;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d((x - lens_.cx) / lens_.fx, (y - lens_.cy) / lens_.fy, 1) * depth);
  T.rotate(Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(random.uniform(-0.4, 0.4), Eigen::Vector3d::UnitZ()));
  T.translate(Eigen::Vector3d(-0.5 * width, -0.5 * height, 0));
  return T;
}

cv::Mat BoardCamera::picture(const Eigen::Isometry3d& T_c_board, uint64_t seed, uint64_t picture) const {
  const int width = static_cast<int>(lens_.width), height = static_cast<int>(lens_.height);
  const Eigen::Matrix3d R = T_c_board.linear();
  const Eigen::Vector3d normal = R.col(2), origin = T_c_board.translation();
  const double reach = normal.dot(origin), scale = kSquare_px / board_.square_m, margin = 0.5 * kSquare_px;
  cv::Mat x(kSide * height, kSide * width, CV_32F), y(x.size(), CV_32F), fine, light;
  for (int i = 0; i < x.rows; ++i)
    for (int k = 0; k < x.cols; ++k) {
      const cv::Point2d& ray = rays_[static_cast<size_t>(i) * static_cast<size_t>(x.cols) + static_cast<size_t>(k)];
      const Eigen::Vector3d direction(ray.x, ray.y, 1);
      const double depth = reach / normal.dot(direction);
      const Eigen::Vector3d at = R.transpose() * (depth * direction - origin);
      const bool met = depth > 0 && at.allFinite();
      x.at<float>(i, k) = met ? static_cast<float>(at.x() * scale + margin - 0.5) : -1e4f;
      y.at<float>(i, k) = met ? static_cast<float>(at.y() * scale + margin - 0.5) : -1e4f;
    }
  cv::remap(print_, fine, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(120));
  cv::resize(fine, light, {width, height}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(light, light, {0, 0}, 0.6);
  Random random(seed, 5000 + picture);
  const double bright = random.uniform(0.6, 0.9), slope = random.uniform(-0.2, 0.2);
  cv::Mat out(light.size(), CV_8U);
  for (int i = 0; i < height; ++i)
    for (int k = 0; k < width; ++k)
      out.at<uint8_t>(i, k) = cv::saturate_cast<uint8_t>(
          20 + light.at<uint8_t>(i, k) * (bright + slope * (k / static_cast<double>(width) - 0.5)) +
          2 * random.normal());
  return out;
}

odo_calibration random_lens(bool fisheye, uint64_t seed) {
  Random random(seed, 3);
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.width = 640, c.height = 480;
  c.model = fisheye ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE;
  c.fx = fisheye ? random.uniform(280, 380) : random.uniform(430, 620);
  c.fy = c.fx * random.uniform(0.99, 1.01);
  c.cx = 319.5 + random.uniform(-12, 12), c.cy = 239.5 + random.uniform(-12, 12);
  const auto put = [&](std::initializer_list<double> k) {
    c.distortion_count = static_cast<uint32_t>(k.size());
    std::copy(k.begin(), k.end(), c.distortion);
  };
  if (fisheye)
    put({random.uniform(-0.03, 0.03), random.uniform(-0.01, 0.01), random.uniform(-0.004, 0.004), 0.0});
  else
    put({random.uniform(-0.2, 0.1), random.uniform(-0.05, 0.1), random.uniform(-1e-3, 1e-3),
         random.uniform(-1e-3, 1e-3)});
  return c;
}

Result<std::vector<BoardView>> simulated_views(const Board& board, const odo_calibration& lens, uint64_t seed,
                                               size_t pictures, const std::filesystem::path& folder,
                                               const std::function<void(size_t done, size_t all)>& progress) {
  const BoardCamera camera(board, lens);
  BoardFinder finder(board);
  std::vector<BoardView> views;
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  for (size_t i = 0; i < pictures; ++i) {
    if (progress) progress(i, pictures);
    const cv::Mat picture = camera.picture(camera.pose(seed, i), seed, i);
    if (!folder.empty() && !cv::imwrite((folder / (std::to_string(100 + i) + ".png")).string(), picture))
      return Failure{ODO_E_IO, folder.string() + ": cannot be written"};
    if (auto view = finder.find(picture)) views.push_back(std::move(*view));
  }
  return views;
}

}  // namespace odograph
