// SPDX-License-Identifier: Apache-2.0
#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/surface_finder.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/plugin_host/backend.hpp"

namespace odograph {

KindTypes kind_types(const std::string& id) {
  if (id == ODO_INTERFACE_ATTITUDE)
    return {{ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER, ODO_TYPE_IMU_NOISE}, {ODO_TYPE_ATTITUDE}};
  if (id == ODO_INTERFACE_STEP_ESTIMATOR)
    return {{ODO_TYPE_IMU, ODO_TYPE_ATTITUDE, ODO_TYPE_BAROMETER, ODO_TYPE_SYSTEM_STEP, ODO_TYPE_FIX},
            {ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE}};
  if (id == ODO_INTERFACE_VO_FRONTEND)
    return {{ODO_TYPE_CALIBRATION, ODO_TYPE_FRAME, ODO_TYPE_IMU, ODO_TYPE_IMU_NOISE, ODO_TYPE_ATTITUDE},
            {ODO_TYPE_VO_MOTION, ODO_TYPE_REFINED}};
  if (id == ODO_INTERFACE_SCALE_SOURCE)
    return {{ODO_TYPE_VO_MOTION, ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE, ODO_TYPE_FIX}, {ODO_TYPE_SCALE}};
  if (id == ODO_INTERFACE_ABSOLUTE_FIXER)
    return {{ODO_TYPE_GNSS, ODO_TYPE_BAROMETER, ODO_TYPE_WAYPOINT, ODO_TYPE_RANGE, ODO_TYPE_EARTH_FIELD, ODO_TYPE_FRAME,
             ODO_TYPE_CALIBRATION, ODO_TYPE_POSE},
            {ODO_TYPE_FIX, ODO_TYPE_RELATIVE_POSE}};
  if (id == ODO_INTERFACE_SURFACE_FINDER)
    return {{ODO_TYPE_POINTS, ODO_TYPE_POSE, ODO_TYPE_CORRECTION}, {ODO_TYPE_SURFACE}};
  return {};
}

KindTypes plugin_types(const std::string& id, const odo_plugin& table) {
  KindTypes types = kind_types(id);
  if (table.flags & ODO_PLUGIN_INPUTS_WHOLE) types.inputs.clear();
  types.inputs.insert(types.inputs.end(), table.inputs, table.inputs + table.input_count);
  types.outputs.insert(types.outputs.end(), table.outputs, table.outputs + table.output_count);
  types.flags = table.flags;
  return types;
}

}  // namespace odograph
