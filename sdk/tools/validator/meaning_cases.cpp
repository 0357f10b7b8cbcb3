// SPDX-License-Identifier: Apache-2.0
//
// Events required of each kind, and plausibility of their numbers: the thresholds are limits of people and phones.
#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Geometry>
#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/validator/case_fixture.hpp"

namespace odograph {
CASES(meaning)
namespace {

constexpr double kShortestStep_m = 0.1, kLongestStep_m = 2.6;  // a runner's longest
constexpr double kFastestStep_hz = 6.0;                        // sprinters reach 5
constexpr double kWrongScale = 10;                             // factor: the walk's true scale is 1.4 m
constexpr double kWrongUp_rad = 0.5;                           // of an attitude after ten seconds of walking
constexpr double kFarthest_m = 1e6;                            // a fix in a pedestrian's local frame
constexpr int64_t kLateStep_ns = 500'000'000;                  // step_estimator.h
constexpr int64_t kHeldBack_ns = 4'000'000'000;                // the same: six steps at the start of a walk
constexpr int64_t kPause_ns = 1'500'000'000;                   // longer than any step: the walk ended there
constexpr int64_t kSecond_ns = 1'000'000'000;

template <class Event>
std::vector<std::pair<const SeenEvent*, const Event*>> all_of(const PluginDriver& driver, uint32_t type) {
  std::vector<std::pair<const SeenEvent*, const Event*>> found;
  for (const SeenEvent& event : driver.events)
    if (event.message.header().type == type) found.emplace_back(&event, &as<Event>(event.message.header()));
  return found;
}

/// Runs the walk and checks all events of a type; not applicable if the plugin does not emit it.
template <class Event, class Ask>
Verdict of_all(CaseFixture& fixture, uint32_t type, Ask&& ask) {
  if (!fixture.emits(type)) return not_applicable("it emits no " + message_name(type));
  const PluginDriver* driver = fixture.walked_instance();
  return ask(all_of<Event>(*driver, type));
}
/// The same for each event; the fault is completed by its time.
template <class Event, class Ask>
Verdict of_each(CaseFixture& fixture, uint32_t type, Ask&& ask) {
  return of_all<Event>(fixture, type, [&](const auto& all) -> std::string {
    for (const auto& [seen, event] : all)
      if (const std::string fault = ask(*event); !fault.empty())
        return fault + " (t_ns = " + std::to_string(event->header.t_ns) + ")";
    return "";
  });
}
std::string at(const odo_header& h) { return " (t_ns = " + std::to_string(h.t_ns) + ")"; }

// ---- attitude ------------------------------------------------------------------------------------------------------
CASE(meaning, "attitude.each_sample", "emits an attitude for each sample once it has started", 20, 10,
     .any_input = true) {
  if (!fixture.serves(ODO_INTERFACE_ATTITUDE)) return not_applicable("it is not an attitude plugin");
  return of_all<odo_attitude>(fixture, ODO_TYPE_ATTITUDE, [&](const auto& all) -> std::string {
    size_t next = 0;
    bool begun = false;
    for (const AnyMessage& message : fixture.input) {
      if (message.header().type != ODO_TYPE_IMU) continue;
      const bool answered = next < all.size() && all[next].second->header.t_ns == message.header().t_ns;
      if (!answered && begun) return "no attitude for the sample" + at(message.header()) + " although it had started";
      if (answered) begun = true, ++next;
    }
    return next == all.size() ? "" : "it emits attitudes for times without a sample";
  });
}

CASE(meaning, "attitude.up", "knows the vertical after 10 s", 20, 10) {
  return of_all<odo_attitude>(fixture, ODO_TYPE_ATTITUDE, [](const auto& all) -> std::string {
    if (all.empty()) return "it emitted no attitude";
    const Eigen::Vector3d up_n = raw_quaternion(all.back().second->q_n_b) * Eigen::Vector3d::UnitZ();
    const double off = std::acos(std::clamp(-up_n.z(), -1.0, 1.0));
    return off < kWrongUp_rad
               ? ""
               : "up is " + std::to_string(off) + " rad off after 10 s: is q_n_b from b to North-East-Down?";
  });
}

// ---- steps ---------------------------------------------------------------------------------------------------------
CASE(meaning, "step.length", "emits steps of plausible length", 20, 10, .any_input = true) {
  return of_each<odo_step>(fixture, ODO_TYPE_STEP, [](const odo_step& step) -> std::string {
    if (step.length_m >= kShortestStep_m && step.length_m <= kLongestStep_m) return "";
    return "length_m = " + std::to_string(step.length_m) + ", people step 0.1 to 2.6 m";
  });
}

CASE(meaning, "step.frequency", "emits plausible step frequencies", 20, 10, .any_input = true) {
  return of_each<odo_step>(fixture, ODO_TYPE_STEP, [](const odo_step& step) -> std::string {
    if (step.frequency_hz > 0 && step.frequency_hz <= kFastestStep_hz) return "";
    return "frequency_hz = " + std::to_string(step.frequency_hz) + ", expected steps a second";
  });
}

CASE(meaning, "step.order", "emits steps that do not overlap", 20, 10, .any_input = true) {
  return of_all<odo_step>(fixture, ODO_TYPE_STEP, [](const auto& all) -> std::string {
    for (size_t i = 1; i < all.size(); ++i)
      if (all[i].second->t_start_ns < all[i - 1].second->t_end_ns)
        return "two steps overlap" + at(all[i].second->header);
    return "";
  });
}

CASE(meaning, "step.times", "emits only completed steps of finite duration", 20, 10, .any_input = true) {
  return of_each<odo_step>(fixture, ODO_TYPE_STEP, [](const odo_step& step) -> std::string {
    if (step.t_end_ns > step.header.t_ns) return "t_end_ns is after the step's own time";
    return step.t_end_ns - step.t_start_ns > 5 * kSecond_ns ? "a step lasts more than 5 s" : "";
  });
}

/// The first steps of a walk may be held back until the walk is confirmed: they arrive together with a timely one, long
/// after the previous walk's last step.
CASE(meaning, "step.late", "emits a step at most 0.5 s after the foot's contact", 20, 10, .any_input = true) {
  return of_all<odo_step>(fixture, ODO_TYPE_STEP, [](const auto& all) -> std::string {
    int64_t last_end_ns = INT64_MIN;  // of the earlier calls
    for (size_t i = 0; i < all.size();) {
      size_t end = i;
      int64_t min_ns = INT64_MAX;
      for (; end < all.size() && all[end].first->call == all[i].first->call; ++end)
        min_ns = std::min(min_ns, all[end].first->input_ns - all[end].second->t_end_ns);
      const odo_step& first = *all[i].second;
      const bool walk_begins = last_end_ns == INT64_MIN || first.t_start_ns - last_end_ns > kPause_ns;
      const int64_t max_ns = walk_begins && min_ns <= kLateStep_ns ? kHeldBack_ns : kLateStep_ns;
      for (; i < end; ++i) {
        const auto& [seen, step] = all[i];
        if (const int64_t late_ns = seen->input_ns - step->t_end_ns; late_ns > max_ns)
          return "a step arrived " + std::to_string(seconds(late_ns)) + " s after the foot's contact" +
                 at(step->header) + "; expected at most " + std::to_string(seconds(max_ns)) + " s";
        last_end_ns = step->t_end_ns;
      }
    }
    return "";
  });
}

CASE(meaning, "step.index", "counts its steps from 0", 20, 10, .any_input = true) {
  return of_all<odo_step>(fixture, ODO_TYPE_STEP, [](const auto& all) -> std::string {
    for (size_t i = 0; i < all.size(); ++i)
      if (all[i].second->index != i)
        return "the step number " + std::to_string(i) + " has index = " + std::to_string(all[i].second->index);
    return "";
  });
}

CASE(meaning, "mode.changes", "reports a mode only when it changes", 20, 10, .any_input = true) {
  return of_all<odo_motion_mode>(fixture, ODO_TYPE_MOTION_MODE, [](const auto& all) -> std::string {
    for (size_t i = 1; i < all.size(); ++i)
      if (all[i].second->mode == all[i - 1].second->mode)
        return "it reports the same mode twice" + at(all[i].second->header);
    return "";
  });
}

// ---- odometry ------------------------------------------------------------------------------------------------------
CASE(meaning, "motion.each_frame", "emits a motion for each frame after the first, from the previous one", 20, 10,
     .any_input = true) {
  if (!fixture.serves(ODO_INTERFACE_VO_FRONTEND)) return not_applicable("it is no front-end");
  return of_all<odo_vo_motion>(fixture, ODO_TYPE_VO_MOTION, [&](const auto& all) -> std::string {
    std::vector<int64_t> frames;
    for (const AnyMessage& message : fixture.input)
      if (message.header().type == ODO_TYPE_FRAME) frames.push_back(message.header().t_ns);
    if (all.size() + 2 < frames.size())
      return std::to_string(frames.size()) + " frames, " + std::to_string(all.size()) + " motions";
    for (size_t i = 0; i < all.size(); ++i) {
      if (i + 1 >= frames.size()) return "more motions than frames";
      if (all[i].second->header.t_ns != frames[i + 1])
        return "a motion does not end at its frame's time" + at(all[i].second->header);
      if (all[i].second->t_from_ns != frames[i])
        return "t_from_ns is not the previous frame's time" + at(all[i].second->header);
    }
    return "";
  });
}

CASE(meaning, "motion.reason", "has a reason when it is lost, a covariance with a translation", 20, 10,
     .any_input = true) {
  return of_each<odo_vo_motion>(fixture, ODO_TYPE_VO_MOTION, [](const odo_vo_motion& motion) -> std::string {
    if (motion.state == ODO_LOST && motion.reason == ODO_REASON_NONE) return "it is lost without a reason";
    if (motion.inliers > motion.tracked) return "more inliers than tracked features";
    const bool known = !(motion.header.flags & ODO_VO_TRANSLATION) || (motion.header.flags & ODO_VO_COVARIANCE);
    return known ? "" : "a translation without a covariance";
  });
}

CASE(meaning, "motion.speed", "emits metric motions in metres", 20, 10) {
  return of_each<odo_vo_motion>(fixture, ODO_TYPE_VO_MOTION, [](const odo_vo_motion& motion) -> std::string {
    const double distance = Eigen::Vector3d(motion.p_c0_c1).norm();
    if (!(motion.header.flags & ODO_VO_METRIC) || distance <= 10) return "";
    return "a metric motion of " + std::to_string(distance) + " m in a tenth of a second";
  });
}

CASE(meaning, "motion.camera", "names the camera", 20, 10) {
  return of_each<odo_vo_motion>(fixture, ODO_TYPE_VO_MOTION, [](const odo_vo_motion& motion) -> std::string {
    return motion.camera == 0 ? "" : "camera = " + std::to_string(motion.camera) + ", the only one is 0";
  });
}

CASE(meaning, "motion.refined", "refines an existing camera, at most once a second", 20, 10) {
  if (!fixture.serves(ODO_INTERFACE_VO_FRONTEND)) return not_applicable("it is no front-end");
  return of_all<odo_refined>(fixture, ODO_TYPE_REFINED, [](const auto& all) -> std::string {
    int64_t last_ns = INT64_MIN / 2;
    for (const auto& [seen, c] : all) {
      if (c->camera != 0) return "it refined a camera that does not exist: " + std::to_string(c->camera);
      if (c->header.t_ns - last_ns < kSecond_ns)
        return "it emits odo_refined more often than once a second" + at(c->header);
      last_ns = c->header.t_ns;
    }
    return "";
  });
}

// ---- scales and fixes ----------------------------------------------------------------------------------------------
CASE(meaning, "scale.unit", "gives metres", 20, 10) {
  return of_each<odo_scale>(fixture, ODO_TYPE_SCALE, [](const odo_scale& scale) -> std::string {
    const double times = scale.scale / (TestInput::kSpeed_mps / TestInput::kUnit_mps);
    if (times <= kWrongScale && times >= 1 / kWrongScale) return "";
    return "scale = " + std::to_string(scale.scale) + ", the walk's is 1.4: is it in metres?";
  });
}

CASE(meaning, "scale.group", "refers to the motions' scale group", 20, 10) {
  return of_each<odo_scale>(fixture, ODO_TYPE_SCALE, [](const odo_scale& scale) -> std::string {
    if (scale.scale_group == 3) return "";
    return "scale_group = " + std::to_string(scale.scale_group) + ", all motions were of group 3";
  });
}

CASE(meaning, "scale.interval", "states for which motions it is valid", 20, 10, .any_input = true) {
  return of_all<odo_scale>(fixture, ODO_TYPE_SCALE, [&](const auto& all) -> std::string {
    for (const auto& [seen, scale] : all)
      if (scale->valid_from_ns >= scale->valid_to_ns)
        return "valid_from_ns is not before valid_to_ns" + at(scale->header);
    // An answer to a motion applies to that motion; a scale stated on a step or a fix applies to later motions.
    for (const auto& [seen, scale] : all) {
      int64_t past_ns = INT64_MIN;
      for (const AnyMessage& message : fixture.input)
        if (message.header().type == ODO_TYPE_VO_MOTION && message.header().t_ns < seen->input_ns)
          past_ns = std::max(past_ns, message.header().t_ns);
      if (scale->valid_to_ns <= past_ns)
        return "valid_to_ns = " + std::to_string(scale->valid_to_ns) + at(scale->header) + " when the motion until " +
               std::to_string(past_ns) + " had been processed: it is too late";
    }
    return "";
  });
}

CASE(meaning, "scale.sigma", "has a plausible sigma", 20, 10, .any_input = true) {
  return of_each<odo_scale>(fixture, ODO_TYPE_SCALE, [](const odo_scale& scale) -> std::string {
    const bool plausible = scale.sigma >= 0 && scale.sigma <= 1e3 * std::max(scale.scale, 1e-9);
    return plausible ? "" : "sigma = " + std::to_string(scale.sigma);
  });
}

CASE(meaning, "fix.says_something", "emits fixes with at least one valid component", 20, 10, .any_input = true) {
  return of_each<odo_fix>(fixture, ODO_TYPE_FIX, [](const odo_fix& fix) -> std::string {
    return fix.header.flags & 127 ? "" : "a fix without a valid component";
  });
}

CASE(meaning, "fix.place", "emits fixes on the Earth, near the local frame", 20, 10, .any_input = true) {
  return of_each<odo_fix>(fixture, ODO_TYPE_FIX, [](const odo_fix& fix) -> std::string {
    for (int i = 0; i < 3; ++i)
      if ((fix.header.flags >> i & 1) && std::abs(fix.p_n[i]) > kFarthest_m)
        return "p_n[" + std::to_string(i) + "] = " + std::to_string(fix.p_n[i]) + " m";
    if (!(fix.header.flags & ODO_FIX_SLANT) || fix.slant_distance_m > 0) return "";
    return "slant_distance_m = " + std::to_string(fix.slant_distance_m);
  });
}

/// A terrain height below a pose is new information; a position derived from a pose is not.
CASE(meaning, "fix.no_echo", "does not derive positions from poses", 20, 10, .any_input = true) {
  return of_all<odo_fix>(fixture, ODO_TYPE_FIX, [&](const auto& all) -> std::string {
    constexpr uint32_t place = ODO_FIX_NORTH | ODO_FIX_EAST;
    size_t echoes = 0;
    for (const auto& [seen, fix] : all)
      echoes += seen->input_type == ODO_TYPE_POSE && (fix->header.flags & place) == place;
    return echoes < 5 ? ""
                      : std::to_string(echoes) +
                            " positions in answer to poses: a position derived from a pose is not new information and "
                            "creates a feedback loop";
  });
}

}  // namespace

}  // namespace odograph
