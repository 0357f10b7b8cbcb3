// SPDX-License-Identifier: Apache-2.0
//
// A map of one walk in later sessions: how soon the place is recognised, how well, and whether another place is.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A later walk on the same route.
struct Visit {
  const char* name;
  const char* change;  ///< of the scenario, in YAML
  uint64_t further_seed = 0;
};
constexpr Visit kVisits[] = {
    {"same light", "walker: {height: 1.76 m, speed: 0.7 m/s}\n"},
    {"dusk", "world: {light: 0.15}\nwalker: {speed: 0.7 m/s}\n"},
    {"other phone", "camera: {width: 960, height: 720, focal: 800}\nwalker: {height: 1.60 m, speed: 0.9 m/s}\n"},
    {"elsewhere", "walker: {speed: 0.9 m/s}\n", 1000},
};
constexpr double kWrong_m = 0.3, kWrong_part = 0.1, kWrong_deg = 5;  ///< part: of the distance to what is seen
constexpr double kMark_m = 0.03, kMark_part = 0.01, kMark_deg = 1;   ///< the requirement

Isometry3d isometry(const Vector3d& p, const Eigen::Quaterniond& q) { return Eigen::Translation3d(p) * q; }
bool is_used(const odo_map_pose& place) { return (place.header.flags & ODO_FLAG_ACCEPTED) != 0; }

Isometry3d isometry(const StampedPose& pose) { return isometry(pose.p, pose.q); }

Isometry3d camera_in_body(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION) {
      const auto c = as<odo_calibration>(m.message.header());
      return isometry(Vector3d(c.p_b_c), quaternion(c.q_b_c));
    }
  return Isometry3d::Identity();
}

/// The walk that made a map, with its truth.
class Made {
 public:
  Made(const RunResult& result, const StampedPoses& truth) {
    for (const StampedPose& pose : result.corrected.empty() ? result.track : result.corrected)
      if (const auto there = pose_at(truth, pose.t_ns, 0.1)) poses_.push_back({isometry(pose), isometry(*there)});
  }

  /// Difference of a camera's pose in the map and its true one, both seen from where the map's walk came nearest.
  Isometry3d error(const Isometry3d& in_map, const Isometry3d& truth) const {
    const auto far = [&](const Pair& pair) {
      return (pair.truth.translation() - truth.translation()).norm() +
             2 * Eigen::AngleAxisd(pair.truth.linear().transpose() * truth.linear()).angle();
    };
    const Pair& near =
        *std::min_element(poses_.begin(), poses_.end(), [&](const Pair& a, const Pair& b) { return far(a) < far(b); });
    return (near.estimate.inverse() * in_map).inverse() * (near.truth.inverse() * truth);
  }
  bool empty() const { return poses_.empty(); }

 private:
  struct Pair {
    Isometry3d estimate, truth;
  };
  std::vector<Pair> poses_;
};

struct Visited {
  size_t visits = 0, found = 0, places = 0, within = 0, wrong = 0;
  std::vector<double> after_s, error_m, error_deg;
};

struct MapBenchmark : Benchmark {
  MapBenchmark()
      : Benchmark("map", "A map of one walk in later sessions, in simulated places", kConfigs | kSimulated,
                  {"walk_map"}) {
    options.scenarios = {sample_file("scenarios/map_room.yaml"), sample_file("scenarios/map_street.yaml")};
    variants.clear();
    for (const Visit& visit : kVisits) variants.emplace_back(visit.name);
    variant_label = "visit";
  }
  void add_options(CLI::App& command) override {
    command.add_option("--every", every_s, "time between the starts of two visits, s")->check(CLI::PositiveNumber);
    command.add_option("--length", length_s, "length of a visit, s")->check(CLI::PositiveNumber);
  }

  Result<bool> complete(BenchCase& one) const override {
    const Visit& visit = kVisits[one.variant];
    std::error_code error;
    fs::create_directories(options.keep, error);
    const fs::path scenario = fs::path(options.keep) / (stem_of(one.scenario) + text("-visit%zu.yaml", one.variant));
    std::ofstream(scenario) << "odograph_scenario: 1\nbase: " << fs::absolute(one.scenario).string() << '\n'
                            << visit.change;
    const auto file = simulated_recording(scenario, one.seed + visit.further_seed);
    if (!file) return file.failure();
    one.files.push_back(*file);
    return true;
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& walk) const override {
    const auto scenario = read_scenario(one.scenario);
    if (!scenario) return scenario.failure();
    const auto later = read_recording(one.files[1]);
    if (!later) return later.failure();
    const bool elsewhere = kVisits[one.variant].further_seed != 0;
    const World world(*scenario, one.seed);
    const fs::path map = fs::path(options.keep) /
                         text("map-%zx.odomap", std::hash<std::string>{}(one.files[1].string() + one.run.config));
    RunOptions run = one.run;
    run.map = map.string();
    std::error_code error;
    fs::remove(map, error);
    const auto first = replay(walk, run);
    if (!first) return first.failure();
    const Made made(*first, walk.truth);
    const auto bytes = fs::file_size(map, error);
    if (error || made.empty()) return Failure{ODO_E_STATE, one.run.config + ": the walk makes no map"};
    const fs::path copy = map.string() + "-copy";
    fs::rename(map, copy);
    Visited tally;
    const double all_s = seconds(later->messages.back().message.header().t_ns - first_frame_ns(*later));
    for (double from = 0; from + length_s <= all_s; from += every_s) {
      fs::copy_file(copy, map, fs::copy_options::overwrite_existing);
      if (const auto done = visit(*later, from, run, elsewhere ? nullptr : &made, world, tally); !done)
        return done.failure();
    }
    fs::remove(map), fs::remove(copy);
    return row_of(figures_of(tally, first->key_frames.size(), 1e-6 * static_cast<double>(bytes)));
  }

  static int64_t first_frame_ns(const Recording& recording) {
    for (const RecordedMessage& m : recording.messages)
      if (m.message.header().type == ODO_TYPE_FRAME) return m.message.header().t_ns;
    return 0;
  }

  Result<bool> visit(const Recording& later, double from_s, RunOptions run, const Made* made, const World& world,
                     Visited& tally) const {
    Degradation window;
    window.cut_s = from_s, window.length_s = length_s;
    const Recording part = degraded(later, window, sensor_seed);
    std::optional<double> after_s;
    run.at_frame = [&](odo_session*, const RunResult& so_far) {
      if (after_s || so_far.track.empty() || so_far.map_poses.empty() || !is_used(so_far.map_poses.back())) return;
      after_s = seconds(so_far.track.back().t_ns - first_frame_ns(part));
    };
    const auto result = replay(part, run);
    if (!result) return result.failure();
    ++tally.visits;
    if (after_s) ++tally.found, tally.after_s.push_back(*after_s);
    const Isometry3d T_b_c = camera_in_body(later);
    for (const odo_map_pose& place : result->map_poses) {
      ++tally.places;
      const auto truth = pose_at(later.truth, place.header.t_ns, 0.1);
      if (!made || !truth) {
        tally.wrong += made ? 0 : 1;
        continue;
      }
      const Isometry3d error =
          made->error(isometry(Vector3d(place.p_m_b), quaternion(place.q_m_b)) * T_b_c, isometry(*truth));
      const double m = error.translation().norm(), deg = kDeg_per_rad * Eigen::AngleAxisd(error.linear()).angle();
      const auto ahead = world.look(truth->p, truth->q * Vector3d::UnitZ());
      const double far_m = ahead ? std::min(ahead->distance_m, 30.0) : 30;
      tally.error_m.push_back(m), tally.error_deg.push_back(deg);
      tally.within += m < kMark_m + kMark_part * far_m && deg < kMark_deg ? 1 : 0;
      tally.wrong += m > kWrong_m + kWrong_part * far_m || deg > kWrong_deg ? 1 : 0;
    }
    return true;
  }

  static std::vector<Figure> figures_of(const Visited& t, size_t key_frames, double megabytes) {
    const auto percent = [](size_t part, size_t all) {
      return 100.0 * static_cast<double>(part) / static_cast<double>(std::max<size_t>(1, all));
    };
    const auto soon =
        static_cast<size_t>(std::count_if(t.after_s.begin(), t.after_s.end(), [](double after) { return after <= 4; }));
    return {{"key", "frames", "key_frames", 0, key_frames},
            {"map", "MB", "map_mb", 2, megabytes},
            {"", "visits", "visits", 0, t.visits, kSum},
            {"found", "% in 4 s", "soon_percent", 1, percent(soon, t.visits)},
            {"found", "%", "found_percent", 1, percent(t.found, t.visits)},
            {"after", "s", "after_s", 2, percentile_or_nan(t.after_s, 0.5)},
            {"", "places", "places", 0, t.places, kSum},
            {"error", "cm", "error_cm", 1, 100 * percentile_or_nan(t.error_m, 0.5)},
            {"error", "cm 95 %", "error_95_cm", 1, 100 * percentile_or_nan(t.error_m, 0.95)},
            {"error", "deg", "error_deg", 2, percentile_or_nan(t.error_deg, 0.5)},
            {"within", "%", "within_percent", 1, percent(t.within, t.places)},
            {"", "wrong", "wrong", 0, t.wrong, kSum}};
  }

  std::string heading(const Rows&) const override {
    return text(
        "Sessions of %.0f s, started every %.0f s of a later walk, with the map of the first walk. found: sessions in "
        "which a pose in the\nmap is used, after: the median time from the first picture. error: of each pose in the "
        "map, seen from where the map was made\nnearest to it. within: %.0f cm plus %.0f %% of the distance to what "
        "is seen, and %.0f degree. wrong: more than %.0f cm plus %.0f %%, or\n%.0f degrees; elsewhere, each pose.\n\n",
        length_s, every_s, 100 * kMark_m, 100 * kMark_part, kMark_deg, 100 * kWrong_m, 100 * kWrong_part, kWrong_deg);
  }

  double every_s = 4, length_s = 8;
};

}  // namespace

std::shared_ptr<Benchmark> map_benchmark() { return std::make_shared<MapBenchmark>(); }

}  // namespace odograph
