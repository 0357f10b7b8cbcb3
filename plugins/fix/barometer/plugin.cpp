// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include <odograph/plugin.hpp>

#include "plugins/fix/barometer/pressure_height.hpp"

namespace {

using odograph::barometer::PressureHeight;

/// Heights from the barometer, relative to the start or to the last fix with a height.
class Barometer {
 public:
  double start_down = 0, start_sigma = 0.1, noise = 0.5, walk = 0.03, trend = 7e-4, interval = 2, alike = 60;
  bool from_start = true;

  static constexpr odo::Description description{"fix/barometer", "1.0.0",
                                                "Heights from pressure relative to the start or the last known height",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Barometer>> parameters() {
    using P = Barometer;
    return {
        odo::boolean("from_start", &P::from_start, "the height at the first reading is start_down"),
        odo::real("start_down", "m", -1e5, 1e5, &P::start_down, "n's down coordinate at the start"),
        odo::real("start_sigma", "m", 0.001, 1000, &P::start_sigma, "standard deviation of start_down"),
        odo::real("noise", "m", 0.01, 100, &P::noise, "standard deviation of a reading, as a height: sensor and wind"),
        odo::real("walk", "", 0, 10, &P::walk,
                  "random walk of the pressure as a height, m/sqrt(s): weather, doors, ventilation"),
        odo::real("trend", "m/s", 0, 1, &P::trend, "standard deviation of the weather's trend"),
        odo::real("interval", "s", 0.1, 600, &P::interval, "averaging time of the readings of one fix"),
        odo::real("alike", "s", 0, 36000, &P::alike, "correlation time of the weather's error since the reference")};
  }

  void configured() { reset(); }
  void reset() {
    PressureHeight::Parameters p;
    p.noise_m = noise, p.walk_m = walk, p.trend_mps = trend, p.average_s = interval, p.alike_s = alike;
    height_.emplace(p);
    started_ = false;
  }

  void on(const odo_barometer& reading, odo::Output& output) {
    if (!started_ && from_start) height_->refer(reading.header.t_ns, start_down, start_sigma * start_sigma);
    started_ = true;
    const auto height = height_->add(reading.header.t_ns, reading.pressure_pa);
    if (!height) return;
    auto fix = odo::make<odo_fix>(height->t_ns);
    fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
    fix.p_n[2] = height->down_m;
    fix.covariance_n[0] = fix.covariance_n[4] = 1e6;  // horizontal: not valid
    fix.covariance_n[8] = height->fix_variance_m2;
    fix.integrity = 0.01;
    output.emit(fix);
  }

  /// A height from another plugin that the estimator has used.
  void on(const odo_fix& fix, odo::Output&) {
    constexpr uint32_t needed = ODO_FIX_DOWN | ODO_FLAG_ACCEPTED;
    if ((fix.header.flags & needed) != needed) return;
    height_->refer(fix.header.t_ns, fix.p_n[2], fix.covariance_n[8]);
  }

 private:
  std::optional<PressureHeight> height_;
  bool started_ = false;
};

}  // namespace

ODO_PLUGIN(Barometer)
