// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>

#include "plugins/step/odograph/carry_mode.hpp"
#include "plugins/step/odograph/gait_finder.hpp"
#include "plugins/step/odograph/stair_detector.hpp"
#include "plugins/step/odograph/walk_direction.hpp"
#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace odograph::steps;

class OdographSteps {
 public:
  LengthModel model;
  double factor = 1.0, factor_sigma = 0.08;
  bool learn = true;
  std::array<double, 3> forward_axis{0.0, 1.0, -1.0};
  std::string features;

  static constexpr odo::Description description{
      "step/odograph", "1.1.0", "Steps from regular peaks of the vertical acceleration, lengths from pace and rise",
      ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<OdographSteps>> parameters() {
    using P = OdographSteps;
    return {odo::real("factor", "", 0.5, 2, &P::factor, "the walker's own factor on the model's lengths, if known"),
            odo::real("factor_sigma", "", 0.005, 0.5, &P::factor_sigma,
                      "its standard deviation; the default is that among walkers"),
            odo::boolean("learn", &P::learn, "estimate the factor from the displacement between position fixes"),
            odo::reals("forward_axis", "", -1, 1, &P::forward_axis,
                       "body axis in the direction of walking; the default suits a phone held upright or flat in "
                       "front"),
            odo::text("features", &P::features,
                      "file that receives the features of each step's length, for a fit of the length law; empty = "
                      "none")};
  }

  void configured() {
    if (Vector3d(forward_axis.data()).norm() < 1e-6) throw odo::Error(ODO_E_CONFIG, "forward_axis must not be zero");
    forward_b_ = Vector3d(forward_axis.data()).normalized();
    if (!features.empty()) open_features();
    new_walker();
  }

  /// As after configure: the estimated walker is discarded too, unless it is loaded again.
  void reset() {
    resampler_ = Resampler();
    finder_.reset(), classifier_.reset(), direction_.reset(), stairs_.reset();
    carry_mode_ = ODO_MODE_WALKING_TEXTING, mode_since_ns_ = INT64_MIN;
    hand_ = StillnessDetector();
    walking_ = false, stopped_ns_ = 0;
    headings_.fill({});
    heading_count_ = 0, heading_now_.setZero();
    q_n_b_.setIdentity(), has_attitude_ = false;
    count_ = 0;
    mode_ = ODO_MODE_UNKNOWN;
    new_walker();
  }

  std::vector<uint8_t> save() const { return walker_->save(); }
  void load(const uint8_t* data, size_t size) {
    if (!walker_->load(data, size)) throw odo::Error(ODO_E_DATA, "not data saved by step/odograph");
  }

  void on(const odo_attitude& a, odo::Output&) {
    q_n_b_ = odograph::raw_quaternion(a.q_n_b);
    has_attitude_ = true;
    const Vector3d forward = q_n_b_ * forward_b_;
    const double level = std::hypot(forward.x(), forward.y());
    if (level > 0.2) heading_now_ = Vector2d(forward.x(), forward.y()) / level;
  }

  void on(const odo_imu& imu, odo::Output& output) {
    const Vector3d accel(imu.accel_b), gyro(imu.gyro_b);
    if (!accel.allFinite() || !gyro.allFinite()) return;
    // Without an attitude the norm replaces the vertical component.
    const Vector3d force = has_attitude_ ? Vector3d(q_n_b_ * accel) : Vector3d(0, 0, -accel.norm());
    const Vector2d horizontal = force.head<2>();
    const Vector3d rotating = q_n_b_ * gyro;
    resampler_.push(
        {imu.header.t_ns, -force.z() - odograph::kStandardGravity_mps2, horizontal.norm(), gyro.norm(), horizontal,
         rotating.head<2>(), rotating.z()},
        [&](const WalkSample& s) { on_sample(s, output); }, [&] { finder_.reset(); });
  }

  void on(const odo_barometer& sample, odo::Output& output) {
    stairs_.add(sample.header.t_ns, sample.pressure_pa);
    if (walking_ && (mode_ == ODO_MODE_STAIRS) != stairs_.on_stairs())
      set_mode(walking_mode(), std::max(stairs_.since_ns(), mode_since_ns_), output);
  }

  void on(const odo_fix& fix, odo::Output&) {
    if (!learn || (fix.header.flags & (ODO_FIX_NORTH | ODO_FIX_EAST)) != (ODO_FIX_NORTH | ODO_FIX_EAST)) return;
    const double sigma = std::sqrt(0.5 * std::max(0.0, fix.covariance_n[0] + fix.covariance_n[4]));
    const bool by_camera = fix.header.source == 0;  // the host's own, from the camera's track
    walker_->on_fix(Vector2d(fix.p_n[0], fix.p_n[1]), std::max(sigma, 0.05), by_camera);
  }

 private:
  /// Standard deviation; less than that of a phone's axis on a leg.
  static constexpr double kKnownDirection_rad = 0.25;

  struct Heading {
    int64_t t_ns = 0;
    Vector2d forward = Vector2d::Zero();
  };

  void new_walker() {
    Walker::Parameters p;
    p.factor_sigma = factor_sigma;
    walker_.emplace(p);
    walker_->set_factor(factor);
  }

  void open_features() {
    features_.open(features);
    features_ << "t_start_ns,t_end_ns,frequency_hz,rise_m,turning_radps,second_harmonic,vertical_part,repetition,"
                 "swing_mps2,gyro_radps,gentle,on_leg,since_stood,length_m,own_sigma,common_sigma\n";
    if (!features_) throw odo::Error(ODO_E_CONFIG, "features: cannot write " + features);
  }

  void write_features(const FoundStep& s, const ModelLength& length) {
    features_ << s.t_start_ns << ',' << s.t_end_ns;
    for (const double value : {s.frequency_hz, s.rise_m, s.turning_radps, s.second_harmonic, s.vertical_part,
                               s.repetition, s.swing_mps2, s.gyro_radps, double(s.gentle), double(s.on_leg),
                               double(s.since_stood), length.m, length.own_sigma, length.common_sigma})
      features_ << ',' << value;
    features_ << '\n';
  }

  void on_sample(const WalkSample& s, odo::Output& output) {
    if (mode_ == ODO_MODE_UNKNOWN && stopped_ns_ == 0) stopped_ns_ = s.t_ns;
    headings_[heading_count_++ % headings_.size()] = {s.t_ns, heading_now_};
    finder_.add(s);
    for (const FoundStep& step : finder_.found()) emit(step, s.t_ns, output);
    const bool stopped = std::exchange(walking_, finder_.walking()) && !walking_;
    // Standing starts with the last step, not when the next one is found missing; hand motion is judged from there.
    if (stopped) hand_ = StillnessDetector(), stopped_ns_ = finder_.since_ns();
    if (!walking_) {
      const bool still = hand_.is_still(finder_.signal(), s.t_ns);
      set_mode(still ? ODO_MODE_STATIC : ODO_MODE_HANDLING, std::max(stopped_ns_, hand_.since_ns()), output);
    }
  }

  void emit(FoundStep step, int64_t now_ns, odo::Output& output) {
    const Vector3d up_b = q_n_b_.conjugate() * Vector3d(0, 0, -1);
    if (std::exchange(carry_mode_, mode_of(classifier_.classify(step, up_b))) != carry_mode_) direction_.reset();
    step.on_leg = classifier_.on_leg();
    const ModelLength length = model.estimate(step);
    if (features_.is_open()) write_features(step, length);
    const double length_m = walker_->factor(length.pace) * length.m;
    stairs_.add_step(step.t_start_ns, step.t_end_ns, length_m);
    const uint32_t mode = walking_mode();
    set_mode(mode, std::max(classifier_.since_ns(), since_ns(mode, step)), output);
    auto event = odo::make<odo_step>(now_ns);
    event.t_start_ns = step.t_start_ns, event.t_end_ns = step.t_end_ns;
    event.frequency_hz = 1e9 / static_cast<double>(std::max<int64_t>(1, step.t_end_ns - step.t_start_ns));
    const bool treads = mode == ODO_MODE_STAIRS;  // on stairs the tread length applies, not the walker's
    event.length_m = treads ? stairs_.parameters().tread_m : length_m;
    event.sigma_m =
        treads ? stairs_.parameters().tread_sigma_m
               : length_m * std::hypot(walker_->factor_sigma(length.pace), length.common_sigma, length.own_sigma);
    event.mode = mode;
    event.index = count_++;
    event.header.flags |= ODO_FLAG_QUALITY;
    event.header.quality = step.gentle ? 0.7f : 0.9f;
    if (const Vector2d f = heading_of(step); f.norm() > 0) {
      event.heading_rad = std::atan2(f.y(), f.x());
      direction_.add(step.surge_n, event.heading_rad);
      // On a leg the phone's axis is arbitrary; elsewhere it is the better estimate (README).
      if (step.on_leg && direction_.sigma_rad() < kKnownDirection_rad)
        event.heading_rad = std::remainder(event.heading_rad + direction_.offset_rad(), 2 * odograph::kPi);
      event.header.flags |= ODO_STEP_HEADING;
      ModelLength walked = length;
      if (treads) walked.m = stairs_.parameters().tread_m / walker_->factor(length.pace);
      walker_->on_step(walked, event.heading_rad);
    }
    output.emit(event);
  }

  /// Start of a step's mode, in addition to the carrying mode.
  int64_t since_ns(uint32_t mode, const FoundStep& step) const {
    if (mode_ == ODO_MODE_STATIC || mode_ == ODO_MODE_HANDLING) return step.t_start_ns;
    return (mode_ == ODO_MODE_STAIRS) != (mode == ODO_MODE_STAIRS) ? stairs_.since_ns() : 0;
  }

  /// Heading of the forward axis, averaged over a stride about the step's middle, over which the body's left and right
  /// rotation cancels: from half a step before to half a step after it, as far as samples are available.
  Vector2d heading_of(const FoundStep& step) const {
    const int64_t length_ns = step.t_end_ns - step.t_start_ns,
                  newest_ns = headings_[(heading_count_ - 1) % headings_.size()].t_ns;
    const int64_t to = std::min(step.t_end_ns + length_ns / 2, newest_ns), from = to - 2 * length_ns;
    Vector2d sum = Vector2d::Zero();
    for (const Heading& h : headings_)
      if (h.t_ns > from && h.t_ns <= to) sum += h.forward;
    return sum;
  }

  void set_mode(uint32_t mode, int64_t since_ns, odo::Output& output) {
    if (mode == mode_) return;
    auto event = odo::make<odo_motion_mode>(std::max(since_ns, mode_since_ns_));  // in chronological order
    mode_since_ns_ = event.header.t_ns;
    event.mode = mode_ = mode;
    output.emit(event);
  }

  uint32_t walking_mode() const { return stairs_.on_stairs() ? ODO_MODE_STAIRS : carry_mode_; }

  static uint32_t mode_of(CarryMode carry) {
    switch (carry) {
      case CarryMode::swinging: return ODO_MODE_WALKING_SWINGING;
      case CarryMode::pocket: return ODO_MODE_WALKING_POCKET;
      case CarryMode::running: return ODO_MODE_RUNNING;
      default: return ODO_MODE_WALKING_TEXTING;
    }
  }

  std::optional<Walker> walker_;
  StairDetector stairs_;
  uint32_t carry_mode_ = ODO_MODE_WALKING_TEXTING;
  int64_t mode_since_ns_ = INT64_MIN;
  std::ofstream features_;
  Resampler resampler_;
  GaitFinder finder_;
  CarryModeClassifier classifier_;
  WalkDirection direction_;
  StillnessDetector hand_;
  int64_t stopped_ns_ = 0;
  Quaterniond q_n_b_ = Quaterniond::Identity();
  Vector3d forward_b_ = Vector3d(0, 1, -1).normalized();
  Vector2d heading_now_ = Vector2d::Zero();
  std::array<Heading, 256> headings_{};
  size_t heading_count_ = 0;
  bool has_attitude_ = false, walking_ = false;
  uint32_t mode_ = ODO_MODE_UNKNOWN;
  uint32_t count_ = 0;
};

}  // namespace

ODO_PLUGIN(OdographSteps)
