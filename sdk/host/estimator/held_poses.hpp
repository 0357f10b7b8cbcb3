// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// A pose of the body in the past that is kept because something hangs on it, as it is known now.
struct HeldPose {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  /// Of the small rotation in n and the position, rad and m, squared: of the held pose, of the body now, and held by
  /// now.
  Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> now = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> cross = Eigen::Matrix<double, 6, 6>::Zero();
};

/// The share of a correction that belongs to a place: nothing up to where the position was last known, at `fixed_m` of
/// the path, all of it now, at `now_m`, linearly between: an error that has grown with the path. With no such place,
/// `fixed_m` below 0, all of it everywhere: then it was n that was wrong.
inline double share_of_correction(double held_m, double fixed_m, double now_m) {
  if (fixed_m < 0) return 1.0;
  if (held_m >= now_m) return 1.0;
  return held_m <= fixed_m ? 0.0 : (held_m - fixed_m) / (now_m - fixed_m);
}

namespace inertial {

/// Poses of the past that later measurements go on correcting, though they are no part of what is measured: of each its
/// covariance with the filter's errors is carried (Schmidt 1966; "delayed-state" poses), so that the gain that moves
/// the filter moves them as a filter would that had them among its states, and the filter itself is the same to the bit
/// with and without them. `Size` is the filter's number of errors.
template <int Size>
class HeldPoses {
 public:
  using Rows = Eigen::Matrix<double, 6, Size>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Held {
    uint64_t id = 0;
    int64_t t_ns = 0;
    double path_m = 0;  ///< walked until then
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
    Rows cross = Rows::Zero();      ///< its errors by the filter's
    Matrix6 own = Matrix6::Zero();  ///< its errors by themselves

    /// Its covariance with what a measurement errs by through the filter: cross H'.
    template <class Innovation>
    auto by(const Innovation& innovation) const {
      Eigen::Matrix<double, 6, Innovation::Vector::RowsAtCompileTime> out;
      out.setZero();
      for (int i = 0; i < innovation.count; ++i) {
        const auto& part = innovation.parts[static_cast<size_t>(i)];
        for (int c = 0; c < part.width; ++c) out += cross.col(part.at + c) * part.by.col(c).transpose();
      }
      return out;
    }
  };

  bool empty() const { return held_.empty(); }
  Held& add(Held held) { return held_.emplace_back(std::move(held)); }
  void remove(uint64_t id) {
    std::erase_if(held_, [id](const Held& held) { return held.id == id; });
  }
  const Held* find(uint64_t id) const {
    for (const Held& held : held_)
      if (held.id == id) return &held;
    return nullptr;
  }
  auto begin() { return held_.begin(); }
  auto end() { return held_.end(); }

 private:
  std::vector<Held> held_;
};

}  // namespace inertial
}  // namespace odograph
