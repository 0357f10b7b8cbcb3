// SPDX-License-Identifier: Apache-2.0
//
// Whether poses err by as much as they say, and what they cost: `odograph bench consistency`.
#include "sdk/cli/bench_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <sys/resource.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "sdk/cli/commands.hpp"
#include "sdk/cli/replayed.hpp"
#include "sdk/cli/runner.hpp"
#include "sdk/core/messages.hpp"

namespace odograph {
namespace {

using Eigen::Matrix2d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double kThreeSigma1 = 9.0, kThreeSigma2 = 11.83;  // 99.73 % of chi-square, one and two degrees of freedom
constexpr double kLargestGap_s = 0.5;                       // of the truth, and of the covariance's floor:
constexpr double kLeastSigma_m = 0.01, kLeastSigma_rad = 1e-3;

struct ConsistencyArguments {
  std::vector<std::string> recordings, configs = {"samples/configs/walk.yaml"};
  double first_s = 1e9;
  bool json = false;
};

struct Poses {
  std::vector<odo_pose> all;
};

void on_event(void* user, const odo_header* event) {
  auto& poses = *static_cast<Poses*>(user);
  const odo_pose& pose = as<odo_pose>(*event);
  if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
  if (!poses.all.empty() && poses.all.back().header.t_ns >= event->t_ns) poses.all.pop_back();  // corrected
  poses.all.push_back(pose);
}

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/// Both for the whole pipeline with its pictures read and decoded.
struct Cost {
  double cpu_s = 0, recorded_s = 0;
};

Result<Poses> run(const Recording& recording, const std::string& config, double first_s, Cost& cost) {
  const auto session = replay_session(config);
  if (!session) return session.failure();
  odo_session* raw = session->get();
  Poses poses;
  const uint32_t wanted[] = {ODO_TYPE_POSE};
  odo_session_set_callback(raw, wanted, 1, on_event, &poses);
  const double before_s = cpu_s();
  const int64_t begin_ns = recording.messages.front().message.header().t_ns;
  for (const RecordedMessage& message : recording.messages) {
    const odo_header& header = message.message.header();
    cost.recorded_s = static_cast<double>(header.t_ns - begin_ns) * kNanoseconds;
    if (cost.recorded_s > first_s) break;
    if (const auto failure = push(raw, message)) return *failure;
  }
  odo_session_flush(raw);
  cost.cpu_s = cpu_s() - before_s;
  return poses;
}

/// Time for which something has been beyond three sigmas without a break.
struct Beyond {
  double longest_s = 0, now_s = 0;
  void see(bool is, double dt_s) {
    now_s = is ? now_s + dt_s : 0;
    longest_s = std::max(longest_s, now_s);
  }
};

/// Against the truth, after the first pose was laid on it: position and heading are known from there.
Json figures_of(const std::vector<odo_pose>& poses, const Trajectory& truth) {
  double position = 0, heading = 0, turn = 0;
  Vector3d moved = Vector3d::Zero();
  size_t n = 0;
  Beyond position_beyond, heading_beyond;
  Trajectory estimate, reference;
  for (const odo_pose& pose : poses) {
    const auto there = pose_at(truth, pose.header.t_ns, kLargestGap_s);
    if (!there) continue;
    const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
    const auto heading_off = [&] {
      const Quaterniond off = there->q * (Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitZ())) * q).conjugate();
      const Eigen::AngleAxisd rotation(off);
      return std::remainder(rotation.angle(), static_cast<double>(2 * EIGEN_PI)) * rotation.axis().z();
    };
    if (estimate.empty()) {
      turn = heading_off();
      moved = there->p - Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * Vector3d(pose.p_n);
    }
    const double dt_s =
        estimate.empty() ? 0 : static_cast<double>(pose.header.t_ns - estimate.back().t_ns) * kNanoseconds;
    estimate.push_back({pose.header.t_ns, q, Vector3d(pose.p_n)});
    reference.push_back(*there);
    const Eigen::AngleAxisd laid(turn, Vector3d::UnitZ());
    const Eigen::Vector2d error = (laid * Vector3d(pose.p_n) + moved - there->p).head<2>();
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(pose.covariance);
    const Eigen::Matrix3d turned = laid * Eigen::Matrix3d(P.block<3, 3>(3, 3)) * laid.inverse().toRotationMatrix();
    const Matrix2d S = Matrix2d(turned.topLeftCorner<2, 2>()) + kLeastSigma_m * kLeastSigma_m * Matrix2d::Identity();
    const double position_2 = error.dot(S.inverse() * error), off = heading_off(),
                 heading_2 = off * off / (P(2, 2) + kLeastSigma_rad * kLeastSigma_rad);
    position += position_2 / 2, heading += heading_2, ++n;
    position_beyond.see(position_2 > kThreeSigma2, dt_s);
    heading_beyond.see(heading_2 > kThreeSigma1, dt_s);
  }
  if (n < 3) return {{"poses", n}};
  const Pairs pairs{reference, estimate};
  double scale = 1, one = 1, path = 0;
  for (size_t i = 1; i < reference.size(); ++i) path += (reference[i].p - reference[i - 1].p).norm();
  const auto errors = absolute_errors(reference, align(pairs, Alignment::yaw, &one)).translation_m;
  align(pairs, Alignment::sim3, &scale);
  return {{"poses", n},
          {"path_m", path},
          {"ape_percent", 100 * statistics_of(errors).rmse / path},
          {"scale_percent", 100 * (1 / scale - 1)},
          {"position_nees", position / static_cast<double>(n)},
          {"heading_nees", heading / static_cast<double>(n)},
          {"position_beyond_s", position_beyond.longest_s},
          {"heading_beyond_s", heading_beyond.longest_s}};
}

int consistency(const ConsistencyArguments& a) {
  Json rows = Json::array();
  if (!a.json)
    std::printf("%-26s %-22s %8s %8s %8s %15s %17s %9s %8s\n%-26s %-22s %8s %8s %8s %15s %17s %9s %8s\n", "recording",
                "config", "path", "APE yaw", "scale", "NEES", "beyond 3 sigma", "times", "peak", "", "", "m", "%", "%",
                "position  head.", "position  head. s", "realtime", "MB");
  for (const std::string& file : a.recordings) {
    const auto recording = read_recording(file, {.true_states = false});
    if (!recording) return complain(recording.failure());
    for (const std::string& config : a.configs) {
      Cost cost;
      const auto poses = run(*recording, config, a.first_s, cost);
      if (!poses) return complain(poses.failure());
      Json row = {{"recording", std::filesystem::path(file).stem().string()},
                  {"config", std::filesystem::path(config).stem().string()}};
      row.update(figures_of(poses->all, recording->truth));
      row["times_realtime"] = cost.cpu_s > 0 ? cost.recorded_s / cost.cpu_s : 0.0;
      row["peak_rss_mb"] = peak_rss_mb();
      rows.push_back(row);
      const auto value = [&](const char* key) { return row.contains(key) ? row[key].get<double>() : std::nan(""); };
      if (a.json) continue;
      std::printf("%-26s %-22s %8.1f %8.2f %+8.2f %8.2f %6.2f %10.1f %6.1f %9.1f %8.0f\n",
                  row["recording"].get<std::string>().substr(0, 26).c_str(),
                  row["config"].get<std::string>().substr(0, 22).c_str(), value("path_m"), value("ape_percent"),
                  value("scale_percent"), value("position_nees"), value("heading_nees"), value("position_beyond_s"),
                  value("heading_beyond_s"), value("times_realtime"), value("peak_rss_mb"));
      std::fflush(stdout);
    }
  }
  if (a.json)
    std::printf("%s\n", rows.dump(2).c_str());
  else
    std::printf(
        "\nNEES: error squared over its covariance, per degree of freedom, mean over the poses, the first of them laid "
        "on\n"
        "the truth; 1 is consistent. beyond 3 sigma: the longest time without a break. times realtime: of one core's "
        "time,\n"
        "pictures decoded. peak: resident, of the process until then.\n");
  return kDone;
}

}  // namespace

void add_bench_consistency(CLI::App& bench, int& status) {
  auto a = std::make_shared<ConsistencyArguments>();
  auto* command = bench.add_subcommand("consistency", "Do poses err by as much as they say; what they cost");
  command->add_option("recordings", a->recordings, "recordings with truth")->required();
  command->add_option("-c,--config", a->configs, "pipeline configs")->capture_default_str();
  command->add_option("--first", a->first_s, "s from the start that are run");
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = consistency(*a); });
}

}  // namespace odograph
