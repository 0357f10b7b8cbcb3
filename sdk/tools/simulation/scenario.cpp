// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/scenario.hpp"

#include <algorithm>
#include <filesystem>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/table.hpp"

namespace odograph {
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
  for (const Value& stretch : d["open"].items) w.open.push_back(two(stretch));
  for (const Value& stretch : d["river"].items) w.river.push_back(two(stretch));
  w.open_width_m = d["open_width"].real, w.glass_fronts = d["glass_fronts"].real;
  w.glass = d["glass"].boolean, w.shadows = d["shadows"].boolean;
  w.trees = d["trees"].integer, w.parked_cars = d["parked_cars"].integer;
  w.pedestrians = d["pedestrians"].integer, w.cars = d["cars"].integer, w.light = d["light"].real;
  return w;
}

/// Explicit values override those of a profile or a default.
void set(const Value& v, double& x) {
  if (v.given) x = v.real;
}

Scenario::Camera take_camera(const Value& v, const std::string& profile) {
  Scenario::Camera c;
  c.width = static_cast<int>(v["width"].integer), c.height = static_cast<int>(v["height"].integer);
  take_camera_of(profile, c);
  c.model = v["model"].text;
  if (v["distortion"].given) c.distortion = v["distortion"].reals;
  set(v["focal"], c.focal_px), set(v["rate"], c.rate_hz), set(v["pitch"], c.pitch_rad), set(v["tilt"], c.tilt_rad);
  set(v["facing"], c.facing_rad);
  set(v["row_time"], c.row_time_s), set(v["exposure"], c.exposure_s);
  set(v["exposure_longest"], c.exposure_longest_s), set(v["exposure_interval"], c.exposure_interval_s);
  set(v["exposure_steps"], c.exposure_steps), set(v["vignetting"], c.vignetting);
  set(v["shot_noise"], c.shot_noise), set(v["read_noise"], c.read_noise);
  set(v["drop"], c.drop), set(v["jitter"], c.jitter_s), set(v["time_offset"], c.time_offset_s);
  set(v["unknown_time_offset"], c.unknown_time_offset_s), set(v["row_time_error"], c.row_time_error);
  set(v["focal_error"], c.focal_error), set(v["bit_rate"], c.bit_rate);
  const Value &s = v["stabiliser"], &f = v["focus"];
  set(s["travel"], c.stabiliser.travel_rad), set(s["high_pass"], c.stabiliser.high_pass_hz);
  set(s["end_pass"], c.stabiliser.end_pass_hz), set(s["gain"], c.stabiliser.gain);
  set(s["settling"], c.stabiliser.settling_s), set(s["residual"], c.stabiliser.residual_px);
  if (s["reported"].given) c.stabiliser.reported = s["reported"].boolean;
  set(s["report_error"], c.stabiliser.report_error_px);
  set(f["breathing"], c.focus.breathing), set(f["interval"], c.focus.interval_s), set(f["move"], c.focus.move_s);
  if (v["jpeg_quality"].given) c.jpeg_quality = static_cast<int>(v["jpeg_quality"].integer);
  return c;
}

Scenario::Imu take_imu(const Value& v, const std::string& profile) {
  Scenario::Imu i;
  take_imu_of(profile, i);
  set(v["rate"], i.rate_hz), set(v["gyro_noise"], i.gyro_noise), set(v["gyro_walk"], i.gyro_walk);
  set(v["accel_noise"], i.accel_noise), set(v["accel_walk"], i.accel_walk);
  set(v["gyro_bias"], i.gyro_bias), set(v["accel_bias"], i.accel_bias);
  set(v["misalignment"], i.misalignment_rad);
  if (v["scale_error"].given) i.scale_error = v["scale_error"].real, i.accel_scale_error = -1;
  set(v["accel_scale_error"], i.accel_scale_error);
  set(v["gyro_range"], i.gyro_range), set(v["accel_range"], i.accel_range);
  set(v["gyro_step"], i.gyro_step), set(v["accel_step"], i.accel_step), set(v["drop"], i.drop);
  set(v["gyro_warming"], i.gyro_warming), set(v["gyro_by_g"], i.gyro_by_g);
  set(v["jitter"], i.jitter_s), set(v["gap"], i.gap_s), set(v["gap_interval"], i.gap_interval_s);
  set(v["wild_interval"], i.outlier_interval_s);
  i.accelerometer = v["accelerometer"].boolean;
  return i;
}

Result<Scenario> take(const Value& v, const std::string& path, const std::string& profile) {
  Scenario s;
  const Value &w = v["walker"], &r = v["route"], &c = v["camera"], &i = v["imu"];
  auto world = take_world(v["world"], path);
  if (!world) return world.failure();
  s.world = std::move(*world);
  s.carrier = v["carrier"].text;
  s.vehicle = {v["vehicle"]["speed"].real, v["vehicle"]["camera_height"].real};
  s.walker = {w["height"].real, w["speed"].real, w["carry"].text, w["gait"].text,   w["stand"].real,
              w["bounce"].real, w["sway"].real,  w["weave"].real, w["rocking"].real};
  s.record_from_s = v["record"]["from"].real;
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
    s.objects.push_back(
        {o["at"].real, o["right"].real, o["up"].real, o["size"].real, o["kind"].text, o["aspect"].real});
  for (const Value& e : r["events"].items) {
    const std::string& what = e["do"].text;
    const bool car_only = what == "bump", both = what == "stand" || what == "speed";
    if (!both && car_only != s.drives())
      return Failure{ODO_E_CONFIG, at(path, e["do"].mark,
                                      "route.events: '" + what + "' is nothing that a " + s.carrier + " does" +
                                          (s.drives() ? "; expected stand, speed or bump" : ""))};
    s.events.push_back({e["at"].real, e["do"].text, e["for"].real, e["speed"].real, e["waypoint"].boolean});
  }
  s.camera = take_camera(c, profile);
  s.imu = take_imu(i, i["profile"].text == "camera" ? profile : i["profile"].text);
  const Value &m = v["magnetometer"], &b = v["barometer"], &g = v["gnss"];
  s.magnetometer = {m["rate"].real, m["noise"].real, m["hard_iron"].real, m["soft_iron"].real, m["disturbance"].real};
  s.barometer = {b["noise"].real, b["drift"].real, b["wind"].real};
  s.gnss = {g["sigma"].real, g["canyon_sigma"].real, g["correlation"].real, g["availability"].real};
  return s;
}

constexpr int kMaxBases = 8;

/// Merges maps recursively; keys of `over` take precedence.
YamlNode merged(YamlNode base, const YamlNode& over) {
  if (base.kind != YamlNode::Kind::map || over.kind != YamlNode::Kind::map) return over;
  for (const auto& entry : over.entries) {
    const auto same = std::find_if(base.entries.begin(), base.entries.end(),
                                   [&](const YamlNode::Entry& e) { return e.key == entry.key; });
    if (same == base.entries.end())
      base.entries.push_back(entry);
    else
      *same = {entry.key, entry.mark, merged(same->value, entry.value)};
  }
  base.mark = over.mark;
  return base;
}

Result<Value> checked(const YamlNode& node, const std::string& path) {
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  return validate(node, scenario_spec(), path, none);
}

/// The files from this one to the last base, each with its document.
Result<std::vector<std::pair<std::string, YamlNode>>> read_with_bases(const std::string& path) {
  std::vector<std::pair<std::string, YamlNode>> files;
  for (std::string next = path; !next.empty();) {
    auto node = read_yaml(next);
    if (!node) return node.failure();
    const YamlNode* base = node->kind == YamlNode::Kind::map ? node->find("base") : nullptr;
    std::string other;
    if (base && base->kind == YamlNode::Kind::scalar && !base->text.empty()) {
      if (files.size() == kMaxBases)
        return Failure{ODO_E_CONFIG, at(next, base->mark,
                                        "base: more than " + std::to_string(kMaxBases) +
                                            " files build on each other; is it a circle?")};
      other = (std::filesystem::path(next).parent_path() / base->text).string();
    }
    files.emplace_back(std::move(next), std::move(*node));
    next = std::move(other);
  }
  return files;
}

}  // namespace

Result<Scenario> read_scenario(const std::string& path, const std::string& camera_profile) {
  auto files = read_with_bases(path);
  if (!files) return files.failure();
  YamlNode node = files->back().second;
  for (size_t i = files->size() - 1; i > 0; --i) {  // reports a mistake in a base with the base's own line
    if (const auto good = checked(node, (*files)[i].first); !good) return good.failure();
    node = merged(std::move(node), (*files)[i - 1].second);
  }
  const auto values = checked(node, path);
  if (!values) return values.failure();
  const std::string profile = camera_profile.empty() ? (*values)["camera"]["profile"].text : camera_profile;
  const auto known = split(kPhoneProfiles, '|');
  if (std::find(known.begin(), known.end(), profile) == known.end())
    return Failure{ODO_E_CONFIG, "camera profile '" + profile + "'; expected one of " + join(known) + " (nearest: '" +
                                     nearest(profile, known) + "')"};
  return take(*values, path, profile.empty() ? "clean" : profile);
}

Result<std::string> scenario_text(const std::string& path) {
  const auto files = read_with_bases(path);
  if (!files) return files.failure();
  std::string all;
  for (const auto& [file, node] : *files) {
    const auto text = read_limited(file);
    if (!text) return text.failure();
    all += *text;
  }
  return all;
}

}  // namespace odograph
