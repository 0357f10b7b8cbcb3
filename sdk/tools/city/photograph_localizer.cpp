// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/photograph_localizer.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>
#include <odograph/skylines.h>
#include <opencv2/imgproc.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/frame_loan.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int64_t kBetweenPhotographs_ns = 1'000'000'000;
constexpr double kWidest_px = 1280;      // a frame has at most 2^24 pixels, and roofs need no more
constexpr double kCorners_m = 0.5;       // sigma of the model's corners, part of each fix of a photograph
constexpr double kHeldLevel_rad = 0.35;  // sigma of the inclination, which is not measured

/// Orientation of an upright, horizontal camera with a heading.
Eigen::Quaterniond level_camera(double heading_rad) {
  Eigen::Matrix3d R;  // x right, y down, z ahead
  R << -std::sin(heading_rad), 0, std::cos(heading_rad), std::cos(heading_rad), 0, std::sin(heading_rad), 0, 1, 0;
  return Eigen::Quaterniond(R);
}

odo_pose pose_of(const PhotographGuess& guess, int64_t t_ns) {
  auto pose = odo_pose{};
  pose.header = {.struct_size = sizeof pose, .type = ODO_TYPE_POSE};
  pose.header.t_ns = t_ns;
  pose.header.flags =
      ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_CAMERA | ODO_POSE_METRIC | ODO_POSE_COVARIANCE;
  put_quaternion(level_camera(guess.heading_rad.value_or(0)), pose.q_n);
  pose.p_n[0] = guess.north_m, pose.p_n[1] = guess.east_m;
  const double yaw = guess.heading_rad ? guess.heading_sigma_rad : std::numbers::pi;
  const double sigmas[] = {kHeldLevel_rad, kHeldLevel_rad, yaw, guess.sigma_m, guess.sigma_m, 10};
  for (size_t i = 0; i < 6; ++i) pose.covariance[7 * i] = sigmas[i] * sigmas[i];
  pose.scale = 1, pose.state = ODO_TRACKING;
  return pose;
}

}  // namespace

double PhotographPose::heading_rad() const {
  const Vector3d axis = q_n_c * Vector3d::UnitZ();
  return std::atan2(axis.y(), axis.x());
}
double PhotographPose::pitch_rad() const { return std::asin(std::clamp(-(q_n_c * Vector3d::UnitZ()).z(), -1.0, 1.0)); }
double PhotographPose::roll_rad() const {
  return std::atan2((q_n_c * Vector3d::UnitX()).z(), (q_n_c * Vector3d::UnitY()).z());
}
double PhotographPose::sigma_m() const {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()[1]);
}

/// Collects every report of the plugin, without rate limiting.
class PhotographLocalizer::Host : public HostServices {
 public:
  explicit Host(const fs::path& folder) : HostServices(0, {folder}, [](const Report&) {}) {}
  void report(uint32_t, uint32_t severity, const std::string& key, const std::string& said, int32_t, Author) override {
    if (severity >= ODO_SEVERITY_ERROR) error = said;
    if (key == "reference_system") reference_system = said;
    if (key.starts_with("no_fix_")) why = said.substr(0, said.find("; refused so far"));
  }
  std::string why, error, reference_system;
};

PhotographLocalizer::PhotographLocalizer() = default;
PhotographLocalizer::~PhotographLocalizer() = default;

Result<std::unique_ptr<PhotographLocalizer>> PhotographLocalizer::make(const fs::path& model,
                                                                       const PhotographOrigin& origin) {
  std::string yaml = text(
      "odograph: 1\nabsolute_fixers:\n  - plugin: fix/skyline\n    parameters:\n      model: %s\n"
      "      photographs: true\n      interval: 0 s\n      height_sigma: 0.6 m\n",
      nlohmann::json(model.filename().string()).dump().c_str());
  if (origin.geodetic_deg)
    yaml += text("      geodetic: true\n      geodetic_origin: [%.9f, %.9f, 0]\n", (*origin.geodetic_deg)[0],
                 (*origin.geodetic_deg)[1]);
  else
    yaml +=
        text("      model_origin: [%.4f m, %.4f m, %.4f m]\n", origin.model.x(), origin.model.y(), origin.model.z());
  auto config = read_pipeline_config(yaml, "fix/skyline", {});
  if (!config) return config.failure();
  std::unique_ptr<PhotographLocalizer> made(new PhotographLocalizer);
  made->host_ = std::make_unique<Host>(fs::absolute(model).parent_path());
  auto plugin = PluginInstance::make(config->fixers.front(), config->library_check, 1, *made->host_);
  if (!plugin)
    return Failure{ODO_E_DATA,
                   made->host_->error.empty() ? model.string() + ": " + plugin.failure().text : made->host_->error};
  made->plugin_ = std::move(*plugin);
  if (!made->table())
    return Failure{ODO_E_UNSUPPORTED, "this fix/skyline does not support photographs; is it an older version?"};
  return made;
}

Result<PhotographPose> PhotographLocalizer::estimate_pose(const cv::Mat& photograph, double focal_px,
                                                          const PhotographGuess& guess) {
  t_ns_ += kBetweenPhotographs_ns;
  cv::Mat bgr = photograph;
  if (const double part = kWidest_px / std::max(bgr.cols, bgr.rows); part < 1) {
    cv::resize(
        photograph, bgr,
        {std::max(1, static_cast<int>(part * photograph.cols)), std::max(1, static_cast<int>(part * photograph.rows))},
        0, 0, cv::INTER_AREA);
    focal_px *= static_cast<double>(bgr.cols) / photograph.cols;
  }
  odo_calibration lens{};
  lens.header = {.struct_size = sizeof lens, .type = ODO_TYPE_CALIBRATION};
  lens.header.t_ns = t_ns_ - 1, lens.header.source = 1;
  lens.model = ODO_CAMERA_PINHOLE;
  lens.width = static_cast<uint32_t>(bgr.cols), lens.height = static_cast<uint32_t>(bgr.rows);
  lens.fx = lens.fy = focal_px, lens.cx = 0.5 * (bgr.cols - 1), lens.cy = 0.5 * (bgr.rows - 1);
  odo_frame head{};
  head.header = {.struct_size = sizeof head, .type = ODO_TYPE_FRAME};
  head.header.t_ns = t_ns_, head.header.source = 1;
  const auto frame = borrow_image(bgr, head, "photograph");
  if (!frame) return frame.failure();
  host_->why.clear();
  plugin_->process(lens.header);
  plugin_->process(pose_of(guess, t_ns_).header);
  PhotographPose placed;
  for (const AnyMessage& event : plugin_->process(frame->header)) {
    if (event.header().type != ODO_TYPE_FIX) continue;
    const auto fix = copy_as<odo_fix>(event.header());
    placed.placed = true;
    placed.p_n = Vector3d(fix.p_n), placed.q_n_c = raw_quaternion(fix.q_n_b);
    const Eigen::Matrix2d measured = Eigen::Map<const Eigen::Matrix3d>(fix.covariance_n).topLeftCorner<2, 2>();
    // A fix is without the prior, which does not reduce the error of the model's corners.
    const Eigen::Matrix2d known = Eigen::Matrix2d::Identity() / (guess.sigma_m * guess.sigma_m);
    const Eigen::Matrix2d corners = Eigen::Matrix2d::Identity() * (kCorners_m * kCorners_m);
    placed.covariance = ((measured - corners).inverse() + known).inverse() + corners;
    placed.height_sigma_m = std::sqrt(fix.covariance_n[8]);
    placed.heading_sigma_rad = std::sqrt(fix.orientation_cov_n[8]);
    placed.integrity = fix.integrity, placed.agreement = static_cast<double>(fix.header.quality);
  }
  frame->loan.release(frame->loan.owner);
  if (!placed.placed && host_->why.empty())
    return Failure{ODO_E_ERROR, "fix/skyline reported no result for the photograph"};
  placed.why = host_->why;
  return placed;
}

const std::string& PhotographLocalizer::reference_system() const { return host_->reference_system; }

/// Null where the plugin has failed. It is another one after a reset.
const odo_skylines* PhotographLocalizer::table() const {
  const auto* table = static_cast<const odo_skylines*>(plugin_->extension(ODO_EXTENSION_SKYLINES));
  return table && table->struct_size >= sizeof(odo_skylines) ? table : nullptr;
}

std::vector<float> PhotographLocalizer::skyline(const Vector3d& p_n) const {
  std::vector<float> elevation(ODO_SKYLINE_DIRECTIONS);
  std::vector<int32_t> object(ODO_SKYLINE_DIRECTIONS);
  const odo_skylines* of = table();
  if (!of || of->look(of->user, p_n.data(), elevation.data(), object.data()) != ODO_OK) elevation.clear();
  return elevation;
}

std::optional<PhotographLocalizer::Ground> PhotographLocalizer::ground(const Eigen::Vector2d& at) const {
  Ground ground{};
  int32_t terrain = 0;
  const odo_skylines* of = table();
  if (!of || of->ground(of->user, at.x(), at.y(), &ground.down_m, &terrain) != ODO_OK) return std::nullopt;
  ground.terrain = terrain != 0;
  return ground;
}

std::vector<std::array<Vector3d, 2>> PhotographLocalizer::edges_near(const Eigen::Vector2d& at, double radius_m) const {
  std::vector<std::array<Vector3d, 2>> near;
  std::array<Vector3d, 2> ends;
  int32_t object = 0;
  const odo_skylines* of = table();
  for (uint64_t i = 0; of && of->edge(of->user, i, ends[0].data(), ends[1].data(), &object) == ODO_OK; ++i)
    if (object >= 0 && (ends[0].head<2>() - at).norm() < radius_m) near.push_back(ends);
  return near;
}

}  // namespace odograph
