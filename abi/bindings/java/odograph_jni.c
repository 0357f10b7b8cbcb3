/* SPDX-License-Identifier: Apache-2.0
 *
 * Native part of the Java binding: addresses of buffers, calls from the library's threads, borrowed pictures.
 */
#include <jni.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>

#include <odograph/odograph.h>

static JavaVM* vm;
static pthread_key_t attached; /* of a thread that was attached here */

static void detach(void* machine) { (*(JavaVM*)machine)->DetachCurrentThread((JavaVM*)machine); }

/* JNI environment of the calling thread, which stays attached until it ends: Android aborts if it ends attached. */
static JNIEnv* environment(void) {
  JNIEnv* env = NULL;
  if ((*vm)->GetEnv(vm, (void**)&env, JNI_VERSION_1_6) == JNI_OK) return env;
  if ((*vm)->AttachCurrentThreadAsDaemon(vm, (void*)&env, NULL) != JNI_OK) return NULL;
  pthread_setspecific(attached, vm);
  return env;
}

JNIEXPORT jint JNICALL JNI_OnLoad(JavaVM* machine, void* reserved) {
  (void)reserved;
  vm = machine;
  return pthread_key_create(&attached, detach) == 0 ? JNI_VERSION_1_6 : JNI_ERR;
}

JNIEXPORT jlong JNICALL Java_org_odograph_Native_address(JNIEnv* env, jclass self, jobject buffer) {
  (void)self;
  return (jlong)(intptr_t)(*env)->GetDirectBufferAddress(env, buffer);
}

JNIEXPORT jobject JNICALL Java_org_odograph_Native_view(JNIEnv* env, jclass self, jlong address, jlong size) {
  (void)self;
  return (*env)->NewDirectByteBuffer(env, (void*)(intptr_t)address, size);
}

/* Listener of a session: an object with a method `take(long)`. */
typedef struct listener {
  jobject object;
  jmethodID take;
} listener;

static void ODO_CALL on_event(void* user, const odo_header* event) {
  const listener* to = (const listener*)user;
  JNIEnv* env = environment();
  if (env && !(*env)->ExceptionCheck(env)) (*env)->CallVoidMethod(env, to->object, to->take, (jlong)(intptr_t)event);
}

/* Returns a handle for `unlisten`, or 0 if out of memory. */
JNIEXPORT jlong JNICALL Java_org_odograph_Native_listen(JNIEnv* env, jclass self, jlong session, jintArray types,
                                                        jobject object) {
  listener* made = (listener*)calloc(1, sizeof *made);
  const jsize count = (*env)->GetArrayLength(env, types);
  jint* numbers = (*env)->GetIntArrayElements(env, types, NULL);
  (void)self;
  if (!made || !numbers) return 0;
  made->object = (*env)->NewGlobalRef(env, object);
  made->take = (*env)->GetMethodID(env, (*env)->GetObjectClass(env, object), "take", "(J)V");
  odo_session_set_callback((odo_session*)(intptr_t)session, count ? (const uint32_t*)numbers : NULL,
                           count ? (uint32_t)count : ODO_ALL_EVENTS, on_event, made);
  (*env)->ReleaseIntArrayElements(env, types, numbers, JNI_ABORT);
  return (jlong)(intptr_t)made;
}

JNIEXPORT void JNICALL Java_org_odograph_Native_unlisten(JNIEnv* env, jclass self, jlong made) {
  listener* old = (listener*)(intptr_t)made;
  (void)self;
  if (old) (*env)->DeleteGlobalRef(env, old->object);
  free(old);
}

/* A direct buffer shared with the library. */
typedef struct shared {
  int32_t holds;
  jobject buffer;
} shared;

static int32_t borrowed;

JNIEXPORT jint JNICALL Java_org_odograph_Native_borrowed(JNIEnv* env, jclass self) {
  (void)env, (void)self;
  return __atomic_load_n(&borrowed, __ATOMIC_SEQ_CST);
}

static int32_t ODO_CALL retain(void* owner) {
  __atomic_add_fetch(&((shared*)owner)->holds, 1, __ATOMIC_SEQ_CST);
  return ODO_OK;
}

static void ODO_CALL release(void* owner) {
  shared* picture = (shared*)owner;
  JNIEnv* env;
  if (__atomic_sub_fetch(&picture->holds, 1, __ATOMIC_SEQ_CST) > 0) return;
  env = environment();
  if (env) (*env)->DeleteGlobalRef(env, picture->buffer);
  free(picture);
  __atomic_sub_fetch(&borrowed, 1, __ATOMIC_SEQ_CST);
}

/* `frame`: address of an odo_frame in which only the loan and the address of the pixels are missing. */
JNIEXPORT jint JNICALL Java_org_odograph_Native_pushFrame(JNIEnv* env, jclass self, jlong session, jlong frame,
                                                          jobject buffer, jint begin) {
  odo_frame* lent = (odo_frame*)(intptr_t)frame;
  uint8_t* pixels = (uint8_t*)(*env)->GetDirectBufferAddress(env, buffer);
  shared* owner = (shared*)calloc(1, sizeof *owner);
  int32_t status;
  (void)self;
  if (!pixels || !owner) {
    free(owner);
    return pixels ? ODO_E_MEMORY : ODO_E_ARGUMENT;
  }
  owner->holds = 1;
  __atomic_add_fetch(&borrowed, 1, __ATOMIC_SEQ_CST);
  owner->buffer = (*env)->NewGlobalRef(env, buffer);
  lent->planes[0].data = pixels + begin;
  lent->loan.owner = owner, lent->loan.retain = retain, lent->loan.release = release;
  status = odo_session_push((odo_session*)(intptr_t)session, &lent->header);
  release(owner);
  return status;
}
