// SPDX-License-Identifier: Apache-2.0
//
// How far `odograph calibrate` is from the truth on simulated boards: `odograph bench calibrate`.
#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/board_option.hpp"
#include "sdk/tools/simulation/board_pictures.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct Calibrate : Benchmark {
  Calibrate() : Benchmark("calibrate", "Intrinsics from simulated boards against the truth", 0) { options.seeds = 5; }
  void add_options(CLI::App& command) override {
    command.add_option("--seed", options.first_seed, "the first seed; each has a lens and poses of its own")
        ->group(kCases);
    command.add_option("--seeds", options.seeds, "how many, for each lens model")->group(kCases);
    command.add_option("--pictures", pictures, "of the board")->check(CLI::Range(3, 1000));
    command.add_option("--keep", folder, "folder for the pictures");
    board.add_board(command);
  }

  Result<std::vector<BenchCase>> cases() override {
    if (const auto made = board.board(); !made) return made.failure();
    options.fresh |= !folder.empty();
    std::vector<BenchCase> all;
    for (const char* lens : {"pinhole", "kannala_brandt"})
      for (uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed)
        all.push_back({{{"lens", lens}, {"seed", seed}}, {}, {}, seed});
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    LensOptions lens = board.lens();
    lens.lens = one.labels["lens"] == "pinhole" ? Lens::pinhole : Lens::kannala_brandt;
    const odo_calibration truth = random_lens(lens.lens != Lens::pinhole, one.seed);
    const auto views = views_of(one, truth, progress);
    if (!views) return views.failure();
    const auto found = calibrate_lens(*views, {640, 480}, lens);
    if (!found) return Json{{"found", views->size()}, {"failure", found.failure().text}};
    const double fx = found->fx - truth.fx, fy = found->fy - truth.fy, cx = found->cx - truth.cx,
                 cy = found->cy - truth.cy;
    const Eigen::Vector4d normalised(fx / found->sigma_fx, fy / found->sigma_fy, cx / found->sigma_cx,
                                     cy / found->sigma_cy);
    return row_of("calibrate", {{"", "found", "found", 0, views->size()},
                                {"fx", "%", "fx_percent", 4, 100 * fx / truth.fx, true},
                                {"fy", "%", "fy_percent", 4, 100 * fy / truth.fy, true},
                                {"cx", "px", "cx_px", 3, cx, true},
                                {"cy", "px", "cy_px", 3, cy, true},
                                {"rms", "px", "rms_px", 3, found->rms_px},
                                {"e/sigma", "", "normalised", 2, normalised.norm() / 2}});
  }

  BenchReport report(const Rows& rows) const override {
    std::string out = text("%s %s of %.0f mm, %zu pictures of 640x480; errors against the truth\n\n",
                           board.kind.c_str(), board.squares.c_str(), 1000 * board.board()->square_m, pictures) +
                      table_text({"", {{"lens", "lens"}, {"seed", "seed"}}, columns_of(rows, "calibrate")}, rows);
    for (const Json& row : rows)
      if (row.contains("failure"))
        out += row["lens"].dump() + ' ' + row["seed"].dump() + ": " + row["failure"].dump() + '\n';
    const auto worst = [&](const char* x, const char* y) {
      const bool all = numbers_at(rows, x).size() == rows.size();  // one that failed is off by any amount
      return all ? std::max(percentile_at(rows, x, 1, true), percentile_at(rows, y, 1, true)) : INFINITY;
    };
    return {out + text("\nworst: focal length %.4f %%, principal point %.3f px\n", worst("fx_percent", "fy_percent"),
                       worst("cx_px", "cy_px"))};
  }

 private:
  /// Pictures in which the board is found; kept if there is a folder for them.
  Result<std::vector<BoardView>> views_of(const BenchCase& one, const odo_calibration& truth,
                                          const ShowProgress& progress) const {
    const BoardCamera camera(*board.board(), truth);
    BoardFinder finder(*board.board());
    std::vector<BoardView> views;
    const fs::path own = fs::path(folder) / (one.labels["lens"].get<std::string>() + "_s" + std::to_string(one.seed));
    std::error_code error;
    if (!folder.empty()) fs::create_directories(own, error);
    for (size_t i = 0; i < pictures; ++i) {
      if (progress) progress(i, pictures);
      const cv::Mat picture = camera.picture(camera.pose(one.seed, i), one.seed, i);
      if (!folder.empty() && !cv::imwrite((own / (std::to_string(100 + i) + ".png")).string(), picture))
        return Failure{ODO_E_NOT_FOUND, own.string() + ": cannot be written"};
      if (auto view = finder.find(picture)) views.push_back(std::move(*view));
    }
    return views;
  }

  BoardOptions board;
  size_t pictures = 25;
  std::string folder;
};

}  // namespace

std::shared_ptr<Benchmark> bench_calibrate() { return std::make_shared<Calibrate>(); }

}  // namespace odograph
