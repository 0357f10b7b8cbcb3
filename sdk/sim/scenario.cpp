// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/scenario.hpp"

#include <filesystem>

#include "sdk/config/table.hpp"

namespace odograph {
namespace {

using table::boolean, table::choice, table::integer, table::map, table::real;

Spec list(const char* name, const char* help, Spec item) {
  return {.name = name, .type = SpecType::list, .help = help, .children = {std::move(item)}};
}

Spec text(const char* name, const char* help) {
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
      "world", "what there is to see",
      {choice("type", "street|downtown|city|room|corridor", "street",
              "a street of houses along the route, a downtown of towers, a city model, a furnished hall, or a "
              "white corridor"),
       text("model", "city model for `type: city`, CityJSON or OBJ; relative to this file"),
       reals("model_origin", "m", -1e8, 1e8, 3,
             "easting, northing and height of the route's zero in the model; its south-west corner if not given"),
       list("unmapped", "stretches of the route whose buildings are newer than any city model",
            reals("stretch", "m", 0, 1e5, 2, "from, to")),
       reals("sun", "rad", -7, 7, 2, "azimuth from north and height; drawn by the seed if not given"),
       real("street_width", "m", 4, 80, "16", "between the facades"),
       real("house_height", "m", 3, 200, "12", "mean height of the houses"),
       boolean("glass", "true", "windows reflect what stands opposite"), boolean("shadows", "true", "of the sun"),
       integer("trees", 0, 100, "12", "for every 100 m of the route"),
       integer("parked_cars", 0, 100, "8", "for every 100 m of the route"),
       integer("pedestrians", 0, 200, "6", "walking, for every 100 m of the route"),
       integer("cars", 0, 50, "2", "driving, for every 100 m of the route"),
       real("light", "", 0.01, 1, "1", "of the day: 1 noon, 0.03 night under lamps")});
}

Spec route_spec() {
  const Spec point = reals("point", "m", -1e4, 1e4, 3, "north, east, up");
  Spec event =
      map("event", "what happens on the way",
          {required(real("at", "m", 0, 1e5, "0", "distance along the route")),
           required(choice("do", "stand|look_around|handle|turn|evade|cross|shuffle|speed|bump|texting|swinging|pocket",
                           "stand",
                           "stop and stand still, look around, type and gesture (handle) or turn in place; step "
                           "around somebody; cross a road from kerb to kerb; small steps; another speed; another way "
                           "to carry the phone; a car knows "
                           "stand, speed and bump (a hump in the road)")),
           real("for", "s", 0, 3600, "5", "how long, where the walker stands; over how long otherwise"),
           real("speed", "m/s", 0.2, 40, "1.35", "for `do: speed`; above 2.2 a walker runs"),
           boolean("waypoint", "false", "a surveyed mark on the ground: the recording says when he is on it")});
  Spec object = map("object", "a board with a tag of the family 36h11, its place surveyed; tags are numbered from 0",
                    {required(real("at", "m", 0, 1e5, "0", "distance along the route; it faces those who come")),
                     real("right", "m", -100, 100, "4", "beside the route"),
                     real("up", "m", 0, 100, "1.8", "of its middle above the ground"),
                     real("size", "m", 0.05, 10, "0.8", "side of the tag's black square")});
  return map(
      "route", "where the walk or drive goes",
      {list("points", "corners of the route, at least two", point),
       real("corner", "m", 0.3, 100, "3", "radius of the corners"), list("events", "in any order", std::move(event)),
       list("objects", "known objects along the way", std::move(object))});
}

Spec camera_spec() {
  return map(
      "camera", "the phone's rear camera",
      {integer("width", 64, 4096, "640", "pixels"), integer("height", 48, 4096, "480", "pixels"),
       choice("model", "pinhole|kannala_brandt", "pinhole", "lens"),
       real("focal", "px", 50, 5000, "500", "focal length"),
       reals("distortion", "", -2, 2, 4, "k1 k2 p1 p2 of a pinhole, k1 k2 k3 k4 of Kannala-Brandt"),
       real("rate", "Hz", 1, 120, "10", "frames a second"),
       real("pitch", "rad", -1.57, 1.57, "-0.2", "of the view when texting; negative looks down"),
       real("tilt", "rad", -1.6, 1.6, "0", "of the camera in the phone, from straight out of its back towards its top"),
       real("row_time", "s", 0, 1e-3, "30e-6", "rolling shutter: from one row to the next; 0 = global shutter"),
       real("exposure", "s", 0, 0.1, "8e-3", "of a frame; moving pictures blur over it"),
       real("exposure_steps", "", 0, 1, "0.03", "standard deviation of the gain's steps from frame to frame"),
       real("vignetting", "", 0, 1, "0.25", "loss of light in the corners"),
       real("shot_noise", "", 0, 5, "0.35", "standard deviation of a grey value at 1, growing with its root"),
       real("read_noise", "", 0, 50, "1.2", "standard deviation of a grey value in the dark"),
       real("drop", "", 0, 0.9, "0", "fraction of the frames that are lost"),
       real("jitter", "s", 0, 0.05, "0", "standard deviation of the time stamps"),
       real("time_offset", "s", -0.2, 0.2, "0", "IMU time = camera time + this; told in the calibration"),
       integer("jpeg_quality", 0, 100, "90", "of the stored pictures; 0 = PNG")});
}

Spec imu_spec() {
  return map(
      "imu", "inertial sensor",
      {real("rate", "Hz", 20, 1000, "200", "samples a second"), real("gyro_noise", "", 0, 1, "1e-3", "rad/s/sqrt(Hz)"),
       real("gyro_walk", "", 0, 1, "1e-5", "rad/s^2/sqrt(Hz)"), real("accel_noise", "", 0, 1, "1e-2", "m/s^2/sqrt(Hz)"),
       real("accel_walk", "", 0, 1, "1e-4", "m/s^3/sqrt(Hz)"),
       real("gyro_bias", "rad/s", 0, 1, "5e-3", "standard deviation of the constant bias"),
       real("accel_bias", "m/s^2", 0, 5, "5e-2", "standard deviation of the constant bias"),
       real("scale_error", "", 0, 0.2, "3e-3", "standard deviation of each axis's scale"),
       real("misalignment", "rad", 0, 0.2, "3e-3", "standard deviation of each axis's angle"),
       real("gyro_range", "rad/s", 0.5, 100, "34.9", "saturates beyond"),
       real("accel_range", "m/s^2", 15, 1000, "78.5", "saturates beyond"),
       real("gyro_step", "rad/s", 0, 0.1, "1.07e-3", "quantisation"),
       real("accel_step", "m/s^2", 0, 1, "2.4e-3", "quantisation"),
       real("drop", "", 0, 0.9, "0", "fraction of the samples that are lost")});
}

}  // namespace

const Spec& scenario_spec() {
  static const Spec spec =
      map("scenario", "A simulated walk or drive",
          {required(integer("odograph_scenario", 1, 1, "1", "version of this file format")), world_spec(),
           choice("carrier", "walker|car", "walker", "a walker's hand, or a car's roof with the camera upwards"),
           map("vehicle", "for `carrier: car`",
               {real("speed", "m/s", 1, 40, "11", "the limit, in bends and before stops less"),
                real("camera_height", "m", 0.5, 4, "1.55", "above the road")}),
           map("walker", "who walks; seeds draw the individual's gait",
               {real("height", "m", 1.0, 2.3, "1.70", "body height"),
                real("speed", "m/s", 0.3, 4, "1.35", "mean walking speed; above 2.2 he runs"),
                choice("carry", "texting|swinging|pocket", "texting", "how the phone is carried at the start"),
                real("stand", "s", 0.5, 600, "2", "standing before and after the walk or drive")}),
           route_spec(), camera_spec(), imu_spec(),
           map("magnetometer", "three-axis compass",
               {real("rate", "Hz", 1, 200, "50", "samples a second"),
                real("noise", "T", 0, 1e-4, "0.4e-6", "standard deviation of a sample"),
                real("hard_iron", "T", 0, 1e-3, "3e-6", "standard deviation of the phone's own constant field"),
                real("soft_iron", "", 0, 0.5, "0.02", "standard deviation of the entries of its distortion"),
                real("disturbance", "T", 0, 1e-3, "5e-6",
                     "standard deviation of fields along the way, a few metres wide")}),
           map("barometer", "pressure, once a second",
               {real("noise", "Pa", 0, 100, "3", "standard deviation of a sample"),
                real("drift", "Pa", 0, 1000, "20", "standard deviation reached in an hour of weather"),
                real("wind", "Pa", 0, 100, "4", "standard deviation of gusts, a few seconds long")}),
           map("gnss", "satellite receiver, one fix a second",
               {real("sigma", "m", 0.01, 100, "4", "standard deviation of each horizontal component in the open"),
                real("canyon_sigma", "m", 0.01, 200, "12", "the same between the houses"),
                real("correlation", "s", 1, 600, "20", "time constant of the error"),
                real("availability", "", 0, 1, "0.9", "fraction of the time with a fix, lost in whole stretches")})});
  return spec;
}

namespace {

Result<Scenario::World> take_world(const Value& d, const std::string& path) {
  Scenario::World w;
  w.type = d["type"].text;
  w.street_width_m = d["street_width"].real, w.house_height_m = d["house_height"].real;
  if (d["model"].given) w.model = (std::filesystem::path(path).parent_path() / d["model"].text).string();
  if ((w.type == "city") != d["model"].given)
    return Failure{ODO_E_CONFIG, at(path, d["model"].given ? d["model"].mark : d["type"].mark,
                                    w.type == "city" ? "world.model: missing; `type: city` is built of a city model"
                                                     : "world.model: only `type: city` is built of a city model")};
  const auto two = [](const Value& pair) { return Eigen::Vector2d(pair.reals[0], pair.reals[1]); };
  if (const Value& o = d["model_origin"]; o.given) w.model_origin = Eigen::Vector3d::Map(o.reals.data());
  if (d["sun"].given) w.sun = two(d["sun"]);
  for (const Value& stretch : d["unmapped"].items) w.unmapped.push_back(two(stretch));
  w.glass = d["glass"].boolean, w.shadows = d["shadows"].boolean;
  w.trees = d["trees"].integer, w.parked_cars = d["parked_cars"].integer;
  w.pedestrians = d["pedestrians"].integer, w.cars = d["cars"].integer, w.light = d["light"].real;
  return w;
}

Result<Scenario> take(const Value& v, const std::string& path) {
  Scenario s;
  const Value &w = v["walker"], &r = v["route"], &c = v["camera"], &i = v["imu"];
  auto world = take_world(v["world"], path);
  if (!world) return world.failure();
  s.world = std::move(*world);
  s.carrier = v["carrier"].text;
  s.vehicle = {v["vehicle"]["speed"].real, v["vehicle"]["camera_height"].real};
  s.walker = {w["height"].real, w["speed"].real, w["carry"].text, w["stand"].real};
  if (r["points"].given) {
    s.route.clear();
    for (const Value& p : r["points"].items) s.route.emplace_back(p.reals[0], p.reals[1], p.reals[2]);
    if (s.route.size() < 2)
      return Failure{ODO_E_CONFIG,
                     at(path, r["points"].mark,
                        "route.points: " + std::to_string(s.route.size()) + " points; expected at least two")};
  }
  s.corner_m = r["corner"].real;
  for (const Value& o : r["objects"].items)
    s.objects.push_back({o["at"].real, o["right"].real, o["up"].real, o["size"].real});
  for (const Value& e : r["events"].items) {
    const std::string& what = e["do"].text;
    const bool car_only = what == "bump", both = what == "stand" || what == "speed";
    if (!both && car_only != s.drives())
      return Failure{ODO_E_CONFIG, at(path, e["do"].mark,
                                      "route.events: '" + what + "' is nothing that a " + s.carrier + " does" +
                                          (s.drives() ? "; expected stand, speed or bump" : ""))};
    s.events.push_back({e["at"].real, e["do"].text, e["for"].real, e["speed"].real, e["waypoint"].boolean});
  }
  s.camera.width = static_cast<int>(c["width"].integer), s.camera.height = static_cast<int>(c["height"].integer);
  s.camera.model = c["model"].text, s.camera.focal_px = c["focal"].real;
  if (c["distortion"].given) s.camera.distortion = c["distortion"].reals;
  s.camera.rate_hz = c["rate"].real, s.camera.pitch_rad = c["pitch"].real, s.camera.tilt_rad = c["tilt"].real;
  s.camera.row_time_s = c["row_time"].real, s.camera.exposure_s = c["exposure"].real;
  s.camera.exposure_steps = c["exposure_steps"].real, s.camera.vignetting = c["vignetting"].real;
  s.camera.shot_noise = c["shot_noise"].real, s.camera.read_noise = c["read_noise"].real;
  s.camera.drop = c["drop"].real, s.camera.jitter_s = c["jitter"].real, s.camera.time_offset_s = c["time_offset"].real;
  s.camera.jpeg_quality = static_cast<int>(c["jpeg_quality"].integer);
  s.imu = {i["rate"].real,         i["gyro_noise"].real, i["gyro_walk"].real,   i["accel_noise"].real,
           i["accel_walk"].real,   i["gyro_bias"].real,  i["accel_bias"].real,  i["scale_error"].real,
           i["misalignment"].real, i["gyro_range"].real, i["accel_range"].real, i["gyro_step"].real,
           i["accel_step"].real,   i["drop"].real};
  const Value &m = v["magnetometer"], &b = v["barometer"], &g = v["gnss"];
  s.magnetometer = {m["rate"].real, m["noise"].real, m["hard_iron"].real, m["soft_iron"].real, m["disturbance"].real};
  s.barometer = {b["noise"].real, b["drift"].real, b["wind"].real};
  s.gnss = {g["sigma"].real, g["canyon_sigma"].real, g["correlation"].real, g["availability"].real};
  return s;
}

}  // namespace

Result<Scenario> read_scenario(const std::string& path) {
  auto node = read_yaml(path);
  if (!node) return node.failure();
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  const auto checked = validate(*node, scenario_spec(), path, none);
  if (!checked) return checked.failure();
  return take(*checked, path);
}

}  // namespace odograph
