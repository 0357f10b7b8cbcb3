// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/simulate.hpp"

#include <chrono>
#include <algorithm>
#include <cmath>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/platform/temporary_folder.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/simulation/drive.hpp"
#include "sdk/tools/simulation/reconstruct_walk.hpp"
#include "sdk/tools/simulation/sensors.hpp"
#include "sdk/tools/simulation/walker.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr int64_t kStart_ns = 1'000'000'000'000;
constexpr size_t kSkylineDirections = 720;  // every half degree, as Gakne & O'Keefe 2018, eq. (2)
constexpr double kSightingRange_m = 40;

struct ExposedFrame {
  double t_s;      // true, of the middle of the middle row
  double stamp_s;  // time stamp in the recording
  double exposure_s;
};

/// The exposure of each frame: it switches between the scenario's two values at random times.
class Exposures {
 public:
  Exposures(const Scenario::Camera& c, uint64_t seed) : c_(c), random_(seed, 98), now_s_(c.exposure_s) {}
  double at(double t_s) {
    while (c_.exposure_longest_s > 0 && t_s >= next_s_) {
      now_s_ = random_.uniform() < 0.5 ? c_.exposure_s : c_.exposure_longest_s;
      next_s_ -= c_.exposure_interval_s * std::log(1 - random_.uniform());
    }
    return now_s_;
  }

 private:
  const Scenario::Camera& c_;
  Random random_;
  double now_s_, next_s_ = 0;
};

/// The frames that are not dropped, with their time stamps. The phone stamps the start of the first row's exposure; the
/// recording uses the middle of the middle row, converted with the known exposure and the recording's own row time.
std::vector<ExposedFrame> expose(const Scenario& scenario, double duration_s, uint64_t seed) {
  const Scenario::Camera& c = scenario.camera;
  Random random(seed, 90);
  Exposures exposures(c, seed);
  std::vector<ExposedFrame> frames;
  const double half = 0.5 * c.height * c.row_time_s + 0.5 * std::max(c.exposure_s, c.exposure_longest_s);
  const double conversion = 0.5 * (c.height - 1) * c.row_time_s * c.row_time_error;
  for (size_t k = 0;; ++k) {
    const double t = half + static_cast<double>(k) / c.rate_hz;
    if (t + half >= duration_s) return frames;
    const bool lost = random.uniform() < c.drop;
    const double jitter = c.jitter_s * random.normal(), exposure = exposures.at(t);
    if (lost || t < scenario.record_from_s) continue;
    const double stamp = t + std::clamp(jitter, -0.4 / c.rate_hz, 0.4 / c.rate_hz) - c.time_offset_s;
    frames.push_back({t, stamp + (conversion - c.unknown_time_offset_s), exposure});
  }
}

Journey travel(const Scenario& c, const Route& route, uint64_t seed) {
  return c.drives() ? make_drive(c, route, seed) : make_walk(c, route, seed);
}

class Simulation {
 public:
  /// `city` and `reconstructed` may be null.
  Simulation(const Scenario& c, uint64_t seed, OdoWriter& writer, const CityModel* city,
             const ReconstructedWalk* reconstructed, unsigned threads, bool frames)
      : c_(c),
        writer_(writer),
        start_ns_(reconstructed ? reconstructed->start_ns : kStart_ns),
        world_(c, seed, city),
        walk_(reconstructed ? reconstructed->journey : travel(c, world_.route(), seed)),
        camera_(c.camera, c.world.light, seed, &walk_.phone),
        frames_(frames ? expose(c, walk_.phone.duration_s(), seed) : std::vector<ExposedFrame>()),
        drops_(seed, 91),
        report_errors_(seed, 99),
        gyro_(Random(seed, 2),
              {c.imu.gyro_bias, c.imu.gyro_walk, c.imu.gyro_noise, c.imu.scale_error, c.imu.misalignment_rad,
               c.imu.gyro_range, c.imu.gyro_step},
              c.imu.rate_hz),
        accel_(Random(seed, 3),
               {c.imu.accel_bias, c.imu.accel_walk, c.imu.accel_noise,
                c.imu.accel_scale_error < 0 ? c.imu.scale_error : c.imu.accel_scale_error, c.imu.misalignment_rad,
                c.imu.accel_range, c.imu.accel_step},
               c.imu.rate_hz),
        gyro_errors_(c.imu, seed),
        stamps_(c.imu, seed),
        outliers_(c.imu, seed),
        magnetometer_(c.magnetometer, seed),
        barometer_(c.barometer, seed),
        gnss_(c, seed),
        watcher_(world_, camera_, c) {
    geodesy_.set_origin(kSimulatedOrigin);
    std::vector<Exposure> exposures;
    for (const auto& frame : frames_) exposures.push_back({frame.t_s, frame.exposure_s});
    maker_ = std::make_unique<FrameMaker>(world_, camera_, c_, walk_, std::move(exposures), threads);
  }

  Result<SimulationReport> run(const std::function<void(size_t, size_t)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    write_imu_noise();
    if (!frames_.empty()) check(writer_.write(calibration().header));
    simulate_sensors(progress);
    for (const auto& step : walk_.steps)
      if (step.t_start_s >= c_.record_from_s) write_step(step);
    return report(start);
  }

  /// The same with a real walk's own samples.
  Result<SimulationReport> run_along(const Recording& real, const std::function<void(size_t, size_t)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    check(writer_.write(calibration().header));
    size_t next_frame = 0, next_mark = 0;
    for (const auto& m : real.messages) {
      const odo_header& header = m.message.header();
      const double t = seconds(header.t_ns - start_ns_);
      write_frames_until(t, next_frame, progress);
      if (header.type == ODO_TYPE_WAYPOINT) {
        write_mark(walk_.waypoints[next_mark++]);
      } else {
        check(writer_.write(header));
      }
      if (header.type == ODO_TYPE_IMU && (header.flags & ODO_IMU_ACCEL)) {
        const auto s = walk_.phone.at(t);
        check(writer_.write_true_state({header.t_ns, Eigen::Quaterniond(s.T_n_b.linear()), s.T_n_b.translation(),
                                        s.velocity_n, Vector3d::Zero(), Vector3d::Zero(), ODO_MODE_UNKNOWN}));
      }
      if (!failure_.text.empty()) break;
    }
    write_frames_until(1e9, next_frame, progress);
    return report(start);
  }

  const World& world() const { return world_; }

 private:
  void simulate_sensors(const std::function<void(size_t, size_t)>& progress) {
    const auto samples = static_cast<size_t>(walk_.phone.duration_s() * c_.imu.rate_hz);
    double next_second = 0, next_field = 0;
    size_t next_frame = 0, next_mark = 0, next_mode = 0;
    const auto first = static_cast<size_t>(std::ceil(c_.record_from_s * c_.imu.rate_hz));
    next_second = next_field = c_.record_from_s;
    while (next_mark < walk_.waypoints.size() && walk_.waypoints[next_mark].t_s < c_.record_from_s) ++next_mark;
    for (size_t i = first; i < samples && failure_.text.empty(); ++i) {
      const double t = static_cast<double>(i) / c_.imu.rate_hz;
      while (next_mode < walk_.modes.size() && walk_.modes[next_mode].t_start_s <= t)
        mode_ = walk_.modes[next_mode++].mode;
      write_imu(t);
      for (; next_field <= t; next_field += 1 / c_.magnetometer.rate_hz) write_magnetometer(t);
      for (; next_second <= t; next_second += 1) write_slow(t);
      for (; next_mark < walk_.waypoints.size() && walk_.waypoints[next_mark].t_s <= t; ++next_mark)
        write_mark(walk_.waypoints[next_mark]);
      write_frames_until(t, next_frame, progress);
    }
  }

  void write_frames_until(double t, size_t& next, const std::function<void(size_t, size_t)>& progress) {
    for (; next < frames_.size() && frames_[next].t_s <= t && failure_.text.empty(); ++next) {
      write_frame(next);
      if (progress) progress(next, frames_.size());
    }
  }

  Result<SimulationReport> report(std::chrono::steady_clock::time_point start) {
    if (!failure_.text.empty()) return failure_;
    if (const auto finished = writer_.finish(); !finished) return finished.failure();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    return SimulationReport{frames_.size(), wall.count(), maker_->threads(), maker_->times(), maker_->moving_parts()};
  }

  int64_t clock_ns(double t_s) const { return start_ns_ + nanoseconds(t_s); }

  /// Keeps the first failure; nothing is written after it.
  void check(const Result<bool>& written) {
    if (!written && failure_.text.empty()) failure_ = written.failure();
  }

  void write_imu_noise() {
    auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, start_ns_);
    noise.gyro_noise = c_.imu.gyro_noise, noise.gyro_walk = c_.imu.gyro_walk, noise.accel_noise = c_.imu.accel_noise,
    noise.accel_walk = c_.imu.accel_walk;
    check(writer_.write(noise.header));
  }

  /// The camera as stated in the recording: the nominal lens.
  odo_calibration calibration() const {
    const int64_t first_ns = frames_.empty() ? start_ns_ : clock_ns(frames_.front().stamp_s);  // by the camera's clock
    auto m = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, std::min(start_ns_, first_ns));
    m.header.flags = ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET;
    m.model = c_.camera.model == "kannala_brandt" ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE;
    m.width = static_cast<uint32_t>(c_.camera.width), m.height = static_cast<uint32_t>(c_.camera.height);
    m.fx = m.fy = c_.camera.focal_px * (1 + c_.camera.focal_error), m.cx = camera_.cx(), m.cy = camera_.cy();
    std::copy(c_.camera.distortion.begin(), c_.camera.distortion.end(), m.distortion);
    m.distortion_count = 4;
    const Eigen::Quaterniond q = camera_.in_body();
    put_quaternion(q, m.q_b_c);
    m.time_offset_ns = nanoseconds(c_.camera.time_offset_s);
    return m;
  }

  /// Lens report for frame k, at the middle of its exposure.
  void write_reported_lens(size_t k) {
    const SimLens::State lens = camera_.lens().at(frames_[k].t_s);
    odo_calibration m = calibration();
    m.header.t_ns = clock_ns(frames_[k].stamp_s);
    m.fx *= lens.focal, m.fy *= lens.focal;
    m.cx += lens.shift_px.x() + c_.camera.stabiliser.report_error_px * report_errors_.normal();
    m.cy += lens.shift_px.y() + c_.camera.stabiliser.report_error_px * report_errors_.normal();
    check(writer_.write(m.header));
  }

  void write_imu(double t) {
    const auto state = walk_.phone.at(t);
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, clock_ns(stamps_.of(t)));
    imu.header.flags = ODO_IMU_GYRO | (c_.imu.accelerometer ? ODO_IMU_ACCEL : 0);
    const Vector3d force = state.specific_force_b(), drift = gyro_errors_.at(t, force);
    Vector3d gyro = gyro_.measure(state.angular_velocity_b + drift), accel = accel_.measure(force);
    outliers_.apply(t, gyro, accel);
    Vector3d::Map(imu.gyro_b) = gyro;
    if (c_.imu.accelerometer) Vector3d::Map(imu.accel_b) = accel;
    if (drops_.uniform() >= c_.imu.drop) check(writer_.write(imu.header));
    const Eigen::Quaterniond q(state.T_n_b.linear());
    check(writer_.write_true_state(
        {clock_ns(t), q, state.T_n_b.translation(), state.velocity_n, gyro_.bias() + drift, accel_.bias(), mode_}));
  }

  void write_frame(size_t k) {
    const auto picture = maker_->take(k);
    if (!picture) return check(picture.failure());
    if (c_.camera.stabiliser.reported && camera_.lens().moves()) write_reported_lens(k);
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, clock_ns(frames_[k].stamp_s));
    frame.header.flags = ODO_FRAME_EXPOSURE | ODO_FRAME_LINE_TIME;
    frame.format = c_.camera.colour ? ODO_FORMAT_RGB8 : ODO_FORMAT_GREY8;
    frame.width = static_cast<uint32_t>(c_.camera.width), frame.height = static_cast<uint32_t>(c_.camera.height);
    frame.exposure_ns = nanoseconds(frames_[k].exposure_s);
    frame.line_time_ns = nanoseconds(c_.camera.row_time_s * (1 + c_.camera.row_time_error));
    check(writer_.write_encoded_frame(frame, *picture));
    const Eigen::Isometry3d T = camera_.pose(walk_.phone, frames_[k].t_s);
    check(writer_.write_truth({clock_ns(frames_[k].t_s), Eigen::Quaterniond(T.linear()), T.translation()}));
    for (const KnownObject& object : world_.known_objects()) write_sighting(object, frames_[k].t_s, T.translation());
  }

  void write_sighting(const KnownObject& object, double t, const Vector3d& eye) {
    const Vector3d middle = 0.5 * (object.corners[0] + object.corners[2]);
    const Vector3d front = (object.corners[1] - object.corners[0]).cross(object.corners[0] - object.corners[3]);
    if ((middle - eye).norm() > kSightingRange_m || (middle - eye).dot(front) < 0) return;
    TrueSighting sighting{.t_ns = clock_ns(t), .tag = object.tag};
    for (size_t i = 0; i < 4; ++i) {
      const auto pixel = camera_.project_rolling(walk_.phone, t, object.corners[i]);
      if (!pixel) return;
      sighting.corners_px[2 * i] = pixel->x(), sighting.corners_px[2 * i + 1] = pixel->y();
    }
    sighting.visible = static_cast<float>(watcher_.visible_part(object, eye, t));
    if (sighting.visible > 0) check(writer_.write_true_sighting(sighting));
  }

  void write_skyline(double t) {
    TrueSkyline skyline{.t_ns = clock_ns(t)};
    for (const auto& point : world_.skyline(walk_.phone.pose(t).translation(), kSkylineDirections)) {
      skyline.elevation_rad.push_back(point.elevation_rad);
      skyline.distance_m.push_back(point.distance_m);
    }
    check(writer_.write_true_skyline(skyline));
  }

  void write_magnetometer(double t) {
    auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, clock_ns(t));
    Vector3d::Map(m.field_b) = magnetometer_.measure(walk_.phone.pose(t));
    check(writer_.write(m.header));
  }

  void write_slow(double t) {
    const Vector3d p = walk_.phone.pose(t).translation();
    if (const auto fix = gnss_.measure(p); fix.available) {
      const auto geodetic = geodesy_.to_geodetic({fix.p_n.x(), fix.p_n.y(), fix.p_n.z()});
      auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, clock_ns(t));
      gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
      gnss.latitude_rad = geodetic[0], gnss.longitude_rad = geodetic[1], gnss.height_m = geodetic[2];
      gnss.covariance_n[0] = gnss.covariance_n[4] = fix.sigma_m * fix.sigma_m;
      gnss.covariance_n[8] = 4 * fix.sigma_m * fix.sigma_m;
      gnss.satellites = 9;
      check(writer_.write(gnss.header));
    }
    auto barometer = make_message<odo_barometer>(ODO_TYPE_BAROMETER, clock_ns(t));
    barometer.pressure_pa = barometer_.measure(20.0 - p.z());
    check(writer_.write(barometer.header));
    if (!c_.is_indoors() && !frames_.empty()) write_skyline(t);
  }

  void write_mark(const Journey::Mark& mark) {
    auto m = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, clock_ns(mark.t_s));
    m.header.flags = ODO_WAYPOINT_VERTICAL;
    Vector3d::Map(m.p_n) = mark.p_n;
    m.sigma_m = 0.3;  // a walker stands near a mark, not exactly on it
    check(writer_.write(m.header));
  }

  void write_step(const Journey::Step& step) {
    auto s = make_message<odo_step>(ODO_TYPE_STEP, clock_ns(step.t_end_s));
    s.t_start_ns = clock_ns(step.t_start_s);
    s.t_end_ns = clock_ns(step.t_end_s);
    s.length_m = step.length_m;
    s.frequency_hz = 1.0 / (step.t_end_s - step.t_start_s);
    s.mode = step.mode;
    check(writer_.write_true_step(s));
  }

  const Scenario& c_;
  OdoWriter& writer_;
  const int64_t start_ns_;
  const World world_;
  const Journey walk_;
  const SimCamera camera_;
  const std::vector<ExposedFrame> frames_;
  Random drops_, report_errors_;
  SimTriad gyro_, accel_;
  const SimGyroErrors gyro_errors_;
  SimStamps stamps_;
  SimOutliers outliers_;
  SimMagnetometer magnetometer_;
  SimBarometer barometer_;
  SimGnss gnss_;
  View watcher_;
  Geodesy geodesy_;
  std::unique_ptr<FrameMaker> maker_;
  uint32_t mode_ = ODO_MODE_STATIC;
  Failure failure_{ODO_OK, ""};
};

}  // namespace

Result<SimulationReport> simulate(const Scenario& scenario, uint64_t seed, const std::filesystem::path& output,
                                  const SimulationOptions& options) {
  std::optional<CityModel> city;
  if (scenario.world.type == "city") {
    auto model = read_city_model(scenario.world.model, scenario.world.model_origin);
    if (!model) return model.failure();
    city = std::move(*model);
  }
  Scenario c = scenario;
  std::optional<ReconstructedWalk> reconstructed;
  if (options.walk) {
    auto walk = reconstruct_walk(*options.walk);
    if (!walk) return walk.failure();
    reconstructed = std::move(*walk);
    c.route = reconstructed->route;
    c.events.clear(), c.objects.clear();
    c.record_from_s = 0;
  }
  auto writer = OdoWriter::create(output, c.camera.jpeg_quality);
  if (!writer) return writer.failure();
  Simulation simulation(c, seed, **writer, city ? &*city : nullptr, reconstructed ? &*reconstructed : nullptr,
                        options.threads, options.frames);
  if (const auto blocked = simulation.world().route_blocked_at_m())
    return Failure{ODO_E_CONFIG, scenario.world.model + ": the route leads into a building after " +
                                     std::to_string(std::lround(*blocked)) + " m"};
  if (!options.city.empty()) {
    const auto written =
        write_city_json(options.city, simulation.world().buildings(), simulation.world().known_objects());
    if (!written) return written.failure();
  }
  return options.walk ? simulation.run_along(*options.walk, options.progress) : simulation.run(options.progress);
}

Result<Recording> simulated(const Scenario& scenario, uint64_t seed) {
  const TemporaryFolder folder;
  const auto made = simulate(scenario, seed, folder / "walk.odo", {.threads = 1, .frames = false});
  return made ? read_recording(folder / "walk.odo") : made.failure();
}

}  // namespace odograph
