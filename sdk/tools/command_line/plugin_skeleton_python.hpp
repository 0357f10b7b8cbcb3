// SPDX-License-Identifier: Apache-2.0
//
// Templates of `odograph plugin new --language python`; words between @ are replaced.
#pragma once

namespace odograph {

/// The parts that depend on the kind: the same small algorithms as in C++ and C.
struct PythonSkeleton {
  const char* kind;
  const char* state;  // initial state of an instance
  const char* body;   // body of on(self, message, emit)
};

inline const PythonSkeleton kPythonSkeletons[] = {
    {"attitude", "    heading_rad, last_ns = 0.0, 0\n    up_b = np.zeros(3)\n",
     R"(        if message.TYPE != ODO_TYPE_IMU:
            return
        gyro, accel = np.array(message.gyro_b), np.array(message.accel_b)
        if not (np.abs(gyro).max() < 1e3 and np.abs(accel).max() < 1e3):
            raise plugin.Discard  # no sensor says that, and it would stay in up_b for ever
        dt = 1e-9 * (message.t_ns - self.last_ns) if self.last_ns else 0.0
        self.last_ns = message.t_ns
        self.up_b = self.up_b + (accel - self.up_b) * (min(1.0, self.gain * dt) if dt > 0 else 1.0)
        norm = float(np.linalg.norm(self.up_b))
        if not norm > 1.0:
            return
        if 0 < dt < 1:
            self.heading_rad -= float(gyro @ self.up_b) / norm * dt  # about down
        # The shortest rotation that takes up_b to z, 180 degrees about x (up is -z in North-East-Down), the heading about z.
        w, x, y = norm + self.up_b[2], self.up_b[1], -self.up_b[0]
        q = math.sqrt(w * w + x * x + y * y)
        w, x, y = (w / q, x / q, y / q) if q > 1e-6 * norm else (0.0, 1.0, 0.0)
        c, s = math.cos(self.heading_rad / 2), math.sin(self.heading_rad / 2)
        emit(Attitude(t_ns=message.t_ns, q_n_b=(-c * x - s * y, c * w, s * w, c * y - s * x), covariance_n=0.01 * np.eye(3).ravel()))
)"},
    {"step_estimator", "    last_ns, high, count = 0, False, 0\n",
     R"(        if message.TYPE != ODO_TYPE_IMU:
            return
        high = math.hypot(*message.accel_b) > 10.8
        begins = high and not self.high
        self.high = high
        lasted_ns = message.t_ns - self.last_ns
        if not begins or lasted_ns < 300_000_000:
            return
        before_ns, self.last_ns = self.last_ns, message.t_ns
        if lasted_ns > 1_500_000_000:
            return  # the first of a walk
        emit(Step(t_ns=message.t_ns, t_start_ns=before_ns, t_end_ns=message.t_ns, length_m=self.gain, sigma_m=0.2 * self.gain,
                  frequency_hz=1e9 / lasted_ns, index=self.count))
        self.count += 1
)"},
    {"vo_frontend", "    last_ns = None\n",
     R"(        if message.TYPE != ODO_TYPE_FRAME:
            return
        # message.pixels: NumPy, height x width x bytes of a pixel, of the first plane
        if self.last_ns is not None and message.t_ns <= self.last_ns:
            raise plugin.Discard
        from_ns, self.last_ns = self.last_ns, message.t_ns
        if from_ns is not None:
            emit(VoMotion(t_ns=message.t_ns, t_from_ns=from_ns, camera=message.source, state=ODO_LOST, reason=ODO_REASON_INITIALISING))
)"},
    {"scale_source", "",
     R"(        if message.TYPE != ODO_TYPE_VO_MOTION or not message.flags & ODO_VO_TRANSLATION:
            return
        units = math.hypot(*message.p_c0_c1)
        if not 1e-9 < units < 1e9:
            return
        scale = self.gain * 1e-9 * (message.t_ns - message.t_from_ns) / units
        emit(Scale(t_ns=message.t_ns, scale=scale, sigma=0.2 * scale, valid_from_ns=message.t_from_ns, valid_to_ns=message.t_ns,
                   scale_group=message.scale_group))
)"},
    {"absolute_fixer", "",
     R"(        if message.TYPE != ODO_TYPE_WAYPOINT:
            return
        north, east, _ = message.p_n
        if not (abs(north) < 1e7 and abs(east) < 1e7 and message.sigma_m < 1e7):
            raise plugin.Discard  # not a position on the Earth
        sigma = max(self.gain * 0.01, message.sigma_m)
        emit(Fix(t_ns=message.t_ns, flags=ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE, p_n=(north, east, 0),
                 covariance_n=sigma * sigma * np.eye(3).ravel()))
)"},
};

inline constexpr char kPython[] = R"(# SPDX-License-Identifier: Apache-2.0
"""@SUMMARY@."""
import math

import numpy as np
from odograph import plugin
from odograph.abi import *  # constants and messages, by their C names


class Mine:
    ID, VERSION, SUMMARY = "@ID@", "0.1.0", "@SUMMARY@"
    KIND = @INTERFACE@
    PARAMETERS = [plugin.Parameter("gain", "@UNIT@", @LOW@, @HIGH@, @DEFAULT@, "@HELP@")]  # each becomes a member: self.gain
@STATE@
    def on(self, message, emit):
@BODY@

plugin.serve(Mine)
)";

inline constexpr char kPythonCMake[] = R"(cmake_minimum_required(VERSION 3.16)
project(@FILE@ LANGUAGES C)
find_package(Odograph REQUIRED)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
find_path(ODOGRAPH_PYTHON plugin_host.c HINTS ${Odograph_DIR}/../../../share/odograph/bindings/python ${Odograph_DIR}/../../../../share/odograph/bindings/python REQUIRED)
# Generate the plugin's table from its Python file, which the library runs in a separate process.
set(describe ${CMAKE_COMMAND} -E env PYTHONPATH=${ODOGRAPH_PYTHON} ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/@FILE@.py --describe)
add_custom_command(OUTPUT plugin_description.h COMMAND ${describe} > plugin_description.h DEPENDS @FILE@.py VERBATIM)
add_library(@FILE@ MODULE ${ODOGRAPH_PYTHON}/plugin_host.c ${CMAKE_CURRENT_BINARY_DIR}/plugin_description.h)
target_include_directories(@FILE@ PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
target_compile_definitions(@FILE@ PRIVATE PLUGIN_FILE="${CMAKE_CURRENT_SOURCE_DIR}/@FILE@.py" PLUGIN_PYTHON="${Python3_EXECUTABLE}" PLUGIN_PATH="${ODOGRAPH_PYTHON}")
target_link_libraries(@FILE@ PRIVATE Odograph::abi)
set_target_properties(@FILE@ PROPERTIES PREFIX "" C_STANDARD 99 C_VISIBILITY_PRESET hidden)
# Write the manifest beside the library.
find_program(ODOGRAPH_PROGRAM odograph HINTS ${Odograph_DIR}/../../../bin ${Odograph_DIR}/../../../../bin REQUIRED)
add_custom_command(TARGET @FILE@ POST_BUILD COMMAND ${ODOGRAPH_PROGRAM} plugin manifest $<TARGET_FILE:@FILE@> VERBATIM)
)";

}  // namespace odograph
