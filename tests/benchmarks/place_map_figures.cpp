// SPDX-License-Identifier: Apache-2.0
//
// Figures of fix/map's recognition: maps from the landmarks of a replayed recording, queries from recordings or
// rendered in simulated worlds. Prints one line per query; place_map_figures.py sums them up.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <numbers>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/map/key_frame_chooser.hpp"
#include "plugins/fix/map/map_section.hpp"
#include "plugins/fix/map/place_map.hpp"
#include "plugins/fix/map/place_session.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/replay/picture_source.hpp"
#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/simulation/world.hpp"
#include "tests/benchmarks/place_map_shots.hpp"

namespace {

using namespace odograph;
using namespace odograph::place_map;
using Eigen::Quaterniond;
using Eigen::Vector3d;

double milliseconds(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// One line per query: what the best candidate is and what speaks for it.
class Printer {
 public:
  explicit Printer(const std::map<uint64_t, Rigid>& places) : places_(places) {}

  /// `truth`: of the query in the frame of `places`, nothing if it is elsewhere.
  void query(const std::string& name, const PlaceMap& map, const Picture& picture, const std::optional<Rigid>& truth,
             const PlaceMap::Excludes& excludes = {}) {
    std::vector<PlaceMap::Candidate> found;
    QueryView view;
    const double ms = milliseconds([&] {
      view = view_of(picture, map.parameters().features);
      found = map.candidates(view, excludes);
    });
    std::printf("%s %.3f ms=%.1f", name.c_str(), 1e-9 * static_cast<double>(picture.t_ns), ms);
    if (found.empty() || !found[0].verified) {
      std::printf(" none\n");
      return;
    }
    const auto& best = found[0];
    const Evidence& e = best.verified->evidence;
    const KeyFrame& frame = map.key_frames()[best.frame];
    const Evidence second = found.size() > 1 && found[1].verified ? found[1].verified->evidence : Evidence();
    std::printf(
        " kf=%llu votes=%.1f tentative=%d inliers=%d icells=%d visible=%d matched=%d cells=%d chance=%.1f "
        "chance2=%.1f",
        static_cast<unsigned long long>(frame.id), best.votes, e.tentative, e.inliers, e.inlier_cells, e.visible,
        e.matched, e.cells, e.log_chance, second.log_chance);
    const auto recognition = map.best_of(view, found);
    std::printf(" off=%d covered=%.2f odds=%.1f runner_up=%.1f accepted=%d plausible=%d", e.off_plane, e.covered,
                recognition->log_odds, recognition->runner_up, map.is_accepted(*recognition) ? 1 : 0,
                map.is_plausible(*recognition) ? 1 : 0);
    if (truth) {
      const Rigid& place = places_.at(frame.id);
      const Rigid T_k_c = place.inverse() * *truth, estimate = best.verified->T_c_k.inverse();
      const double range = map_range(frame);
      Eigen::Matrix<double, 6, 1> error;
      error << log_rotation(estimate.q * T_k_c.q.conjugate()), estimate.p - T_k_c.p;
      std::printf(" nees=%.2f", error.dot(recognition->covariance.ldlt().solve(error)) / 6);
      std::printf(" error_m=%.3f error_deg=%.2f range=%.2f moved=%.2f", (estimate.p - T_k_c.p).norm(),
                  180 / std::numbers::pi * estimate.q.angularDistance(T_k_c.q), range, T_k_c.p.norm());
    }
    std::printf("\n");
  }

 private:
  static double map_range(const KeyFrame& frame) {
    std::vector<float> d;
    for (const auto& l : frame.landmarks) d.push_back(Eigen::Vector3f::Map(l.p_k.data()).norm());
    std::nth_element(d.begin(), d.begin() + static_cast<long>(d.size() / 2), d.end());
    return static_cast<double>(d[d.size() / 2]);
  }
  const std::map<uint64_t, Rigid>& places_;
};

struct Made {
  PlaceMap map;
  std::map<uint64_t, Rigid> places;  // the key frames' true poses; estimated ones without a truth
  std::vector<Shot> shots;           // some of the frames
};

bool make(const std::string& file, const std::string& config, double shots_each_s, Made& made) {
  const auto recording = read_recording(file);
  if (!recording) return std::fprintf(stderr, "%s\n", recording.failure().text.c_str()), false;
  KeyFrameChooser chooser;
  int64_t last_ns = INT64_MIN / 2;
  double add_ms = 0;
  size_t landmarks = 0;
  Collector collector(*recording, [&](Shot&& shot) {
    if (shot.scale_sigma < 0.1 && chooser.choose(shot.picture.t_ns, shot.T_n_c, shot.landmarks)) {
      uint64_t id = 0;
      add_ms += milliseconds([&] { id = made.map.add(shot.picture, shot.landmarks, shot.T_n_c, 0, shot.scale_sigma); });
      if (id) made.places[id] = shot.truth.value_or(shot.T_n_c), landmarks += made.map.find(id)->landmarks.size();
    }
    if (static_cast<double>(shot.picture.t_ns - last_ns) < 1e9 * shots_each_s) return;
    last_ns = shot.picture.t_ns;
    made.shots.push_back(std::move(shot));
  });
  if (!collector.run(config)) return false;
  const auto count = static_cast<double>(std::max<size_t>(1, made.map.key_frames().size()));
  std::fprintf(stderr, "%s: %zu key frames, %.0f landmarks and %.0f bytes each, %.1f ms to add, %zu frames\n",
               file.c_str(), made.map.key_frames().size(), static_cast<double>(landmarks) / count,
               static_cast<double>(made.map.bytes()) / count, add_ms / count, made.shots.size());
  return true;
}

/// Views of a simulated world, near the places of a map.
class Views {
 public:
  Views(const Scenario& scenario, uint64_t seed) : scenario_(scenario), world_(scenario, seed) {}

  Picture render(const Rigid& T_n_c, double light, const Scenario::Camera& with, uint64_t number) const {
    Scenario scenario = scenario_;
    scenario.camera = with, scenario.world.light = light;
    const SimCamera camera(scenario.camera, light, number);
    const Motion still(1, {T_n_c.p}, {(T_n_c.q * camera.in_body().conjugate()).normalized()});
    View view(world_, camera, scenario);
    Picture picture;
    picture.grey = camera.develop(view.render(still, 0, 0), number);
    picture.t_ns = static_cast<int64_t>(number) * 1'000'000'000;
    picture.lens.fx = picture.lens.fy = with.focal_px, picture.lens.cx = camera.cx(), picture.lens.cy = camera.cy();
    picture.lens.coefficients = with.distortion;
    if (with.model == "kannala_brandt") picture.lens.distortion = CameraModel::Distortion::kannala_brandt;
    picture.down_c = T_n_c.q.conjugate() * Vector3d::UnitZ();
    return picture;
  }
  const World& world() const { return world_; }

 private:
  Scenario scenario_;
  World world_;
};

/// Pictures of files in a map, held upright by a lens of 60 degrees.
void photographs(const PlaceMap& map, const std::vector<std::string>& paths, Printer& printer) {
  for (const std::string& path : paths) {
    const auto pictures = pictures_of(path);
    if (!pictures) {
      std::fprintf(stderr, "%s\n", pictures.failure().text.c_str());
      continue;
    }
    for (const PictureSource& source : *pictures) {
      Picture picture;
      picture.grey = source.grey();
      if (picture.grey.empty()) continue;
      picture.lens.fx = picture.lens.fy = 0.87 * std::max(picture.grey.cols, picture.grey.rows);
      picture.lens.cx = 0.5 * (picture.grey.cols - 1), picture.lens.cy = 0.5 * (picture.grey.rows - 1);
      picture.tilt_sigma_rad = 0.05;
      printer.query("photo", map, picture, std::nullopt);
    }
  }
}

struct SimulatedOptions {
  std::string scenario, recording, config;
  uint64_t seed = 1, other_seed = 0;
  size_t queries = 100, visits = 0;
  double light = 1, tilt_sigma_rad = 0.005, aside_m = 0.5, yaw_rad = 0.25;
  std::string other_lens;
  bool landmarks = false;
};

Scenario::Camera camera_of(const Scenario& scenario, const std::string& lens) {
  Scenario::Camera camera = scenario.camera;
  camera.stabiliser = {}, camera.focus = {};
  if (lens == "wide") camera.width = 800, camera.height = 600, camera.focal_px = 450;
  if (lens == "tele") camera.width = 960, camera.height = 720, camera.focal_px = 950;
  if (lens == "portrait") camera.width = 480, camera.height = 640, camera.focal_px = 520;
  if (lens == "fisheye")
    camera.model = "kannala_brandt", camera.distortion = {0.01, -0.005, 0.001, 0}, camera.focal_px = 380;
  return camera;
}

/// Looks at a simulated world from near the places of a map.
class Visitor {
 public:
  Visitor(const SimulatedOptions& o, const Scenario& scenario, const Made& made)
      : o_(o),
        views_(scenario, o.other_seed ? o.other_seed : o.seed),
        camera_(camera_of(scenario, o.other_lens)),
        made_(made),
        random_(o.seed, 4711) {
    for (const auto& [id, place] : made.places) places_.push_back(place);
  }

  Rigid place() {
    const Rigid& place = places_[random_.next() % places_.size()];
    const Quaterniond yaw(Eigen::AngleAxisd(o_.yaw_rad * random_.normal(), Vector3d::UnitZ()));
    const Quaterniond nod(Eigen::AngleAxisd(0.1 * random_.normal(), Vector3d::UnitX()));
    const Quaterniond roll(Eigen::AngleAxisd(0.1 * random_.normal(), Vector3d::UnitZ()));
    Rigid at{(yaw * place.q * nod * roll).normalized(), place.p};
    const double north = random_.normal(), east = random_.normal(), down = random_.normal();
    at.p += Vector3d(o_.aside_m * north, o_.aside_m * east, 0.1 * down);
    return at;
  }

  Picture look(const Rigid& at) {
    Picture picture = views_.render(at, o_.light, camera_, ++number_);
    const double pitch = random_.normal(), other = random_.normal();
    const Vector3d tilt(o_.tilt_sigma_rad * pitch, o_.tilt_sigma_rad * other, 0);
    picture.down_c = exp_rotation(tilt) * picture.down_c, picture.tilt_sigma_rad = std::max(0.003, o_.tilt_sigma_rad);
    return picture;
  }

  /// Distances of the map's landmarks over the exact ones, of each key frame.
  void landmarks() const {
    for (const KeyFrame& frame : made_.map.key_frames()) {
      const Rigid& place = made_.places.at(frame.id);
      std::vector<double> ratios;
      int beyond = 0;
      for (const KeptLandmark& one : frame.landmarks) {
        const Vector3d p_k = Eigen::Vector3f::Map(one.p_k.data()).cast<double>();
        const auto seen = views_.world().look(place.p, place.q * p_k.normalized());
        if (!seen) continue;
        ratios.push_back(p_k.norm() / seen->distance_m);
        beyond += std::abs(p_k.norm() - seen->distance_m) > 3 * static_cast<double>(one.along_sigma);
      }
      if (ratios.empty()) continue;
      std::sort(ratios.begin(), ratios.end());
      const auto quantile = [&](size_t percent) { return ratios[(ratios.size() - 1) * percent / 100]; };
      std::printf("landmarks kf=%llu n=%zu beyond=%d q10=%.2f q50=%.2f q90=%.2f\n",
                  static_cast<unsigned long long>(frame.id), ratios.size(), beyond, quantile(10), quantile(50),
                  quantile(90));
    }
  }

  /// A single picture.
  void query(Printer& printer) {
    const Rigid at = place();
    const Picture picture = look(at);
    std::printf("d=%.2f ", ahead_m(at));
    printer.query("sim", made_.map, picture, o_.other_seed ? std::nullopt : std::optional(at));
  }

  /// Somebody who starts in a loaded map and looks for some seconds, with a hand that turns to and fro by 0.2 rad and
  /// moves by 0.15 m a second.
  void visit(const std::vector<uint8_t>& map) {
    PlaceSession session(PlaceMapParameters(), PlaceSession::Parameters(), false);
    session.load(1, map);
    const Rigid start = place();
    const double turn = 0.2 * random_.normal(), north = 0.15 * random_.normal(), east = 0.15 * random_.normal();
    const double ahead = ahead_m(start);
    for (int64_t i = 0; i <= 7; ++i) {
      const double t = 0.5 * static_cast<double>(i);
      const Quaterniond yaw(Eigen::AngleAxisd(turn * std::sin(2 * t), Vector3d::UnitZ()));
      const Rigid at{(yaw * start.q).normalized(), start.p + t * Vector3d(north, east, 0)};
      Sight sight;
      if (i < 7) sight.picture = look(at);
      sight.picture.t_ns = i * 500'000'000, sight.T_n_c = at;
      if (i < 7) session.see(std::move(sight));
      for (const Found& found : session.take(i * 500'000'000)) return report(found, t, ahead, start, turn, north, east);
    }
    std::printf("visit d=%.2f found=0\n", ahead);
  }

 private:
  double ahead_m(const Rigid& at) const {
    const auto ahead = views_.world().look(at.p, at.q * Vector3d::UnitZ());
    return ahead ? ahead->distance_m : 99.0;
  }
  void report(const Found& found, double after, double ahead, const Rigid& start, double turn, double north,
              double east) const {
    const double t = 1e-9 * static_cast<double>(found.t_ns);
    const Quaterniond yaw(Eigen::AngleAxisd(turn * std::sin(2 * t), Vector3d::UnitZ()));
    const Rigid at{(yaw * start.q).normalized(), start.p + t * Vector3d(north, east, 0)};
    const auto far = [&](const KeyFrame& frame) {
      return (frame.T_m_k.p - found.T_x_c.p).norm() + 2 * frame.T_m_k.q.angularDistance(found.T_x_c.q);
    };
    const auto& frames = made_.map.key_frames();
    const KeyFrame& near = *std::min_element(frames.begin(), frames.end(),
                                             [&](const KeyFrame& a, const KeyFrame& b) { return far(a) < far(b); });
    const Rigid error = (near.T_m_k.inverse() * found.T_x_c).inverse() * (made_.places.at(near.id).inverse() * at);
    std::printf("visit d=%.2f found=1 after=%.1f error_m=%.3f error_deg=%.2f\n", ahead, after, error.p.norm(),
                180 / std::numbers::pi * error.q.angularDistance(Quaterniond::Identity()));
  }

  const SimulatedOptions& o_;
  Views views_;
  Scenario::Camera camera_;
  const Made& made_;
  Random random_;
  std::vector<Rigid> places_;
  uint64_t number_ = 0;
};

int simulated_queries(const SimulatedOptions& o) {
  Made made;
  if (!make(o.recording, o.config, 1e9, made)) return 1;
  const auto scenario = read_scenario(o.scenario);
  if (!scenario) return std::fprintf(stderr, "%s\n", scenario.failure().text.c_str()), 1;
  Visitor visitor(o, *scenario, made);
  Printer printer(made.places);
  const std::vector<uint8_t> stored = bytes_of(made.map);
  if (o.landmarks) visitor.landmarks();
  for (size_t i = 0; i < o.queries; ++i) visitor.query(printer);
  for (size_t i = 0; i < o.visits; ++i) visitor.visit(stored);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Figures of fix/map");
  std::string recording, config = "samples/configs/walk.yaml";
  std::vector<std::string> others;
  double each_s = 0.5, excluded_s = 10;
  SimulatedOptions o;
  app.add_option("--config", config);
  auto* self = app.add_subcommand("self", "frames of a recording in its own map, without the key frames of their time");
  self->add_option("recording", recording)->required();
  self->add_option("--each", each_s, "s");
  self->add_option("--excluded", excluded_s, "s");
  auto* cross = app.add_subcommand("cross", "pictures of others in a map");
  cross->add_option("recording", recording)->required();
  cross->add_option("others", others)->required();
  auto* photos = app.add_subcommand("photos", "pictures in files in a map");
  photos->add_option("recording", recording)->required();
  photos->add_option("paths", others)->required();
  auto* sim = app.add_subcommand("sim", "views of a simulated world in the map of a walk in it");
  sim->add_option("scenario", o.scenario)->required();
  sim->add_option("recording", o.recording)->required();
  sim->add_option("--seed", o.seed);
  sim->add_option("--other-seed", o.other_seed, "of another world");
  sim->add_option("--queries", o.queries);
  sim->add_option("--visits", o.visits, "of 3 s, in the map as it is loaded");
  sim->add_option("--light", o.light);
  sim->add_option("--tilt", o.tilt_sigma_rad);
  sim->add_option("--aside", o.aside_m);
  sim->add_option("--yaw", o.yaw_rad);
  sim->add_option("--lens", o.other_lens);
  sim->add_flag("--landmarks", o.landmarks, "distances of the map's landmarks over the exact ones");
  app.require_subcommand(1);
  CLI11_PARSE(app, argc, argv);
  o.config = config;
  if (*sim) return simulated_queries(o);
  Made made;
  if (!make(recording, config, *self ? each_s : 1e9, made)) return 1;
  Printer printer(made.places);
  if (*self) {
    for (const Shot& shot : made.shots)
      printer.query("self", made.map, shot.picture, shot.truth.value_or(shot.T_n_c), [&](const KeyFrame& frame) {
        return std::abs(static_cast<double>(frame.t_ns - shot.picture.t_ns)) < 1e9 * excluded_s;
      });
    return 0;
  }
  if (*photos) return photographs(made.map, others, printer), 0;
  for (const std::string& other : others) {
    Made theirs;
    if (!make(other, config, each_s, theirs)) return 1;
    for (const Shot& shot : theirs.shots) printer.query("cross", made.map, shot.picture, std::nullopt);
  }
  return 0;
}
