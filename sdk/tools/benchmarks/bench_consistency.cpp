// SPDX-License-Identifier: Apache-2.0
//
// Whether poses err by as much as they say, and what they cost: `odograph bench consistency`.
#include "sdk/tools/benchmarks/bench_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>

#include <sys/resource.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

using Eigen::Matrix2d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double kThreeSigma1 = 9.0, kThreeSigma2 = 11.83;  // 99.73 % of chi-square, one and two degrees of freedom
constexpr double kLargestGap_s = 0.5;                       // of the truth, and of the covariance's floor:
constexpr double kMinSigma_m = 0.01, kMinSigma_rad = 1e-3;

struct ConsistencyArguments {
  std::vector<std::string> recordings, configs = {"samples/configs/walk.yaml"};
  double first_s = 1e9, marks_sigma_m = 0, marks_every_s = 20;
  uint64_t seed = 1;  ///< of the marks' errors, and of worse sensors
  bool sensors = false, json = false;
};

/// What brings a track onto the truth, about the vertical.
struct Laid {
  double yaw_rad = 0;
  Vector3d moved = Vector3d::Zero();

  double heading_off(const Quaterniond& estimate, const Quaterniond& truth) const {
    const Eigen::AngleAxisd off(truth *
                                (Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())) * estimate).conjugate());
    return std::remainder(off.angle(), static_cast<double>(2 * EIGEN_PI)) * off.axis().z();
  }
  Vector3d on_truth(const Vector3d& p) const { return Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()) * p + moved; }
  Vector3d on_track(const Vector3d& p) const {
    return Eigen::AngleAxisd(-yaw_rad, Vector3d::UnitZ()) * Vector3d(p - moved);
  }
};

Laid lay(const odo_pose& pose, const StampedPose& truth) {
  Laid laid;
  laid.yaw_rad = laid.heading_off(Quaterniond(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]), truth.q);
  laid.moved = truth.p - laid.on_truth(Vector3d(pose.p_n));
  return laid;
}

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

/// Places told to the session from its first metric pose on, in the frame of its track, with an error of their own.
class Marks {
 public:
  Marks(const ConsistencyArguments& a, const Trajectory& truth) : a_(a), truth_(truth), random_(a.seed) {}

  std::optional<Failure> tell(odo_session* session, const Poses& poses, int64_t t_ns) {
    if (a_.marks_sigma_m <= 0 || poses.all.empty() || t_ns < next_ns_) return std::nullopt;
    const auto there = pose_at(truth_, t_ns, kLargestGap_s);
    if (!there) return std::nullopt;
    if (!laid_) {
      const auto first = pose_at(truth_, poses.all.front().header.t_ns, kLargestGap_s);
      if (!first) return std::nullopt;
      laid_ = lay(poses.all.front(), *first);
    } else {
      odo_waypoint mark{};
      mark.header = {sizeof(odo_waypoint), ODO_TYPE_WAYPOINT, t_ns, 0, 0, 0.0F, 0};
      Eigen::Map<Vector3d> p(mark.p_n);
      p = laid_->on_track(there->p);
      for (int i = 0; i < 3; ++i) p[i] += a_.marks_sigma_m * normal_(random_);
      mark.sigma_m = a_.marks_sigma_m;
      if (const int32_t status = odo_session_push(session, &mark.header); status != ODO_OK)
        return Failure{status, "a mark was not taken"};
    }
    next_ns_ = t_ns + static_cast<int64_t>(a_.marks_every_s * 1e9);
    return std::nullopt;
  }

 private:
  const ConsistencyArguments& a_;
  const Trajectory& truth_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::optional<Laid> laid_;
  int64_t next_ns_ = INT64_MIN;
};

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

Result<Poses> run(const ConsistencyArguments& a, const Recording& recording, const std::string& config, Cost& cost) {
  const auto session = replay_session(config);
  if (!session) return session.failure();
  odo_session* raw = session->get();
  Poses poses;
  const uint32_t wanted[] = {ODO_TYPE_POSE};
  odo_session_set_callback(raw, wanted, 1, on_event, &poses);
  Marks marks(a, recording.truth);
  const double before_s = cpu_s();
  const int64_t begin_ns = recording.messages.front().message.header().t_ns;
  for (const RecordedMessage& message : recording.messages) {
    const odo_header& header = message.message.header();
    cost.recorded_s = static_cast<double>(header.t_ns - begin_ns) * kNanoseconds;
    if (cost.recorded_s > a.first_s) break;
    if (a.marks_sigma_m > 0 && header.type == ODO_TYPE_WAYPOINT) continue;  // the scenario's own
    if (const auto failure = marks.tell(raw, poses, header.t_ns)) return *failure;
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
  double position = 0, heading = 0;
  Laid laid;
  size_t n = 0;
  Beyond position_beyond, heading_beyond;
  Trajectory estimate, reference;
  for (const odo_pose& pose : poses) {
    const auto there = pose_at(truth, pose.header.t_ns, kLargestGap_s);
    if (!there) continue;
    const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
    if (estimate.empty()) laid = lay(pose, *there);
    const double dt_s =
        estimate.empty() ? 0 : static_cast<double>(pose.header.t_ns - estimate.back().t_ns) * kNanoseconds;
    estimate.push_back({pose.header.t_ns, q, Vector3d(pose.p_n)});
    reference.push_back(*there);
    const Eigen::Vector2d error = (laid.on_truth(Vector3d(pose.p_n)) - there->p).head<2>();
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(pose.covariance);
    const Eigen::AngleAxisd rotation(laid.yaw_rad, Vector3d::UnitZ());
    const Eigen::Matrix3d turned =
        rotation * Eigen::Matrix3d(P.block<3, 3>(3, 3)) * rotation.inverse().toRotationMatrix();
    const Matrix2d S = Matrix2d(turned.topLeftCorner<2, 2>()) + kMinSigma_m * kMinSigma_m * Matrix2d::Identity();
    const double position_2 = error.dot(S.inverse() * error), off = laid.heading_off(q, there->q),
                 heading_2 = off * off / (P(2, 2) + kMinSigma_rad * kMinSigma_rad);
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

constexpr const char* kFigures[] = {"path_m",           "ape_percent",    "scale_percent",
                                    "position_nees",    "heading_nees",   "position_beyond_s",
                                    "heading_beyond_s", "times_realtime", "peak_rss_mb"};

void print_row(const std::string& name, const Json& row) {
  double v[std::size(kFigures)];
  for (size_t i = 0; i < std::size(kFigures); ++i)
    v[i] = row.contains(kFigures[i]) ? row[kFigures[i]].get<double>() : std::nan("");
  std::printf("%-30s %-22s %8.1f %8.2f %+8.2f %8.2f %6.2f %10.1f %6.1f %9.1f %8.0f\n", name.substr(0, 30).c_str(),
              row["config"].get<std::string>().substr(0, 22).c_str(), v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7],
              v[8]);
  std::fflush(stdout);
}

/// Over the runs of a config: means, but of the times the longest, and of the scale the mean size.
Json summary_of(const Json& rows, const std::string& config) {
  Json all = {{"config", config}};
  for (const char* figure : kFigures) {
    const std::string name(figure);
    const bool longest = name.ends_with("beyond_s") || name == "peak_rss_mb";
    double sum = 0, most = 0, n = 0;
    for (const Json& row : rows)
      if (row["config"] == config && row.contains(name)) {
        const double value = std::abs(row[name].get<double>());
        sum += value, most = std::max(most, value), ++n;
      }
    if (n > 0) all[name] = longest ? most : sum / n;
  }
  return all;
}

std::string stem_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }

int consistency(const ConsistencyArguments& a) {
  Json rows = Json::array();
  if (!a.json)
    std::printf("%-30s %-22s %8s %8s %8s %15s %17s %9s %8s\n%-30s %-22s %8s %8s %8s %15s %17s %9s %8s\n", "recording",
                "config", "path", "APE yaw", "scale", "NEES", "beyond 3 sigma", "times", "peak", "", "", "m", "%", "%",
                "position  head.", "position  head. s", "realtime", "MB");
  const std::vector<Degradation> variants = a.sensors ? sensor_qualities() : std::vector<Degradation>{{}};
  for (const std::string& file : a.recordings) {
    const auto recording = read_recording(file, {.true_states = false});
    if (!recording) return complain(recording.failure());
    for (const Degradation& variant : variants) {
      std::optional<Recording> worse;
      if (!variant.name.empty()) worse = degraded(*recording, variant, a.seed);
      for (const std::string& config : a.configs) {
        Cost cost;
        const auto poses = run(a, worse ? *worse : *recording, config, cost);
        if (!poses) return complain(poses.failure());
        Json row = {{"recording", stem_of(file)}, {"config", stem_of(config)}};
        if (!variant.name.empty()) row["sensors"] = variant.name;
        row.update(figures_of(poses->all, recording->truth));
        row["times_realtime"] = cost.cpu_s > 0 ? cost.recorded_s / cost.cpu_s : 0.0;
        row["peak_rss_mb"] = peak_rss_mb();
        rows.push_back(row);
        if (!a.json) print_row(variant.name.empty() ? stem_of(file) : variant.name, row);
      }
    }
  }
  if (a.json) {
    std::printf("%s\n", rows.dump(2).c_str());
    return kDone;
  }
  if (a.recordings.size() > 1)
    for (const std::string& config : a.configs) print_row("mean, longest", summary_of(rows, stem_of(config)));
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
  command->add_option(
      "--marks", a->marks_sigma_m,
      "tell the session where it is, with errors of so many m on each axis; the config has fix/waypoint "
      "with `use: all`");
  command->add_option("--every", a->marks_every_s, "s between two of --marks")->capture_default_str();
  command->add_flag("--sensors", a->sensors,
                    "each recording as it is and with one fault of the sensors after the other");
  command->add_option("--seed", a->seed, "of the errors of --marks and --sensors")->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = consistency(*a); });
}

}  // namespace odograph
