// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/calibration/camera_imu_window.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Quaterniond, Eigen::Vector2d, Eigen::Vector3d, Eigen::VectorXd;

constexpr double kLength = 1e-3;  // sigma of a path's length about 1, because scale is unobservable
// Lower clamp of the depth, in path lengths; it applies to nearer points and those behind the camera.
constexpr double kMinDepth = 0.05;
constexpr double kNearest = 0.5;  // maximum initial inverse depth of a point, 1 / path length

}  // namespace

/// Reprojection error of a point in a frame, px: normalised coordinates times the focal length.
class CameraImuProblem::Reprojection final : public ceres::SizedCostFunction<2, shared::count, kPath, 3> {
 public:
  Reprojection(const CameraImuLinearization& at, const Window& window, const Sight& sight)
      : at_(at), window_(window), sight_(sight) {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const Eigen::Map<const SharedUnknowns> x(blocks[0]);
    const Eigen::Map<const Vector3d> point(blocks[2]);
    const View v = view(x, Eigen::Map<const Path>(blocks[1]), point);
    const double depth = std::max(v.Y.z(), kMinDepth);
    const double focal = at_.lens.fx;
    const Vector2d measured = sight_.ray.ray + sight_.ray.by_lens * x.segment<4>(shared::lens);
    Eigen::Map<Vector2d> r(residual);
    r = focal * (measured - v.Y.head<2>() / depth);
    if (!jacobians) return true;
    Matrix23d by_Y;
    by_Y << 1, 0, -v.Y.x() / depth, 0, 1, -v.Y.y() / depth;
    by_Y *= -focal / depth;
    if (v.Y.z() < kMinDepth) by_Y.col(2).setZero();
    const Matrix23d by_Z = by_Y * (v.R_reference_b * v.R_b_c).transpose();
    if (jacobians[0]) derive_by_shared(v, by_Y, by_Z, point.z(), jacobians[0]);
    if (jacobians[1]) {
      Eigen::Map<Eigen::Matrix<double, 2, kPath, Eigen::RowMajor>> J(jacobians[1]);
      for (size_t k = 1; k < kWindowFrames; ++k)
        J.middleCols<3>(3 * static_cast<Eigen::Index>(k - 1)) = -point.z() * v.weight[k] * by_Z;
    }
    if (jacobians[2]) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> J(jacobians[2]);
      J.leftCols<2>() = by_Z * window_.R_reference_c.leftCols<2>();
      J.col(2) = -by_Z * v.place;
    }
    return true;
  }

 private:
  using Path = Eigen::Matrix<double, kPath, 1>;
  using Matrix23d = Eigen::Matrix<double, 2, 3>;

  /// The camera at the exposure time of the point's row, and the point in it.
  struct View {
    double since_s = 0, t = 0;  // after the window's reference time; on the IMU's clock
    Vector3d theta, delta;      // rotation by the gyroscope; change of the mount
    Matrix3d R_reference_b, R_b_c;
    std::array<double, kWindowFrames> weight, rate;  // of the path's positions in the camera's position and velocity
    Vector3d place = Vector3d::Zero(), velocity = Vector3d::Zero();
    Vector3d Z_b, Y;  // the point in b and in c
  };

  View view(const Eigen::Map<const SharedUnknowns>& x, const Eigen::Map<const Path>& path,
            const Eigen::Map<const Vector3d>& point) const {
    View v;
    const double late_s = sight_.rows * x[shared::row_time];
    v.t = sight_.t_s + x[shared::time_offset] + late_s;
    v.since_s = v.t - window_.reference_s;
    const Quaterniond turned = window_.q_reference_g * at_.gyro->at(v.t);
    v.theta = log_rotation(turned);
    Matrix3d E;
    const auto e = x.segment<6>(shared::gyro_scale);
    E << e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2];
    const Vector3d phi = E * v.theta - x.segment<3>(shared::bias) * v.since_s;
    v.R_reference_b = (turned * exp_rotation(phi)).toRotationMatrix();
    v.delta = x.segment<3>(shared::mount);
    v.R_b_c = (at_.q_b_c * exp_rotation(v.delta)).toRotationMatrix();
    window_.passing(sight_.frame, late_s, v.weight, v.rate);
    for (size_t k = 1; k < kWindowFrames; ++k) {
      const auto p = path.segment<3>(3 * static_cast<Eigen::Index>(k - 1));
      v.place += v.weight[k] * p, v.velocity += v.rate[k] * p;
    }
    const Vector3d Z = window_.R_reference_c * Vector3d(point.x(), point.y(), 1) - point.z() * v.place;
    v.Z_b = v.R_reference_b.transpose() * Z, v.Y = v.R_b_c.transpose() * v.Z_b;
    return v;
  }

  void derive_by_shared(const View& v, const Matrix23d& by_Y, const Matrix23d& by_Z, double inverse_depth,
                        double* jacobian) const {
    Eigen::Map<Eigen::Matrix<double, 2, shared::count, Eigen::RowMajor>> J(jacobian);
    const Matrix23d by_rotation = by_Y * v.R_b_c.transpose() * skew(v.Z_b);
    J.middleCols<3>(shared::mount) = by_Y * skew(v.Y) * (Matrix3d::Identity() - 0.5 * skew(v.delta));
    const Vector2d by_turning = by_rotation * at_.gyro->rate(v.t), by_moving = -inverse_depth * (by_Z * v.velocity);
    J.col(shared::time_offset) = by_turning;  // the frames' positions change along
    J.col(shared::row_time) = sight_.rows * (by_turning + by_moving);
    J.middleCols<3>(shared::bias) = -v.since_s * by_rotation;
    J.middleCols<4>(shared::lens) = at_.lens.fx * sight_.ray.by_lens;
    for (Eigen::Index i = 0; i < 3; ++i) J.col(shared::gyro_scale + i) = by_rotation.col(i) * v.theta[i];
    J.col(shared::gyro_scale + 3) = by_rotation.col(0) * v.theta[1] + by_rotation.col(1) * v.theta[0];
    J.col(shared::gyro_scale + 4) = by_rotation.col(0) * v.theta[2] + by_rotation.col(2) * v.theta[0];
    J.col(shared::gyro_scale + 5) = by_rotation.col(1) * v.theta[2] + by_rotation.col(2) * v.theta[1];
  }

  const CameraImuLinearization& at_;
  const Window& window_;
  const Sight& sight_;
};

namespace {

/// Prior: a path has length 1 and is approximately straight and uniform.
struct PathPrior {
  std::array<double, kWindowFrames> part;  // fraction of the window's time, by frame
  template <class T>
  bool operator()(const T* path, T* residual) const {
    const T* last = path + kPath - 3;
    residual[0] = (last[0] * last[0] + last[1] * last[1] + last[2] * last[2] - T(1)) / T(kLength);
    for (size_t k = 1; k + 1 < kWindowFrames; ++k)
      for (size_t i = 0; i < 3; ++i)
        residual[1 + 3 * (k - 1) + i] = (path[3 * (k - 1) + i] - part[k] * last[i]) / T(kBend);
    return true;
  }
};

struct SharedPrior {
  const CameraImuLinearization& at;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (Eigen::Index i = 0; i < shared::count; ++i)
      residual[i] = at.prior_sigma[i] > 0 ? (x[i] - at.prior[i]) / at.prior_sigma[i] : T(0);
    return true;
  }
};

}  // namespace

std::vector<FrameWindow> windows_of(const std::vector<TrackedFrame>& frames, double length_s, size_t most,
                                    size_t fewest) {
  std::vector<FrameWindow> all;
  for (size_t first = 0; first < frames.size();) {
    FrameWindow window{.frames = {first}, .corners = {}};
    size_t k = first;
    for (size_t i = 1; i < kWindowFrames; ++i) {
      const auto due_ns =
          frames[first].t_ns + static_cast<int64_t>(length_s * 1e9 * static_cast<double>(i) / (kWindowFrames - 1));
      for (++k; k + 1 < frames.size() && std::abs(frames[k + 1].t_ns - due_ns) <= std::abs(frames[k].t_ns - due_ns);)
        ++k;
      window.frames[i] = k;
    }
    if (k >= frames.size()) break;
    first = k;
    if (frames[k].t_ns - frames[window.frames[0]].t_ns > static_cast<int64_t>(2e9 * length_s)) continue;
    std::array<size_t, kWindowFrames> at{};
    for (; at[0] < frames[window.frames[0]].ids.size(); ++at[0]) {
      const uint64_t id = frames[window.frames[0]].ids[at[0]];
      bool everywhere = true;
      for (size_t i = 1; i < kWindowFrames; ++i) {
        const auto& ids = frames[window.frames[i]].ids;
        while (at[i] < ids.size() && ids[at[i]] < id) ++at[i];
        everywhere = everywhere && at[i] < ids.size() && ids[at[i]] == id;
      }
      if (everywhere) window.corners.push_back(at);
    }
    if (window.corners.size() >= fewest) all.push_back(std::move(window));
  }
  if (all.size() <= most) return all;
  std::vector<FrameWindow> some;
  for (size_t i = 0; i < most; ++i) some.push_back(std::move(all[i * all.size() / most]));
  return some;
}

CameraImuProblem::CameraImuProblem(const CameraImuData& data, const std::vector<FrameWindow>& windows,
                                   const CameraImuLinearization& at, const CameraImuOptions& options)
    : at_(at), x_(SharedUnknowns::Zero()) {
  const double middle_row = 0.5 * (at.lens.height - 1.0);
  for (const FrameWindow& from : windows) {
    auto window = std::make_unique<Window>();
    for (size_t k = 0; k < kWindowFrames; ++k) window->t_s[k] = at.gyro->seconds(data.frames[from.frames[k]].t_ns);
    const size_t taken = std::min(from.corners.size(), options.corners_of_window);
    for (size_t i = 0; i < taken; ++i) {
      const auto& places = from.corners[i * from.corners.size() / taken];
      auto& corner = window->corners.emplace_back();
      for (size_t k = 0; k < kWindowFrames; ++k) {
        const cv::Point2f pixel = data.frames[from.frames[k]].pixels[places[k]];
        corner[k] = {ray_of(at.lens, pixel), pixel, window->t_s[k], pixel.y - middle_row, k};
      }
    }
    windows_.push_back(std::move(window));
  }
  size_t size = shared::count;
  for (const auto& window : windows_) size += kPath + 3 * window->corners.size();
  numbers_.resize(size);
  double* next = numbers_.data() + shared::count;
  for (auto& window : windows_) {
    new (&window->path) Eigen::Map<Eigen::Matrix<double, kPath, 1>>(next);
    next += kPath;
  }
  for (auto& window : windows_) {
    window->points = next;
    next += 3 * window->corners.size();
  }
}

void CameraImuProblem::relinearize(const CameraImuLinearization& at) {
  problem_.reset();
  at_ = at;
  for (auto& window : windows_)
    for (auto& corner : window->corners)
      for (Sight& sight : corner) sight.ray = ray_of(at.lens, sight.pixel);
}

CameraImuProblem::~CameraImuProblem() = default;

/// Initial straight path in the direction that best fits the first and the last frame: the smallest eigenvector of the
/// normals of the corners' planes (Kneip & Lynen, ICCV 2013) with Sampson and Cauchy weights, started from each of the
/// three unweighted eigenvectors. Points start where their rays are closest.
void CameraImuProblem::start(Window& window, const SharedUnknowns& x, double scale_px) const {
  const auto orientation = [&](const Sight& s) {
    return Matrix3d(
        (window.q_reference_g * at_.gyro->at(s.t_s + x[shared::time_offset] + s.rows * x[shared::row_time]) * at_.q_b_c)
            .toRotationMatrix());
  };
  const auto turned = [&](const Sight& s) -> Vector3d { return orientation(s) * s.ray.ray.homogeneous(); };
  std::vector<Vector3d> a, c, n;
  std::vector<Matrix3d> R_a, R_c;
  Matrix3d N = Matrix3d::Zero();
  for (const auto& corner : window.corners) {
    R_a.push_back(orientation(corner.front())), R_c.push_back(orientation(corner.back()));
    a.push_back(turned(corner.front())), c.push_back(turned(corner.back()));
    n.push_back(a.back().cross(c.back()));
    N += n.back() * n.back().transpose();
  }
  const Matrix3d starts = Eigen::SelfAdjointEigenSolver<Matrix3d>(N).eigenvectors();
  const double scale = scale_px / at_.lens.fx;
  Vector3d best = starts.col(0);
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    Vector3d d = starts.col(k);
    for (int pass = 0; pass < 6; ++pass) {
      Matrix3d weighted = Matrix3d::Zero();
      double cost = 0;
      for (size_t i = 0; i < n.size(); ++i) {
        const double slope = (R_a[i].transpose() * c[i].cross(d)).head<2>().squaredNorm() +
                             (R_c[i].transpose() * d.cross(a[i])).head<2>().squaredNorm() + 1e-9;
        const double squared = std::pow(d.dot(n[i]) / scale, 2) / slope;
        cost += std::log1p(squared);
        weighted += n[i] * n[i].transpose() / (slope * (1 + squared));
      }
      if (cost < least) least = cost, best = d;
      d = Eigen::SelfAdjointEigenSolver<Matrix3d>(weighted).eigenvectors().col(0);
    }
  }
  // a and a - w d are parallel to c for the inverse depth w; most w are positive for the correct sign.
  const auto inverse_depth = [&](size_t i) {
    const Vector3d across = c[i].cross(best);
    return across.dot(c[i].cross(a[i])) / std::max(1e-12, across.squaredNorm());
  };
  size_t behind = 0;
  for (size_t i = 0; i < n.size(); ++i) behind += inverse_depth(i) < 0;
  if (2 * behind > n.size()) best = -best;
  for (size_t k = 1; k < kWindowFrames; ++k)
    window.path.segment<3>(3 * static_cast<Eigen::Index>(k - 1)) =
        (window.t_s[k] - window.t_s[0]) / (window.t_s.back() - window.t_s[0]) * best;
  for (size_t i = 0; i < n.size(); ++i) {
    const Vector3d p = window.R_reference_c.transpose() * a[i];
    const double w = std::clamp(inverse_depth(i) / p.z(), 0.0, kNearest);
    Vector3d::Map(window.points + 3 * i) = Vector3d(p.x() / p.z(), p.y() / p.z(), w);
  }
}

bool CameraImuProblem::solve(SharedUnknowns& unknowns, const std::array<bool, shared::count>& fixed, double scale_px) {
  x_ = unknowns, fixed_ = fixed, scale_px_ = scale_px;
  SharedUnknowns::Map(numbers_.data()) = x_;
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_ = std::make_unique<ceres::Problem>(ownership);
  blocks_.clear();
  auto* ordering = new ceres::ParameterBlockOrdering;
  loss_ = std::make_unique<ceres::CauchyLoss>(scale_px);
  for (auto& window : windows_) {
    if (!window->started) {
      window->reference_s = window->t_s[kWindowFrames / 2] + x_[shared::time_offset];
      window->R_reference_c = at_.q_b_c.toRotationMatrix();
    }
    window->q_reference_g = at_.gyro->at(window->reference_s).conjugate();
    if (!window->started) start(*window, x_, scale_px);
    window->started = true;
    for (size_t i = 0; i < window->corners.size(); ++i) {
      for (const Sight& sight : window->corners[i])
        blocks_.push_back(problem_->AddResidualBlock(new Reprojection(at_, *window, sight), loss_.get(),
                                                     numbers_.data(), window->path.data(), window->points + 3 * i));
      ordering->AddElementToGroup(window->points + 3 * i, 0);
    }
    ordering->AddElementToGroup(window->path.data(), 1);
  }
  for (auto& window : windows_) {
    PathPrior prior{};
    for (size_t k = 0; k < kWindowFrames; ++k)
      prior.part[k] = (window->t_s[k] - window->t_s[0]) / (window->t_s.back() - window->t_s[0]);
    blocks_.push_back(
        problem_->AddResidualBlock(new ceres::AutoDiffCostFunction<PathPrior, kPath - 2, kPath>(new PathPrior(prior)),
                                   nullptr, window->path.data()));
  }
  problem_->AddResidualBlock(
      new ceres::AutoDiffCostFunction<SharedPrior, shared::count, shared::count>(new SharedPrior{at_}), nullptr,
      numbers_.data());
  ordering->AddElementToGroup(numbers_.data(), 1);
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(shared::count); ++i)
    if (fixed[static_cast<size_t>(i)]) kept.push_back(i);
  if (!kept.empty()) problem_->SetManifold(numbers_.data(), new ceres::SubsetManifold(shared::count, kept));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.linear_solver_ordering.reset(ordering);
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-6;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // reproducible on any machine
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  if (!summary.IsSolutionUsable()) return false;
  x_ = SharedUnknowns::Map(numbers_.data());
  unknowns = x_;
  measure();
  return true;
}

void CameraImuProblem::measure() {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = blocks_;
  options.apply_loss_function = false;
  std::vector<double> values;
  problem_->Evaluate(options, nullptr, &values, nullptr, nullptr);
  residuals_.clear();
  size_t i = 0;
  for (const auto& window : windows_)
    for (const auto& corner : window->corners)
      for (size_t k = 0; k < corner.size(); ++k, i += 2) residuals_.emplace_back(values[i], values[i + 1]);
}

}  // namespace odograph
