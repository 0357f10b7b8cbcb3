// SPDX-License-Identifier: Apache-2.0
//
// Hit tests against the exact geometry of simulated scenes.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <odograph/anchor.h>
#include <odograph/scene.h>

#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kKnownScale = 0.03;  ///< relative sigma of the scale from which on errors are counted
constexpr double kEvery_s = 0.5;      ///< between two looks
constexpr int kColumns = 8, kRows = 6;
constexpr int kTap_looks = 4;        ///< a tap in each so many looks
constexpr double kReach_m = 5;       ///< farther away nobody taps to place something
constexpr double kAround_rad = 0.5;  ///< change of the direction of view after which somebody has walked round a thing

struct Hits {
  std::vector<double> error_m, share, sigma_m, normalised;
  void add(double error, double distance_m, double sigma) {
    error_m.push_back(error), share.push_back(error / distance_m), sigma_m.push_back(sigma);
    normalised.push_back(error / sigma);
  }
};

/// What one scene shows, look by look.
class Looks {
 public:
  Looks(const World& world, const Recording& recording) : world_(world), truth_(recording.truth) {
    for (const RecordedMessage& message : recording.messages)
      if (message.message.header().type == ODO_TYPE_CALIBRATION) lens_ = as<odo_calibration>(message.message.header());
  }

  void look(odo_session* session, const RunResult& so_far) {
    if (so_far.track.empty()) return;
    const int64_t t_ns = so_far.track.back().t_ns;
    if (last_ns_ && seconds(t_ns - *last_ns_) < kEvery_s) return;
    const auto place = pose_at(truth_, t_ns, 0.5);
    odo_pose pose{};
    pose.header.struct_size = sizeof pose;
    if (!place || odo_session_get_pose_of(session, ODO_OF_CAMERA, ODO_WORLD_CORRECTED, t_ns, &pose) != ODO_OK) return;
    if (!(pose.scale > 0)) return;
    passed_s_ += last_ns_ ? seconds(t_ns - *last_ns_) : 0;
    last_ns_ = t_ns;
    const bool known = pose.scale_sigma < kKnownScale * pose.scale;
    bool sees_floor = false;
    for (int k = 0; k < kColumns * kRows; ++k) {
      const double column = (k % kColumns + 0.5) * lens_.width / kColumns;
      const double row = (k / kColumns + 0.5) * lens_.height / kRows;
      const Vector3d direction = Vector3d((column - lens_.cx) / lens_.fx, (row - lens_.cy) / lens_.fy, 1).normalized();
      const auto seen = world_.look(place->p, place->q * direction);
      if (!seen || seen->distance_m > kFarthest_m) continue;
      const double floor_m = place->p.z() + seen->distance_m * (place->q * direction).z();
      sees_floor = sees_floor || (std::abs(seen->normal_n.z()) > 0.99 && floor_m > -0.3);
      seen_ += known ? 1 : 0;
      hit(session, t_ns, direction, *seen, known);
    }
    if (known && sees_floor && !floor_seen_ns_) floor_seen_ns_ = t_ns;
    look_at_taps(session, *place, t_ns);
    if (known && ++known_looks_ % kTap_looks == 1) tap(session, *place, t_ns);
    check_surfaces(session, *place, pose, t_ns);
  }

  Json row() const {
    const double until_floor_s = floor_seen_ns_ && floor_ns_ ? seconds(*floor_ns_ - *floor_seen_ns_) : std::nan("");
    std::vector<Figure> figures = {{"rays", "", "rays", 0, seen_}};
    for (const auto& [name, hits] :
         {std::pair<std::string, const Hits*>{"surfaces", &surfaces_}, {"points", &points_}}) {
      const auto within = [&](double limit) {
        const auto& all = hits->normalised;
        return 100.0 * static_cast<double>(std::count_if(all.begin(), all.end(), [&](double x) { return x < limit; })) /
               static_cast<double>(std::max<size_t>(1, all.size()));
      };
      figures.push_back(
          {name, "% hit", name + "_percent", 1,
           100.0 * static_cast<double>(hits->error_m.size()) / static_cast<double>(std::max<size_t>(1, seen_))});
      figures.push_back({name, "cm", name + "_error_cm", 1, 100 * percentile_or_nan(hits->error_m, 0.5)});
      figures.push_back({name, "% of d", name + "_error_percent", 2, 100 * percentile_or_nan(hits->share, 0.5)});
      figures.push_back({name, "sigma cm", name + "_sigma_cm", 1, 100 * percentile_or_nan(hits->sigma_m, 0.5)});
      figures.push_back({name, "< 3 sigma %", name + "_within_percent", 1, within(3)});
    }
    figures.push_back({"taps", "px", "tap_px", 1, percentile_or_nan(tap_px_, 0.5)});
    figures.push_back({"taps", "px 95 %", "tap_95_px", 1, percentile_or_nan(tap_px_, 0.95)});
    figures.push_back({"taps", "round px", "tap_round_px", 1, percentile_or_nan(tap_round_px_, 0.5)});
    figures.push_back({"taps", "round", "taps_round", 0, tap_round_px_.size()});
    figures.push_back({"floor", "after s", "floor_s", 1, until_floor_s});
    figures.push_back({"false", "surfaces", "false_surfaces", 0, false_.size()});
    figures.push_back({"of", "", "all_surfaces", 0, all_.size()});
    figures.push_back({"in", "s", "passed_s", 0, passed_s_});
    return row_of(figures);
  }

 private:
  static constexpr double kFarthest_m = 30;

  void hit(odo_session* session, int64_t t_ns, const Vector3d& direction, const World::Sight& seen, bool known) {
    odo_ray ray{};
    ray.struct_size = sizeof ray, ray.kind = ODO_RAY_VIEW, ray.t_ns = t_ns;
    ray.wanted = ODO_HIT_SURFACE | ODO_HIT_POINT;
    Vector3d::Map(ray.direction) = direction;
    odo_hit first{};
    first.struct_size = sizeof first;
    uint32_t count = 0;
    if (odo_session_hit_test(session, &ray, &first, 1, &count) != ODO_OK || count == 0) return;
    const double error_m = std::abs(first.distance_m - seen.distance_m);
    Hits& hits = first.what == ODO_HIT_SURFACE ? surfaces_ : points_;
    if (known)
      hits.add(error_m, seen.distance_m, first.sigma_m);
    else
      hits.normalised.push_back(error_m / first.sigma_m);
  }

  /// A surface is false where most of five places on it are on nothing, and the phone is near enough to know.
  void check_surfaces(odo_session* session, const StampedPose& place, const odo_pose& pose, int64_t t_ns) {
    const Eigen::Quaterniond turn = place.q * quaternion(pose.q_n).conjugate();
    const int64_t count = odo_surface_list(session, nullptr, 0);
    std::vector<uint64_t> ids(static_cast<size_t>(std::max<int64_t>(0, count)));
    odo_surface_list(session, ids.data(), ids.size());
    for (const uint64_t id : ids) {
      alignas(8) char bytes[ODO_LARGEST_SURFACE];
      auto& surface = *reinterpret_cast<odo_surface*>(bytes);
      surface.header.struct_size = sizeof bytes;
      if (odo_surface_get(session, id, ODO_WORLD_CORRECTED, &surface) != ODO_OK) continue;
      all_.insert(id);
      const bool fine = surface.kind == ODO_SURFACE_FLOOR && surface.sigma_m < 0.05;
      if (fine && floor_seen_ns_ && !floor_ns_) floor_ns_ = t_ns;
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (uint32_t i = 0; i < surface.count; ++i) middle += vertex(surface, i) / surface.count;
      int on = 0, places = 0;
      const auto test = [&](const Eigen::Vector2d& at) {
        const Vector3d p_n = quaternion(surface.q_n) * Vector3d(at.x(), at.y(), 0) + Vector3d(surface.p_n);
        const Vector3d p = place.p + turn * (p_n - Vector3d(pose.p_n));
        const Vector3d normal = turn * (quaternion(surface.q_n) * Vector3d::UnitZ());
        const double far_m = (p - place.p).norm(),
                     within =
                         3 * std::hypot(surface.sigma_m, std::max(0.02, pose.scale_sigma / pose.scale) * far_m) + 0.03;
        const auto below = world_.look(p + within * normal, -normal, 0);
        ++places;
        on += below && below->distance_m < 2 * within ? 1 : 0;
      };
      test(middle);
      for (uint32_t i = 0; i < 4; ++i) test(0.5 * (middle + vertex(surface, i * surface.count / 4)));
      const double far_m = (Vector3d(surface.p_n) - Vector3d(pose.p_n)).norm();
      if (2 * on < places && far_m < kFarthest_m / 3) false_.insert(id);
    }
  }

  /// A thing that somebody has put down: its anchor, and what the pixel really showed.
  struct Tap {
    uint64_t anchor;
    Vector3d p, from;  ///< true place and the direction from the camera to it
  };

  /// Taps the middles of the quarters of the picture: an anchor at the first hit of each.
  void tap(odo_session* session, const StampedPose& place, int64_t t_ns) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      odo_ray ray{};
      ray.struct_size = sizeof ray, ray.kind = ODO_RAY_VIEW, ray.t_ns = t_ns;
      const double column = (0.25 + 0.5 * (quarter % 2)) * lens_.width,
                   row = (0.25 + 0.5 * (quarter / 2)) * lens_.height;
      const Vector3d to = Vector3d((column - lens_.cx) / lens_.fx, (row - lens_.cy) / lens_.fy, 1).normalized();
      Vector3d::Map(ray.direction) = to;
      const auto seen = world_.look(place.p, place.q * to);
      if (!seen || seen->distance_m > kReach_m) continue;
      odo_hit hit{};
      hit.struct_size = sizeof hit;
      uint32_t count = 0;
      if (odo_session_hit_test(session, &ray, &hit, 1, &count) != ODO_OK || count == 0) continue;
      odo_anchor_place put{};
      put.struct_size = sizeof put, put.kind = ODO_ANCHOR_HIT, put.t_ns = t_ns;
      std::copy_n(hit.q_n, 4, put.q);
      std::copy_n(hit.p_n, 3, put.p);
      put.surface = hit.surface, put.sigma_m = hit.sigma_m;
      uint64_t id = 0;
      if (odo_anchor_create(session, &put, &id) == ODO_OK)
        taps_.push_back({id, place.p + seen->distance_m * (place.q * to), place.q * to});
    }
  }

  /// How far on the screen each thing is from where it was put, where that is in view.
  void look_at_taps(odo_session* session, const StampedPose& place, int64_t t_ns) {
    const auto pixel_of = [&](const Vector3d& p_c) {
      return Eigen::Vector2d(lens_.cx + lens_.fx * p_c.x() / p_c.z(), lens_.cy + lens_.fy * p_c.y() / p_c.z());
    };
    for (const Tap& tap : taps_) {
      const Vector3d truth = place.q.conjugate() * (tap.p - place.p);
      if (truth.z() < 0.2) continue;
      const Eigen::Vector2d there = pixel_of(truth);
      if (there.x() < 0 || there.y() < 0 || there.x() >= lens_.width || there.y() >= lens_.height) continue;
      const Vector3d to = (tap.p - place.p).normalized();
      const auto seen = world_.look(place.p, to);
      constexpr double kHidden_m = 0.02;
      if (!seen || seen->distance_m < truth.norm() - kHidden_m) continue;
      odo_anchor anchor{};
      anchor.struct_size = sizeof anchor;
      if (odo_anchor_get(session, tap.anchor, ODO_WORLD_CORRECTED, t_ns, &anchor) != ODO_OK) continue;
      if (!(anchor.flags & ODO_ANCHOR_VIEW_POSE) || !(anchor.p_view[2] > 0)) continue;
      const double off_px = (pixel_of(Vector3d(anchor.p_view)) - there).norm();
      tap_px_.push_back(off_px);
      if (to.dot(tap.from) < std::cos(kAround_rad)) tap_round_px_.push_back(off_px);
    }
  }

  static Eigen::Vector2d vertex(const odo_surface& surface, uint32_t i) {
    const odo_vertex* found = ODO_VERTEX_AT(&surface, i);
    return found ? Eigen::Vector2d(static_cast<double>(found->p[0]), static_cast<double>(found->p[1]))
                 : Eigen::Vector2d::Zero().eval();
  }

  const World& world_;
  const StampedPoses& truth_;
  odo_calibration lens_{};
  std::optional<int64_t> last_ns_, floor_seen_ns_, floor_ns_;
  double passed_s_ = 0;
  size_t seen_ = 0, known_looks_ = 0;
  std::vector<Tap> taps_;
  std::vector<double> tap_px_, tap_round_px_;
  Hits surfaces_, points_;
  std::set<uint64_t> all_, false_;
};

struct Surfaces : Benchmark {
  Surfaces()
      : Benchmark("surfaces", "Hit tests on surfaces and landmarks against the exact distance, in simulated scenes",
                  kConfigs | kSimulated, {"walk"}) {
    options.scenarios.clear();
    for (const char* scene : {"room", "street", "stairs", "round"})
      options.scenarios.push_back(sample_file(text("scenarios/surfaces_%s.yaml", scene)));
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    const auto scenario = read_scenario(one.scenario);
    if (!scenario) return scenario.failure();
    const World world(*scenario, one.seed);
    Looks looks(world, recording);
    RunOptions run = one.run;
    run.at_frame = [&](odo_session* session, const RunResult& so_far) { looks.look(session, so_far); };
    const auto result = replay(recording, run);
    if (!result) return result.failure();
    return looks.row();
  }

  std::string heading(const Rows&) const override {
    return text(
        "Rays through %d pixels every %.1f s: the nearest hit on a surface or a landmark against the exact distance, "
        "once the scale's\nstated sigma is below 3 %%; medians. < 3 sigma: share of all hits, also before that. floor: "
        "from seeing it until its sigma is\nbelow 5 cm. false: surfaces most of which are on nothing. taps: how far "
        "things put down within %.0f m are from "
        "there on the screen,\nand so when seen from a direction that differs by %.0f degrees.\n\n",
        kColumns * kRows, kEvery_s, kReach_m, kDeg_per_rad * kAround_rad);
  }
};

}  // namespace

std::shared_ptr<Benchmark> surfaces_benchmark() { return std::make_shared<Surfaces>(); }

}  // namespace odograph
