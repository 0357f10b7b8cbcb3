/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include <android/looper.h>
extern "C" {
enum {
  ASENSOR_TYPE_ACCELEROMETER = 1,
  ASENSOR_TYPE_GYROSCOPE = 4,
  ASENSOR_TYPE_PRESSURE = 6,
  ASENSOR_TYPE_MAGNETIC_FIELD_UNCALIBRATED = 14,
  ASENSOR_TYPE_GYROSCOPE_UNCALIBRATED = 16,
  ASENSOR_TYPE_ACCELEROMETER_UNCALIBRATED = 35
};
struct ASensorManager;
struct ASensorEventQueue;
struct ASensor;
struct ASensorEvent {
  int32_t version, sensor, type, reserved0;
  int64_t timestamp;
  float data[16];
  uint32_t flags;
  int32_t reserved1[3];
};
ASensorManager* ASensorManager_getInstanceForPackage(const char* package);
const ASensor* ASensorManager_getDefaultSensor(ASensorManager* manager, int type);
ASensorEventQueue* ASensorManager_createEventQueue(ASensorManager* manager, ALooper* looper, int ident,
                                                   ALooper_callbackFunc callback, void* data);
int ASensorManager_destroyEventQueue(ASensorManager* manager, ASensorEventQueue* queue);
int ASensorEventQueue_enableSensor(ASensorEventQueue* queue, const ASensor* sensor);
int ASensorEventQueue_setEventRate(ASensorEventQueue* queue, const ASensor* sensor, int32_t period_us);
ssize_t ASensorEventQueue_getEvents(ASensorEventQueue* queue, ASensorEvent* events, size_t count);
}
