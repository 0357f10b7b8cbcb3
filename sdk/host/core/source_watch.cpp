// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/source_watch.hpp"

#include <algorithm>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

/// Without which a plugin of any kind does its work: descriptions, and what the host adds.
constexpr uint32_t kOptional[] = {ODO_TYPE_CALIBRATION, ODO_TYPE_IMU_NOISE,  ODO_TYPE_EARTH_FIELD, ODO_TYPE_SYSTEM_STEP,
                                  ODO_TYPE_MOTION_MODE, ODO_TYPE_CORRECTION, ODO_TYPE_KEY_FRAME};

}  // namespace

void SourceWatch::came(const odo_header& message) {
  came_.add(message.type);
  if (ODO_IS_EVENT(message.type)) gave_.insert(message.source);
  if (ODO_IS_EVENT(message.type) || is_description(message)) return;
  if (!first_ns_) first_ns_ = message.t_ns;
  now_ns_ = std::max(now_ns_, message.t_ns);
}

void SourceWatch::report(const PluginInstance& plugin, const std::string& text) {
  host_.report(plugin.number(), ODO_SEVERITY_INFO, "unused_source", "no effect: " + text);
}

void SourceWatch::on_pointless_scale(uint32_t source) {
  if (!pointless_.insert(source).second || source - 1 >= roster_.plugins().size()) return;
  report(*roster_.plugins()[source - 1],
         "the front-end's motions are in metres; remove the scale source, or choose a front-end up to scale "
         "(vo/odograph with 'inertial: false')");
}

/// The inputs of the plugin that have not come; empty if all have.
std::string SourceWatch::without_input(const PluginInstance& plugin) const {
  std::string missing;
  const auto add = [&](uint32_t type) {
    const bool optional = std::find(std::begin(kOptional), std::end(kOptional), type) != std::end(kOptional);
    if (optional || !plugin.wants(type) || came_.has(type)) return;
    missing += (missing.empty() ? "" : ", ") + message_name(type);
  };
#define ODO_ROW(number, type, name, min_size) add(number);
  ODO_FOR_EACH_MESSAGE(ODO_ROW)
#undef ODO_ROW
  return missing;
}

void SourceWatch::judge() {
  if (judged_ || !first_ns_ || seconds(saturating_difference(now_ns_, *first_ns_)) < p_.judged_s) return;
  judged_ = true;
  for (const auto& plugin : roster_.plugins()) {
    if (gave_.contains(plugin->number()) || !plugin->alive()) continue;
    if (const std::string missing = without_input(*plugin); !missing.empty())  // otherwise it may need more
      report(*plugin, "it has given nothing, and " + missing + " did not come; add this input, or remove the plugin");
  }
}

}  // namespace odograph
