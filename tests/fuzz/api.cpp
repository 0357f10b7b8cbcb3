// SPDX-License-Identifier: Apache-2.0
//
// The C API in any order: each byte is a call, on one of two sessions, with arguments off the input.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <odograph/anchor.h>

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/session.hpp"

namespace {

constexpr size_t kMaxCalls = 64;

const char* const kConfigs[] = {
    "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n",
    "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n"
    "coupling:\n  type: localizer\n",
    "navigation:\n  origin: {latitude: 47 deg, longitude: 8 deg, height: 400 m}\n"
    "attitude:\n  plugin: attitude/vqf\nabsolute_fixers:\n  plugin: fix/waypoint\n",
};

/// The callback calls back, as it may.
void on_event(void* user, const odo_header* event) {
  auto* session = static_cast<odo_session*>(user);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  odo_session_get_pose(session, event->t_ns, &pose);
  if (odo_session_flush(session) != ODO_E_STATE) std::abort();
}

int64_t time_of(fuzz::Bytes& left) { return int64_t(left.take<uint16_t>()) * 10'000'000; }

void destroy(odo_session*& session, fuzz::Bytes& left) {
  if (left.take<uint8_t>() < 192) return;  // to make one takes longer than all else
  odo_session_destroy(session);
  session = nullptr;
}

void push_samples(odo_session* session, fuzz::Bytes& left) {
  double sample[6];
  for (double& value : sample) value = left.take<int8_t>() * 0.2;
  const int64_t from_ns = time_of(left);
  for (int i = 0; i < 20; ++i) odo_session_push_imu(session, from_ns + i * 10'000'000LL, sample, sample + 3);
}

void get_statistics(odo_session* session, fuzz::Bytes& left) {
  odo_statistics statistics{};
  statistics.struct_size = left.take<uint8_t>() < 200 ? static_cast<uint32_t>(sizeof statistics) : 4;
  odo_session_get_statistics(session, &statistics);
}

void last_error(odo_session* session) {
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session_last_error(session, &error);
}

void save_and_load(odo_session* session, fuzz::Bytes& left) {
  std::vector<uint8_t> blob(left.take<uint8_t>() * 16u);
  const int64_t size = odo_session_save(session, blob.data(), blob.size());
  if (size >= 0 && static_cast<size_t>(size) <= blob.size()) odo_session_load(session, blob.data(), size);
}

void load(odo_session* session, fuzz::Bytes& left) {
  const auto blob = left.take(left.take<uint8_t>());
  odo_session_load(session, blob.data(), blob.size());
}

void create_anchor(odo_session* session, fuzz::Bytes& left) {
  odo_anchor_place place{};
  const auto bytes = left.take(sizeof place);
  std::memcpy(static_cast<void*>(&place), bytes.data(), bytes.size());
  place.struct_size = sizeof place;
  place.name = {"anchor", 6};
  uint64_t id = 0;
  odo_anchor_create(session, &place, &id);
}

void get_anchor(odo_session* session, fuzz::Bytes& left) {
  odo_anchor anchor{};
  anchor.struct_size = sizeof anchor;
  odo_anchor_get(session, left.take<uint8_t>(), left.take<uint8_t>(), ODO_TIME_LATEST, &anchor);
}

void list_anchors(odo_session* session, fuzz::Bytes& left) {
  uint64_t ids[4];
  odo_anchor_list(session, ids, left.take<uint8_t>() % 5);
}

void to_geodetic_and_back(odo_session* session, fuzz::Bytes& left) {
  double place[3] = {left.take<float>(), left.take<float>(), left.take<float>()}, there[3];
  odo_session_to_geodetic(session, place, there);
  odo_session_from_geodetic(session, place, there);
}

void call(uint8_t what, odo_session*& session, fuzz::Bytes& left) {
  if (!session) {
    session = fuzz::open(kConfigs[what % std::size(kConfigs)]);
    return;
  }
  odo_pose pose{};
  pose.header.struct_size = left.take<uint8_t>() < 250 ? static_cast<uint32_t>(sizeof pose) : 7;
  switch (what % 20) {
    case 0: return destroy(session, left);
    case 1:
    case 2:
    case 3: return push_samples(session, left);
    case 4: odo_session_push_imu(session, time_of(left), nullptr, nullptr); return;
    case 5: odo_session_flush(session); return;
    case 6: odo_session_get_pose(session, time_of(left), &pose); return;
    case 7: odo_session_get_smooth_pose(session, ODO_TIME_LATEST, &pose); return;
    case 8: odo_session_get_pose_of(session, left.take<uint8_t>(), left.take<uint8_t>(), time_of(left), &pose); return;
    case 9: odo_session_set_callback(session, nullptr, ODO_ALL_EVENTS, on_event, session); return;
    case 10: odo_session_set_callback(session, nullptr, 0, nullptr, nullptr); return;
    case 11: return get_statistics(session, left);
    case 12: return last_error(session);
    case 13: return save_and_load(session, left);
    case 14: return load(session, left);
    case 15: return create_anchor(session, left);
    case 16: return get_anchor(session, left);
    case 17: odo_anchor_remove(session, left.take<uint8_t>()); return;
    case 18: return list_anchors(session, left);
    default: return to_geodetic_and_back(session, left);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static odo_session* sessions[2] = {nullptr, nullptr};
  fuzz::Bytes left(data, size);
  for (size_t count = 0; !left.empty() && count < kMaxCalls; ++count) {
    const auto what = left.take<uint8_t>();
    call(what & 0x7f, sessions[what >> 7], left);
  }
  return 0;
}
