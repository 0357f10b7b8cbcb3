// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/known_object_scene.hpp"

#include <cmath>
#include <fstream>
#include <map>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/simulation/poster.hpp"

namespace odograph::known_object_scene {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kFrame_ns = 100'000'000;

cv::Mat wall_picture(uint64_t seed) {
  Random random(seed, 21);
  cv::Mat wall(1024, 2048, CV_8U, cv::Scalar(random.uniform(90, 170)));
  for (int k = 0; k < 500; ++k) {
    const cv::Point a(static_cast<int>(random.uniform(0, 2048)), static_cast<int>(random.uniform(0, 1024)));
    const cv::Point b = a + cv::Point(static_cast<int>(random.uniform(4, 70)), static_cast<int>(random.uniform(4, 90)));
    cv::rectangle(wall, a, b, random.uniform(40, 230), random.uniform() < 0.5 ? cv::FILLED : 2);
  }
  for (uint8_t& p : cv::Mat_<uint8_t>(wall)) p = cv::saturate_cast<uint8_t>(p + 10 * random.normal());
  return wall;
}

}  // namespace

odo_calibration lens_of(uint64_t number) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.width = 640, c.height = 480;
  c.fx = c.fy = 500, c.cx = 319.5, c.cy = 239.5;
  c.q_b_c[1] = 1;  // the body's x, -y, -z
  c.model = ODO_CAMERA_PINHOLE;
  const auto put = [&](std::initializer_list<double> k) {
    c.distortion_count = static_cast<uint32_t>(k.size());
    std::copy(k.begin(), k.end(), c.distortion);
  };
  if (number % 3 == 1) put({-0.15, 0.05, 4e-4, -3e-4});
  if (number % 3 == 2) c.model = ODO_CAMERA_KANNALA_BRANDT, c.fx = c.fy = 430, put({-0.02, 0.008, -0.003, 0});
  return c;
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
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nabsolute_fixers:\n  - plugin: fix/known_object\n    "
      "parameters: "
      "{objects: objects.yaml, prior: always}\n";
  auto config = read_pipeline_config(yaml, "bench known-object", plugin_directories({}));
  if (!config) return config.failure();
  fixer->host_ =
      std::make_unique<HostServices>(seed, std::vector<fs::path>{fixer->folder_.path()}, [](const Report&) {});
  auto instance = PluginInstance::make(config->fixers.at(0), LibraryCheck::none, 1, *fixer->host_);
  if (!instance) return instance.failure();
  fixer->instance_ = std::move(*instance);
  return fixer;
}

cv::Mat Fixer::picture_of(const Target& t, uint64_t layout, uint64_t content) {
  if (t.tag >= 0) return tag_board_picture(static_cast<uint32_t>(t.tag), 512);
  const int height = 900;
  return poster_picture(layout, content, {static_cast<int>(std::lround(height * t.width_m / t.height_m)), height});
}

std::vector<odo_fix> Fixer::see(const odo_pose& prior, const cv::Mat& grey, int64_t line_time_ns) {
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

Viewpoint viewpoint(Random& random, double distance_m, double oblique_rad, bool walking) {
  Viewpoint v;
  const double side = random.uniform() < 0.5 ? -1 : 1;
  v.p_n = kMiddle + distance_m * Vector3d(-std::cos(oblique_rad), side * std::sin(oblique_rad), 0);
  v.p_n.z() = -random.uniform(1.2, 1.7);
  const double spread = 0.12 * distance_m;
  const Vector3d target = kMiddle + Vector3d(0, random.uniform(-spread, spread), random.uniform(-spread, spread));
  const Vector3d forward = (target - v.p_n).normalized();
  const Vector3d right = Vector3d::UnitZ().cross(forward).normalized();
  v.R_n_c << right, forward.cross(right), forward;
  v.R_n_c = v.R_n_c * Eigen::AngleAxisd(0.08 * random.normal(), Vector3d::UnitZ()).toRotationMatrix();
  if (walking) {
    const double heading = random.uniform(-kPi, kPi);
    v.velocity_n = random.uniform(0.5, 1.3) * Vector3d(std::cos(heading), std::sin(heading), 0);
    for (double& w : v.rate_c) w = 0.2 * random.normal();
  } else {
    for (double& w : v.rate_c) w = 0.005 * random.normal();
  }
  return v;
}

std::vector<Told> play(Fixer& fixer, const std::vector<Hung>& hung, const Viewpoint& start, int frames, uint64_t scene,
                       Random& random, double position_sigma_m, const std::string& keep) {
  const odo_calibration lens = lens_of(scene);
  static std::map<uint64_t, PosterCamera> cameras;
  const PosterCamera& camera = cameras.try_emplace(scene % 3, lens).first->second;
  static const cv::Mat wall = wall_picture(5);
  PosterCamera::Shot shot;
  shot.light = random.uniform(0.35, 0.95), shot.slope = random.uniform(0, 0.3), shot.noise = random.uniform(1, 4);
  shot.shadow = random.uniform() < 0.3 ? random.uniform(0.5, 0.9) : 1.0;
  shot.exposure_s = random.uniform(2e-3, 12e-3);
  const Vector3d position_error = position_sigma_m * Vector3d(random.normal(), random.normal(), 0.3 * random.normal());
  const double yaw_error = 3 * kDegree * random.normal();
  const Vector3d tilt_error(0.6 * kDegree * random.normal(), 0.6 * kDegree * random.normal(), yaw_error);
  const Eigen::AngleAxisd wrong(tilt_error.norm(), tilt_error.normalized());
  fixer.begin(lens);
  std::vector<Told> told;
  const double span_s = (frames - 1) * 0.1;
  for (int k = 0; k < frames; ++k) {
    const Viewpoint v = start.after(k * 0.1 - 0.5 * span_s);
    std::vector<FlatPicture> pictures = {{wall, 60, 30, v.to(kMiddle + Vector3d(0.03, 7, 0))}};
    for (const Hung& h : hung) pictures.push_back({h.grey, h.width_m, h.height_m, v.to(h.at_n)});
    shot.rate_c = v.rate_c, shot.velocity_c = v.R_n_c.transpose() * v.velocity_n;
    shot.seed = scene * 1000 + static_cast<uint64_t>(k);
    const cv::Mat grey = camera.take(pictures, shot);
    if (!keep.empty() && k == 0) cv::imwrite((fs::path(keep) / (std::to_string(scene) + ".png")).string(), grey);
    auto prior = make_message<odo_pose>(ODO_TYPE_POSE, 1'000'000'000 + k * kFrame_ns);
    prior.header.flags =
        ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_CAMERA | ODO_POSE_VELOCITY;
    const Eigen::Quaterniond q(Matrix3d(wrong * v.R_n_c));
    prior.q_n[0] = q.w(), prior.q_n[1] = q.x(), prior.q_n[2] = q.y(), prior.q_n[3] = q.z();
    Vector3d::Map(prior.p_n) = v.p_n + position_error;
    Vector3d::Map(prior.velocity_n) = v.velocity_n;
    for (int i = 0; i < 3; ++i) {
      const double turned = (i < 2 ? 1.0 : 3.0) * kDegree, off = position_sigma_m * (i < 2 ? 1.0 : 0.3);
      prior.covariance[7 * i] = turned * turned, prior.covariance[7 * (i + 3)] = off * off;
    }
    prior.state = ODO_TRACKING;
    for (const odo_fix& fix : fixer.see(prior, grey, std::llround(shot.line_time_s * 1e9))) told.push_back({fix, v});
  }
  return told;
}

}  // namespace odograph::known_object_scene
