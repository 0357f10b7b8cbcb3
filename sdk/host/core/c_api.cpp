// SPDX-License-Identifier: Apache-2.0
//
// The C API: checks arguments and stops exceptions; Session does the rest.
#include <odograph/anchor.h>
#include <odograph/layout.h>
#include <odograph/map.h>
#include <odograph/odograph.h>
#include <odograph/scene.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/base/version.hpp"
#include "sdk/host/core/c_guard.hpp"
#include "sdk/host/core/session.hpp"
#include "sdk/host/platform/utf8_path.hpp"
#include "sdk/host/plugin_host/plugin_call.hpp"
#include "sdk/host/plugin_host/library.hpp"

struct odo_session {
  std::unique_ptr<odograph::Session> session;
};

namespace {

using odograph::fail;
using odograph::guarded;
using odograph::text;

int32_t create(const odo_session_options& options, odo_session** out, odo_error* error) {
  const std::string path = text(options.config_path), config_text = text(options.config_text);
  if (options.run != ODO_RUN_LIVE && options.run != ODO_RUN_REPLAY)
    return fail(error, {ODO_E_ARGUMENT, "run = " + std::to_string(options.run) + "; expected one of ODO_RUN_*"});
  if (options.flags & ~ODO_SESSION_CRASH_NOTES)
    return fail(error,
                {ODO_E_UNSUPPORTED, "flags = " + std::to_string(options.flags) + "; expected ODO_SESSION_* alone"});
  if (path.empty() == config_text.empty())
    return fail(error, {ODO_E_ARGUMENT, "expected exactly one of config_path and config_text"});
  const auto directories = odograph::path_list(text(options.plugin_path));
  std::vector<std::filesystem::path> assets;
  for (const auto& folder : odograph::path_list(text(options.asset_path)))
    assets.push_back(std::filesystem::absolute(folder));
  auto config = path.empty() ? odograph::read_pipeline_config(config_text, "<text>", directories, assets)
                             : odograph::read_pipeline_config_file(path, directories, assets);
  if (!config) return fail(error, config.failure());
  if (!path.empty()) assets.insert(assets.begin(), std::filesystem::absolute(odograph::utf8_path(path)).parent_path());
  if (options.flags & ODO_SESSION_CRASH_NOTES) odograph::install_crash_handler();
  auto session = odograph::Session::make(std::move(*config), std::move(assets), options.run != ODO_RUN_REPLAY,
                                         options.seed, {options.user, options.get_service});
  if (!session) return fail(error, session.failure());
  *out = new odo_session{std::move(*session)};
  return ODO_OK;
}

/// Copies what `find` returns into the caller's struct, which may be older or newer than the host's.
template <class Struct, class Find>
int32_t hand_out(Struct* out, uint32_t min_size, Find&& find) {
  uint32_t size = 0;
  std::memcpy(&size, out, sizeof size);  // struct_size is the first member of each
  if (size < min_size) return ODO_E_STRUCT_SIZE;
  return guarded([&] {
    Struct found{};
    const int32_t status = find(found);
    if (status != ODO_OK) return status;
    size = std::min<uint32_t>(size, sizeof found);
    std::memcpy(static_cast<void*>(out), &found, size);
    std::memcpy(static_cast<void*>(out), &size, sizeof size);
    return status;
  });
}

/// Writes element i of the caller's array, whose elements may be older or newer than the host's.
template <class Struct>
void put_element(Struct* array, uint64_t i, uint32_t stride, Struct element) {
  element.struct_size = std::min<uint32_t>(stride, sizeof element);
  std::memcpy(reinterpret_cast<char*>(array) + i * stride, &element, element.struct_size);
}

/// The number of all ids, of which those that fit are written.
template <class Find>
int64_t list(Find&& find, uint64_t* ids, uint64_t capacity) {
  int64_t count = 0;
  const int32_t status = guarded([&] {
    const std::vector<uint64_t> all = find();
    std::copy_n(all.begin(), std::min<uint64_t>(capacity, all.size()), ids);
    count = static_cast<int64_t>(all.size());
    return ODO_OK;
  });
  return status < 0 ? status : count;
}

constexpr uint32_t kMostHits = 64;

int32_t get_pose(odo_session* session, uint32_t of, uint32_t world, int64_t t_ns, odo_pose* pose) {
  if (!session || !pose) return ODO_E_ARGUMENT;
  return hand_out(pose, ODO_POSE_SIZE_MIN,
                  [&](odo_pose& found) { return session->session->world().pose_of(of, world, t_ns, found); });
}

}  // namespace

extern "C" {

int32_t odo_session_create(const odo_session_options* options, odo_session** session, odo_error* error) {
  if (session) *session = nullptr;
  if (!options || !session) return fail(error, {ODO_E_ARGUMENT, "options and session must not be null"});
  if (options->struct_size < ODO_SESSION_OPTIONS_SIZE_MIN)
    return fail(error, {ODO_E_STRUCT_SIZE, "odo_session_options.struct_size = " + std::to_string(options->struct_size) +
                                               "; expected at least " + std::to_string(ODO_SESSION_OPTIONS_SIZE_MIN)});
  return guarded([&] { return create(*options, session, error); });
}

void odo_session_destroy(odo_session* session) {
  guarded([&] {
    if (session && session->session->is_forked_child()) return ODO_OK;  // a copy; memory is all that it has
    delete session;
    return ODO_OK;
  });
}

int32_t odo_session_push(odo_session* session, const odo_header* sample) {
  if (!session || !sample) return ODO_E_ARGUMENT;
  if (sample->struct_size < sizeof(odo_header)) return ODO_E_STRUCT_SIZE;
  return guarded([&] { return session->session->push(*sample); });
}

int32_t odo_session_push_imu(odo_session* session, int64_t t_ns, const double* gyro_b, const double* accel_b) {
  if (!session || !gyro_b || !accel_b) return ODO_E_ARGUMENT;
  auto imu = odograph::make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
  imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
  std::copy(gyro_b, gyro_b + 3, imu.gyro_b);
  std::copy(accel_b, accel_b + 3, imu.accel_b);
  return guarded([&] { return session->session->push(imu.header); });
}

int32_t odo_register_plugin(odo_plugin_entry entry, odo_error* error) {
  if (!entry) return fail(error, {ODO_E_ARGUMENT, "entry must not be null"});
  return guarded([&]() -> int32_t {
    const auto registered = odograph::register_plugin(entry);
    return registered ? ODO_OK : fail(error, registered.failure());
  });
}

uint64_t odo_current_plugin_call(char* text, uint64_t capacity) {
  return text ? odograph::current_plugin_call(text, static_cast<size_t>(capacity)) : 0;
}

int32_t odo_session_flush(odo_session* session) {
  return session ? guarded([&] { return session->session->flush(); }) : ODO_E_ARGUMENT;
}

int32_t odo_session_get_pose(odo_session* session, int64_t t_ns, odo_pose* pose) {
  return get_pose(session, ODO_OF_PIPELINE, ODO_WORLD_CORRECTED, t_ns, pose);
}

int32_t odo_session_get_smooth_pose(odo_session* session, int64_t t_ns, odo_pose* pose) {
  return get_pose(session, ODO_OF_PIPELINE, ODO_WORLD_SMOOTH, t_ns, pose);
}

int32_t odo_session_get_pose_of(odo_session* session, uint32_t of, uint32_t world, int64_t t_ns, odo_pose* pose) {
  return get_pose(session, of, world, t_ns, pose);
}

int32_t odo_session_set_callback(odo_session* session, const uint32_t* types, uint32_t count, odo_callback callback,
                                 void* user) {
  const bool all = count == ODO_ALL_EVENTS;
  if (!session || (count > 0 && !types && !all)) return ODO_E_ARGUMENT;
  return guarded([&] {
    odograph::TypeSet wanted;
    for (uint32_t i = 0; i < count && !all; ++i) wanted.add(types[i]);
    session->session->set_callback(all ? odograph::TypeSet::all() : wanted, callback, user);
    return ODO_OK;
  });
}

int32_t odo_session_get_statistics(odo_session* session, odo_statistics* statistics) {
  if (!session || !statistics) return ODO_E_ARGUMENT;
  return hand_out(statistics, ODO_STATISTICS_SIZE_MIN,
                  [&](odo_statistics& found) { return found = session->session->statistics(), ODO_OK; });
}

int32_t odo_session_last_error(odo_session* session, odo_error* error) {
  if (!session || !error) return ODO_E_ARGUMENT;
  if (error->struct_size < ODO_ERROR_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  return guarded([&] { return fail(error, session->session->take_last_error()), ODO_OK; });
}

int32_t odo_session_to_geodetic(odo_session* session, const double* p_n, double* geodetic) {
  if (!session || !p_n || !geodetic) return ODO_E_ARGUMENT;
  return guarded([&] { return session->session->world().to_geodetic(p_n, geodetic); });
}

int32_t odo_session_from_geodetic(odo_session* session, const double* geodetic, double* p_n) {
  if (!session || !p_n || !geodetic) return ODO_E_ARGUMENT;
  return guarded([&] { return session->session->world().from_geodetic(geodetic, p_n); });
}

int64_t odo_session_save(odo_session* session, void* data, uint64_t capacity) {
  if (!session || (capacity > 0 && !data)) return ODO_E_ARGUMENT;
  int64_t size = 0;
  const int32_t status = guarded([&] { return size = session->session->save(data, capacity), ODO_OK; });
  return status < 0 ? status : size;
}

int32_t odo_session_load(odo_session* session, const void* data, uint64_t size) {
  if (!session || !data) return ODO_E_ARGUMENT;
  return guarded([&] { return session->session->load(data, size); });
}

int64_t odo_map_save(odo_session* session, void* data, uint64_t capacity) {
  if (!session || (capacity > 0 && !data)) return ODO_E_ARGUMENT;
  int64_t size = 0;
  const int32_t status = guarded([&] { return size = session->session->save_maps(data, capacity), ODO_OK; });
  return status < 0 ? status : size;
}

int32_t odo_map_load(odo_session* session, const void* data, uint64_t size) {
  if (!session || !data) return ODO_E_ARGUMENT;
  return guarded([&] { return session->session->load_maps(data, size); });
}

int32_t odo_anchor_create(odo_session* session, const odo_anchor_place* place, uint64_t* id) {
  if (id) *id = 0;
  if (!session || !place || !id) return ODO_E_ARGUMENT;
  if (place->struct_size < ODO_ANCHOR_PLACE_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  if (place->kind == ODO_ANCHOR_HIT && !ODO_HAS(place, surface)) return ODO_E_ARGUMENT;  // unknown to its writer
  odo_anchor_place whole{};
  std::memcpy(static_cast<void*>(&whole), place, std::min<size_t>(place->struct_size, sizeof whole));
  return guarded([&] { return session->session->world().create_anchor(whole, *id); });
}

int32_t odo_anchor_get(odo_session* session, uint64_t id, uint32_t world, int64_t t_ns, odo_anchor* anchor) {
  if (!session || !anchor) return ODO_E_ARGUMENT;
  return hand_out(anchor, ODO_ANCHOR_SIZE_MIN,
                  [&](odo_anchor& found) { return session->session->world().anchor(id, world, t_ns, found); });
}

int64_t odo_anchor_list(odo_session* session, uint64_t* ids, uint64_t capacity) {
  if (!session || (capacity > 0 && !ids)) return ODO_E_ARGUMENT;
  return list([&] { return session->session->world().anchor_ids(); }, ids, capacity);
}

int32_t odo_anchor_remove(odo_session* session, uint64_t id) {
  return session ? guarded([&] { return session->session->world().remove_anchor(id); }) : ODO_E_ARGUMENT;
}

int64_t odo_session_get_points(odo_session* session, uint32_t world, odo_map_point* points, uint64_t capacity) {
  if (!session || (capacity > 0 && !points)) return ODO_E_ARGUMENT;
  const uint32_t stride = capacity > 0 ? points->struct_size : sizeof(odo_map_point);
  if (stride < ODO_MAP_POINT_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  int64_t count = 0;
  const int32_t status = guarded([&] {
    std::vector<odo_map_point> all;
    all.reserve(std::min<uint64_t>(capacity, ODO_MOST_MAP_POINTS));
    count = session->session->world().points(
        world, [&](uint64_t i) { return i < all.capacity() ? &all.emplace_back() : nullptr; });
    for (size_t i = 0; i < all.size(); ++i) put_element(points, i, stride, all[i]);
    return count < 0 ? static_cast<int32_t>(count) : ODO_OK;
  });
  return status < 0 ? status : count;
}

int64_t odo_surface_list(odo_session* session, uint64_t* ids, uint64_t capacity) {
  if (!session || (capacity > 0 && !ids)) return ODO_E_ARGUMENT;
  return list([&] { return session->session->world().surface_ids(); }, ids, capacity);
}

int32_t odo_surface_get(odo_session* session, uint64_t id, uint32_t world, odo_surface* surface) {
  if (!session || !surface) return ODO_E_ARGUMENT;
  if (surface->header.struct_size < ODO_SURFACE_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  return guarded([&] { return session->session->world().surface(id, world, *surface); });
}

int32_t odo_session_hit_test(odo_session* session, const odo_ray* ray, odo_hit* hits, uint32_t capacity,
                             uint32_t* count) {
  if (count) *count = 0;
  if (!session || !ray || !count || (capacity > 0 && !hits)) return ODO_E_ARGUMENT;
  const uint32_t stride = capacity > 0 ? hits->struct_size : sizeof(odo_hit);
  if (ray->struct_size < ODO_RAY_SIZE_MIN || stride < ODO_HIT_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  return guarded([&] {
    odo_ray whole{};
    std::memcpy(static_cast<void*>(&whole), ray, std::min<size_t>(ray->struct_size, sizeof whole));
    odo_hit found[kMostHits];
    const int32_t status = session->session->world().hit_test(whole, {found, std::min(capacity, kMostHits)}, *count);
    for (uint32_t i = 0; i < *count; ++i) put_element(hits, i, stride, found[i]);
    return status;
  });
}

const char* odo_version(void) { return odograph::kVersion; }
uint32_t odo_abi_version(void) { return ODO_ABI_MAJOR << 16 | ODO_ABI_MINOR; }

const char* odo_status_text(int32_t status) {
  switch (status) {
    case ODO_OK: return "ok";
    case ODO_NOT_READY: return "not ready yet";
    case ODO_END: return "at the end";
    case ODO_PARTIAL: return "done in part";
    case ODO_E_ARGUMENT: return "bad argument";
    case ODO_E_DISCARD: return "input discarded";
    case ODO_E_EXHAUSTED: return "quota or buffer exhausted";
    case ODO_E_UNSUPPORTED: return "not supported";
    case ODO_E_STRUCT_SIZE: return "struct too small";
    case ODO_E_VERSION: return "no common ABI version";
    case ODO_E_STATE: return "called in the wrong state";
    case ODO_E_CONFIG: return "configuration refused";
    case ODO_E_NOT_FOUND: return "not found";
    case ODO_E_DATA: return "damaged data";
    case ODO_E_IO: return "input or output failed";
    case ODO_E_MEMORY: return "out of memory";
    case ODO_E_ERROR: return "error";
    case ODO_E_FATAL: return "fatal error";
    default: return "unknown status";
  }
}

const char* odo_state_text(uint32_t state) {
  static const char* const texts[] = {"none", "tracking", "degraded", "lost"};
  return state < 4 ? texts[state] : "unknown";
}

const char* odo_reason_text(uint32_t reason) {
  static const char* const texts[] = {"",
                                      "initialising",
                                      "too dark",
                                      "moving too fast",
                                      "too few features",
                                      "no parallax",
                                      "no steps yet",
                                      "sensor silent",
                                      "plugin failed",
                                      "no scale yet",
                                      "no start position and no position fix yet",
                                      "no ground known there",
                                      "no origin on the Earth yet",
                                      "wrong input"};
  return reason < 14 ? texts[reason] : "unknown";
}

const char* odo_mode_text(uint32_t mode) {
  static const char* const texts[] = {"unknown",        "static", "walking_texting", "walking_swinging",
                                      "walking_pocket", "stairs", "running",         "handling"};
  return mode < 8 ? texts[mode] : "unknown";
}

}  // extern "C"
