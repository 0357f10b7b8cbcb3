// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/reference_poses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLongest_s = 0.25;  // maximum interval between poses compared with the gyroscope
constexpr size_t kMinPoses = 50;
constexpr double kPlain = 3;  // minimum ratio of the wrong frame's disagreement to the right one's

struct Extrinsics {
  Quaterniond q_b_c;
  Vector3d p_b_c;
};

std::optional<Extrinsics> extrinsics_of(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_CALIBRATION) continue;
    const auto& c = as<odo_calibration>(m.message.header());
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) return Extrinsics{raw_quaternion(c.q_b_c), Vector3d(c.p_b_c)};
  }
  return std::nullopt;
}

struct Rate {
  int64_t t_ns;
  Vector3d rate_b;
};

std::vector<Rate> rates_of(const Recording& recording) {
  std::vector<Rate> rates;
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_IMU && (m.message.header().flags & ODO_IMU_GYRO))
      rates.push_back({m.message.header().t_ns, Vector3d(as<odo_imu>(m.message.header()).gyro_b)});
  return rates;
}

/// Median over pairs of neighbouring poses, rad: their rotation in their own axes minus the gyroscope's in the axes x
/// to which `q_x_b` maps b. NaN if too few pairs have samples.
double disagreement(const StampedPoses& poses, const std::vector<Rate>& rates, const Quaterniond& q_x_b) {
  std::vector<double> off_rad;
  auto sample = rates.begin();
  for (size_t i = 1; i < poses.size(); ++i) {
    const int64_t from = poses[i - 1].t_ns, to = poses[i].t_ns;
    const double seconds = odograph::seconds(to - from);
    Vector3d sum = Vector3d::Zero();
    double count = 0;
    while (sample != rates.end() && sample->t_ns < from) ++sample;
    for (; sample != rates.end() && sample->t_ns < to; ++sample, ++count) sum += sample->rate_b;
    if (count == 0 || seconds > kLongest_s) continue;
    off_rad.push_back((log_rotation(poses[i - 1].q.conjugate() * poses[i].q) - q_x_b * (seconds / count * sum)).norm());
  }
  return off_rad.size() < kMinPoses ? std::nan("") : percentile(off_rad, 0.5);
}

}  // namespace

Result<StampedPoses> read_reference(const std::filesystem::path& tum, const std::string& frame,
                                    const Recording& recording) {
  auto poses = read_tum(tum);
  if (!poses) return poses;
  std::stable_sort(poses->begin(), poses->end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.t_ns < b.t_ns; });
  const auto mount = extrinsics_of(recording);
  const bool body = frame == "body";
  if (body && !mount)
    return Failure{ODO_E_DATA, recording.path.string() + ": without camera-IMU extrinsics the poses of a body in " +
                                   tum.string() + " do not determine its camera's poses"};
  if (mount) {
    const auto rates = rates_of(recording);
    const double as_body = disagreement(*poses, rates, Quaterniond::Identity()),
                 as_camera = disagreement(*poses, rates, mount->q_b_c.conjugate());
    if (body ? as_body > kPlain * as_camera : as_camera > kPlain * as_body)
      return Failure{ODO_E_ARGUMENT, tum.string() + ": by the gyroscope these poses are the " +
                                         (body ? "camera's" : "body's") + "; use --reference-frame " +
                                         (body ? "camera" : "body")};
  }
  if (body)
    for (StampedPose& x : *poses) x.p += x.q * mount->p_b_c, x.q = (x.q * mount->q_b_c).normalized();
  return poses;
}

}  // namespace odograph
