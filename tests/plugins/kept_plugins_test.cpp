// SPDX-License-Identifier: Apache-2.0
//
// Output of each plugin without a camera on a walk with many faults, compared with the last reviewed one (see
// kept_results_test.cpp). Correctness is the subject of other tests.
#include <string>

#include "tests/support/kept.hpp"
#include "tests/support/plugin_run.hpp"
#include "tests/support/disturbed_walk.hpp"

TEST_SUITE_BEGIN("kept_plugins");

namespace {

constexpr Tolerance kSame = {1e-6, false};

const std::vector<AnyMessage>& disturbed_walk() {
  static const DisturbedWalk walk;
  return walk.messages;
}

void add(Digest& digest, const std::string& of, const odo_header& header, int64_t start_ns) {
  const auto s = [&](int64_t t_ns) { return static_cast<double>(t_ns - start_ns) * 1e-9; };
  digest.add(of + ".t_s", s(header.t_ns));
  digest.add(of + ".flags", header.flags);
  if (header.type == ODO_TYPE_ATTITUDE) {
    const auto& x = as<odo_attitude>(header);
    digest.add(of + ".q_n_b", x.q_n_b, 4);
    digest.add(of + ".covariance_n", x.covariance_n, 3, 4);
    digest.add(of + ".gyro_bias_b", x.gyro_bias_b, 3);
  } else if (header.type == ODO_TYPE_STEP) {
    const auto& x = as<odo_step>(header);
    const double all[] = {s(x.t_start_ns), s(x.t_end_ns), x.length_m,         x.sigma_m,
                          x.frequency_hz,  x.heading_rad, double(x.mode) + 0, double(x.index) + 0};
    digest.add(of + ".step", all, 8);
    digest.add(of + ".quality", static_cast<double>(header.quality));
  } else if (header.type == ODO_TYPE_MOTION_MODE) {
    digest.add(of + ".mode", as<odo_motion_mode>(header).mode);
  } else if (header.type == ODO_TYPE_SCALE) {
    const auto& x = as<odo_scale>(header);
    const double all[] = {s(x.valid_from_ns), s(x.valid_to_ns),     x.scale, x.sigma,
                          x.displacement_m,   double(x.scale_group)};
    digest.add(of + ".scale", all, 6);
  } else if (header.type == ODO_TYPE_FIX) {
    const auto& x = as<odo_fix>(header);
    digest.add(of + ".p_n", x.p_n, 3);
    digest.add(of + ".covariance_n", x.covariance_n, 3, 4);
    const double all[] = {x.yaw_rad,  x.yaw_sigma_rad, x.latitude_rad * 1e6, x.longitude_rad * 1e6,
                          x.height_m, x.integrity};
    digest.add(of + ".fix", all, 6);
  }
}

struct Choice {
  const char* plugin;
  PluginRun::Settings settings;
  size_t at_least = 5;  ///< min events for a valid test
};

}  // namespace

TEST_CASE("every plugin gives the kept events on a walk with many faults, and each choice the same after a reset") {
  const bool compared = kept_for_this_machine();
  Digest digest;
  for (const Choice& choice : std::vector<Choice>{
           {"attitude_vqf", {}},
           {"attitude_vqf", {{"magnetometer", "true"}, {"tau_mag", "2"}, {"tau_acc", "1"}}},
           {"attitude_vqf", {{"forward_axis", "[1, 0.2, 0]"}}},
           {"attitude_magyq", {}},
           {"attitude_magyq", {{"magnetometer", "false"}}},
           {"step_odograph", {}},
           {"step_odograph", {{"learn", "false"}, {"factor", "1.1"}, {"factor_sigma", "0.03"}}},
           {"step_odograph", {{"forward_axis", "[1, 0, 0]"}}},
           {"step_renaudin2012", {}},
           {"step_weinberg2002", {}},
           {"step_kim2004", {}},
           {"step_scarlett2007", {}},
           {"step_tian2016", {{"forward_axis", "[1, 0, 0]"}}},
           {"scale_step_length", {}},
           {"scale_step_length", {{"hold", "1"}}},
           {"scale_step_fit", {}},
           {"scale_step_fit", {{"drift", "0.03"}, {"common", "0"}}},
           {"scale_fixed_step", {}},
           {"scale_slant_distance", {}},
           {"scale_slant_distance", {{"window", "5"}, {"min_displacement", "3"}, {"initial_scale", "3"}}},
           {"scale_slant_distance", {{"formula", "gakne2018"}}},
           {"scale_inertial", {}},
           {"fix_gnss", {}},
           {"fix_gnss", {{"height", "true"}, {"heading", "false"}, {"correlation", "0"}, {"min_satellites", "3"}}},
           {"fix_gnss", {{"correlation", "5"}, {"bias_time", "20"}, {"sigma", "3"}, {"min_sigma", "6"}}},
           {"fix_barometer", {}},
           {"fix_barometer", {{"from_start", "false"}, {"interval", "1"}}},
           {"fix_waypoint", {}, 1},
           {"fix_waypoint", {{"use", "all"}}}}) {
    CAPTURE(std::string(choice.plugin));
    PluginRun run(choice.plugin, choice.settings);
    const auto events = run(disturbed_walk());
    CHECK(events.size() >= choice.at_least);
    if (choice.settings.empty() || std::string(choice.plugin) == "step_tian2016")
      for (const auto& event : events)
        add(digest, std::string(choice.plugin) + "." + message_name(event.header().type), event.header(),
            disturbed_walk().front().header().t_ns);
    run.reset();
    CHECK(same_events(events, run(disturbed_walk())));
  }
  if (compared) compare_kept("plugins", digest.text(), kSame);
}
