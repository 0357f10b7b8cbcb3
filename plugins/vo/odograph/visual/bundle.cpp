// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/bundle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <ceres/ceres.h>

#include "plugins/vo/odograph/visual/bundle_costs.hpp"
#include "plugins/vo/odograph/visual/ceres_silence.hpp"

namespace odograph::vo {
namespace {

using namespace bundle;

ceres::Problem::Options borrowed() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

/// The window as a Ceres problem.
class WindowProblem {
 public:
  WindowProblem(Window& window, const Vector3d& bias_c, const AdjustmentParameters& p)
      : p_(p), window_(window), poses_(window.keyframes().size() + 1) {
    const auto& keyframes = window_.keyframes();
    Eigen::Map<Vector3d>{bias()} = bias_c;
    for (size_t k = 0; k < keyframes.size(); ++k) {
      Eigen::Map<Quaterniond>{poses_[k].data()} = Quaterniond(keyframes[k].T_w_c.linear());
      Eigen::Map<Vector3d>{poses_[k].data() + 4} = keyframes[k].T_w_c.translation();
      problem_.AddParameterBlock(poses_[k].data(), 7, &manifold_);
      ordering_->AddElementToGroup(poses_[k].data(), 1);
    }
  }

  /// Adds the observations; returns their number.
  int add_observations(double sigma) {
    int observations = 0;
    const uint32_t first = window_.keyframes().front().id;
    // Contiguous storage: Ceres orders its blocks by address, and the order of summation must be repeatable.
    for (auto& [track, landmark] : window_.landmarks())
      if (landmark.triangulated && landmark.seen.size() > 1) triangulated_.push_back(&landmark);
    inverse_depths_.resize(triangulated_.size());
    for (size_t k = 0; k < triangulated_.size(); ++k) {
      const Landmark& landmark = *triangulated_[k];
      double* rho = &inverse_depths_[k];
      *rho = landmark.inverse_depth;
      problem_.AddParameterBlock(rho, 1);
      ordering_->AddElementToGroup(rho, 0);
      const Observation& anchor = landmark.seen.front();
      for (size_t i = 1; i < landmark.seen.size(); ++i) {
        const Observation& o = landmark.seen[i];
        problem_.AddResidualBlock(new Reprojection(anchor.seen, o.seen, sigma, p_.min_depth), &cauchy_,
                                  poses_[anchor.keyframe - first].data(), poses_[o.keyframe - first].data(), rho);
        ++observations;
      }
    }
    return observations;
  }

  /// Adds the gyroscope's rotations, with its bias.
  void add_rotations(const Vector3d& bias_c) {
    const auto& keyframes = window_.keyframes();
    bool any = false;
    for (size_t k = 1; k < keyframes.size(); ++k) {
      if (!keyframes[k].rotation) continue;
      if (!std::exchange(any, true)) {
        problem_.AddParameterBlock(bias(), 3);
        ordering_->AddElementToGroup(bias(), 1);
        problem_.AddResidualBlock(new BiasPrior(bias_c, p_.bias_sigma_radps), nullptr, bias());
      }
      problem_.AddResidualBlock(new Rotation(*keyframes[k].rotation, keyframes[k].rotation_bias_c), nullptr,
                                poses_[k - 1].data(), poses_[k].data(), bias());
    }
  }

  /// Fixes the gauge: position, heading and scale, which the terms above do not determine.
  void hold_gauge() {
    const auto& keyframes = window_.keyframes();
    problem_.SetParameterBlockConstant(poses_[0].data());
    if (window_.slid())
      problem_.SetParameterBlockConstant(poses_[1].data());
    else
      problem_.AddResidualBlock(
          new Length((keyframes[1].T_w_c.translation() - keyframes[0].T_w_c.translation()).norm(), p_.baseline_sigma),
          nullptr, poses_[0].data(), poses_[1].data());
  }

  ceres::Solver::Summary solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = ordering_;
    options.max_num_iterations = p_.iterations;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = p_.function_tolerance;
    ceres::Solver::Summary summary;
    const CeresSilence silence;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }

  void write_back(Vector3d& bias_c) {
    auto& keyframes = window_.keyframes();
    bias_c = Eigen::Map<Vector3d>(bias());
    for (size_t k = 0; k < keyframes.size(); ++k) {
      keyframes[k].T_w_c.linear() = Eigen::Map<Quaterniond>(poses_[k].data()).normalized().toRotationMatrix();
      keyframes[k].T_w_c.translation() = Eigen::Map<Vector3d>(poses_[k].data() + 4);
    }
    for (size_t k = 0; k < triangulated_.size(); ++k)
      triangulated_[k]->inverse_depth = std::max(inverse_depths_[k], p_.min_inverse_depth);
  }

 private:
  double* bias() { return poses_.back().data(); }

  AdjustmentParameters p_;
  Window& window_;
  std::vector<std::array<double, 7>> poses_;  // and the bias
  std::vector<Landmark*> triangulated_;
  std::vector<double> inverse_depths_;
  PoseManifold manifold_;
  ceres::CauchyLoss cauchy_{p_.cauchy_sigmas};
  ceres::Problem problem_{borrowed()};
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
};

}  // namespace

BundleReport adjust(Window& window, Vector3d& bias_c, double sigma, const AdjustmentParameters& p) {
  BundleReport report;
  if (window.keyframes().size() < 3) return report;
  WindowProblem problem(window, bias_c, p);
  report.observations = problem.add_observations(sigma);
  problem.add_rotations(bias_c);
  problem.hold_gauge();
  const ceres::Solver::Summary summary = problem.solve();
  report.solved = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  report.failed = !report.solved;
  report.iterations = static_cast<int>(summary.iterations.size());
  if (report.solved) problem.write_back(bias_c);
  return report;
}

}  // namespace odograph::vo
