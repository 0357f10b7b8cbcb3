// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/calibration/calibrate_lens.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <opencv2/calib3d.hpp>

#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

constexpr size_t kMinViews = 3;
constexpr double kHuber_px = 1;

size_t coefficients_of(const LensOptions& options) {
  return options.lens == Lens::kannala_brandt ? 4 : static_cast<size_t>(options.coefficients);
}

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A fit to some of the views: fx, fy, cx, cy and distortion, and the board's pose in the camera for each view
/// (rotation vector, then translation).
struct Fit {
  std::vector<double> lens;
  std::vector<Vector6d> poses;
};

/// One corner: measured minus modelled pixels.
struct CornerResidual {
  Lens model;
  size_t coefficients;
  cv::Point3f on_board;
  cv::Point2f pixel;

  template <class T>
  bool operator()(T const* const* blocks, T* residual) const {
    const T *lens = blocks[0], *pose = blocks[1];
    const T corner[3] = {T(on_board.x), T(on_board.y), T(on_board.z)};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, corner, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (p[2] < T(1e-6)) return false;
    const auto modelled = project(model, lens, coefficients, T(p[0] / p[2]), T(p[1] / p[2]));
    residual[0] = T(pixel.x) - modelled[0];
    residual[1] = T(pixel.y) - modelled[1];
    return true;
  }
};

/// Pose of the board for an undistorted lens of this focal length, and the rms error of its corners, px; infinite if no
/// pose has all corners in front of the camera.
std::pair<Vector6d, double> rough_pose(const BoardView& view, Lens model, cv::Size size, double focal) {
  std::vector<cv::Point2d> rays, again;
  const std::vector<cv::Point3d> corners(view.corners_m.begin(), view.corners_m.end());
  for (const auto& pixel : view.pixels) {
    cv::Point2d p((pixel.x - 0.5 * (size.width - 1)) / focal, (pixel.y - 0.5 * (size.height - 1)) / focal);
    if (const double theta = cv::norm(p); model == Lens::kannala_brandt && theta > 1e-9)
      p *= std::tan(std::min(theta, 1.5)) / theta;
    rays.push_back(p);
  }
  const std::pair<Vector6d, double> none{Vector6d::Zero(), INFINITY};
  cv::Vec3d rotation, translation;
  if (!cv::solvePnP(corners, rays, cv::Matx33d::eye(), cv::noArray(), rotation, translation)) return none;
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  for (const auto& corner : corners)
    if (!((R * cv::Vec3d(corner.x, corner.y, corner.z))[2] + translation[2] > 0)) return none;
  cv::projectPoints(corners, rotation, translation, cv::Matx33d::eye(), cv::noArray(), again);
  double sum = 0;
  for (size_t i = 0; i < rays.size(); ++i) sum += (rays[i] - again[i]).dot(rays[i] - again[i]);
  Vector6d pose;
  pose << rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2];
  return {pose, focal * std::sqrt(sum / static_cast<double>(rays.size()))};
}

/// Initial focal length, from a range between telephoto and fisheye: the one with the lowest median error of the
/// boards.
Fit start(const std::vector<const BoardView*>& views, cv::Size size, const LensOptions& options) {
  Fit best;
  double least = INFINITY;
  for (double part = 0.25; part < 5; part *= 1.12) {
    const double focal = part * size.width;
    Fit fit;
    std::vector<double> off;
    for (const BoardView* view : views) {
      const auto [pose, rms_px] = rough_pose(*view, options.lens, size, focal);
      fit.poses.push_back(pose);
      off.push_back(rms_px);
    }
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (*middle >= least) continue;
    least = *middle;
    fit.lens = {focal, focal, 0.5 * (size.width - 1), 0.5 * (size.height - 1)};
    best = std::move(fit);
  }
  if (!best.lens.empty()) best.lens.resize(4 + coefficients_of(options), 0.0);
  return best;
}

void build(ceres::Problem& problem, Fit& fit, const std::vector<const BoardView*>& views, const LensOptions& options) {
  const size_t coefficients = coefficients_of(options);
  for (size_t i = 0; i < views.size(); ++i)
    for (size_t k = 0; k < views[i]->pixels.size(); ++k) {
      auto* cost = new ceres::DynamicAutoDiffCostFunction<CornerResidual, 4>(
          new CornerResidual{options.lens, coefficients, views[i]->corners_m[k], views[i]->pixels[k]});
      cost->AddParameterBlock(static_cast<int>(4 + coefficients));
      cost->AddParameterBlock(6);
      cost->SetNumResiduals(2);
      problem.AddResidualBlock(cost, new ceres::HuberLoss(kHuber_px), fit.lens.data(), fit.poses[i].data());
    }
}

/// Optimises all lens parameters and poses jointly, with a Huber loss of kHuber_px.
bool refine(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

double rms(const std::vector<cv::Point2d>& residuals) {
  double sum = 0;
  for (const auto& r : residuals) sum += r.dot(r);
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, residuals.size())));
}

/// Computes the residuals of every view.
void measure(const Fit& fit, const std::vector<const BoardView*>& views, LensCalibration& out) {
  double squares = 0;
  size_t corners = 0;
  out.pictures.clear();
  for (size_t i = 0; i < views.size(); ++i) {
    LensCalibration::Picture picture{.name = views[i]->name, .pixels = views[i]->pixels, .residuals_px = {}};
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
      const CornerResidual corner{out.lens, fit.lens.size() - 4, views[i]->corners_m[k], views[i]->pixels[k]};
      const double* blocks[] = {fit.lens.data(), fit.poses[i].data()};
      double r[2] = {0, 0};
      corner(blocks, r);
      picture.residuals_px.emplace_back(r[0], r[1]);
    }
    picture.rms_px = rms(picture.residuals_px);
    const double angle = fit.poses[i].head<3>().norm();
    const Eigen::Vector3d axis = fit.poses[i].head<3>() / std::max(angle, 1e-12);
    const double normal_z = std::cos(angle) + (1 - std::cos(angle)) * axis.z() * axis.z();
    picture.tilt_rad = std::acos(std::clamp(std::abs(normal_z), 0.0, 1.0));
    squares += picture.rms_px * picture.rms_px * static_cast<double>(picture.pixels.size());
    corners += picture.pixels.size();
    out.pictures.push_back(std::move(picture));
  }
  out.rms_px = std::sqrt(squares / static_cast<double>(corners));
}

/// Standard deviations of the intrinsics with the poses marginalised, scaled by the residuals' variance.
bool measure_spread(ceres::Problem& problem, const Fit& fit, LensCalibration& out) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  ceres::Covariance covariance(options);
  const double* lens = fit.lens.data();
  const auto n = static_cast<Eigen::Index>(fit.lens.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> C(n, n);
  const std::vector<std::pair<const double*, const double*>> wanted = {{lens, lens}};
  if (!covariance.Compute(wanted, &problem) || !covariance.GetCovarianceBlock(lens, lens, C.data())) return false;
  const double residuals = problem.NumResiduals();
  const double freedom = std::max(1.0, residuals - problem.NumParameters());
  const double variance = 0.5 * out.rms_px * out.rms_px * residuals / freedom;  // of one coordinate
  const Eigen::VectorXd sigma = (variance * C.diagonal()).cwiseMax(0).cwiseSqrt();
  out.sigma_fx = sigma[0], out.sigma_fy = sigma[1], out.sigma_cx = sigma[2], out.sigma_cy = sigma[3];
  return true;
}

/// Pictures whose residual exceeds the limit, relative to the median picture.
std::set<size_t> rejected_pictures(const LensCalibration& calibration, double reject) {
  std::vector<double> sorted;
  for (const auto& picture : calibration.pictures) sorted.push_back(picture.rms_px);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double limit = std::max(0.5, reject * sorted[sorted.size() / 2]);
  std::set<size_t> out;
  for (size_t i = 0; i < calibration.pictures.size(); ++i)
    if (calibration.pictures[i].rms_px > limit) out.insert(i);
  return out;
}

}  // namespace

Result<LensCalibration> calibrate_lens(const std::vector<BoardView>& views, cv::Size size, const LensOptions& options) {
  if (views.size() < kMinViews)
    return Failure{ODO_E_DATA, "pictures in which the board was found: " + std::to_string(views.size()) +
                                   "; at least " + std::to_string(kMinViews) + " are needed, twenty are good"};
  const Failure no_lens{
      ODO_E_DATA,
      "no lens of this model explains the pictures; are they of one camera with one focus, and of the "
      "board as given? Tilted views that reach the picture's edges help"};
  LensCalibration out;
  out.lens = options.lens, out.size = size;
  std::vector<const BoardView*> used;
  for (const BoardView& view : views) used.push_back(&view);
  std::vector<LensCalibration::Picture> left_out;
  for (;;) {
    Fit fit = start(used, size, options);
    if (fit.lens.empty()) return no_lens;
    for (size_t i = used.size(); i-- > 0;)
      if (fit.poses[i].isZero()) {
        left_out.push_back({.name = used[i]->name, .used = false, .pixels = used[i]->pixels, .residuals_px = {}});
        used.erase(used.begin() + static_cast<std::ptrdiff_t>(i));
        fit.poses.erase(fit.poses.begin() + static_cast<std::ptrdiff_t>(i));
      }
    if (used.size() < kMinViews) return no_lens;
    ceres::Problem problem;
    build(problem, fit, used, options);
    if (!refine(problem)) return no_lens;
    measure(fit, used, out);
    const auto bad = rejected_pictures(out, options.reject);
    if (bad.empty() || used.size() - bad.size() < kMinViews) {
      out.fx = fit.lens[0], out.fy = fit.lens[1], out.cx = fit.lens[2], out.cy = fit.lens[3];
      out.distortion.assign(fit.lens.begin() + 4, fit.lens.end());
      const bool plausible = out.fx > 0 && out.fy > 0 && out.rms_px < 0.02 * size.width;
      if (!plausible || !measure_spread(problem, fit, out)) return no_lens;
      break;
    }
    for (auto i = bad.rbegin(); i != bad.rend(); ++i) {
      left_out.push_back(std::move(out.pictures[*i]));
      left_out.back().used = false;
      used.erase(used.begin() + static_cast<std::ptrdiff_t>(*i));
    }
  }
  out.pictures.insert(out.pictures.end(), left_out.begin(), left_out.end());
  return out;
}

double LensCalibration::covered() const {
  std::set<int> cells;
  for (const Picture& picture : pictures)
    for (const auto& p : picture.pixels)
      if (picture.used)
        cells.insert(std::clamp(static_cast<int>(8 * p.x / static_cast<float>(size.width)), 0, 7) +
                     8 * std::clamp(static_cast<int>(6 * p.y / static_cast<float>(size.height)), 0, 5));
  return static_cast<double>(cells.size()) / 48;
}

double LensCalibration::widest_tilt_rad() const {
  double widest = 0;
  for (const Picture& picture : pictures)
    if (picture.used) widest = std::max(widest, picture.tilt_rad);
  return widest;
}

std::vector<std::string> warnings_about(const LensCalibration& c) {
  std::vector<std::string> warnings;
  const auto say = [&](auto... words) { warnings.push_back(text(words...)); };
  const auto used = std::count_if(c.pictures.begin(), c.pictures.end(), [](const auto& p) { return p.used; });
  if (used < 10) say("only %d pictures were used; twenty from different sides are good", static_cast<int>(used));
  if (c.covered() < 0.8)
    say("corners cover %.0f %% of the picture; move the board to its edges and corners, too", 100 * c.covered());
  if (c.widest_tilt_rad() < 0.5)
    say("the board was tilted by at most %.0f degrees; the focal length needs 30 or more to be observable",
        c.widest_tilt_rad() * 57.29578);
  if (c.sigma_fx > 2e-3 * c.fx) say("the focal length is known only to %.1f %%", 100 * c.sigma_fx / c.fx);
  if (c.rms_px > 0.5)
    say("the residual is %.2f px; below 0.3 is usual. Is the board flat, are its squares counted correctly, are the "
        "pictures sharp?",
        c.rms_px);
  return warnings;
}

std::string camera_yaml(const LensCalibration& c) {
  const auto used = std::count_if(c.pictures.begin(), c.pictures.end(), [](const auto& p) { return p.used; });
  std::string yaml = text(
      "# %d pictures of a board, residual %.3f px; one standard deviation: fx %.3f, fy %.3f, cx %.3f, cy %.3f px\n"
      "model: %s\nwidth: %d\nheight: %d\nfx: %.6f\nfy: %.6f\ncx: %.6f\ncy: %.6f\ndistortion: [",
      static_cast<int>(used), c.rms_px, c.sigma_fx, c.sigma_fy, c.sigma_cx, c.sigma_cy,
      c.lens == Lens::pinhole ? "pinhole" : "kannala_brandt", c.size.width, c.size.height, c.fx, c.fy, c.cx, c.cy);
  for (size_t i = 0; i < c.distortion.size(); ++i) yaml += text("%s%.9g", i ? ", " : "", c.distortion[i]);
  return yaml + "]\n";
}

}  // namespace odograph
