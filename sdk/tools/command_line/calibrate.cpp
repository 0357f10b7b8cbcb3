// SPDX-License-Identifier: Apache-2.0
//
// `odograph calibrate`: intrinsics of a camera from pictures of a board; with --imu the camera-IMU
// extrinsics.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/tools/command_line/calibrate_imu.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/console/board_option.hpp"
#include "sdk/tools/replay/picture_source.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostViews = 60;  // of which a lens is estimated
constexpr size_t kTried = 10;      // pictures in which a board of another size is looked for

struct CalibrateArguments {
  BoardOptions options;
  std::vector<std::string> inputs;
  std::string output = "calibration", print;
  CalibrateImuArguments imu;
  bool json = false;
};

struct Seen {
  std::vector<BoardView> views;
  cv::Size size;
  size_t pictures = 0, other_size = 0;
};

/// Detects the board in every picture. Pictures of another size than the first are counted and skipped.
Result<Seen> look(const std::vector<PictureSource>& sources, const Board& board) {
  Seen seen;
  BoardFinder finder(board);
  Progress progress("calibrate");
  for (const PictureSource& source : sources) {
    progress.show(seen.pictures++, sources.size());
    const cv::Mat grey = source.grey();
    if (grey.empty()) continue;
    if (seen.size.empty()) seen.size = grey.size();
    if (grey.size() != seen.size) {
      ++seen.other_size;
      continue;
    }
    if (auto view = finder.find(grey)) {
      view->name = source.name;
      seen.views.push_back(std::move(*view));
    }
  }
  return seen;
}

/// Position, size and slant of a view's corners: four numbers that measure the difference of views.
std::array<double, 4> looks_of(const BoardView& view, cv::Size size) {
  cv::Point2d mean(0, 0);
  for (const auto& p : view.pixels) mean += cv::Point2d(p) / static_cast<double>(view.pixels.size());
  double xx = 0, yy = 0, xy = 0;
  for (const auto& p : view.pixels) {
    const cv::Point2d d = cv::Point2d(p) - mean;
    xx += d.x * d.x, yy += d.y * d.y, xy += d.x * d.y;
  }
  const double n = static_cast<double>(view.pixels.size());
  const double sx = std::sqrt(xx / n), sy = std::sqrt(yy / n);
  return {mean.x / size.width, mean.y / size.height, 2 * std::sqrt(sx * sy) / size.width, 0.5 * xy / (n * sx * sy)};
}

/// Selects at most `most` views greedily, each the one that differs most from those selected before.
std::vector<BoardView> max_different(std::vector<BoardView> views, cv::Size size, size_t most) {
  if (views.size() <= most) return views;
  std::vector<std::array<double, 4>> looks;
  for (const BoardView& view : views) looks.push_back(looks_of(view, size));
  std::vector<double> nearest(views.size(), INFINITY);
  std::vector<size_t> taken = {0};
  while (taken.size() < most) {
    for (size_t i = 0; i < views.size(); ++i) {
      double d2 = 0;
      for (size_t k = 0; k < 4; ++k) d2 += std::pow(looks[i][k] - looks[taken.back()][k], 2);
      nearest[i] = std::min(nearest[i], d2);
    }
    taken.push_back(static_cast<size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin()));
  }
  std::sort(taken.begin(), taken.end());
  std::vector<BoardView> out;
  for (const size_t i : taken) out.push_back(std::move(views[i]));
  return out;
}

/// The number of inner corners, as other programs state it, in place of that of the squares.
std::string hint_of_inner_corners(std::vector<PictureSource> sources, Board board) {
  sources.resize(std::min(sources.size(), kTried));
  ++board.columns, ++board.rows;
  const auto seen = look(sources, board);
  if (!seen || seen->views.empty()) return "";
  return text("; --squares counts squares, not inner corners: they show %dx%d", board.columns, board.rows);
}

std::string figures_of(const LensCalibration& c) {
  const auto used = std::count_if(c.pictures.begin(), c.pictures.end(), [](const auto& p) { return p.used; });
  return text(
      "fx %10.3f +- %.3f px\nfy %10.3f +- %.3f px\ncx %10.3f +- %.3f px\ncy %10.3f +- %.3f px\nresidual %.3f px (rms) "
      "over %d pictures of %dx%d, %zu rejected; corners in %.0f %% of the picture\n",
      c.fx, c.sigma_fx, c.fy, c.sigma_fy, c.cx, c.sigma_cx, c.cy, c.sigma_cy, c.rms_px, static_cast<int>(used),
      c.size.width, c.size.height, c.pictures.size() - static_cast<size_t>(used), 100 * c.covered());
}

nlohmann::ordered_json json_of(const LensCalibration& c, const std::vector<std::string>& warnings) {
  nlohmann::ordered_json pictures = nlohmann::json::array();
  for (const auto& p : c.pictures)
    pictures.push_back({{"name", p.name},
                        {"used", p.used},
                        {"corners", p.pixels.size()},
                        {"rms_px", p.rms_px},
                        {"tilt_rad", p.tilt_rad}});
  return {{"model", c.lens == Lens::pinhole ? "pinhole" : "kannala_brandt"},
          {"width", c.size.width},
          {"height", c.size.height},
          {"fx", c.fx},
          {"fy", c.fy},
          {"cx", c.cx},
          {"cy", c.cy},
          {"distortion", c.distortion},
          {"sigma", {{"fx", c.sigma_fx}, {"fy", c.sigma_fy}, {"cx", c.sigma_cx}, {"cy", c.sigma_cy}}},
          {"rms_px", c.rms_px},
          {"covered", c.covered()},
          {"doubts", warnings},
          {"pictures", pictures}};
}

int print_board(const CalibrateArguments& a, const Board& board) {
  if (fs::path(a.print).extension() != ".svg")
    return print_failure({ODO_E_ARGUMENT, "--print: '" + a.print + "'; expected a file that ends in .svg"});
  if (const auto written = write_file(a.print, board_svg(board)); !written) return print_failure(written.failure());
  std::printf(
      "%s: %.0f x %.0f mm with its margin. Print it in true size, glue it to something flat, and measure a "
      "square.\n",
      a.print.c_str(), 1000 * (board.columns + 1) * board.square_m, 1000 * (board.rows + 1) * board.square_m);
  return kDone;
}

int calibrate(const CalibrateArguments& a) {
  const auto board = a.options.board();
  if (!board) return print_failure(board.failure());
  if (!a.print.empty()) return print_board(a, *board);
  CalibrateImuArguments imu = a.imu;
  imu.output = a.output, imu.json = a.json;
  if (a.inputs.empty()) {
    if (!imu.recording.empty()) return calibrate_imu(imu, nullptr);
    return print_failure({ODO_E_ARGUMENT,
                          "calibrate: no pictures; expected pictures, folders, a recording or a video (or "
                          "--imu RECORDING without a board, or --print FILE.svg for a board)"});
  }
  std::vector<PictureSource> sources;
  for (const auto& input : a.inputs) {
    auto more = pictures_of(input);
    if (!more) return print_failure(more.failure());
    std::move(more->begin(), more->end(), std::back_inserter(sources));
  }
  const auto seen = look(sources, *board);
  if (!seen) return print_failure(seen.failure());
  if (seen->other_size > 0)
    std::fprintf(stderr, "%zu of %zu pictures are not %dx%d like the first, and are skipped\n", seen->other_size,
                 seen->pictures, seen->size.width, seen->size.height);
  const auto views = max_different(seen->views, seen->size, kMostViews);
  auto found = calibrate_lens(views, seen->size, a.options.lens());
  if (!found) {
    Failure failure = found.failure();
    failure.text = "calibrate: " + failure.text;
    if (2 * seen->views.size() < seen->pictures)
      failure.text += "; looked for " + a.options.kind + " " + a.options.squares +
                      " (--board, --squares, --family) in " + std::to_string(seen->pictures) + " pictures" +
                      hint_of_inner_corners(sources, *board);
    return print_failure(failure);
  }
  const auto warnings = warnings_about(*found);
  std::error_code error;
  fs::create_directories(a.output, error);
  if (const auto written = write_file(fs::path(a.output) / "camera.yaml", camera_yaml(*found)); !written)
    return print_failure(written.failure());
  if (!imu.recording.empty()) return calibrate_imu(imu, &*found);
  if (a.json) {
    std::printf("%s\n", json_of(*found, warnings).dump(2).c_str());
    return kDone;
  }
  std::printf("board found in %zu of %zu pictures\n%s", seen->views.size(), seen->pictures, figures_of(*found).c_str());
  for (const auto& warning : warnings) std::printf("beware: %s\n", warning.c_str());
  std::printf("%s/camera.yaml (in a config: 'camera: FILE')\n", a.output.c_str());
  return kDone;
}

}  // namespace

Result<bool> write_file(const fs::path& path, const std::string& text) { return write_whole_file(path, text); }

void add_calibrate(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "calibrate", "Calibrate a camera from pictures of a board, and camera-IMU extrinsics from a recording");
  auto a = std::make_shared<CalibrateArguments>();
  command->add_option("pictures", a->inputs, "pictures, folders of pictures, a recording or a video");
  command->add_option("-o,--output", a->output, "folder for camera.yaml")->capture_default_str();
  a->options.add_lens(*command);
  a->options.add_board(*command);
  command->add_option("--print", a->print, "write the board as *.svg for printing, instead of calibrating");
  command->add_option("--imu", a->imu.recording,
                      "a recording with IMU and much rotation: camera-IMU rotation, time offset, row time; without "
                      "pictures of a board also the lens, as far as it is observable");
  command->add_option("--camera", a->imu.camera, "with --imu: a camera.yaml to start from, instead of the recording's");
  command->add_flag("--keep-lens", a->imu.keep_lens, "with --imu: do not estimate the lens");
  command->add_flag("--json", a->json, "print one JSON object");
  command->callback([a, &status] { status = calibrate(*a); });
}

}  // namespace odograph
