// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench known-object`: fix/known_object on pictures of posters, boards and tags, and on what looks like them.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/replay/known_object_runner.hpp"

namespace odograph {
namespace {

using namespace known_object_scene;

const std::vector<Column> kAccuracy = {{"", "scenes", "scenes", 0, false, "_scenes", Over::sum},
                                       {"", "fixes", "fixes", 0, false, "_fixes", Over::sum},
                                       {"mean", "m", "mean_m", 3, false, "_error_m", Over::mean},
                                       {"90 %", "m", "_p90", 3, false, "_error_m", Over::percentile, 0.9},
                                       {"max", "m", "_max", 3, false, "_error_m", Over::percentile, 1},
                                       {"rotation", "deg", "_rotation", 2, false, "_rotation_deg", Over::mean},
                                       {"in 95 %", "%", "_inside", 0, false, "_inside_percent", Over::mean}};

const std::vector<Column> kLookalikes = {{"", "frames", "frames", 0, false, "frames", Over::sum},
                                         {"", "fixes", "fixes", 0, false, "fixes", Over::sum},
                                         {"", "wrong", "wrong", 0, false, "wrong", Over::sum},
                                         {"largest", "m", "_worst_m", 2, false, "_worst_m", Over::percentile, 1}};

struct KnownObject : Benchmark {
  KnownObject() : Benchmark("known-object", "fix/known_object on posters, boards, tags and look-alikes", 0) {}
  void add_options(CLI::App& command) override {
    command.add_option("--scenes", scenes, "of each distance and obliqueness, for each object");
    command.add_option("--look-alikes", lookalike_frames, "frames with them");
    command.add_option("--kind", only, "only this kind of look-alike, by its row from 0")->check(CLI::Range(0, 7));
    command.add_option("--seed", seed, "other pictures, places and light");
    command.add_option("--keep", folder, "folder for some of the frames");
  }

  Result<std::vector<BenchCase>> cases() override {
    std::error_code error;
    if (!folder.empty()) std::filesystem::create_directories(folder, error);
    options.fresh |= !folder.empty();
    const auto config = Fixer::config();
    if (!config) return config.failure();
    const std::filesystem::path plugin = config->fixers.at(0).manifest.library;
    std::vector<BenchCase> all;
    for (size_t t = 0; t < std::size(kTargets); ++t)
      for (size_t i = 0; scenes > 0 && i < std::size(kCells); ++i) {
        const Cell& c = kCells[i];
        all.push_back({{{"target", kTargets[t].id},
                        {"standing", c.standing},
                        {"from_m", c.from_m},
                        {"to_m", c.to_m},
                        {"from_deg", c.from_deg},
                        {"to_deg", c.to_deg}},
                       {plugin},
                       {},
                       t,
                       i});
      }
    if (lookalike_frames > 0) all.push_back({{{"target", "look-alikes"}}, {plugin}});
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    if (one.labels["target"] == "look-alikes") {
      const auto kinds = look_alikes(lookalike_frames, only, seed, folder, progress);
      if (!kinds) return kinds.failure();
      Json row;
      for (size_t i = 0; i < kinds->size(); ++i) {
        const LookAlikeFigures& f = (*kinds)[i];
        row["_kinds"].push_back({{"kind", kLookAlikes[i]},
                                 {"frames", f.frames},
                                 {"fixes", f.fixes},
                                 {"wrong", f.wrong},
                                 {"_worst_m", f.worst_m}});
      }
      return row;
    }
    const auto f = scenes_of(kTargets[one.seed], one.variant, scenes, seed, folder, progress);
    if (!f) return f.failure();
    Json inside = Json::array();
    for (const double nis : f->nis) inside.push_back(nis < 5.99 ? 100 : 0);
    return Json{{"_scenes", f->scenes},
                {"_fixes", f->nis.size()},
                {"_error_m", f->error_m},
                {"_rotation_deg", f->rotation_deg},
                {"_inside_percent", inside}};
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report;
    report.json = Json::object();
    report.text =
        "Frames of 640x480, 500 px (pinhole, radial-tangential, Kannala-Brandt in turn), 10 Hz, rolling shutter of 14 "
        "ms; horizontal error of the last fix of each scene.\n";
    for (const Target& target : kTargets) {
      Rows lines;
      for (const Json& row : rows_with(rows, "target", target.id)) {
        lines.push_back(summary_of(printed({row})[0], {row}, kAccuracy));
        report.json["accuracy"].push_back(printed({lines.back()})[0]);
        lines.back()["_name"] = text("%s %g-%g m, %g to %g deg", row["standing"].get<bool>() ? "standing" : "walking",
                                     number_at(row, "from_m"), number_at(row, "to_m"), number_at(row, "from_deg"),
                                     number_at(row, "to_deg"));
      }
      if (!lines.empty())
        report.text += text("\n%s, %.1f x %.1f m\n", target.id.c_str(), target.width_m, target.height_m) +
                       table_text({"", {{"", "_name"}}, kAccuracy}, lines);
    }
    for (const Json& row : rows_with(rows, "target", "look-alikes")) {
      Rows kinds(row["_kinds"].begin(), row["_kinds"].end());
      report.json["look_alikes"] = printed(kinds);
      kinds.push_back(summary_of({{"kind", "all"}}, kinds, kLookalikes));
      report.text += '\n' + table_text({"", {{"look-alikes", "kind"}}, kLookalikes}, kinds);
    }
    return report;
  }

  uint64_t scenes = 20, lookalike_frames = 10000, seed = 1;
  std::string folder;
  int only = -1;  // of the kinds of look-alikes; below 0: all in turn
};

}  // namespace

std::shared_ptr<Benchmark> bench_known_object() { return std::make_shared<KnownObject>(); }

}  // namespace odograph
