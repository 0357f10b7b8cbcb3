// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench known-object`: fix/known_object on pictures of posters, boards and tags, and on what looks like them.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/benchmarks/known_object_scene.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/poster.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using namespace known_object_scene;

constexpr int kWalkingFrames = 6, kStandingFrames = 36;
constexpr size_t kLast = 7;     // of the kinds of look-alikes
constexpr double kWrong_m = 1;  // a fix so far off is wrong, whatever it says of itself

struct KnownObjectArguments {
  uint64_t scenes = 20, lookalike_frames = 10000, seed = 1;
  std::string keep;
  int only = -1;  // of the kinds of look-alikes; below 0: all in turn
  bool json = false;
};

double horizontal_error(const Told& t) { return (Vector3d(t.fix.p_n) - t.truth.p_n).head<2>().norm(); }

struct Cell {
  double from_m, to_m, from_deg, to_deg;
  bool standing;
  std::vector<double> error_m, nis, rotation_deg;
  uint64_t scenes = 0, seen = 0;
  void add(const std::vector<Told>& told) {
    ++scenes;
    if (told.empty()) return;
    ++seen;
    const Told& last = told.back();  // the one that stays
    error_m.push_back(horizontal_error(last));
    const Eigen::Vector2d off = (Vector3d(last.fix.p_n) - last.truth.p_n).head<2>();
    Eigen::Matrix2d P;
    P << last.fix.covariance_n[0], last.fix.covariance_n[1], last.fix.covariance_n[3], last.fix.covariance_n[4];
    nis.push_back(off.dot(P.inverse() * off));
    const Eigen::Quaterniond q_b_c(0, 1, 0, 0),
        q(last.fix.q_n_b[0], last.fix.q_n_b[1], last.fix.q_n_b[2], last.fix.q_n_b[3]);
    rotation_deg.push_back(Eigen::AngleAxisd((q * q_b_c).toRotationMatrix().transpose() * last.truth.R_n_c).angle() /
                           kDegree);
  }
};

double mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}

Result<std::vector<Cell>> accuracy(const KnownObjectArguments& a, const Target& target) {
  auto fixer = Fixer::make({target}, a.seed);
  if (!fixer) return fixer.failure();
  std::vector<Cell> cells = {{2, 5, -20, 20, true, {}, {}, {}}};
  for (const auto& [from_m, to_m] : {std::pair{2.0, 5.0}, {5.0, 10.0}, {10.0, 15.0}})
    for (const auto& [from_deg, to_deg] : {std::pair{0.0, 30.0}, {30.0, 60.0}})
      cells.push_back({from_m, to_m, from_deg, to_deg, false, {}, {}, {}});
  const cv::Mat picture = Fixer::picture_of(target, a.seed, a.seed);
  Progress progress(target.id);
  uint64_t scene = 0;
  for (Cell& cell : cells)
    for (uint64_t k = 0; k < a.scenes; ++k) {
      progress.show(scene, cells.size() * a.scenes);
      Random random(a.seed * 100003 + ++scene, 31);
      const int frames = cell.standing ? kStandingFrames : kWalkingFrames;
      for (int attempt = 0; attempt < 200; ++attempt) {
        const double d = random.uniform(cell.from_m, cell.to_m);
        const Viewpoint v = viewpoint(random, d, random.uniform(cell.from_deg, cell.to_deg) * kDegree, !cell.standing);
        const PosterCamera look(lens_of(0));
        const double late_s = 0.05 * frames;
        const auto all_in = [&](double s) {
          return look.sees({picture, target.width_m, target.height_m, v.after(s).to(kMiddle)}, 24);
        };
        if (!all_in(-late_s) || !all_in(late_s)) continue;
        cell.add(play(**fixer, {{picture, target.width_m, target.height_m, kMiddle}}, v, frames, scene, random, 1.0,
                      k < 2 ? a.keep : ""));
        break;
      }
    }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return cells;
}

/// Scenes in which something looks like a known object, and is not, or is not where it belongs.
struct Lookalikes {
  std::string name;
  uint64_t frames = 0, fixes = 0, wrong = 0;
  double worst_m = 0;
};

/// Before the copy instead of the original, turned away and walking away so that at least half of that is out of the
/// picture.
Viewpoint before_copy(Viewpoint v, const Vector3d& aside, const PosterCamera& camera) {
  constexpr double kRotation_rad = 0.02, kFirst_s = -0.25;
  constexpr int kYaws = 60;
  const double side = aside.y() > 0 ? 1 : -1;
  v.p_n += aside;
  v.velocity_n.y() = side * std::abs(v.velocity_n.y());
  v.rate_c.setZero();
  for (int k = 0; k < kYaws; ++k) {
    const Eigen::Vector3d p_c = v.after(kFirst_s).to(kMiddle).translation();
    if (p_c.z() <= 0) break;
    const double x = camera.project(p_c).x();
    if (x < 0 || x > 639) break;
    v.R_n_c = Eigen::AngleAxisd(side * kRotation_rad, Vector3d::UnitZ()).toRotationMatrix() * v.R_n_c;
  }
  return v;
}

std::vector<Hung> disguise(size_t kind, const Target& target, const cv::Mat& original, uint64_t seed, Random& random,
                           Viewpoint& v, const std::vector<uint64_t>& layouts, uint64_t scene) {
  const auto as_target = [&](cv::Mat grey) { return Hung{std::move(grey), target.width_m, target.height_m, kMiddle}; };
  switch (kind) {
    case 0: {  // another board of the same layout, or another tag
      Target other = target;
      if (target.tag >= 0) other.tag = 8 + static_cast<int>(random.next() % 400);
      return {as_target(Fixer::picture_of(other, seed, 1000 + random.next() % 1000000))};
    }
    case 1: {  // a part of it exchanged
      Hung h = as_target(original.clone());
      const cv::Mat other = poster_picture(seed, 1000 + random.next() % 1000000, original.size());
      const int cut = static_cast<int>(original.rows * random.uniform(0.4, 0.6));
      const cv::Range rows = random.uniform() < 0.5 ? cv::Range(0, cut) : cv::Range(original.rows - cut, original.rows);
      other.rowRange(rows).copyTo(h.grey.rowRange(rows));
      return {h};
    }
    case 2: {  // mirrored or upside down
      Hung h = as_target(cv::Mat());
      cv::flip(original, h.grey, random.uniform() < 0.5 ? 1 : -1);
      return {h};
    }
    case 3: {  // the same at another place: everything else of the scene is there
      const double direction = random.uniform(0, 2 * kPi), far_m = random.uniform(12, 150);
      const Vector3d away = far_m * Vector3d(std::cos(direction), std::sin(direction), 0);
      v.p_n += away;
      Hung h = as_target(original);
      h.at_n += away;
      return {h};
    }
    case 4: {  // a smaller print of it beside where it belongs
      const double part = random.uniform(0.3, 0.6), aside = (random.uniform() < 0.5 ? -1 : 1) * random.uniform(7, 12);
      v.p_n += Vector3d(0, aside, 0);
      Hung h{original, part * target.width_m, part * target.height_m, kMiddle + Vector3d(0, aside, 0)};
      return {h};
    }
    case 5: {  // two of it side by side, of which one belongs there
      Hung h = as_target(original), second = h;
      second.at_n.y() += (random.uniform() < 0.5 ? -1 : 1) * 1.15 * target.width_m;
      return {h, second};
    }
    case kLast: {  // two of it, and the camera looks at the one that does not belong there, past the other
      Hung h = as_target(original), second = h;
      const double side = random.uniform() < 0.5 ? -1 : 1;
      const Vector3d aside = side * random.uniform(1.05, 1.25) * target.width_m * Vector3d::UnitY();
      second.at_n += aside;
      v = before_copy(v, aside, PosterCamera(lens_of(scene)));
      return {h, second};
    }
    default: {  // other boards
      const uint64_t layout = layouts[random.next() % layouts.size()];
      return {as_target(poster_picture(layout, 1000 + random.next() % 1000000, {600, 900}))};
    }
  }
}

Result<std::vector<Lookalikes>> lookalikes(const KnownObjectArguments& a) {
  auto fixer = Fixer::make({std::begin(kTargets), std::end(kTargets)}, a.seed);
  if (!fixer) return fixer.failure();
  std::vector<Lookalikes> rows = {{"the same layout, another content"},
                                  {"a half of it exchanged"},
                                  {"mirrored, upside down"},
                                  {"the same, 12 to 150 m away"},
                                  {"a smaller print, 7 to 12 m aside"},
                                  {"two side by side"},
                                  {"other boards"},
                                  {"two, the right one out of view"}};
  const std::vector<uint64_t> layouts = {101, 102, 103, 104, 105, 106, 107, 108};
  std::vector<cv::Mat> originals;
  for (const Target& t : kTargets) originals.push_back(Fixer::picture_of(t, a.seed, a.seed));
  Progress progress("look-alikes");
  uint64_t frames = 0;
  // The last kind comes after the others, a seventh as often.
  const uint64_t all_frames = a.lookalike_frames + (a.only < 0 ? a.lookalike_frames / kLast : 0);
  for (uint64_t scene = 0; frames < all_frames; ++scene) {
    progress.show(frames, all_frames);
    Random random(a.seed * 200003 + scene, 32);
    const bool last = a.only < 0 ? frames >= a.lookalike_frames : a.only == static_cast<int>(kLast);
    const size_t kind = last ? kLast : scene % kLast, which = scene / kLast % std::size(kTargets);
    const Target& target = kTargets[which];
    if (a.only >= 0 && kind != static_cast<size_t>(a.only)) continue;
    // Every seventh of them is stood before: what is told then is told with more weight.
    const bool standing = scene % 49 < 7;
    const int count = standing ? kStandingFrames : kWalkingFrames;
    const double nearest = std::max(2.0, 1.2 * target.width_m);
    Viewpoint v = viewpoint(random, random.uniform(nearest, 12), random.uniform(0, 55) * kDegree, !standing);
    const auto hung = disguise(kind, target, originals[which], a.seed, random, v, layouts, scene);
    const auto told = play(**fixer, hung, v, count, scene, random, 1.0, scene < 42 ? a.keep : "");
    Lookalikes& row = rows[kind];
    row.frames += static_cast<uint64_t>(count), frames += static_cast<uint64_t>(count);
    for (const Told& t : told) {
      ++row.fixes;
      row.worst_m = std::max(row.worst_m, horizontal_error(t));
      row.wrong += horizontal_error(t) > kWrong_m || kind < 3 || kind == 6;  // those are not known objects at all
    }
  }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return rows;
}

void print(const Target& target, const std::vector<Cell>& cells) {
  std::printf("%s, %.1f x %.1f m\n%-28s %7s %7s %9s %9s %9s %12s %10s\n", target.id.c_str(), target.width_m,
              target.height_m, "", "scenes", "fixes", "mean (m)", "90 % (m)", "max (m)", "turn (deg)", "in 95 %");
  for (const Cell& c : cells) {
    char name[120];
    std::snprintf(name, sizeof name, "%s %g-%g m, %g to %g deg", c.standing ? "standing" : "walking", c.from_m, c.to_m,
                  c.from_deg, c.to_deg);
    const auto inside = std::count_if(c.nis.begin(), c.nis.end(), [](double x) { return x < 5.99; });
    if (c.error_m.empty())
      std::printf("%-28s %7llu %7d\n", name, static_cast<unsigned long long>(c.scenes), 0);
    else
      std::printf("%-28s %7llu %7llu %9.3f %9.3f %9.3f %12.2f %8.0f %%\n", name,
                  static_cast<unsigned long long>(c.scenes), static_cast<unsigned long long>(c.seen), mean(c.error_m),
                  percentile(c.error_m, 0.9), percentile(c.error_m, 1), mean(c.rotation_deg),
                  100.0 * static_cast<double>(inside) / static_cast<double>(c.nis.size()));
  }
  std::printf("\n");
}

int run_known_object(const KnownObjectArguments& a) {
  std::error_code error;
  if (!a.keep.empty()) fs::create_directories(a.keep, error);
  nlohmann::ordered_json all;
  if (!a.json)
    std::printf(
        "Frames of 640x480, 500 px (pinhole, radial-tangential, Kannala-Brandt in turn), 10 Hz, rolling shutter "
        "of 14 ms; horizontal error of the last fix of each scene.\n\n");
  if (a.scenes > 0)
    for (const Target& target : kTargets) {
      const auto cells = accuracy(a, target);
      if (!cells) return complain(cells.failure());
      if (!a.json) print(target, *cells);
      for (const Cell& c : *cells)
        all["accuracy"].push_back({{"target", target.id},
                                   {"standing", c.standing},
                                   {"from_m", c.from_m},
                                   {"to_m", c.to_m},
                                   {"from_deg", c.from_deg},
                                   {"to_deg", c.to_deg},
                                   {"scenes", c.scenes},
                                   {"fixes", c.seen},
                                   {"mean_m", mean(c.error_m)}});
    }
  if (a.lookalike_frames > 0) {
    const auto rows = lookalikes(a);
    if (!rows) return complain(rows.failure());
    if (!a.json) std::printf("%-36s %9s %9s %9s %12s\n", "look-alikes", "frames", "fixes", "wrong", "largest (m)");
    Lookalikes sum{"all"};
    const auto line = [](const Lookalikes& r) {
      std::printf("%-36s %9llu %9llu %9llu %12.2f\n", r.name.c_str(), static_cast<unsigned long long>(r.frames),
                  static_cast<unsigned long long>(r.fixes), static_cast<unsigned long long>(r.wrong), r.worst_m);
    };
    for (const Lookalikes& r : *rows) {
      sum.frames += r.frames, sum.fixes += r.fixes, sum.wrong += r.wrong,
          sum.worst_m = std::max(sum.worst_m, r.worst_m);
      if (!a.json) line(r);
      all["look_alikes"].push_back({{"kind", r.name}, {"frames", r.frames}, {"fixes", r.fixes}, {"wrong", r.wrong}});
    }
    if (!a.json) line(sum);
  }
  if (a.json) std::printf("%s\n", all.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench_known_object(CLI::App& bench, int& status) {
  auto a = std::make_shared<KnownObjectArguments>();
  auto* command = bench.add_subcommand("known-object", "fix/known_object on posters, boards, tags and look-alikes");
  command->add_option("--scenes", a->scenes, "of each distance and obliqueness, for each object")
      ->capture_default_str();
  command->add_option("--look-alikes", a->lookalike_frames, "frames with them")->capture_default_str();
  command->add_option("--kind", a->only, "only this kind of look-alike, by its row from 0")->check(CLI::Range(0, 7));
  command->add_option("--seed", a->seed, "other pictures, places and light")->capture_default_str();
  command->add_option("--keep", a->keep, "folder for some of the frames");
  command->add_flag("--json", a->json, "print one JSON object");
  command->callback([a, &status] { status = run_known_object(*a); });
}

}  // namespace odograph
