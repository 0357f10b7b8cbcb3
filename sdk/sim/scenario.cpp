// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/scenario.hpp"

namespace odograph {
namespace {

Spec real(const char* name, const char* unit, double min, double max, const char* fallback, const char* help) {
  return {
      .name = name, .type = SpecType::real, .unit = unit, .min = min, .max = max, .fallback = fallback, .help = help};
}
Spec integer(const char* name, double min, double max, const char* fallback, const char* help) {
  return {.name = name, .type = SpecType::integer, .min = min, .max = max, .fallback = fallback, .help = help};
}
Spec map(const char* name, const char* help, std::vector<Spec> children) {
  return {.name = name, .type = SpecType::map, .help = help, .children = std::move(children)};
}

}  // namespace

const Spec& scenario_spec() {
  static const Spec spec = [] {
    Spec version = integer("odograph_scenario", 1, 1, "1", "version of this file format");
    version.required = true;
    return map(
        "scenario", "A simulated walk",
        {
            version,
            {.name = "world",
             .type = SpecType::choice,
             .fallback = "street",
             .choices = "street|room",
             .help = "textured planes: a street of facades, or a room"},
            map("walker", "who walks, and where",
                {
                    real("height", "m", 1.0, 2.3, "1.70", "body height; the phone is held at 0.85 of it"),
                    real("speed", "m/s", 0.3, 2.5, "1.35", "walking speed"),
                    real("step_length", "m", 0.2, 1.2, "0.72",
                         "mean length of a step at that speed; left and right differ by 2 %"),
                    real("stand", "s", 0.5, 60, "2", "standing before and after the walk"),
                    real("straight", "m", 1, 500, "18", "length of the path before the turn, and again after it"),
                    real("turn", "rad", -3, 3, "1.2", "angle of the turn, to the right positive"),
                    real("turn_radius", "m", 1, 100, "4", "radius of the turn"),
                }),
            map("camera", "the phone's rear camera",
                {
                    integer("width", 64, 4096, "640", "pixels"),
                    integer("height", 48, 4096, "480", "pixels"),
                    real("focal", "px", 50, 5000, "500", "focal length"),
                    real("rate", "Hz", 1, 120, "10", "frames a second"),
                    real("pitch", "rad", -1.5, 1.5, "-0.2", "of the view; negative looks down"),
                    real("noise", "", 0, 50, "2", "standard deviation of a grey value, of 255"),
                    integer("jpeg_quality", 0, 100, "92", "of the stored pictures; 0 = PNG"),
                }),
            map("imu", "inertial sensor",
                {
                    real("rate", "Hz", 20, 1000, "200", "samples a second"),
                    real("gyro_noise", "", 0, 1, "1e-3", "rad/s/sqrt(Hz)"),
                    real("gyro_walk", "", 0, 1, "1e-5", "rad/s^2/sqrt(Hz)"),
                    real("accel_noise", "", 0, 1, "1e-2", "m/s^2/sqrt(Hz)"),
                    real("accel_walk", "", 0, 1, "1e-4", "m/s^3/sqrt(Hz)"),
                    real("gyro_bias", "rad/s", 0, 1, "5e-3", "standard deviation of the constant bias"),
                    real("accel_bias", "m/s^2", 0, 5, "5e-2", "standard deviation of the constant bias"),
                }),
            map("gnss", "satellite receiver, one fix a second",
                {
                    real("sigma", "m", 0.01, 100, "4",
                         "standard deviation of each horizontal component, correlated over 10 s"),
                }),
        });
  }();
  return spec;
}

Result<Scenario> read_scenario(const std::string& path) {
  auto node = read_yaml(path);
  if (!node) return node.failure();
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  const auto checked = validate(*node, scenario_spec(), path, none);
  if (!checked) return checked.failure();
  const Value& v = *checked;
  const Value &w = v["walker"], &c = v["camera"], &i = v["imu"];
  Scenario s;
  s.world = v["world"].text;
  s.walker_height_m = w["height"].real, s.speed_mps = w["speed"].real, s.step_length_m = w["step_length"].real;
  s.stand_s = w["stand"].real, s.straight_m = w["straight"].real, s.turn_rad = w["turn"].real,
  s.turn_radius_m = w["turn_radius"].real;
  s.width = static_cast<int>(c["width"].integer), s.height = static_cast<int>(c["height"].integer);
  s.focal_px = c["focal"].real, s.camera_hz = c["rate"].real, s.pitch_rad = c["pitch"].real,
  s.pixel_noise = c["noise"].real;
  s.jpeg_quality = static_cast<int>(c["jpeg_quality"].integer);
  s.imu_hz = i["rate"].real, s.gyro_noise = i["gyro_noise"].real, s.gyro_walk = i["gyro_walk"].real;
  s.accel_noise = i["accel_noise"].real, s.accel_walk = i["accel_walk"].real, s.gyro_bias = i["gyro_bias"].real,
  s.accel_bias = i["accel_bias"].real;
  s.gnss_sigma_m = v["gnss"]["sigma"].real;
  return s;
}

}  // namespace odograph
