// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/scenario.hpp"

#include "sdk/host/config/table.hpp"

namespace odograph {
namespace {

using table::boolean, table::choice, table::integer, table::map, table::real;

Spec list(const char* name, const char* help, Spec item) {
  return {.name = name, .type = SpecType::list, .help = help, .children = {std::move(item)}};
}

Spec text_key(const char* name, const char* help) {
  return {.name = name, .type = SpecType::text, .fallback = "", .help = help};
}

Spec reals(const char* name, const char* unit, double min, double max, size_t count, const char* help) {
  return {.name = name,
          .type = SpecType::reals,
          .unit = unit,
          .min = min,
          .max = max,
          .fallback = "",
          .help = help,
          .count = count};
}

Spec required(Spec spec) {
  spec.required = true;
  return spec;
}

Spec world_spec() {
  return map(
      "world", "the surroundings",
      {choice("type", "street|downtown|city|room|corridor", "street",
              "a street of houses along the route, a downtown of towers, a city model, a furnished hall, or a "
              "white corridor"),
       text_key("model", "city model for `type: city`, CityJSON or OBJ; relative to this file"),
       reals("model_origin", "m", -1e8, 1e8, 3,
             "easting, northing and height of the route's zero in the model; its south-west corner if not given"),
       list("unmapped", "ranges of the route whose buildings are missing in any city model",
            reals("stretch", "m", 0, 1e5, 2, "from, to")),
       list("open", "ranges of the route that cross a square: no houses, trees and cars, distant fronts around",
            reals("stretch", "m", 0, 1e5, 2, "from, to")),
       list("river", "ranges of the route along a river on the right, with moving water and distant fronts beyond",
            reals("stretch", "m", 0, 1e5, 2, "from, to")),
       real("open_width", "m", 40, 600, "160", "width of squares and rivers, from front to front"),
       real("glass_fronts", "", 0, 1, "0", "fraction of the houses with a glass front"),
       reals("sun", "rad", -7, 7, 2, "azimuth from north and elevation; from the seed if not given"),
       real("street_width", "m", 4, 80, "16", "between the facades"),
       real("house_height", "m", 3, 200, "12", "mean height of the houses"),
       boolean("glass", "true", "windows reflect the opposite side"), boolean("shadows", "true", "of the sun"),
       integer("trees", 0, 100, "12", "for every 100 m of the route"),
       integer("parked_cars", 0, 100, "8", "for every 100 m of the route"),
       integer("pedestrians", 0, 200, "6", "walking, for every 100 m of the route"),
       integer("cars", 0, 50, "2", "driving, for every 100 m of the route"),
       real("light", "", 0.01, 1, "1", "daylight: 1 noon, 0.03 night under street lamps")});
}

Spec route_spec() {
  const Spec point = reals("point", "m", -1e4, 1e4, 3, "north, east, up");
  Spec event = map(
      "event", "an event along the route",
      {required(real("at", "m", 0, 1e5, "0", "distance along the route")),
       required(choice(
           "do",
           "stand|look_around|handle|turn|evade|cross|shuffle|sidestep|backwards|speed|bump|texting|"
           "swinging|pocket|leg|bag|dark|lift",
           "stand",
           "stop and stand still, look around, type and gesture (handle) or turn in place; step around somebody; cross "
           "a road from kerb to kerb; small steps (shuffle); small steps to the side or backwards; change the speed; "
           "change the carrying position (leg: against a thigh; bag: on a strap, swinging freely); cover the camera "
           "(dark); ride in a lift, up and the next one down; a car has stand, speed and bump (a hump in the road)")),
       real("for", "s", 0, 3600, "5", "duration"),
       real("speed", "m/s", 0.2, 40, "1.35", "for `do: speed`; above 2.2 a walker runs"),
       boolean("waypoint", "false",
               "a surveyed mark on the ground; the recording has the time at which the walker is on it")});
  Spec object =
      map("object", "a board with a tag of the family 36h11 or a poster, at a surveyed position; numbered from 0",
          {required(real("at", "m", 0, 1e5, "0", "distance along the route; it faces approaching walkers")),
           real("right", "m", -100, 100, "4", "offset to the right of the route"),
           real("up", "m", 0, 100, "1.8", "height of its centre above the ground"),
           real("size", "m", 0.05, 10, "0.8", "side of the tag's black square, or the poster's height"),
           choice("kind", "tag|poster", "tag", "its kind; the seed determines a poster's content"),
           real("aspect", "", 0.25, 4, "0.6667", "of a poster: width over height")});
  return map(
      "route", "the route of the walk or drive",
      {list("points", "corners of the route, at least two", point),
       real("corner", "m", 0.3, 100, "3", "radius of the corners"), list("events", "in any order", std::move(event)),
       list("objects", "known objects along the route", std::move(object))});
}

Spec stabiliser_spec() {
  return map("stabiliser", "optical stabilisation: the principal point follows hand shake, with a leaky integrator",
             {real("travel", "rad", 0, 0.05, "0", "travel of the lens; 0 = no stabilisation"),
              real("high_pass", "Hz", 0, 20, "0.9", "slower rotation is not compensated"),
              real("end_pass", "Hz", 0, 50, "13", "the same at the end of the travel; between them with its square"),
              real("gain", "", 0, 1.2, "0.95", "fraction of the shake that is compensated"),
              real("settling", "s", 0, 0.2, "0.02", "of the lens, to 2 %"),
              real("residual", "px", 0, 5, "0.33", "standard deviation of the lens about its set point"),
              boolean("reported", "false", "the recording has a calibration before each frame"),
              real("report_error", "px", 0, 10, "0.4", "standard deviation of the principal point in it")});
}

Spec focus_spec() {
  return map("focus", "autofocus moves the focal length (breathing)",
             {real("breathing", "", 0, 0.1, "0", "maximum relative change in each direction"),
              real("interval", "s", 0.05, 600, "4", "mean time between moves"),
              real("move", "s", 0, 5, "0.3", "duration of a move")});
}

Spec camera_spec() {
  return map(
      "camera", "the phone's rear camera",
      {choice("profile", kPhoneProfiles, "clean",
              "phone that sets the defaults of the keys below and of `imu`; `clean` has the defaults stated here"),
       integer("width", 64, 4096, "640", "pixels"),
       integer("height", 48, 4096, "480", "pixels"),
       choice("model", "pinhole|kannala_brandt", "pinhole", "lens"),
       real("focal", "px", 50, 5000, "500", "focal length"),
       reals("distortion", "", -2, 2, 4, "k1 k2 p1 p2 of a pinhole, k1 k2 k3 k4 of Kannala-Brandt"),
       real("rate", "Hz", 1, 120, "10", "frames a second"),
       real("pitch", "rad", -1.57, 1.57, "-0.2", "camera elevation when texting; negative is downwards"),
       real("tilt", "rad", -1.6, 1.6, "0", "of the camera in the phone, from straight out of its back towards its top"),
       real("facing", "rad", -3.15, 3.15, "0", "of the phone in the hand, from the direction of the walk to the right"),
       real("row_time", "s", 0, 1e-3, "30e-6", "rolling shutter: from one row to the next; 0 = global shutter"),
       real("exposure", "s", 0, 0.1, "8e-3", "of a frame; moving pictures blur over it"),
       real("exposure_longest", "s", 0, 0.1, "0", "the exposure changes at random between both; 0 = constant"),
       real("exposure_interval", "s", 0.1, 600, "3", "mean time between such changes"),
       real("exposure_steps", "", 0, 1, "0.03", "standard deviation of the gain's steps from frame to frame"),
       real("vignetting", "", 0, 1, "0.25", "loss of light in the corners"),
       real("shot_noise", "", 0, 5, "0.35", "standard deviation at grey value 1, proportional to the square root"),
       real("read_noise", "", 0, 50, "1.2", "standard deviation of a grey value in the dark"),
       real("drop", "", 0, 0.9, "0", "fraction of the frames that are lost"),
       real("jitter", "s", 0, 0.05, "0", "standard deviation of the time stamps"),
       real("time_offset", "s", -0.2, 0.2, "0", "IMU time = camera time + this; stated in the calibration"),
       real("unknown_time_offset", "s", -0.2, 0.2, "0", "additional offset, not stated"),
       real("row_time_error", "", -0.9, 2, "0",
            "fraction by which the recording's row time is larger than the true one"),
       real("focal_error", "", -0.3, 0.3, "0", "fraction by which the recording's focal length is larger"),
       stabiliser_spec(),
       focus_spec(),
       real("bit_rate", "", 0, 1e9, "0",
            "bit rate of the video in bit/s at 30 frames a second, as H.264; 0 = no video codec"),
       integer("jpeg_quality", 0, 100, "90", "of the stored pictures; 0 = PNG")});
}

Spec imu_spec() {
  return map(
      "imu", "inertial sensor",
      {choice("profile", "camera|clean|phone|phone_reported|phone_indoors|phone_old", "camera",
              "phone that sets the defaults of the keys below"),
       real("rate", "Hz", 20, 1000, "200", "samples a second"),
       real("gyro_noise", "", 0, 1, "1e-3", "rad/s/sqrt(Hz)"),
       real("gyro_walk", "", 0, 1, "1e-5", "rad/s^2/sqrt(Hz)"),
       real("accel_noise", "", 0, 1, "1e-2", "m/s^2/sqrt(Hz)"),
       real("accel_walk", "", 0, 1, "1e-4", "m/s^3/sqrt(Hz)"),
       real("gyro_bias", "rad/s", 0, 1, "5e-3", "standard deviation of the constant bias"),
       real("accel_bias", "m/s^2", 0, 5, "5e-2", "standard deviation of the constant bias"),
       real("scale_error", "", 0, 0.2, "3e-3", "standard deviation of each axis's scale"),
       real("misalignment", "rad", 0, 0.2, "3e-3", "standard deviation of each axis's angle"),
       real("gyro_range", "rad/s", 0.5, 100, "34.9", "saturates beyond"),
       real("accel_range", "m/s^2", 15, 1000, "78.5", "saturates beyond"),
       real("gyro_step", "rad/s", 0, 0.1, "1.07e-3", "quantisation"),
       real("accel_step", "m/s^2", 0, 1, "2.4e-3", "quantisation"),
       real("drop", "", 0, 0.9, "0", "fraction of the samples that are lost"),
       real("accel_scale_error", "", 0, 0.2, "3e-3", "scale_error of the accelerometer; as scale_error if not given"),
       real("gyro_warming", "rad/s", 0, 0.1, "0",
            "standard deviation of the bias's change for each kelvin; the phone warms by 10 K (time constant 5 min)"),
       real("gyro_by_g", "rad/s", 0, 0.1, "0", "standard deviation of the error per axis caused by 1 g on each axis"),
       real("jitter", "s", 0, 0.02, "0", "standard deviation of the time stamps, which stay in order"),
       real("gap", "s", 0, 0.5, "0",
            "longest stall after which several samples arrive with nearly the same time stamp"),
       real("gap_interval", "s", 0.1, 600, "5", "mean time between stalls"),
       real("wild_interval", "s", 0, 3600, "0", "mean time between outliers; 0 = none"),
       boolean("accelerometer", "true", "false: the recording has none")});
}

}  // namespace

const Spec& scenario_spec() {
  static const Spec spec =
      map("scenario", "A simulated walk or drive",
          {required(integer("odograph_scenario", 1, 1, "1", "version of this file format")),
           text_key("base", "another scenario file, relative to this one, that provides the keys missing here"),
           map("record", "the recorded part of the walk",
               {real("from", "s", 0, 3600, "0", "start of the recording, for one that begins in mid-walk")}),
           world_spec(),
           choice("carrier", "walker|car", "walker", "a walker's hand, or a car's roof with the camera facing up"),
           map("vehicle", "for `carrier: car`",
               {real("speed", "m/s", 1, 40, "11", "speed limit; lower in bends and before stops"),
                real("camera_height", "m", 0.5, 4, "1.55", "above the road")}),
           map("walker", "the walker; the seed determines the individual gait",
               {real("height", "m", 1.0, 2.3, "1.70", "body height"),
                real("speed", "m/s", 0.3, 4, "1.35", "mean walking speed; above 2.2 a walker runs"),
                choice("carry", "texting|swinging|pocket|leg|bag", "texting",
                       "carrying position of the phone at the start"),
                choice("gait", "brisk|viewing", "brisk",
                       "walks purposefully, or views the world through the phone: gentle, unsteady, scanning, phone "
                       "held up; set 0.5 to 1.2 m/s for the latter"),
                real("stand", "s", 0.5, 600, "2", "standing before and after the walk or drive"),
                real("bounce", "", 0, 3, "1", "vertical motion of the trunk, relative to the usual"),
                real("sway", "", 0, 3, "1", "sway and surge with the stride, relative to the usual"),
                real("weave", "", 0, 3, "1", "lateral deviation from the path, relative to the usual"),
                real("rocking", "", 0, 3, "1", "rotation of the phone with the gait, relative to the usual")}),
           route_spec(), camera_spec(), imu_spec(),
           map("magnetometer", "three-axis compass",
               {real("rate", "Hz", 1, 200, "50", "samples a second"),
                real("noise", "T", 0, 1e-4, "0.4e-6", "standard deviation of a sample"),
                real("hard_iron", "T", 0, 1e-3, "3e-6", "standard deviation of the phone's constant field"),
                real("soft_iron", "", 0, 0.5, "0.02", "standard deviation of the entries of its distortion"),
                real("disturbance", "T", 0, 1e-3, "5e-6",
                     "standard deviation of fields along the path, a few metres wide")}),
           map("barometer", "pressure, once a second",
               {real("noise", "Pa", 0, 100, "3", "standard deviation of a sample"),
                real("drift", "Pa", 0, 1000, "20", "standard deviation of the weather's drift after an hour"),
                real("wind", "Pa", 0, 100, "4", "standard deviation of gusts, a few seconds long")}),
           map("gnss", "GNSS receiver, one fix a second",
               {real("sigma", "m", 0.01, 100, "4", "standard deviation of each horizontal component in the open"),
                real("canyon_sigma", "m", 0.01, 200, "12", "the same between the houses"),
                real("correlation", "s", 1, 600, "20", "time constant of the error"),
                real("availability", "", 0, 1, "0.9", "fraction of the time with a fix; outages are contiguous")})});
  return spec;
}

}  // namespace odograph
