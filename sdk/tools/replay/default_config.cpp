// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/default_config.hpp"

namespace odograph {

std::string default_config(const Recording& recording) {
  const bool camera = recording.has(ODO_TYPE_FRAME), places = recording.has(ODO_TYPE_GNSS);
  const bool compass = !camera && recording.has(ODO_TYPE_MAGNETOMETER);  // with a camera, the heading needs no compass
  std::string text =
      "# For a recording of a walker with a phone in the hand; set walker.height for accuracy.\nodograph: 1\nwalker:\n "
      " height: 1.70 m\n";
  text += std::string("attitude:\n  plugin: ") + (compass ? "attitude/magyq" : "attitude/vqf") + "\n";
  text += "step_estimator:\n  plugin: step/odograph\n";
  if (camera) text += "vo_frontend:\n  plugin: vo/odograph\n";
  text += "coupling:\n  type: localizer\n";
  if (places) text += "absolute_fixers:\n  - plugin: fix/gnss\n";
  return text;
}

}  // namespace odograph
