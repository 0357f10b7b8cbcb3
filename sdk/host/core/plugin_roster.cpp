// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/plugin_roster.hpp"

#include <algorithm>
#include <cmath>

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/surface_finder.h>
#include <odograph/terrain.h>
#include <odograph/vo_frontend.h>

namespace odograph {

Result<bool> PluginRoster::start(const PipelineConfig& config) {
  std::optional<Failure> failure;
  config.visit_plugins([&](const PluginChoice& choice) {
    if (failure) return;
    const auto number = static_cast<uint32_t>(plugins_.size() + 1);
    auto made = PluginInstance::make(choice, config.library_check, number, host_);
    made ? plugins_.push_back(std::move(*made)) : void(failure = made.failure());
  });
  if (failure) return *failure;
  const auto of_kind = [&](const char* interface_id) {
    Plugins found;
    for (const auto& plugin : plugins_)
      if (plugin->interface_id() == interface_id) found.push_back(plugin.get());
    return found;
  };
  for (const char* kind : {ODO_INTERFACE_ATTITUDE, ODO_INTERFACE_VO_FRONTEND, ODO_INTERFACE_SCALE_SOURCE,
                           ODO_INTERFACE_STEP_ESTIMATOR, ODO_INTERFACE_ABSOLUTE_FIXER, ODO_INTERFACE_SURFACE_FINDER})
    for (PluginInstance* plugin : of_kind(kind)) call_order_.push_back(plugin);
  scale_sources_ = of_kind(ODO_INTERFACE_SCALE_SOURCE);
  has_attitude_ = !config.attitudes.empty();
  has_front_end_ = !config.vo_frontends.empty();
  return true;
}

bool PluginRoster::is_for(const PluginInstance& plugin, const odo_header& message) const {
  if (!plugin.wants(message.type)) return false;
  const bool of_camera = message.type == ODO_TYPE_FRAME || message.type == ODO_TYPE_CALIBRATION;
  return !of_camera || camera_ == message.source || plugin.takes_several_cameras() ||
         plugin.interface_id() != ODO_INTERFACE_VO_FRONTEND;
}

bool PluginRoster::dispatch(const odo_header& message, const std::function<void()>& handled) {
  bool wanted = false;
  for (PluginInstance* plugin : call_order_) {
    if (is_for(*plugin, message)) {
      wanted = true;
      deliver(*plugin, message);
      handled();
    } else if (message.type == ODO_TYPE_FRAME && plugin->wants(message.type)) {
      host_.report(0, ODO_SEVERITY_INFO, "other_camera",
                   "frames of camera " + std::to_string(message.source) +
                       " are not passed to the front-end, whose camera is " + std::to_string(camera()));
    }
  }
  return wanted;
}

void PluginRoster::forward_event(const odo_header& event, bool scale_sources_too) {
  for (PluginInstance* plugin : call_order_) {
    if (plugin->number() == event.source || !plugin->wants(event.type)) continue;
    const bool is_scale = std::find(scale_sources_.begin(), scale_sources_.end(), plugin) != scale_sources_.end();
    if (scale_sources_too || !is_scale) deliver(*plugin, event);
  }
}

void PluginRoster::return_event(const odo_header& event) {
  for (PluginInstance* plugin : call_order_)
    if (plugin->number() == event.source && plugin->wants(event.type)) deliver(*plugin, event);
}

void PluginRoster::forward_to_kind(const char* interface_id, const odo_header& message) {
  for (PluginInstance* plugin : call_order_)
    if (plugin->interface_id() == interface_id && plugin->wants(message.type)) deliver(*plugin, message);
}

void PluginRoster::deliver(PluginInstance& plugin, const odo_header& message) {
  for (const AnyMessage& event : plugin.process(message)) emit_(event);
  if (plugin.take_reset()) send_descriptions(plugin);
}

void PluginRoster::send_descriptions(PluginInstance& plugin) {
  resets_.resize(plugins_.size());
  ++resets_[plugin.number() - 1];
  for (const AnyMessage& description : descriptions_) {
    if (!is_for(plugin, description.header())) continue;
    for (const AnyMessage& event : plugin.process(description.header())) emit_(event);
  }
  plugin.take_reset();
}

void PluginRoster::wake(const std::function<void()>& handled) {
  for (const uint32_t number : host_.take_woken()) {
    if (number == 0 || number > plugins_.size()) continue;
    PluginInstance& plugin = *plugins_[number - 1];
    for (const AnyMessage& event : plugin.wake()) emit_(event);
    if (plugin.take_reset()) send_descriptions(plugin);
    handled();
  }
}

void PluginRoster::reset() {
  for (const auto& plugin : plugins_) {
    const auto state = plugin->save();  // the clock was set back, but the walker is the same
    plugin->reset();
    if (!state.empty()) plugin->load(state);
    if (plugin->take_reset()) send_descriptions(*plugin);
  }
}

void PluginRoster::store_description(const odo_header& description) {
  const auto same = [&](const AnyMessage& known) {
    return known.header().type == description.type && known.header().source == description.source;
  };
  const auto found = std::find_if(descriptions_.begin(), descriptions_.end(), same);
  (found != descriptions_.end() ? *found : descriptions_.emplace_back()).assign(description);
}

bool PluginRoster::is_main_camera(const odo_header& message) {
  int64_t none = kNoCamera;
  camera_.compare_exchange_strong(none, message.source);
  return camera_ == message.source;
}

bool PluginRoster::in_use(const odo_header& event) const {
  const uint32_t type = event.type == ODO_TYPE_POINTS ? ODO_TYPE_VO_MOTION : event.type;  // with its frame's motion
  for (const auto& plugin : plugins_)
    if (plugin->alive() && plugin->emits(type)) return plugin->number() == event.source;
  return false;
}

bool PluginRoster::wants(uint32_t type) const {
  return std::any_of(plugins_.begin(), plugins_.end(), [type](const auto& plugin) { return plugin->wants(type); });
}

/// Whether an active plugin provides events of this type.
bool PluginRoster::emits(uint32_t type) const {
  return std::any_of(plugins_.begin(), plugins_.end(),
                     [type](const auto& plugin) { return plugin->alive() && plugin->emits(type); });
}

bool PluginRoster::any_failed() const {
  for (const auto& plugin : plugins_)
    for (const uint32_t type : {ODO_TYPE_ATTITUDE, ODO_TYPE_STEP, ODO_TYPE_VO_MOTION, ODO_TYPE_SCALE})
      if (plugin->emits(type) && (plugin->recovering() || (!plugin->alive() && !emits(type)))) return true;
  return false;
}

std::optional<double> PluginRoster::ground_at(double north_m, double east_m, double near_down_m) const {
  for (const auto& plugin : plugins_) {
    const auto* terrain = static_cast<const odo_terrain*>(plugin->extension(ODO_EXTENSION_TERRAIN));
    double down_m = 0, sigma_m = 0;
    if (terrain && ODO_HAS(terrain, height) && terrain->height &&
        terrain->height(terrain->user, north_m, east_m, near_down_m, &down_m, &sigma_m) == ODO_OK &&
        std::isfinite(down_m))
      return down_m;
  }
  return std::nullopt;
}

uint64_t PluginRoster::faults() const {
  uint64_t faults = 0;
  for (const auto& plugin : plugins_) faults += plugin->faults();
  return faults;
}

std::vector<std::string> PluginRoster::state_names() const {
  std::vector<std::string> names;
  for (const auto& plugin : plugins_) {
    const std::string plain = plugin->id();
    const auto same = [&](const std::string& name) { return name == plain || name.starts_with(plain + " #"); };
    const auto before = std::count_if(names.begin(), names.end(), same);
    names.push_back(before == 0 ? plain : plain + " #" + std::to_string(before + 1));
  }
  return names;
}

}  // namespace odograph
