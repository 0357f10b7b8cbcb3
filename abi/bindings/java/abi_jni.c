/* SPDX-License-Identifier: Apache-2.0
 *
 * Written by abi/generate.py; do not edit. The other end of Abi.java's functions.
 */
#include <jni.h>
#include <stdint.h>

#include <odograph/anchor.h>
#include <odograph/recording.h>

/* clang-format off */
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1create(JNIEnv *env, jclass self, jlong options, jlong session, jlong error) {
  (void)env, (void)self;
  return (jint)odo_session_create((const odo_session_options *)(intptr_t)options, (odo_session **)(intptr_t)session, (odo_error *)(intptr_t)error);
}
JNIEXPORT void JNICALL Java_org_odograph_Abi_odo_1session_1destroy(JNIEnv *env, jclass self, jlong session) {
  (void)env, (void)self;
  odo_session_destroy((odo_session *)(intptr_t)session);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1push(JNIEnv *env, jclass self, jlong session, jlong sample) {
  (void)env, (void)self;
  return (jint)odo_session_push((odo_session *)(intptr_t)session, (const odo_header *)(intptr_t)sample);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1push_1imu(JNIEnv *env, jclass self, jlong session, jlong t_ns, jlong gyro_b, jlong accel_b) {
  (void)env, (void)self;
  return (jint)odo_session_push_imu((odo_session *)(intptr_t)session, (int64_t)t_ns, (const double *)(intptr_t)gyro_b, (const double *)(intptr_t)accel_b);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1flush(JNIEnv *env, jclass self, jlong session) {
  (void)env, (void)self;
  return (jint)odo_session_flush((odo_session *)(intptr_t)session);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1get_1pose(JNIEnv *env, jclass self, jlong session, jlong t_ns, jlong pose) {
  (void)env, (void)self;
  return (jint)odo_session_get_pose((odo_session *)(intptr_t)session, (int64_t)t_ns, (odo_pose *)(intptr_t)pose);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1get_1pose_1of(JNIEnv *env, jclass self, jlong session, jint of, jint world, jlong t_ns, jlong pose) {
  (void)env, (void)self;
  return (jint)odo_session_get_pose_of((odo_session *)(intptr_t)session, (uint32_t)of, (uint32_t)world, (int64_t)t_ns, (odo_pose *)(intptr_t)pose);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1get_1smooth_1pose(JNIEnv *env, jclass self, jlong session, jlong t_ns, jlong pose) {
  (void)env, (void)self;
  return (jint)odo_session_get_smooth_pose((odo_session *)(intptr_t)session, (int64_t)t_ns, (odo_pose *)(intptr_t)pose);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1set_1callback(JNIEnv *env, jclass self, jlong session, jlong types, jint count, jlong callback, jlong user) {
  (void)env, (void)self;
  return (jint)odo_session_set_callback((odo_session *)(intptr_t)session, (const uint32_t *)(intptr_t)types, (uint32_t)count, (odo_callback)(intptr_t)callback, (void *)(intptr_t)user);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1register_1plugin(JNIEnv *env, jclass self, jlong entry, jlong error) {
  (void)env, (void)self;
  return (jint)odo_register_plugin((odo_plugin_entry)(intptr_t)entry, (odo_error *)(intptr_t)error);
}
JNIEXPORT jlong JNICALL Java_org_odograph_Abi_odo_1current_1plugin_1call(JNIEnv *env, jclass self, jlong text, jlong capacity) {
  (void)env, (void)self;
  return (jlong)odo_current_plugin_call((char *)(intptr_t)text, (uint64_t)capacity);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1get_1statistics(JNIEnv *env, jclass self, jlong session, jlong statistics) {
  (void)env, (void)self;
  return (jint)odo_session_get_statistics((odo_session *)(intptr_t)session, (odo_statistics *)(intptr_t)statistics);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1last_1error(JNIEnv *env, jclass self, jlong session, jlong error) {
  (void)env, (void)self;
  return (jint)odo_session_last_error((odo_session *)(intptr_t)session, (odo_error *)(intptr_t)error);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1to_1geodetic(JNIEnv *env, jclass self, jlong session, jlong p_n, jlong geodetic) {
  (void)env, (void)self;
  return (jint)odo_session_to_geodetic((odo_session *)(intptr_t)session, (const double *)(intptr_t)p_n, (double *)(intptr_t)geodetic);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1from_1geodetic(JNIEnv *env, jclass self, jlong session, jlong geodetic, jlong p_n) {
  (void)env, (void)self;
  return (jint)odo_session_from_geodetic((odo_session *)(intptr_t)session, (const double *)(intptr_t)geodetic, (double *)(intptr_t)p_n);
}
JNIEXPORT jlong JNICALL Java_org_odograph_Abi_odo_1session_1save(JNIEnv *env, jclass self, jlong session, jlong data, jlong capacity) {
  (void)env, (void)self;
  return (jlong)odo_session_save((odo_session *)(intptr_t)session, (void *)(intptr_t)data, (uint64_t)capacity);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1session_1load(JNIEnv *env, jclass self, jlong session, jlong data, jlong size) {
  (void)env, (void)self;
  return (jint)odo_session_load((odo_session *)(intptr_t)session, (const void *)(intptr_t)data, (uint64_t)size);
}
JNIEXPORT jstring JNICALL Java_org_odograph_Abi_odo_1version(JNIEnv *env, jclass self) {
  (void)self;
  return (*env)->NewStringUTF(env, odo_version());
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1abi_1version(JNIEnv *env, jclass self) {
  (void)env, (void)self;
  return (jint)odo_abi_version();
}
JNIEXPORT jstring JNICALL Java_org_odograph_Abi_odo_1status_1text(JNIEnv *env, jclass self, jint status) {
  (void)self;
  return (*env)->NewStringUTF(env, odo_status_text((int32_t)status));
}
JNIEXPORT jstring JNICALL Java_org_odograph_Abi_odo_1state_1text(JNIEnv *env, jclass self, jint state) {
  (void)self;
  return (*env)->NewStringUTF(env, odo_state_text((uint32_t)state));
}
JNIEXPORT jstring JNICALL Java_org_odograph_Abi_odo_1reason_1text(JNIEnv *env, jclass self, jint reason) {
  (void)self;
  return (*env)->NewStringUTF(env, odo_reason_text((uint32_t)reason));
}
JNIEXPORT jstring JNICALL Java_org_odograph_Abi_odo_1mode_1text(JNIEnv *env, jclass self, jint mode) {
  (void)self;
  return (*env)->NewStringUTF(env, odo_mode_text((uint32_t)mode));
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1anchor_1create(JNIEnv *env, jclass self, jlong session, jlong place, jlong id) {
  (void)env, (void)self;
  return (jint)odo_anchor_create((odo_session *)(intptr_t)session, (const odo_anchor_place *)(intptr_t)place, (uint64_t *)(intptr_t)id);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1anchor_1get(JNIEnv *env, jclass self, jlong session, jlong id, jint world, jlong t_ns, jlong anchor) {
  (void)env, (void)self;
  return (jint)odo_anchor_get((odo_session *)(intptr_t)session, (uint64_t)id, (uint32_t)world, (int64_t)t_ns, (odo_anchor *)(intptr_t)anchor);
}
JNIEXPORT jlong JNICALL Java_org_odograph_Abi_odo_1anchor_1list(JNIEnv *env, jclass self, jlong session, jlong ids, jlong capacity) {
  (void)env, (void)self;
  return (jlong)odo_anchor_list((odo_session *)(intptr_t)session, (uint64_t *)(intptr_t)ids, (uint64_t)capacity);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1anchor_1remove(JNIEnv *env, jclass self, jlong session, jlong id) {
  (void)env, (void)self;
  return (jint)odo_anchor_remove((odo_session *)(intptr_t)session, (uint64_t)id);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recording_1open(JNIEnv *env, jclass self, jlong path, jlong recording, jlong error) {
  (void)env, (void)self;
  return (jint)odo_recording_open((const odo_string *)(intptr_t)path, (odo_recording **)(intptr_t)recording, (odo_error *)(intptr_t)error);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recording_1next(JNIEnv *env, jclass self, jlong recording, jlong message, jlong picture, jlong picture_size) {
  (void)env, (void)self;
  return (jint)odo_recording_next((odo_recording *)(intptr_t)recording, (const odo_header **)(intptr_t)message, (const void **)(intptr_t)picture, (uint64_t *)(intptr_t)picture_size);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recording_1loss(JNIEnv *env, jclass self, jlong recording, jlong loss) {
  (void)env, (void)self;
  return (jint)odo_recording_loss((odo_recording *)(intptr_t)recording, (odo_error *)(intptr_t)loss);
}
JNIEXPORT void JNICALL Java_org_odograph_Abi_odo_1recording_1close(JNIEnv *env, jclass self, jlong recording) {
  (void)env, (void)self;
  odo_recording_close((odo_recording *)(intptr_t)recording);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recorder_1create(JNIEnv *env, jclass self, jlong path, jlong recorder, jlong error) {
  (void)env, (void)self;
  return (jint)odo_recorder_create((const odo_string *)(intptr_t)path, (odo_recorder **)(intptr_t)recorder, (odo_error *)(intptr_t)error);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recorder_1write(JNIEnv *env, jclass self, jlong recorder, jlong message, jlong picture, jlong picture_size) {
  (void)env, (void)self;
  return (jint)odo_recorder_write((odo_recorder *)(intptr_t)recorder, (const odo_header *)(intptr_t)message, (const void *)(intptr_t)picture, (uint64_t)picture_size);
}
JNIEXPORT jint JNICALL Java_org_odograph_Abi_odo_1recorder_1close(JNIEnv *env, jclass self, jlong recorder) {
  (void)env, (void)self;
  return (jint)odo_recorder_close((odo_recorder *)(intptr_t)recorder);
}
/* clang-format on */
