// SPDX-License-Identifier: Apache-2.0
#include "abi/bindings/vit/tracker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iterator>

namespace {

/// Values by judgement.
struct Parameters {
  /// Pictures in the queue; push blocks beyond. A consumer that stops when no new pose arrives loses as many.
  size_t max_pictures = 1;
  /// Poses not yet popped; beyond, the oldest are dropped.
  size_t max_poses = 4096;
  /// Time without an IMU sample after which a picture is processed without the samples that cover it.
  std::chrono::milliseconds imu_silent{1000};
  /// ns; IMU samples up to this time after a picture are processed with it, so that it need not wait for the next one.
  int64_t imu_ahead_ns = 20'000'000;
};
constexpr Parameters kParameters;

constexpr char kRecommended[] =
    "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
    "vo_frontend: {plugin: vo/odograph}\ncoupling: {type: localizer}\n";

int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Sigma of the noisiest axis.
double largest_of(const double (&sigma)[3]) { return std::max({sigma[0], sigma[1], sigma[2]}); }

void correct(const vit_inertial_calibration& c, double (&values)[3]) {
  double out[3];
  for (int i = 0; i < 3; ++i)
    out[i] = c.transform[3 * i] * values[0] + c.transform[3 * i + 1] * values[1] + c.transform[3 * i + 2] * values[2] +
             c.offset[i];
  std::copy_n(out, 3, values);
}

/// Hamilton quaternion w, x, y, z of the rotation in the upper left of a row-major 4 x 4 matrix (Shepperd 1978).
void quaternion_of(const double (&t)[16], double (&q)[4]) {
  const double d[3] = {t[0], t[5], t[10]}, trace = d[0] + d[1] + d[2];
  const double squares[4] = {1 + trace, 1 + 2 * d[0] - trace, 1 + 2 * d[1] - trace, 1 + 2 * d[2] - trace};
  const auto largest = static_cast<int>(std::max_element(squares, squares + 4) - squares);
  const double s = std::sqrt(std::max(squares[largest], 1e-12)) / 2, f = 1 / (4 * s);
  const double wx = t[9] - t[6], wy = t[2] - t[8], wz = t[4] - t[1], xy = t[1] + t[4], xz = t[2] + t[8],
               yz = t[6] + t[9];
  const double columns[4][4] = {{0, wx, wy, wz}, {wx, 0, xy, xz}, {wy, xy, 0, yz}, {wz, xz, yz, 0}};
  for (int i = 0; i < 4; ++i) q[i] = i == largest ? s : columns[largest][i] * f;
}

}  // namespace

VitTracker::VitTracker(const char* config) {
  if (config && *config)
    options_.file(config);
  else
    options_.text(kRecommended);
  open();
}

void VitTracker::open() {
  session_ = std::make_unique<odo::Session>(options_);
  session_->on_event([this](const odo::Event& event) { take(event); }, {ODO_TYPE_POSE, ODO_TYPE_VO_MOTION});
  described_ = false;
  last_pose_ns_ = INT64_MIN;
  motion_.reset();
  come_.clear();
}

void VitTracker::start() {
  const std::lock_guard lock(mutex_);
  if (running_) return;
  running_ = true;
  imu_came_ = std::chrono::steady_clock::now();
  worker_ = std::thread([this] { run(); });
}

void VitTracker::stop() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  changed_.notify_all();
  if (worker_.joinable()) worker_.join();
}

vit_tracker_extension_set VitTracker::extensions() const {
  const std::lock_guard lock(mutex_);
  return extensions_;
}

void VitTracker::enable(const vit_tracker_extension_set& set) {
  const std::lock_guard lock(mutex_);
  extensions_ = set;
}

bool VitTracker::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

void VitTracker::reset() {
  const bool again = running();
  {
    const std::lock_guard lock(mutex_);
    samples_.clear(), pictures_.clear();
  }
  stop();
  open();
  {
    const std::lock_guard lock(mutex_);
    poses_.clear();
    newest_imu_ns_ = INT64_MIN;
  }
  if (again) start();
}

void VitTracker::push(const vit_imu_sample& sample) {
  {
    const std::lock_guard lock(mutex_);
    if (!running_) return;
    samples_.push_back(sample);
    newest_imu_ns_ = std::max(newest_imu_ns_, sample.timestamp);
    imu_came_ = std::chrono::steady_clock::now();
  }
  changed_.notify_all();
}

void VitTracker::push(const vit_img_sample& sample) {
  const uint32_t pixel = sample.format == VIT_IMAGE_FORMAT_R8G8B8 ? 3 : 1;
  auto picture = std::make_shared<Picture>();
  picture->received_ns = now_ns();
  picture->pixels.assign(sample.data,
                         sample.data + size_t{sample.stride} * (sample.height - 1) + size_t{sample.width} * pixel);
  auto& frame = picture->frame = odo::make<odo_frame>(sample.timestamp);
  frame.header.source = sample.cam_index;
  frame.format = pixel == 3 ? ODO_FORMAT_RGB8 : ODO_FORMAT_GREY8;
  frame.width = sample.width, frame.height = sample.height, frame.plane_count = 1;
  frame.planes[0] = {picture->pixels.data(), sample.stride, pixel, 0};
  if (sample.mask_count > 0) {  // 0: do not use this pixel
    const size_t begin = picture->pixels.size();
    picture->pixels.resize(begin + size_t{sample.width} * sample.height, 255);
    for (uint32_t i = 0; i < sample.mask_count; ++i) {
      const vit_mask& m = sample.masks[i];
      const auto bound = [](float value, uint32_t largest) {
        return static_cast<uint32_t>(std::clamp(value, 0.0F, static_cast<float>(largest)));
      };
      const uint32_t left = bound(m.x, sample.width), right = bound(std::ceil(m.x + m.w), sample.width);
      for (uint32_t y = bound(m.y, sample.height); y < bound(std::ceil(m.y + m.h), sample.height); ++y)
        std::fill(picture->pixels.begin() + static_cast<std::ptrdiff_t>(begin + size_t{y} * sample.width + left),
                  picture->pixels.begin() +
                      static_cast<std::ptrdiff_t>(begin + size_t{y} * sample.width + std::max(left, right)),
                  uint8_t{0});
    }
    frame.planes[0].data = picture->pixels.data();
    frame.mask = {picture->pixels.data() + begin, sample.width, 1, 0};
    frame.header.flags |= ODO_FRAME_MASK;
  }
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !running_ || pictures_.size() < kParameters.max_pictures; });
    if (!running_) return;
    pictures_.push_back(std::move(picture));
  }
  changed_.notify_all();
}

void VitTracker::add(const vit_camera_calibration& v) {
  auto c = odo::make<odo_calibration>(0);
  c.header.source = v.camera_index;
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.model = v.model == VIT_CAMERA_DISTORTION_KB4 ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE;
  c.width = static_cast<uint32_t>(v.width), c.height = static_cast<uint32_t>(v.height);
  c.fx = v.fx, c.fy = v.fy, c.cx = v.cx, c.cy = v.cy;
  const uint32_t counts[] = {0, 4, 5, 8, 4};  // the ninth parameter of RT8 is its radius of validity
  c.distortion_count = counts[v.model];
  std::copy_n(v.distortion, c.distortion_count, c.distortion);
  quaternion_of(v.transform, c.q_b_c);
  for (int i = 0; i < 3; ++i) c.p_b_c[i] = v.transform[4 * i + 3];
  calibrations_.push_back(c);
}

void VitTracker::add(const vit_imu_calibration& v) {
  imu_calibration_ = v;
  if (!(largest_of(v.gyro.noise_std) > 0 && largest_of(v.accel.noise_std) > 0)) return;
  noise_ = odo::make<odo_imu_noise>(0);
  noise_->gyro_noise = largest_of(v.gyro.noise_std), noise_->gyro_walk = largest_of(v.gyro.bias_std);
  noise_->accel_noise = largest_of(v.accel.noise_std), noise_->accel_walk = largest_of(v.accel.bias_std);
}

std::unique_ptr<vit_pose> VitTracker::pop() {
  const std::lock_guard lock(mutex_);
  if (poses_.empty()) return nullptr;
  auto pose = std::move(poses_.front());
  poses_.pop_front();
  return pose;
}

/// Waits for an IMU sample later than the frame, or until the IMU has been silent for imu_silent.
void VitTracker::wait_for_imu(std::unique_lock<std::mutex>& lock, int64_t t_ns) {
  while (running_ && newest_imu_ns_ <= t_ns)
    if (changed_.wait_until(lock, imu_came_ + kParameters.imu_silent) == std::cv_status::timeout) return;
}

void VitTracker::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return !running_ || !pictures_.empty(); });
    if (pictures_.empty()) break;
    wait_for_imu(lock, pictures_.front()->frame.header.t_ns);
    if (pictures_.empty()) continue;  // after a reset
    const auto picture = pictures_.front();
    pictures_.pop_front();
    const int64_t until_ns = picture->frame.header.t_ns + kParameters.imu_ahead_ns;
    const auto end =
        std::find_if(samples_.begin(), samples_.end(), [&](const auto& s) { return s.timestamp > until_ns; });
    const std::vector<vit_imu_sample> samples(samples_.begin(), end);
    samples_.erase(samples_.begin(), end);
    lock.unlock();
    changed_.notify_all();
    process(picture, samples);
    lock.lock();
  }
  lock.unlock();
  session_->flush();
  take_poses();
}

/// Pushes the sensor descriptions before the first sample.
void VitTracker::describe(int64_t t_ns) {
  if (std::exchange(described_, true)) return;
  for (odo_calibration& calibration : calibrations_) {
    calibration.header.t_ns = t_ns;
    session_->push(calibration);
  }
  if (!noise_) return;
  noise_->header.t_ns = t_ns;
  session_->push(*noise_);
}

void VitTracker::process(const std::shared_ptr<Picture>& picture, const std::vector<vit_imu_sample>& samples) {
  const auto push = [this](const vit_imu_sample& s) {
    double gyro[3] = {s.wx, s.wy, s.wz}, accel[3] = {s.ax, s.ay, s.az};
    if (imu_calibration_) correct(imu_calibration_->gyro, gyro), correct(imu_calibration_->accel, accel);
    session_->push_imu(s.timestamp, gyro, accel);
  };
  received_ns_ = picture->received_ns, processing_ns_ = now_ns();
  const int64_t t_ns = picture->frame.header.t_ns;
  describe(samples.empty() ? t_ns : std::min(t_ns, samples.front().timestamp));
  auto at = samples.begin();
  for (; at != samples.end() && at->timestamp <= t_ns; ++at) push(*at);
  session_->push(picture->frame, picture);
  for (; at != samples.end(); ++at) push(*at);
  take_poses();
}

void VitTracker::take(const odo::Event& event) {
  if (const auto motion = event.get<odo_vo_motion>()) motion_ = motion;
  if (const auto pose = event.get<odo_pose>()) come_.push_back(*pose);
}

/// Called after the push or flush that published the poses: only then can the session be queried for them.
void VitTracker::take_poses() {
  for (const odo_pose& pose : come_) take(pose);
  come_.clear();
}

/// Takes metric poses only, one for each time: the interface cannot mark a pose with unknown scale.
void VitTracker::take(const odo_pose& camera) {
  constexpr uint32_t kWanted = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC;
  const bool known = (camera.header.flags & kWanted) == kWanted && camera.reason != ODO_REASON_INITIALISING &&
                     camera.reason != ODO_REASON_NO_SCALE;
  if (!known || camera.header.t_ns <= last_pose_ns_) return;
  const auto body = session_->pose(camera.header.t_ns, false, ODO_OF_BODY);
  if (!body || !(body->header.flags & ODO_POSE_POSITION)) return;
  last_pose_ns_ = camera.header.t_ns;
  auto pose = std::make_unique<vit_pose>();
  const auto f = [](double x) { return static_cast<float>(x); };
  // North-East-Down to z upwards: half a turn about x.
  const double *p = body->p_n, *q = body->q_n, *v = body->velocity_n;
  pose->data = {camera.header.t_ns, f(p[0]), f(-p[1]), f(-p[2]), f(q[0]), f(-q[3]), f(q[2]), f(-q[1]), 0, 0, 0};
  if (body->header.flags & ODO_POSE_VELOCITY)
    pose->data.vx = f(v[0]), pose->data.vy = f(-v[1]), pose->data.vz = f(-v[2]);
  const std::lock_guard lock(mutex_);
  if (extensions_.has_pose_timing) pose->timing = {received_ns_, processing_ns_, now_ns()};
  if (extensions_.has_pose_features) {
    const bool fresh = motion_ && motion_->header.t_ns == camera.header.t_ns;
    pose->camera = fresh ? motion_->camera : 0;
    pose->features.emplace(fresh ? motion_->tracked : 0, vit_pose_feature{-1, -1, -1, 0});
  }
  poses_.push_back(std::move(pose));
  if (poses_.size() > kParameters.max_poses) poses_.pop_front();
}
