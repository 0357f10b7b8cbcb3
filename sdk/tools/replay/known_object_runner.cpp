// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/known_object_runner.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/simulation/poster.hpp"

namespace odograph::known_object_scene {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kFrame_ns = 100'000'000;

}  // namespace

Result<PipelineConfig> Fixer::config() {
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nabsolute_fixers:\n  - plugin: fix/known_object\n    "
      "parameters: "
      "{objects: objects.yaml, prior: always}\n";
  return read_pipeline_config(yaml, "bench known-object", {});
}

Result<std::unique_ptr<Fixer>> Fixer::make(const std::vector<Target>& targets, uint64_t seed) {
  auto fixer = std::unique_ptr<Fixer>(new Fixer);
  std::ofstream objects(fixer->folder_ / "objects.yaml");
  objects << "odograph_objects: 1\nobjects:\n";
  for (const Target& t : targets) {
    objects << "  - id: " << t.id << "\n    sigma: 0.005\n";
    if (t.tag >= 0) {
      objects << "    tag: " << t.tag << "\n";
    } else {
      cv::imwrite((fixer->folder_ / (t.id + ".png")).string(), picture_of(t, seed, seed));
      objects << "    picture: " << t.id << ".png\n";
    }
    objects << "    corners_n:\n";
    for (const auto& [x, y] : {std::pair{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}) {
      const Vector3d p = kMiddle + wall_axes() * Vector3d(x * t.width_m, y * t.height_m, 0);
      objects << "      - [" << p.x() << ", " << p.y() << ", " << p.z() << "]\n";
    }
  }
  objects.close();
  auto config = Fixer::config();
  if (!config) return config.failure();
  fixer->host_ =
      std::make_unique<HostServices>(seed, std::vector<fs::path>{fixer->folder_.path()}, [](const Report&) {});
  auto instance = PluginInstance::make(config->fixers.at(0), LibraryCheck::none, 1, *fixer->host_);
  if (!instance) return instance.failure();
  fixer->instance_ = std::move(*instance);
  return fixer;
}

std::vector<odo_fix> Fixer::process_frame(const odo_pose& prior, const cv::Mat& grey, int64_t line_time_ns) {
  std::vector<odo_fix> fixes;
  take(prior.header, fixes);
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, prior.header.t_ns);
  frame.header.flags = ODO_FRAME_LINE_TIME;
  frame.format = ODO_FORMAT_GREY8;
  frame.width = static_cast<uint32_t>(grey.cols), frame.height = static_cast<uint32_t>(grey.rows);
  frame.planes[0] = {grey.data, static_cast<int64_t>(grey.step), 1, 0};
  frame.line_time_ns = line_time_ns;
  take(frame.header, fixes);
  return fixes;
}

std::vector<TimedFix> run_scene(Fixer& fixer, const std::vector<WallPicture>& hung, const Viewpoint& start, int frames,
                                uint64_t scene, Random& random, double position_sigma_m, const std::string& keep) {
  const odo_calibration lens = lens_of(scene);
  static std::map<uint64_t, PosterCamera> cameras;
  const PosterCamera& camera = cameras.try_emplace(scene % 3, lens).first->second;
  static const cv::Mat wall = wall_picture(5);
  PosterCamera::Shot shot;
  shot.light = random.uniform(0.35, 0.95), shot.slope = random.uniform(0, 0.3), shot.noise = random.uniform(1, 4);
  shot.shadow = random.uniform() < 0.3 ? random.uniform(0.5, 0.9) : 1.0;
  shot.exposure_s = random.uniform(2e-3, 12e-3);
  const double down = random.normal(), east = random.normal(), north = random.normal();
  const Vector3d position_error = position_sigma_m * Vector3d(north, east, 0.3 * down);
  const double yaw_error = 3 * kRad_per_deg * random.normal(), pitch = random.normal(), roll = random.normal();
  const Vector3d tilt_error(0.6 * kRad_per_deg * roll, 0.6 * kRad_per_deg * pitch, yaw_error);
  const Eigen::AngleAxisd wrong(tilt_error.norm(), tilt_error.normalized());
  fixer.begin(lens);
  std::vector<TimedFix> fixes;
  const double span_s = (frames - 1) * 0.1;
  for (int k = 0; k < frames; ++k) {
    const Viewpoint v = start.after(k * 0.1 - 0.5 * span_s);
    std::vector<FlatPicture> pictures = {{wall, 60, 30, v.to(kMiddle + Vector3d(0.03, 7, 0))}};
    for (const WallPicture& h : hung) pictures.push_back({h.grey, h.width_m, h.height_m, v.to(h.at_n)});
    shot.rate_c = v.rate_c, shot.velocity_c = v.R_n_c.transpose() * v.velocity_n;
    shot.seed = scene * 1000 + static_cast<uint64_t>(k);
    const cv::Mat grey = camera.take(pictures, shot);
    if (!keep.empty() && k == 0) cv::imwrite((fs::path(keep) / (std::to_string(scene) + ".png")).string(), grey);
    auto prior = make_message<odo_pose>(ODO_TYPE_POSE, 1'000'000'000 + k * kFrame_ns);
    prior.header.flags =
        ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_CAMERA | ODO_POSE_VELOCITY;
    const Eigen::Quaterniond q(Matrix3d(wrong * v.R_n_c));
    put_quaternion(q, prior.q_n);
    Vector3d::Map(prior.p_n) = v.p_n + position_error;
    Vector3d::Map(prior.velocity_n) = v.velocity_n;
    for (int i = 0; i < 3; ++i) {
      const double turned = (i < 2 ? 1.0 : 3.0) * kRad_per_deg, off = position_sigma_m * (i < 2 ? 1.0 : 0.3);
      prior.covariance[7 * i] = turned * turned, prior.covariance[7 * (i + 3)] = off * off;
    }
    prior.state = ODO_TRACKING;
    for (const odo_fix& fix : fixer.process_frame(prior, grey, nanoseconds(shot.line_time_s)))
      fixes.push_back({fix, v});
  }
  return fixes;
}

namespace {

constexpr int kWalkingFrames = 6, kStandingFrames = 36;
constexpr double kWrong_m = 1;  // error above which a fix counts as wrong, whatever its covariance

Vector3d error_of(const TimedFix& t) { return Vector3d(t.fix.p_n) - t.truth.p_n; }

/// A viewpoint of the cell from which the whole target remains visible; none if the search fails.
std::optional<Viewpoint> viewpoint_of(const Cell& cell, const FlatPicture& target, int frames, Random& random) {
  const PosterCamera look(lens_of(0));
  const double late_s = 0.05 * frames;
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double d = random.uniform(cell.from_m, cell.to_m);
    const Viewpoint v = viewpoint(random, d, random.uniform(cell.from_deg, cell.to_deg) * kRad_per_deg, !cell.standing);
    const auto all_in = [&](double s) {
      FlatPicture there = target;
      there.T_c_o = v.after(s).to(kMiddle);
      return look.sees(there, 24);
    };
    if (all_in(-late_s) && all_in(late_s)) return v;
  }
  return std::nullopt;
}

/// Shows a look-alike: not a known object, or one in the wrong place.
void show_lookalike(Fixer& fixer, const std::vector<cv::Mat>& originals, size_t kind, uint64_t scene, uint64_t seed,
                    const std::string& keep, LookAlikeFigures& row) {
  const size_t which = scene / kRightOneOutOfView % std::size(kTargets);
  const Target& target = kTargets[which];
  Random random(seed * 200003 + scene, 32);
  const bool standing = scene % 49 < 7;  // the plugin states smaller covariances when standing
  const int count = standing ? kStandingFrames : kWalkingFrames;
  const double nearest = std::max(2.0, 1.2 * target.width_m);
  const double oblique_rad = random.uniform(0, 55) * kRad_per_deg, distance_m = random.uniform(nearest, 12);
  Viewpoint v = viewpoint(random, distance_m, oblique_rad, !standing);
  const auto hung = make_look_alike(kind, target, originals[which], seed, random, v, scene);
  row.frames += static_cast<uint64_t>(count);
  for (const TimedFix& t : run_scene(fixer, hung, v, count, scene, random, 1.0, scene < 42 ? keep : "")) {
    const double off_m = error_of(t).head<2>().norm();
    ++row.fixes, row.worst_m = std::max(row.worst_m, off_m);
    row.wrong += off_m > kWrong_m || kind < 3 || kind == kOtherBoards;
  }
}

}  // namespace

Result<CellFigures> scenes_of(const Target& target, size_t number, uint64_t scenes, uint64_t seed,
                              const std::string& keep, const std::function<void(size_t done, size_t all)>& progress) {
  auto fixer = Fixer::make({target}, seed);
  if (!fixer) return fixer.failure();
  const Cell& cell = kCells[number];
  const cv::Mat picture = picture_of(target, seed, seed);
  const int frames = cell.standing ? kStandingFrames : kWalkingFrames;
  CellFigures figures;
  for (uint64_t k = 0; k < scenes; ++k) {
    if (progress) progress(k, scenes);
    const uint64_t scene = number * scenes + k + 1;
    Random random(seed * 100003 + scene, 31);
    const auto v = viewpoint_of(cell, {picture, target.width_m, target.height_m, {}}, frames, random);
    if (!v) continue;
    const auto fixes = run_scene(**fixer, {{picture, target.width_m, target.height_m, kMiddle}}, *v, frames, scene,
                                 random, 1.0, k < 2 ? keep : "");
    ++figures.scenes;
    if (fixes.empty()) continue;
    const TimedFix& last = fixes.back();
    figures.error_m.push_back(error_of(last).head<2>().norm());
    figures.nis.push_back(horizontal_nees(error_of(last), last.fix.covariance_n));
    const Eigen::Quaterniond q_n_c = raw_quaternion(last.fix.q_n_b) * rear_camera_mount();
    figures.rotation_deg.push_back(Eigen::AngleAxisd(q_n_c.toRotationMatrix().transpose() * last.truth.R_n_c).angle() /
                                   kRad_per_deg);
  }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return figures;
}

Result<std::vector<LookAlikeFigures>> look_alikes(uint64_t most, int only, uint64_t seed, const std::string& keep,
                                                  const std::function<void(size_t done, size_t all)>& progress) {
  auto fixer = Fixer::make({std::begin(kTargets), std::end(kTargets)}, seed);
  if (!fixer) return fixer.failure();
  std::vector<LookAlikeFigures> kinds(std::size(kLookAlikes));
  const uint64_t all = most + (only < 0 ? most / kRightOneOutOfView : 0);
  std::vector<cv::Mat> originals;
  for (const Target& t : kTargets) originals.push_back(picture_of(t, seed, seed));
  uint64_t frames = 0;
  for (uint64_t scene = 0; frames < all; ++scene) {
    if (progress) progress(frames, all);
    const bool last = only < 0 ? frames >= most : only == static_cast<int>(kRightOneOutOfView);
    const size_t kind = last ? kRightOneOutOfView : scene % kRightOneOutOfView;
    if (only >= 0 && kind != static_cast<size_t>(only)) continue;
    const uint64_t before = kinds[kind].frames;
    show_lookalike(**fixer, originals, kind, scene, seed, keep, kinds[kind]);
    frames += kinds[kind].frames - before;
  }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return kinds;
}

}  // namespace odograph::known_object_scene
