// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/calibration/camera_imu.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/calibration/camera_imu_problem.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

constexpr int kRounds = 4;            // relinearisations of lens and gyroscope
constexpr double kFirstScale_px = 2;  // the initial estimate is off by tenths of a degree
constexpr double kMinScale_px = 0.1;

/// Rms rotation rates along the principal axes, largest first: the excitation of the recording.
Vector3d rms_rates(const std::vector<GyroSample>& gyro) {
  Vector3d mean = Vector3d::Zero();
  for (const auto& s : gyro) mean += s.rate_b / static_cast<double>(gyro.size());
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (const auto& s : gyro) C += (s.rate_b - mean) * (s.rate_b - mean).transpose() / static_cast<double>(gyro.size());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C).eigenvalues().cwiseMax(0).cwiseSqrt().reverse();
}

double median_of_sizes(const std::vector<Eigen::Vector2d>& residuals) {
  std::vector<double> sizes;
  for (const auto& r : residuals) sizes.push_back(std::hypot(r.x(), r.y()));
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

Failure wrong(const std::string& text) { return {ODO_E_DATA, text}; }

/// State of one calibration.
class Calibrating {
 public:
  Calibrating(const CameraImuData& data, const CameraImuOptions& options, const CameraImuStart& start)
      : data_(data), options_(options), lens_(data.given), q_b_c_(start.q_b_c), bias_(start.bias_b) {
    x_[shared::time_offset] = start.time_offset_s, x_[shared::row_time] = data.given_row_time_s;
    if (!options.refine_lens || start.across_rps < options.min_lens_rate_rps)
      for (const auto i : {kFocal, kCx, kCy, kK1}) fixed_[i] = true;
    windows_ = windows_of(data.frames, options.window_s, options.max_windows, options.min_corners);
    const GyroOrientation gyro(data.gyro, bias_);
    const auto outside = [&](const FrameWindow& window) {
      const auto at = [&](size_t frame) { return gyro.seconds(data.frames[frame].t_ns) + start.time_offset_s; };
      return !gyro.covers(at(window.frames.front()) - kMargin_s, at(window.frames.back()) + kMargin_s, options.gap_s);
    };
    windows_.erase(std::remove_if(windows_.begin(), windows_.end(), outside), windows_.end());
  }

  /// Solves repeatedly, each time linearised at the mount, lens and gyroscope of the previous solution.
  bool solve(const ProgressCallback& progress, size_t& done, size_t all) {
    for (int round = 0; round < kRounds; ++round) {
      gyro_ = std::make_unique<GyroOrientation>(data_.gyro, bias_, scale_);
      if (problem_)
        problem_->relinearize(linearization());
      else
        problem_ = std::make_unique<CameraImuProblem>(data_, windows_, linearization(), options_);
      if (!problem_->solve(x_, fixed_, scale_px_)) return false;
      scale_px_ = std::max(kMinScale_px, 2 * 1.4826 * median_of_sizes(problem_->residuals()));
      if (round + 1 == kRounds) covariance_ = problem_->covariance();
      take_over();
      if (progress) progress(++done, all);
    }
    return true;
  }

  double sigma(Eigen::Index i) const { return std::sqrt(std::max(0.0, covariance_(i, i))); }

  /// Fixes unobservable quantities at their given values; true if there was one.
  bool fix_weak(CameraImuCalibration& out) {
    const auto& given = data_.given;
    bool changed = false;
    const auto accept_if_observable = [&](Estimate& e, size_t i, double unit, double most, auto&& restore) {
      if (fixed_[i]) return;
      e.sigma = sigma(static_cast<Eigen::Index>(i)) * unit;
      if (e.sigma <= most) return;
      fixed_[i] = changed = true;
      restore();
    };
    if (!fixed_[shared::mount]) {
      out.rotation_sigma_rad = {sigma(shared::mount), sigma(shared::mount + 1), sigma(shared::mount + 2)};
      if (out.rotation_sigma_rad.maxCoeff() > options_.max_rotation_sigma_rad) {
        for (size_t i = 0; i < 3; ++i) fixed_[shared::mount + i] = true;
        if (given.header.flags & ODO_CALIBRATION_EXTRINSICS) q_b_c_ = out.given_q_b_c;
        changed = true;
      }
    }
    accept_if_observable(out.time_offset_s, shared::time_offset, 1, options_.max_time_sigma_s, [&] {
      if (given.header.flags & ODO_CALIBRATION_TIME_OFFSET) x_[shared::time_offset] = out.time_offset_s.given;
    });
    accept_if_observable(out.row_time_s, shared::row_time, 1, options_.max_readout_sigma_s / given.height,
                         [&] { x_[shared::row_time] = data_.given_row_time_s; });
    accept_if_observable(out.focal_px, kFocal, lens_.fx, options_.max_focal_sigma * lens_.fx,
                         [&] { lens_.fx = given.fx, lens_.fy = given.fy; });
    accept_if_observable(out.cx, kCx, 1, options_.max_centre_sigma * given.width, [&] { lens_.cx = given.cx; });
    accept_if_observable(out.cy, kCy, 1, options_.max_centre_sigma * given.width, [&] { lens_.cy = given.cy; });
    accept_if_observable(out.k1, kK1, 1, options_.max_distortion_sigma,
                         [&] { lens_.distortion[0] = given.distortion[0]; });
    return changed;
  }

  void put(CameraImuCalibration& out) const {
    const auto set = [](Estimate& e, double value, bool fixed) { e.value = value, e.observable = !fixed; };
    out.q_b_c = q_b_c_, out.rotation_observable = !fixed_[shared::mount];
    set(out.time_offset_s, x_[shared::time_offset], fixed_[shared::time_offset]);
    set(out.row_time_s, x_[shared::row_time], fixed_[shared::row_time]);
    set(out.focal_px, lens_.fx, fixed_[kFocal]);
    set(out.cx, lens_.cx, fixed_[kCx]), set(out.cy, lens_.cy, fixed_[kCy]);
    set(out.k1, lens_.distortion[0], fixed_[kK1]);
    out.gyro_bias_b = bias_, out.gyro_scale = scale_;
    out.gyro_bias_sigma_b = {sigma(shared::bias), sigma(shared::bias + 1), sigma(shared::bias + 2)};
    const auto& residuals = problem_->residuals();
    out.windows = windows_.size(), out.corners = residuals.size();
    out.median_px = median_of_sizes(residuals);
    double squares = 0, within = 0;
    for (const auto& r : residuals)
      if (std::hypot(r.x(), r.y()) < 2 * scale_px_) squares += r.x() * r.x() + r.y() * r.y(), within += 2;
    out.rms_px = std::sqrt(squares / std::max(1.0, within));
    out.lens = lens_;
    const uint32_t given = data_.given.header.flags;
    uint32_t flags = given & (ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET);
    if (out.rotation_observable) flags |= ODO_CALIBRATION_EXTRINSICS;
    if (out.time_offset_s.observable) flags |= ODO_CALIBRATION_TIME_OFFSET;
    if (out.row_time_s.observable) flags |= ODO_CALIBRATION_LINE_TIME;
    if (flags & ODO_CALIBRATION_EXTRINSICS) put_quaternion(q_b_c_, out.lens.q_b_c);
    out.lens.header.flags = flags;
    out.lens.time_offset_ns = nanoseconds(x_[shared::time_offset]);
    out.lens.line_time_ns = nanoseconds(x_[shared::row_time]);
  }

  size_t windows() const { return windows_.size(); }

 private:
  static constexpr double kMargin_s = 0.05;  // half a readout, plus the change of the offset from its start
  static constexpr size_t kFocal = shared::lens, kCx = kFocal + 1, kCy = kFocal + 2, kK1 = kFocal + 3;

  CameraImuLinearization linearization() const {
    CameraImuLinearization at{.q_b_c = q_b_c_, .lens = lens_, .gyro = gyro_.get()};
    const odo_calibration& given = data_.given;
    at.prior.segment<4>(shared::lens) << given.fx / lens_.fx - 1, given.cx - lens_.cx, given.cy - lens_.cy,
        given.distortion[0] - lens_.distortion[0];
    const double centre = options_.centre_prior * given.width;
    at.prior_sigma.segment<4>(shared::lens) << options_.focal_prior, centre, centre, options_.distortion_prior;
    const Eigen::Matrix3d off = Eigen::Matrix3d::Identity() - scale_;
    at.prior.segment<6>(shared::gyro_scale) << off(0, 0), off(1, 1), off(2, 2), off(0, 1), off(0, 2), off(1, 2);
    at.prior_sigma.segment<6>(shared::gyro_scale).setConstant(options_.gyro_scale_prior);
    return at;
  }

  /// Makes the solution the linearisation point of the next round.
  void take_over() {
    q_b_c_ = (q_b_c_ * exp_rotation(x_.segment<3>(shared::mount))).normalized();
    lens_.fx *= 1 + x_[kFocal], lens_.fy *= 1 + x_[kFocal];
    lens_.cx += x_[kCx], lens_.cy += x_[kCy];
    lens_.distortion[0] += x_[kK1];
    if (lens_.distortion[0] != 0) lens_.distortion_count = std::max(4u, lens_.distortion_count);
    bias_ += x_.segment<3>(shared::bias);
    const auto e = x_.segment<6>(shared::gyro_scale);
    Eigen::Matrix3d change;
    change << e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2];
    scale_ += change;
    const double offset = x_[shared::time_offset], row_time = x_[shared::row_time];
    x_.setZero();
    x_[shared::time_offset] = offset, x_[shared::row_time] = row_time;
  }

  const CameraImuData& data_;
  const CameraImuOptions& options_;
  odo_calibration lens_;
  Quaterniond q_b_c_;
  Vector3d bias_;
  Eigen::Matrix3d scale_ = Eigen::Matrix3d::Identity();
  SharedUnknowns x_ = SharedUnknowns::Zero();
  std::array<bool, shared::count> fixed_{};
  std::vector<FrameWindow> windows_;
  std::unique_ptr<GyroOrientation> gyro_;
  std::unique_ptr<CameraImuProblem> problem_;
  Eigen::MatrixXd covariance_;
  double scale_px_ = kFirstScale_px;
};

}  // namespace

Result<CameraImuCalibration> calibrate_camera_imu(const CameraImuData& data, const CameraImuOptions& options,
                                                  const ProgressCallback& progress) {
  if (data.frames.size() < 2) return wrong("no frames: the recording has no pictures of a camera");
  if (data.gyro.size() < 2) return wrong("no IMU: the recording has no gyroscope samples");
  CameraImuCalibration out;
  const odo_calibration& given = data.given;
  out.frames = data.frames.size();
  out.rate_rms_rps = rms_rates(data.gyro);
  if (out.rate_rms_rps[1] < options.min_rate_rps) {
    return wrong(
        text("too little rotation: %.1f, %.1f and %.1f deg/s rms about its three axes, at least %.1f about two are "
             "needed; rotate the phone back and forth about all of its axes",
             57.29578 * out.rate_rms_rps[0], 57.29578 * out.rate_rms_rps[1], 57.29578 * out.rate_rms_rps[2],
             57.29578 * options.min_rate_rps));
  }
  const GyroOrientation gyro(data.gyro, Vector3d::Zero());
  const auto start = find_camera_imu_start(data, gyro, options);
  if (!start) return start.failure();
  out.correlation = start->correlation;
  if (given.header.flags & ODO_CALIBRATION_EXTRINSICS) out.given_q_b_c = quaternion(given.q_b_c);
  if (given.header.flags & ODO_CALIBRATION_TIME_OFFSET) out.time_offset_s.given = seconds(given.time_offset_ns);
  out.row_time_s.given = data.given_row_time_s;
  out.focal_px.given = given.fx, out.cx.given = given.cx, out.cy.given = given.cy;
  out.k1.given = given.distortion[0];
  out.lens_refined = options.refine_lens;

  Calibrating work(data, options, *start);
  if (work.windows() < options.min_windows)
    return wrong("stretches in which enough corners can be followed: " + std::to_string(work.windows()) +
                 "; at least " + std::to_string(options.min_windows) + " are needed");
  // Fixes quantities that are not observable and solves the rest again.
  constexpr size_t kPasses = 4;
  size_t done = 0;
  for (size_t pass = 0; pass < kPasses; ++pass) {
    if (!work.solve(progress, done, kPasses * kRounds)) return wrong("the fit did not converge");
    if (!work.fix_weak(out)) break;
  }
  work.put(out);
  return out;
}

}  // namespace odograph
