// SPDX-License-Identifier: Apache-2.0
//
// How far `odograph calibrate` is from the truth on simulated boards: `odograph bench calibrate`.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/board_option.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/simulation/board_pictures.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
  BoardOptions options;
  uint64_t seed = 1, seeds = 5, pictures = 25;
  std::string keep;
};

/// A phone's lens: no two seeds have the same, and the principal point is not in the middle.
odo_calibration random_lens(Lens lens, uint64_t seed) {
  Random random(seed, 3);
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.width = 640, c.height = 480;
  const bool fisheye = lens == Lens::kannala_brandt;
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

int bench(const BenchArguments& a) {
  const auto board = a.options.board();
  if (!board) return complain(board.failure());
  std::printf(
      "%s %s of %.0f mm, %llu pictures of 640x480; errors against the truth\n\n%-15s %5s %6s %9s %9s %9s %9s %9s %9s\n",
      a.options.kind.c_str(), a.options.squares.c_str(), 1000 * board->square_m,
      static_cast<unsigned long long>(a.pictures), "lens", "seed", "found", "fx (%)", "fy (%)", "cx (px)", "cy (px)",
      "rms (px)", "e/sigma");
  std::vector<double> focal, centre;
  for (const Lens lens : {Lens::pinhole, Lens::kannala_brandt}) {
    const char* name = lens == Lens::pinhole ? "pinhole" : "kannala_brandt";
    for (uint64_t seed = a.seed; seed < a.seed + a.seeds; ++seed) {
      Progress progress(std::string(name) + " " + std::to_string(seed));
      const odo_calibration truth = random_lens(lens, seed);
      const BoardCamera camera(*board, truth);
      BoardFinder finder(*board);
      std::vector<BoardView> views;
      const fs::path folder = fs::path(a.keep) / (std::string(name) + "_s" + std::to_string(seed));
      std::error_code error;
      if (!a.keep.empty()) fs::create_directories(folder, error);
      for (uint64_t i = 0; i < a.pictures; ++i) {
        progress.show(i, a.pictures);
        const cv::Mat picture = camera.picture(camera.pose(seed, i), seed, i);
        if (!a.keep.empty() && !cv::imwrite((folder / (std::to_string(100 + i) + ".png")).string(), picture))
          return complain({ODO_E_NOT_FOUND, folder.string() + ": cannot be written"});
        if (auto view = finder.find(picture)) views.push_back(std::move(*view));
      }
      LensOptions options = a.options.lens();
      options.lens = lens;
      const auto found = calibrate_lens(views, {640, 480}, options);
      if (!found) {
        std::printf("%-15s %5llu %6zu %s\n", name, static_cast<unsigned long long>(seed), views.size(),
                    found.failure().text.c_str());
        focal.push_back(INFINITY), centre.push_back(INFINITY);
        continue;
      }
      const double fx = 100 * (found->fx / truth.fx - 1), fy = 100 * (found->fy / truth.fy - 1);
      const double cx = found->cx - truth.cx, cy = found->cy - truth.cy;
      const double normalised =
          std::sqrt(0.25 * (std::pow((found->fx - truth.fx) / found->sigma_fx, 2) +
                            std::pow((found->fy - truth.fy) / found->sigma_fy, 2) + std::pow(cx / found->sigma_cx, 2) +
                            std::pow(cy / found->sigma_cy, 2)));
      std::printf("%-15s %5llu %6zu %+9.4f %+9.4f %+9.3f %+9.3f %9.3f %9.2f\n", name,
                  static_cast<unsigned long long>(seed), views.size(), fx, fy, cx, cy, found->rms_px, normalised);
      focal.push_back(std::max(std::abs(fx), std::abs(fy)));
      centre.push_back(std::max(std::abs(cx), std::abs(cy)));
    }
  }
  std::printf("\nworst: focal length %.4f %%, principal point %.3f px\n", *std::max_element(focal.begin(), focal.end()),
              *std::max_element(centre.begin(), centre.end()));
  return kDone;
}

}  // namespace

void add_bench_calibrate(CLI::App& bench_command, int& status) {
  auto a = std::make_shared<BenchArguments>();
  auto* command = bench_command.add_subcommand("calibrate", "Intrinsics from simulated boards against the truth");
  command->add_option("--seed", a->seed, "the first seed; each has a lens and poses of its own")->capture_default_str();
  command->add_option("--seeds", a->seeds, "how many, for each lens model")->capture_default_str();
  command->add_option("--pictures", a->pictures, "of the board")->capture_default_str()->check(CLI::Range(3, 1000));
  command->add_option("--keep", a->keep, "folder for the pictures");
  a->options.add_board(*command);
  command->callback([a, &status] { status = bench(*a); });
}

}  // namespace odograph
