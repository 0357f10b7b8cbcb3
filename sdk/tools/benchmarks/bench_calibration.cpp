// SPDX-License-Identifier: Apache-2.0
//
// Calibrations of a lens compared with the truth.
#include <algorithm>
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/board_option.hpp"
#include "sdk/tools/simulation/board_pictures.hpp"

namespace odograph {
namespace {

struct Calibrate : Benchmark {
  Calibrate() : Benchmark("calibrate", "Intrinsics calibrated from simulated boards, compared with the truth", kSeeds) {
    options.seeds = 5;
    variants = {"pinhole", "kannala_brandt"}, variant_label = "lens";
  }
  void add_options(CLI::App& command) override {
    command.add_option("--pictures", pictures, "number of pictures of the board")->check(CLI::Range(3, 1000));
    command.add_option("--keep", folder, "folder for the pictures");
    board.add_board(command);
  }

  Result<std::vector<BenchCase>> recordings() override {
    if (const auto made = board.board(); !made) return made.failure();
    options.fresh |= !folder.empty();
    return Benchmark::recordings();
  }

  Result<Json> measure(const BenchCase& one) const override {
    LensOptions lens = board.lens();
    lens.lens = one.variant == 0 ? Lens::pinhole : Lens::kannala_brandt;
    const odo_calibration truth = random_lens(lens.lens != Lens::pinhole, one.seed);
    const std::string own = one.labels["lens"].get<std::string>() + "_s" + std::to_string(one.seed);
    const auto views = simulated_views(*board.board(), truth, one.seed, pictures,
                                       folder.empty() ? "" : folder + '/' + own, one.run.progress);
    if (!views) return views.failure();
    const auto found = calibrate_lens(*views, {640, 480}, lens);
    if (!found) return Json{{"found", views->size()}, {"failure", found.failure().text}};
    const double fx = found->fx - truth.fx, fy = found->fy - truth.fy, cx = found->cx - truth.cx,
                 cy = found->cy - truth.cy;
    const Eigen::Vector4d normalised(fx / found->sigma_fx, fy / found->sigma_fy, cx / found->sigma_cx,
                                     cy / found->sigma_cy);
    return row_of({{"", "found", "found", 0, views->size()},
                   {"fx", "%", "fx_percent", 4, 100 * fx / truth.fx, kSigned},
                   {"fy", "%", "fy_percent", 4, 100 * fy / truth.fy, kSigned},
                   {"cx", "px", "cx_px", 3, cx, kSigned},
                   {"cy", "px", "cy_px", 3, cy, kSigned},
                   {"rms", "px", "rms_px", 3, found->rms_px},
                   {"e/sigma", "", "normalised", 2, normalised.norm() / 2}});
  }

  std::string heading(const Rows&) const override {
    return text("%s %s of %.0f mm, %zu pictures of 640x480; errors against the truth\n\n", board.kind.c_str(),
                board.squares.c_str(), 1000 * board.board()->square_m, pictures);
  }

  std::string notes(const Rows& rows) const override {
    std::string out;
    for (const Json& row : rows)
      if (row.contains("failure"))
        out += row["lens"].dump() + ' ' + row["seed"].dump() + ": " + row["failure"].dump() + '\n';
    const auto worst = [&](const char* x, const char* y) {
      const bool all = numbers_at(rows, x).size() == rows.size();  // a failed calibration has no worst error
      return all ? std::max(percentile_at(rows, x, 1, true), percentile_at(rows, y, 1, true)) : INFINITY;
    };
    return out + text("\nworst: focal length %.4f %%, principal point %.3f px\n", worst("fx_percent", "fy_percent"),
                      worst("cx_px", "cy_px"));
  }

  BoardOptions board;
  size_t pictures = 25;
  std::string folder;
};

}  // namespace

Benchmarks calibration_benchmarks() { return {std::make_shared<Calibrate>()}; }

}  // namespace odograph
