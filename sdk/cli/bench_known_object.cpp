// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench known-object`: fix/known_object on pictures of posters, boards and tags, and on what looks like them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/base/temporary_folder.hpp"
#include "sdk/cli/commands.hpp"
#include "sdk/config/pipeline_config.hpp"
#include "sdk/core/messages.hpp"
#include "sdk/evaluation/evaluation.hpp"
#include "sdk/plugin_host/instance.hpp"
#include "sdk/sim/poster.hpp"
#include "sdk/sim/random.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;
constexpr int64_t kFrame_ns = 100'000'000;
constexpr int kWalkingFrames = 6, kStandingFrames = 36;
constexpr double kWrong_m = 1;  // a fix so far off is wrong, whatever it says of itself

struct KnownObjectArguments {
  uint64_t scenes = 20, lookalike_frames = 10000, seed = 1;
  std::string keep;
  bool json = false;
};

struct Target {
  std::string id;
  double width_m, height_m;
  int tag;
};
const Target kTargets[] = {{"board", 3.2, 2.4, -1}, {"poster", 1.2, 1.8, -1}, {"tag", 0.8, 0.8, 7}};

/// All targets hang with their middle in the same place of a wall that one reads looking north.
const Vector3d kMiddle(0, 0, -1.7);
Matrix3d wall_axes() {
  Matrix3d R_n_o;
  R_n_o << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // right is east, down is down, into the wall is north
  return R_n_o;
}

odo_calibration lens_of(uint64_t number) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.width = 640, c.height = 480;
  c.fx = c.fy = 500, c.cx = 319.5, c.cy = 239.5;
  c.q_b_c[1] = 1;  // the body's x, -y, -z
  c.model = ODO_CAMERA_PINHOLE;
  const auto put = [&](std::initializer_list<double> k) {
    c.distortion_count = static_cast<uint32_t>(k.size());
    std::copy(k.begin(), k.end(), c.distortion);
  };
  if (number % 3 == 1) put({-0.15, 0.05, 4e-4, -3e-4});
  if (number % 3 == 2) c.model = ODO_CAMERA_KANNALA_BRANDT, c.fx = c.fy = 430, put({-0.02, 0.008, -0.003, 0});
  return c;
}

/// The plugin by itself, with an objects' file of its own.
class Fixer {
 public:
  static Result<std::unique_ptr<Fixer>> make(const std::vector<Target>& targets, uint64_t seed) {
    auto fixer = std::unique_ptr<Fixer>(new Fixer);
    std::ofstream objects(fixer->folder_ / "objects.yaml");
    objects << "odograph_objects: 1\nobjects:\n";
    for (const Target& t : targets) {
      objects << "  - id: " << t.id << "\n    sigma: 0.005\n";
      if (t.tag >= 0) {
        objects << "    tag: " << t.tag << "\n";
      } else {
        cv::imwrite((fixer->folder_ / (t.id + ".png")).string(), picture_of(t, seed, seed));
        objects << "    picture: " << t.id << ".png\n";
      }
      objects << "    corners_n:\n";
      for (const auto& [x, y] : {std::pair{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}) {
        const Vector3d p = kMiddle + wall_axes() * Vector3d(x * t.width_m, y * t.height_m, 0);
        objects << "      - [" << p.x() << ", " << p.y() << ", " << p.z() << "]\n";
      }
    }
    objects.close();
    const std::string yaml =
        "odograph: 1\nattitude:\n  plugin: attitude/vqf\nabsolute_fixers:\n  - plugin: fix/known_object\n    "
        "parameters: "
        "{objects: objects.yaml, prior: always}\n";
    auto config = read_pipeline_config(yaml, "bench known-object", plugin_directories({}));
    if (!config) return config.failure();
    fixer->host_ =
        std::make_unique<HostServices>(seed, std::vector<fs::path>{fixer->folder_.path()}, [](const Report&) {});
    auto instance = PluginInstance::make(config->fixers.at(0), false, 1, *fixer->host_);
    if (!instance) return instance.failure();
    fixer->instance_ = std::move(*instance);
    return fixer;
  }

  /// The picture of a target; of a tag its black border and what is in it.
  static cv::Mat picture_of(const Target& t, uint64_t layout, uint64_t content) {
    if (t.tag >= 0) return tag_board_picture(static_cast<uint32_t>(t.tag), 512);
    const int height = 900;
    return poster_picture(layout, content, {static_cast<int>(std::lround(height * t.width_m / t.height_m)), height});
  }

  void begin(const odo_calibration& lens) {
    instance_->reset();
    instance_->process(lens.header);
  }
  std::vector<odo_fix> see(const odo_pose& prior, const cv::Mat& grey, int64_t line_time_ns) {
    std::vector<odo_fix> fixes;
    take(prior.header, fixes);
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, prior.header.t_ns);
    frame.header.flags = ODO_FRAME_LINE_TIME;
    frame.format = ODO_FORMAT_GREY8;
    frame.width = static_cast<uint32_t>(grey.cols), frame.height = static_cast<uint32_t>(grey.rows);
    frame.planes[0] = {grey.data, static_cast<int64_t>(grey.step), 1, 0};
    frame.line_time_ns = line_time_ns;
    take(frame.header, fixes);
    return fixes;
  }
  uint64_t faults() const { return instance_->faults(); }

 private:
  Fixer() = default;
  void take(const odo_header& message, std::vector<odo_fix>& fixes) {
    for (const AnyMessage& event : instance_->process(message))
      if (event.header().type == ODO_TYPE_FIX) fixes.push_back(as<odo_fix>(event.header()));
  }
  TemporaryFolder folder_;
  std::unique_ptr<HostServices> host_;
  std::unique_ptr<PluginInstance> instance_;
};

/// Where the camera is and looks, and how it moves.
struct Viewpoint {
  Vector3d p_n, velocity_n = Vector3d::Zero(), rate_c = Vector3d::Zero();
  Matrix3d R_n_c;
  Viewpoint after(double s) const {
    Viewpoint v = *this;
    v.p_n += s * velocity_n;
    const double angle = s * rate_c.norm();
    if (angle > 1e-12) v.R_n_c = R_n_c * Eigen::AngleAxisd(angle, rate_c.normalized()).toRotationMatrix();
    return v;
  }
  Eigen::Isometry3d to(const Vector3d& o_n) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R_n_c.transpose() * wall_axes();
    T.translation() = R_n_c.transpose() * (o_n - p_n);
    return T;
  }
};

Viewpoint viewpoint(Random& random, double distance_m, double oblique_rad, bool walking) {
  Viewpoint v;
  const double side = random.uniform() < 0.5 ? -1 : 1;
  v.p_n = kMiddle + distance_m * Vector3d(-std::cos(oblique_rad), side * std::sin(oblique_rad), 0);
  v.p_n.z() = -random.uniform(1.2, 1.7);
  const double spread = 0.12 * distance_m;
  const Vector3d target = kMiddle + Vector3d(0, random.uniform(-spread, spread), random.uniform(-spread, spread));
  const Vector3d forward = (target - v.p_n).normalized();
  const Vector3d right = Vector3d::UnitZ().cross(forward).normalized();
  v.R_n_c << right, forward.cross(right), forward;
  v.R_n_c = v.R_n_c * Eigen::AngleAxisd(0.08 * random.normal(), Vector3d::UnitZ()).toRotationMatrix();
  if (walking) {
    const double heading = random.uniform(-kPi, kPi);
    v.velocity_n = random.uniform(0.5, 1.3) * Vector3d(std::cos(heading), std::sin(heading), 0);
    for (double& w : v.rate_c) w = 0.2 * random.normal();
  } else {
    for (double& w : v.rate_c) w = 0.005 * random.normal();
  }
  return v;
}

cv::Mat wall_picture(uint64_t seed) {
  Random random(seed, 21);
  cv::Mat wall(1024, 2048, CV_8U, cv::Scalar(random.uniform(90, 170)));
  for (int k = 0; k < 500; ++k) {
    const cv::Point a(static_cast<int>(random.uniform(0, 2048)), static_cast<int>(random.uniform(0, 1024)));
    const cv::Point b = a + cv::Point(static_cast<int>(random.uniform(4, 70)), static_cast<int>(random.uniform(4, 90)));
    cv::rectangle(wall, a, b, random.uniform(40, 230), random.uniform() < 0.5 ? cv::FILLED : 2);
  }
  for (uint8_t& p : cv::Mat_<uint8_t>(wall)) p = cv::saturate_cast<uint8_t>(p + 10 * random.normal());
  return wall;
}

/// What hangs in a scene, in n, with its own side to the south.
struct Hung {
  cv::Mat grey;
  double width_m, height_m;
  Vector3d at_n;
};

/// One scene through the plugin: all fixes with the truth at their time.
struct Told {
  odo_fix fix;
  Viewpoint truth;
};
std::vector<Told> play(Fixer& fixer, const std::vector<Hung>& hung, const Viewpoint& start, int frames, uint64_t scene,
                       Random& random, double position_sigma_m, const std::string& keep) {
  const odo_calibration lens = lens_of(scene);
  static std::map<uint64_t, PosterCamera> cameras;
  const PosterCamera& camera = cameras.try_emplace(scene % 3, lens).first->second;
  static const cv::Mat wall = wall_picture(5);
  PosterCamera::Shot shot;
  shot.light = random.uniform(0.35, 0.95), shot.slope = random.uniform(0, 0.3), shot.noise = random.uniform(1, 4);
  shot.shadow = random.uniform() < 0.3 ? random.uniform(0.5, 0.9) : 1.0;
  shot.exposure_s = random.uniform(2e-3, 12e-3);
  const Vector3d position_error = position_sigma_m * Vector3d(random.normal(), random.normal(), 0.3 * random.normal());
  const double yaw_error = 3 * kDegree * random.normal();
  const Vector3d tilt_error(0.6 * kDegree * random.normal(), 0.6 * kDegree * random.normal(), yaw_error);
  const Eigen::AngleAxisd wrong(tilt_error.norm(), tilt_error.normalized());
  fixer.begin(lens);
  std::vector<Told> told;
  const double span_s = (frames - 1) * 0.1;
  for (int k = 0; k < frames; ++k) {
    const Viewpoint v = start.after(k * 0.1 - 0.5 * span_s);
    std::vector<FlatPicture> pictures = {{wall, 60, 30, v.to(kMiddle + Vector3d(0.03, 7, 0))}};
    for (const Hung& h : hung) pictures.push_back({h.grey, h.width_m, h.height_m, v.to(h.at_n)});
    shot.rate_c = v.rate_c, shot.velocity_c = v.R_n_c.transpose() * v.velocity_n;
    shot.seed = scene * 1000 + static_cast<uint64_t>(k);
    const cv::Mat grey = camera.take(pictures, shot);
    if (!keep.empty() && k == 0) cv::imwrite((fs::path(keep) / (std::to_string(scene) + ".png")).string(), grey);
    auto prior = make_message<odo_pose>(ODO_TYPE_POSE, 1'000'000'000 + k * kFrame_ns);
    prior.header.flags =
        ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_CAMERA | ODO_POSE_VELOCITY;
    const Eigen::Quaterniond q(Matrix3d(wrong * v.R_n_c));
    prior.q_n[0] = q.w(), prior.q_n[1] = q.x(), prior.q_n[2] = q.y(), prior.q_n[3] = q.z();
    Vector3d::Map(prior.p_n) = v.p_n + position_error;
    Vector3d::Map(prior.velocity_n) = v.velocity_n;
    for (int i = 0; i < 3; ++i) {
      const double turned = (i < 2 ? 1.0 : 3.0) * kDegree, off = position_sigma_m * (i < 2 ? 1.0 : 0.3);
      prior.covariance[7 * i] = turned * turned, prior.covariance[7 * (i + 3)] = off * off;
    }
    prior.state = ODO_TRACKING;
    for (const odo_fix& fix : fixer.see(prior, grey, std::llround(shot.line_time_s * 1e9))) told.push_back({fix, v});
  }
  return told;
}

double horizontal_error(const Told& t) { return (Vector3d(t.fix.p_n) - t.truth.p_n).head<2>().norm(); }

struct Cell {
  double from_m, to_m, from_deg, to_deg;
  bool standing;
  std::vector<double> error_m, nis, turn_deg;
  uint64_t scenes = 0, seen = 0;
  void add(const std::vector<Told>& told) {
    ++scenes;
    if (told.empty()) return;
    ++seen;
    const Told& last = told.back();  // the one that stays
    error_m.push_back(horizontal_error(last));
    const Eigen::Vector2d off = (Vector3d(last.fix.p_n) - last.truth.p_n).head<2>();
    Eigen::Matrix2d P;
    P << last.fix.covariance_n[0], last.fix.covariance_n[1], last.fix.covariance_n[3], last.fix.covariance_n[4];
    nis.push_back(off.dot(P.inverse() * off));
    const Eigen::Quaterniond q_b_c(0, 1, 0, 0),
        q(last.fix.q_n_b[0], last.fix.q_n_b[1], last.fix.q_n_b[2], last.fix.q_n_b[3]);
    turn_deg.push_back(Eigen::AngleAxisd((q * q_b_c).toRotationMatrix().transpose() * last.truth.R_n_c).angle() /
                       kDegree);
  }
};

double mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}

Result<std::vector<Cell>> accuracy(const KnownObjectArguments& a, const Target& target) {
  auto fixer = Fixer::make({target}, a.seed);
  if (!fixer) return fixer.failure();
  std::vector<Cell> cells = {{2, 5, -20, 20, true, {}, {}, {}}};
  for (const auto& [from_m, to_m] : {std::pair{2.0, 5.0}, {5.0, 10.0}, {10.0, 15.0}})
    for (const auto& [from_deg, to_deg] : {std::pair{0.0, 30.0}, {30.0, 60.0}})
      cells.push_back({from_m, to_m, from_deg, to_deg, false, {}, {}, {}});
  const cv::Mat picture = Fixer::picture_of(target, a.seed, a.seed);
  Progress progress(target.id);
  uint64_t scene = 0;
  for (Cell& cell : cells)
    for (uint64_t k = 0; k < a.scenes; ++k) {
      progress.show(scene, cells.size() * a.scenes);
      Random random(a.seed * 100003 + ++scene, 31);
      const int frames = cell.standing ? kStandingFrames : kWalkingFrames;
      for (int attempt = 0; attempt < 200; ++attempt) {
        const double d = random.uniform(cell.from_m, cell.to_m);
        const Viewpoint v = viewpoint(random, d, random.uniform(cell.from_deg, cell.to_deg) * kDegree, !cell.standing);
        const PosterCamera look(lens_of(0));
        const double late_s = 0.05 * frames;
        const auto all_in = [&](double s) {
          return look.sees({picture, target.width_m, target.height_m, v.after(s).to(kMiddle)}, 24);
        };
        if (!all_in(-late_s) || !all_in(late_s)) continue;
        cell.add(play(**fixer, {{picture, target.width_m, target.height_m, kMiddle}}, v, frames, scene, random, 1.0,
                      k < 2 ? a.keep : ""));
        break;
      }
    }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return cells;
}

/// Scenes in which something looks like a known object, and is not, or is not where it belongs.
struct Lookalikes {
  std::string name;
  uint64_t frames = 0, fixes = 0, wrong = 0;
  double worst_m = 0;
};

std::vector<Hung> disguise(size_t kind, const Target& target, const cv::Mat& original, uint64_t seed, Random& random,
                           Viewpoint& v, const std::vector<uint64_t>& layouts) {
  const auto as_target = [&](cv::Mat grey) { return Hung{std::move(grey), target.width_m, target.height_m, kMiddle}; };
  switch (kind) {
    case 0: {  // another board of the same layout, or another tag
      Target other = target;
      if (target.tag >= 0) other.tag = 8 + static_cast<int>(random.next() % 400);
      return {as_target(Fixer::picture_of(other, seed, 1000 + random.next() % 1000000))};
    }
    case 1: {  // a part of it exchanged
      Hung h = as_target(original.clone());
      const cv::Mat other = poster_picture(seed, 1000 + random.next() % 1000000, original.size());
      const int cut = static_cast<int>(original.rows * random.uniform(0.4, 0.6));
      const cv::Range rows = random.uniform() < 0.5 ? cv::Range(0, cut) : cv::Range(original.rows - cut, original.rows);
      other.rowRange(rows).copyTo(h.grey.rowRange(rows));
      return {h};
    }
    case 2: {  // mirrored or upside down
      Hung h = as_target(cv::Mat());
      cv::flip(original, h.grey, random.uniform() < 0.5 ? 1 : -1);
      return {h};
    }
    case 3: {  // the same at another place: everything else of the scene is there
      const double direction = random.uniform(0, 2 * kPi), far_m = random.uniform(12, 150);
      const Vector3d away = far_m * Vector3d(std::cos(direction), std::sin(direction), 0);
      v.p_n += away;
      Hung h = as_target(original);
      h.at_n += away;
      return {h};
    }
    case 4: {  // a smaller print of it beside where it belongs
      const double part = random.uniform(0.3, 0.6), aside = (random.uniform() < 0.5 ? -1 : 1) * random.uniform(7, 12);
      v.p_n += Vector3d(0, aside, 0);
      Hung h{original, part * target.width_m, part * target.height_m, kMiddle + Vector3d(0, aside, 0)};
      return {h};
    }
    case 5: {  // two of it side by side, of which one belongs there
      Hung h = as_target(original), second = h;
      second.at_n.y() += (random.uniform() < 0.5 ? -1 : 1) * 1.15 * target.width_m;
      return {h, second};
    }
    default: {  // other boards
      const uint64_t layout = layouts[random.next() % layouts.size()];
      return {as_target(poster_picture(layout, 1000 + random.next() % 1000000, {600, 900}))};
    }
  }
}

Result<std::vector<Lookalikes>> lookalikes(const KnownObjectArguments& a) {
  auto fixer = Fixer::make({std::begin(kTargets), std::end(kTargets)}, a.seed);
  if (!fixer) return fixer.failure();
  std::vector<Lookalikes> rows = {{"the same layout, another content"},
                                  {"a half of it exchanged"},
                                  {"mirrored, upside down"},
                                  {"the same, 12 to 150 m away"},
                                  {"a smaller print, 7 to 12 m aside"},
                                  {"two side by side"},
                                  {"other boards"}};
  const std::vector<uint64_t> layouts = {101, 102, 103, 104, 105, 106, 107, 108};
  std::vector<cv::Mat> originals;
  for (const Target& t : kTargets) originals.push_back(Fixer::picture_of(t, a.seed, a.seed));
  Progress progress("look-alikes");
  uint64_t frames = 0;
  for (uint64_t scene = 0; frames < a.lookalike_frames; ++scene) {
    progress.show(frames, a.lookalike_frames);
    Random random(a.seed * 200003 + scene, 32);
    const size_t kind = scene % rows.size(), which = scene / rows.size() % std::size(kTargets);
    const Target& target = kTargets[which];
    // Every seventh of them is stood before: what is told then is told with more weight.
    const bool standing = scene % 49 < 7;
    const int count = standing ? kStandingFrames : kWalkingFrames;
    const double nearest = std::max(2.0, 1.2 * target.width_m);
    Viewpoint v = viewpoint(random, random.uniform(nearest, 12), random.uniform(0, 55) * kDegree, !standing);
    const auto hung = disguise(kind, target, originals[which], a.seed, random, v, layouts);
    const auto told = play(**fixer, hung, v, count, scene, random, 1.0, scene < 42 ? a.keep : "");
    Lookalikes& row = rows[kind];
    row.frames += static_cast<uint64_t>(count), frames += static_cast<uint64_t>(count);
    for (const Told& t : told) {
      ++row.fixes;
      row.worst_m = std::max(row.worst_m, horizontal_error(t));
      row.wrong += horizontal_error(t) > kWrong_m || kind < 3 || kind == 6;  // those are not known objects at all
    }
  }
  if ((*fixer)->faults() > 0) return Failure{ODO_E_ERROR, "the plugin failed"};
  return rows;
}

void print(const Target& target, const std::vector<Cell>& cells) {
  std::printf("%s, %.1f x %.1f m\n%-28s %7s %7s %9s %9s %9s %12s %10s\n", target.id.c_str(), target.width_m,
              target.height_m, "", "scenes", "fixes", "mean (m)", "90 % (m)", "max (m)", "turn (deg)", "in 95 %");
  for (const Cell& c : cells) {
    char name[120];
    std::snprintf(name, sizeof name, "%s %g-%g m, %g to %g deg", c.standing ? "standing" : "walking", c.from_m, c.to_m,
                  c.from_deg, c.to_deg);
    const auto inside = std::count_if(c.nis.begin(), c.nis.end(), [](double x) { return x < 5.99; });
    if (c.error_m.empty())
      std::printf("%-28s %7llu %7d\n", name, static_cast<unsigned long long>(c.scenes), 0);
    else
      std::printf("%-28s %7llu %7llu %9.3f %9.3f %9.3f %12.2f %8.0f %%\n", name,
                  static_cast<unsigned long long>(c.scenes), static_cast<unsigned long long>(c.seen), mean(c.error_m),
                  percentile(c.error_m, 0.9), percentile(c.error_m, 1), mean(c.turn_deg),
                  100.0 * static_cast<double>(inside) / static_cast<double>(c.nis.size()));
  }
  std::printf("\n");
}

int run_known_object(const KnownObjectArguments& a) {
  std::error_code error;
  if (!a.keep.empty()) fs::create_directories(a.keep, error);
  nlohmann::ordered_json all;
  if (!a.json)
    std::printf(
        "Frames of 640x480, 500 px (pinhole, radial-tangential, Kannala-Brandt in turn), 10 Hz, rolling shutter "
        "of 14 ms; horizontal error of the last fix of each scene.\n\n");
  if (a.scenes > 0)
    for (const Target& target : kTargets) {
      const auto cells = accuracy(a, target);
      if (!cells) return complain(cells.failure());
      if (!a.json) print(target, *cells);
      for (const Cell& c : *cells)
        all["accuracy"].push_back({{"target", target.id},
                                   {"standing", c.standing},
                                   {"from_m", c.from_m},
                                   {"to_m", c.to_m},
                                   {"from_deg", c.from_deg},
                                   {"to_deg", c.to_deg},
                                   {"scenes", c.scenes},
                                   {"fixes", c.seen},
                                   {"mean_m", mean(c.error_m)}});
    }
  if (a.lookalike_frames > 0) {
    const auto rows = lookalikes(a);
    if (!rows) return complain(rows.failure());
    if (!a.json) std::printf("%-36s %9s %9s %9s %12s\n", "look-alikes", "frames", "fixes", "wrong", "largest (m)");
    Lookalikes sum{"all"};
    const auto line = [](const Lookalikes& r) {
      std::printf("%-36s %9llu %9llu %9llu %12.2f\n", r.name.c_str(), static_cast<unsigned long long>(r.frames),
                  static_cast<unsigned long long>(r.fixes), static_cast<unsigned long long>(r.wrong), r.worst_m);
    };
    for (const Lookalikes& r : *rows) {
      sum.frames += r.frames, sum.fixes += r.fixes, sum.wrong += r.wrong,
          sum.worst_m = std::max(sum.worst_m, r.worst_m);
      if (!a.json) line(r);
      all["look_alikes"].push_back({{"kind", r.name}, {"frames", r.frames}, {"fixes", r.fixes}, {"wrong", r.wrong}});
    }
    if (!a.json) line(sum);
  }
  if (a.json) std::printf("%s\n", all.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench_known_object(CLI::App& bench, int& status) {
  auto a = std::make_shared<KnownObjectArguments>();
  auto* command = bench.add_subcommand("known-object", "fix/known_object on posters, boards, tags and look-alikes");
  command->add_option("--scenes", a->scenes, "of each distance and obliqueness, for each object")
      ->capture_default_str();
  command->add_option("--look-alikes", a->lookalike_frames, "frames with them")->capture_default_str();
  command->add_option("--seed", a->seed, "other pictures, places and light")->capture_default_str();
  command->add_option("--keep", a->keep, "folder for some of the frames");
  command->add_flag("--json", a->json, "print one JSON object");
  command->callback([a, &status] { status = run_known_object(*a); });
}

}  // namespace odograph
