/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stdint.h>
#define JNIEXPORT __attribute__((visibility("default")))
#define JNICALL
typedef int32_t jint;
typedef int64_t jlong;
typedef double jdouble;
typedef uint8_t jboolean;
class _jobject;
typedef _jobject* jobject;
typedef _jobject* jstring;
typedef _jobject* jdoubleArray;
struct JNIEnv {
  const char* GetStringUTFChars(jstring string, jboolean* is_copy);
  void ReleaseStringUTFChars(jstring string, const char* text);
  jstring NewStringUTF(const char* text);
  jdoubleArray NewDoubleArray(jint length);
  void SetDoubleArrayRegion(jdoubleArray array, jint start, jint length, const jdouble* values);
};
