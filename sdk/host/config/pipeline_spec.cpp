// SPDX-License-Identifier: Apache-2.0
#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/surface_finder.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/config/table.hpp"

namespace odograph {
namespace {

using table::boolean, table::choice, table::integer, table::map, table::real;

Spec texts(const char* name, const char* item, const char* help) {
  return {.name = name, .type = SpecType::list, .help = help, .children = {{.name = item, .type = SpecType::text}}};
}
Spec plugin(const char* name, const char* interface_id, const char* help) {
  return {.name = name, .type = SpecType::plugins, .help = help, .interface_id = interface_id};
}

Spec signers() {
  Spec signer = map("signer", "{ids: PATTERN, key: KEY}", {});
  signer.children = {
      Spec{.name = "ids",
           .type = SpecType::text,
           .fallback = "*",
           .help = "an id, a prefix and '*', as in 'acme/*', or '*' for every plugin"},
      Spec{
          .name = "key", .type = SpecType::text, .help = "Ed25519 public key, 64 hexadecimal digits", .required = true},
  };
  return {.name = "signers",
          .type = SpecType::list,
          .help =
              "a plugin whose id matches must have a manifest signed with one of the matching keys "
              "(NAME.odoplugin.sig); others need no signature",
          .children = {std::move(signer)}};
}

Spec plugins_section() {
  return map("plugins", "where plugins are found and how they run",
             {
                 texts("search", "directory", "directories, relative to this file, before the standard ones"),
                 texts("allow", "id, path or SHA-256",
                       "if given, only plugins with one of these ids, manifest or library paths, or hashes of the "
                       "library may be loaded"),
                 signers(),
                 boolean("verify_hash", "true", "refuse a library whose hash differs from its manifest's"),
                 boolean("allow_writable", "false", "also load from world-writable folders and files"),
                 Spec{.name = "isolation",
                      .type = SpecType::choice,
                      .fallback = "none",
                      .choices = "none|process",
                      .renamed = "thread=process",
                      .help = "where a plugin runs by default; process: in a process of its own"},
                 Spec{.name = "host",
                      .type = SpecType::text,
                      .help = "path of odograph-plugin-host, if it is not beside the library"},
             });
}

Spec navigation_section() {
  Spec position{.name = "position",
                .type = SpecType::reals,
                .unit = "m",
                .fallback = "[0, 0, 0]",
                .help = "north, east, down",
                .count = 3};
  return map("navigation", "the local frame n (North-East-Down)",
             {
                 map("origin", "of n; without it the first GNSS fix",
                     {
                         real("latitude", "rad", -1.5707963267948966, 1.5707963267948966, "0", "geodetic, WGS 84"),
                         real("longitude", "rad", -6.283185307179586, 6.283185307179586, "0", "WGS 84"),
                         real("height", "m", -1000, 10000, "0", "above the ellipsoid"),
                     }),
                 real("declination", "rad", -3.141592653589793, 3.141592653589793, "0",
                      "magnetic north from true north, positive to the east; without it the app's (odo_earth_field)"),
                 map("start", "pose at the start; without it the first fix, or zero",
                     {
                         position,
                         real("heading", "rad", -6.283185307179586, 6.283185307179586, "0", "from north to east"),
                     }),
             });
}

Spec coupling_section() {
  return map(
      "coupling", "how all inputs are fused into one pose",
      {
          Spec{.name = "type",
               .type = SpecType::choice,
               .fallback = "paper",
               .choices = "paper|localizer",
               .renamed = "per_frame=paper|inertial=localizer",
               .help = "paper: each frame's displacement is scaled on its own (Antigny et al. 2019, section 3.4); "
                       "localizer: one scale for the track, estimated from the front-end, steps and scale sources, and "
                       "corrected by fixes (docs/estimator.md)"},
          choice("orientation", "vo|gyroscope|attitude", "vo",
                 "vo: composed from frame to frame; gyroscope: integrated from the gyroscope; both corrected by fixes; "
                 "attitude: the attitude source's, fixes correct its heading"),
          choice("vertical", "ignore|scaled", "ignore",
                 "paper only. ignore: horizontal displacement only, as in the paper; scaled: all three components"),
          choice("compass", "always|start", "always",
                 "always: a heading that refers to north corrects the camera's all along; start: it gives that of the "
                 "start alone, as in Antigny et al. 2019, section 5.2"),
          real("fix_gate", "", 0, 100, "5",
               "a fix more than this many standard deviations from the track is rejected; 0 = no gate"),
          real("bridge", "s", 0, 60, "2",
               "how long steps alone may move the track without visual tracking before the pose is lost"),
          real("fastest", "m/s", 0.01, 200, "2",
               "maximum speed of the carrier: growth of the position uncertainty without scale or picture; a motion "
               "five times faster is rejected"),
          real("odometry_covariance", "", 0.01, 100, "1",
               "factor on the covariance that a visual front-end states, including that of its scale; above 1 for an "
               "overconfident one"),
      });
}

}  // namespace

const Spec& pipeline_spec() {
  static const Spec spec = [] {
    Spec version = integer("odograph", 1, 1, "1", "version of this file format");
    version.required = true;
    return map(
        "pipeline", "An Odograph pipeline",
        {
            version,
            plugins_section(),
            map("walker", "the person who carries the device",
                {
                    real("height", "m", 0.5, 2.5, "1.70",
                         "body height; a plugin's parameter 'walker_height' and fix/terrain's 'height' take it unless "
                         "given"),
                }),
            navigation_section(),
            Spec{.name = "camera",
                 .type = SpecType::text,
                 .help = "camera.yaml of `odograph calibrate`, relative to this file; it overrides the lens of a "
                         "recording or an app, and the mount and the time offset if it states them"},
            map("time_ordering", "how samples of several sensors are merged in time order",
                {
                    real("max_wait", "s", 0, 5, "0.2", "longest wait for a slower sensor, in sensor time"),
                    real("max_gap", "s", 0.01, 60, "1", "a longer gap of the IMU or the camera is reported as a fault"),
                    integer("queue", 64, 1000000, "4096",
                            "maximum number of waiting samples; more are dropped and counted"),
                    integer("frames", 1, 64, "8", "maximum number of camera frames held by the host and by plugins"),
                }),
            plugin("attitude", ODO_INTERFACE_ATTITUDE, "orientation of the body"),
            plugin("step_estimator", ODO_INTERFACE_STEP_ESTIMATOR, "steps and how the device is carried"),
            plugin("vo_frontend", ODO_INTERFACE_VO_FRONTEND, "camera motion up to scale"),
            plugin("scale_source", ODO_INTERFACE_SCALE_SOURCE, "scale of the front-end's displacements"),
            plugin("absolute_fixers", ODO_INTERFACE_ABSOLUTE_FIXER, "absolute positions and orientations"),
            plugin("surface_finder", ODO_INTERFACE_SURFACE_FINDER,
                   "floor, tables and walls from the front-end's landmarks, for odo_session_hit_test"),
            coupling_section(),
            map("replay", "how `odograph run` aligns a recording's map with n",
                {
                    boolean("start_at_first_waypoint", "false",
                            "the written track starts at the recording's first waypoint"),
                    real("align_heading_over", "m", 0, 1000, "0",
                         "the written track is rotated to fit the waypoints over its first metres; 0 = no rotation"),
                }),
        });
  }();
  return spec;
}

}  // namespace odograph
