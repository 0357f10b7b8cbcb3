// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/app_stream.hpp"

#include <chrono>

#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

void on_event(void* user, const odo_header* event) {
  auto& stream = *static_cast<AppStream*>(user);
  if (event->type == ODO_TYPE_POSE) stream.poses.poses[event->t_ns] = as<odo_pose>(*event);
  if (event->type == ODO_TYPE_CORRECTION) ++stream.corrections;
}

/// Appends the results to `to`, and the durations of the calls if `timed`.
void poll(AppStream& stream, odo_session* session, int64_t t_ns, std::vector<PolledPose>& to, bool timed) {
  PolledPose answer{t_ns, {}, {}};
  answer.pose.header.struct_size = answer.smooth.header.struct_size = sizeof(odo_pose);
  using Clock = std::chrono::steady_clock;
  const auto us_since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  };
  auto start = Clock::now();
  if (odo_session_get_pose(session, t_ns, &answer.pose) != ODO_OK) return;
  if (timed) {
    stream.poll_us.push_back(us_since(start));
    odo_statistics statistics{};
    statistics.struct_size = sizeof statistics;
    start = Clock::now();
    odo_session_get_statistics(session, &statistics);
    stream.statistics_us.push_back(us_since(start));
  }
  if (odo_session_get_smooth_pose(session, t_ns, &answer.smooth) == ODO_OK) to.push_back(answer);
}

}  // namespace

Result<AppStream> app_stream(const Recording& recording, const RunOptions& run, const AppTiming& timing) {
  const auto opened = replay_session(run);
  if (!opened) return opened.failure();
  odo_session* session = opened->get();
  AppStream stream;
  const uint32_t wanted[] = {ODO_TYPE_POSE, ODO_TYPE_CORRECTION};
  odo_session_set_callback(session, wanted, 2, on_event, &stream);
  const auto arrivals = arrivals_of(recording, timing.late);
  const auto ahead_ns = static_cast<int64_t>(timing.ahead_ms * 1e6);
  std::vector<int64_t> frames;  // times at which to query a frame's pose
  for (const RecordedMessage& message : recording.messages)
    if (message.message.header().type == ODO_TYPE_FRAME) frames.push_back(message.message.header().t_ns - ahead_ns);
  size_t frame = 0;
  int64_t screen_ns = arrivals.empty() ? 0 : arrivals.front().at_ns;
  for (const Arrival& arrival : arrivals) {
    for (; screen_ns < arrival.at_ns; screen_ns += static_cast<int64_t>(1e9 / timing.poll_hz))
      poll(stream, session, screen_ns + ahead_ns, stream.poses.polls, true);
    for (; frame < frames.size() && frames[frame] < arrival.at_ns; ++frame)
      poll(stream, session, frames[frame] + ahead_ns, stream.poses.early, false);
    if (!arrival.other)
      odo_session_push(session, &arrival.imu.header);
    else if (const auto failure = push(session, *arrival.other))
      return *failure;
  }
  odo_session_flush(session);
  return stream;
}

}  // namespace odograph
