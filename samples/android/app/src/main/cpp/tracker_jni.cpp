// SPDX-License-Identifier: Apache-2.0
//
// Native methods of Tracker.kt. One tracker at a time; Kotlin calls them from its main thread.
#include <jni.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include <odograph/anchor.h>
#include <odograph/map.h>
#include <odograph/odograph.h>

#include "camera.hpp"
#include "sensors.hpp"

extern "C" {
int32_t ODO_CALL odo_plugin_entry_attitude_vqf(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_step_odograph(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_vo_odograph(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_fix_map(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_surface_planes(const struct odo_host* host, struct odo_plugin* out);
}

namespace {

const char kPackage[] = "org.odograph.phone";

struct Tracker {
  odo_session* session = nullptr;
  std::string map;  // the file that keeps the place from run to run
  std::unique_ptr<phone::Camera> camera;
  std::unique_ptr<phone::Sensors> sensors;
  ~Tracker() {
    sensors.reset();
    if (camera) camera->pause();
    odo_session_destroy(session);
  }
};
std::unique_ptr<Tracker> tracker;

/// Before the first frame. False if there is a file that is no map of this version.
bool load_map(odo_session* session, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string map((std::istreambuf_iterator<char>(file)), {});
  return map.empty() || odo_map_load(session, map.data(), map.size()) == ODO_OK;
}

void save_map(odo_session* session, const std::string& path) {
  std::string map;
  for (int64_t size; (size = odo_map_save(session, &map[0], map.size())) != static_cast<int64_t>(map.size());) {
    if (size < 0) return;
    map.resize(static_cast<size_t>(size));
  }
  if (map.empty()) return;
  const std::string whole = path + ".new";
  if ((std::ofstream(whole, std::ios::binary) << map).flush()) std::rename(whole.c_str(), path.c_str());
}

std::string start(const std::string& config, const std::string& map) {
  odo_error error = {};
  error.struct_size = sizeof error;
  for (const odo_plugin_entry entry :
       {odo_plugin_entry_attitude_vqf, odo_plugin_entry_step_odograph, odo_plugin_entry_vo_odograph,
        odo_plugin_entry_fix_map, odo_plugin_entry_surface_planes})
    if (odo_register_plugin(entry, &error) != ODO_OK) return error.message;
  odo_session_options options = {};
  options.struct_size = sizeof options;
  options.run = ODO_RUN_LIVE;
  options.config_text.data = config.data();
  options.config_text.size = config.size();
  auto made = std::make_unique<Tracker>();
  if (odo_session_create(&options, &made->session, &error) != ODO_OK) return error.message;
  if (load_map(made->session, map)) made->map = map;  // otherwise the file stays as it is
  made->camera = std::make_unique<phone::Camera>(made->session);
  const std::string wrong = made->camera->start();
  if (!wrong.empty()) return wrong;
  made->sensors = std::make_unique<phone::Sensors>(made->session, kPackage);
  tracker = std::move(made);
  return "";
}

/// An anchor where that point of the newest picture hits a surface, a landmark or the floor; 0 if nothing is known
/// there.
uint64_t place(double column, double row) {
  const odo_ray ray = tracker->camera->ray(column, row);
  odo_hit hit = {};
  hit.struct_size = sizeof hit;
  uint32_t count = 0;
  if (ray.t_ns == 0 || odo_session_hit_test(tracker->session, &ray, &hit, 1, &count) != ODO_OK || count == 0) return 0;
  if (hit.sigma_m > 0.1 * hit.distance_m) return 0;  // too uncertain to draw on
  odo_anchor_place place = {};
  place.struct_size = sizeof place;
  place.kind = ODO_ANCHOR_HIT;
  place.t_ns = hit.t_ns;
  place.surface = hit.surface;
  place.sigma_m = hit.sigma_m;
  std::copy(hit.q_n, hit.q_n + 4, place.q);
  std::copy(hit.p_n, hit.p_n + 3, place.p);
  uint64_t anchor = 0;
  odo_anchor_create(tracker->session, &place, &anchor);
  return anchor;
}

jdoubleArray array_of(JNIEnv* env, const double* values, jint count) {
  jdoubleArray array = env->NewDoubleArray(count);
  if (array) env->SetDoubleArrayRegion(array, 0, count, values);
  return array;
}

}  // namespace

extern "C" JNIEXPORT jstring JNICALL Java_org_odograph_phone_Tracker_start(JNIEnv* env, jobject, jstring config,
                                                                           jstring map) {
  const char *text = env->GetStringUTFChars(config, nullptr), *path = env->GetStringUTFChars(map, nullptr);
  const std::string wrong = start(text, path);
  env->ReleaseStringUTFChars(map, path);
  env->ReleaseStringUTFChars(config, text);
  return env->NewStringUTF(wrong.c_str());
}

extern "C" JNIEXPORT void JNICALL Java_org_odograph_phone_Tracker_stop(JNIEnv*, jobject) {
  if (tracker && !tracker->map.empty()) save_map(tracker->session, tracker->map);
  tracker.reset();
}

/// The newest anchor of the map; 0 if it has none.
extern "C" JNIEXPORT jlong JNICALL Java_org_odograph_phone_Tracker_mark(JNIEnv*, jobject) {
  uint64_t ids[1024];
  const int64_t count = tracker ? odo_anchor_list(tracker->session, ids, 1024) : 0;
  return count > 0 ? static_cast<jlong>(*std::max_element(ids, ids + count)) : 0;
}

/// North, east, down in m, the state, whether it is metric, and the path length; null before the first pose.
extern "C" JNIEXPORT jdoubleArray JNICALL Java_org_odograph_phone_Tracker_pose(JNIEnv* env, jobject) {
  odo_pose pose = {};
  pose.header.struct_size = sizeof pose;
  if (!tracker || odo_session_get_smooth_pose(tracker->session, ODO_TIME_LATEST, &pose) != ODO_OK) return nullptr;
  odo_statistics statistics = {};
  statistics.struct_size = sizeof statistics;
  odo_session_get_statistics(tracker->session, &statistics);
  const double values[6] = {pose.p_n[0],
                            pose.p_n[1],
                            pose.p_n[2],
                            double(pose.state),
                            pose.header.flags & ODO_POSE_METRIC ? 1.0 : 0.0,
                            statistics.distance_m};
  return array_of(env, values, 6);
}

extern "C" JNIEXPORT jlong JNICALL Java_org_odograph_phone_Tracker_place(JNIEnv*, jobject, jdouble column,
                                                                         jdouble row) {
  return tracker ? static_cast<jlong>(place(column, row)) : 0;
}

/// In the camera's axes, m; null while it is not placed.
extern "C" JNIEXPORT jdoubleArray JNICALL Java_org_odograph_phone_Tracker_anchor(JNIEnv* env, jobject, jlong id) {
  odo_anchor anchor = {};
  anchor.struct_size = sizeof anchor;
  if (!tracker ||
      odo_anchor_get(tracker->session, static_cast<uint64_t>(id), ODO_WORLD_SMOOTH, ODO_TIME_LATEST, &anchor) != ODO_OK)
    return nullptr;
  return anchor.flags & ODO_ANCHOR_VIEW_POSE ? array_of(env, anchor.p_view, 3) : nullptr;
}

extern "C" JNIEXPORT jstring JNICALL Java_org_odograph_phone_Tracker_stateText(JNIEnv* env, jobject, jint state) {
  return env->NewStringUTF(odo_state_text(static_cast<uint32_t>(state)));
}
