// SPDX-License-Identifier: Apache-2.0
//
// Checks that the events are the same, byte for byte, however an app delivers its samples: one by one, or in batches
// of up to 150 ms per sensor, the camera first or last.
// odograph-batches CONFIG RECORDING...
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/tools/replay/replayed.hpp"

using namespace odograph;

namespace {

/// Shorter than `ordering.max_wait`, the session's waiting time for a slow sensor.
constexpr int64_t kBatches_ns[] = {20'000'000, 75'000'000, 150'000'000};

/// Digest of all events but reports, which contain the time of day.
struct Sum {
  uint64_t fnv1a = 0xcbf29ce484222325, events = 0;

  static void add(void* user, const odo_header* event) {
    if (event->type == ODO_TYPE_REPORT) return;
    auto& sum = *static_cast<Sum*>(user);
    ++sum.events;
    const auto* bytes = reinterpret_cast<const unsigned char*>(event);
    for (uint32_t i = 0; i < event->struct_size; ++i) sum.fnv1a = (sum.fnv1a ^ bytes[i]) * 0x100000001b3;
  }
  bool operator==(const Sum&) const = default;
};

/// The messages, each batch sorted by sensor; sensor descriptions first.
std::vector<const RecordedMessage*> in_batches(const Recording& recording, int64_t batch_ns, bool camera_first) {
  std::vector<const RecordedMessage*> order;
  for (const RecordedMessage& message : recording.messages) order.push_back(&message);
  const auto time = [](const RecordedMessage* m) { return m->message.header().t_ns; };
  const auto type = [](const RecordedMessage* m) { return m->message.header().type; };
  auto begin = std::find_if(order.begin(), order.end(), [&](const auto* m) { return type(m) == ODO_TYPE_IMU; });
  while (begin != order.end()) {
    const int64_t until_ns = time(*begin) + batch_ns;
    const auto end = std::find_if(begin, order.end(), [&](const auto* m) { return time(m) >= until_ns; });
    std::stable_sort(
        begin, end, [&](const auto* a, const auto* b) { return camera_first ? type(a) > type(b) : type(a) < type(b); });
    begin = end;
  }
  return order;
}

Result<Sum> events_of(const std::string& config, const std::vector<const RecordedMessage*>& order) {
  RunOptions options;
  options.config = config;
  auto session = replay_session(options);
  if (!session) return session.failure();
  Sum sum;
  odo_session_set_callback(session->get(), nullptr, ODO_ALL_EVENTS, Sum::add, &sum);
  for (const RecordedMessage* message : order)
    if (const auto failure = push(session->get(), *message)) return *failure;
  odo_session_flush(session->get());
  odo_statistics s{};
  s.struct_size = sizeof s;
  odo_session_get_statistics(session->get(), &s);
  if (s.late + s.overflow > 0) return Failure{ODO_E_DATA, std::to_string(s.late + s.overflow) + " samples were late"};
  return sum;
}

bool same(const std::string& config, const std::string& path) {
  const auto recording = read_recording(path);
  if (!recording) return std::fprintf(stderr, "%s\n", recording.failure().text.c_str()), false;
  std::vector<const RecordedMessage*> recorded;
  for (const RecordedMessage& message : recording->messages) recorded.push_back(&message);
  const auto first = events_of(config, recorded);
  if (!first) return std::fprintf(stderr, "%s: %s\n", path.c_str(), first.failure().text.c_str()), false;
  int differ = 0;
  for (const int64_t batch_ns : kBatches_ns)
    for (const bool camera_first : {true, false}) {
      const auto sum = events_of(config, in_batches(*recording, batch_ns, camera_first));
      if (sum && *sum == *first) continue;
      ++differ;
      std::fprintf(stderr, "FAILED: %s, batches of %.0f ms, camera %s: %s\n", path.c_str(),
                   static_cast<double>(batch_ns) * 1e-6, camera_first ? "first" : "last",
                   sum ? "other events" : sum.failure().text.c_str());
    }
  std::printf("%s: %llu events, %d of %zu ways differ\n", path.c_str(), static_cast<unsigned long long>(first->events),
              differ, 2 * std::size(kBatches_ns));
  std::fflush(stdout);
  return differ == 0 && first->events > 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) return std::fputs("usage: odograph-batches CONFIG RECORDING...\n", stderr), 2;
  bool all = true;
  for (int i = 2; i < count; ++i) all = same(arguments[1], arguments[i]) && all;
  return all ? 0 : 1;
}
