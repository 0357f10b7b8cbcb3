// SPDX-License-Identifier: Apache-2.0
#include "sensors.hpp"

#include <android/looper.h>
#include <android/sensor.h>

#include "conversions.hpp"

namespace phone {
namespace {

void push(odo_session* session, const ASensorEvent& event) {
  const int64_t t_ns = event.timestamp;
  switch (event.type) {
    case ASENSOR_TYPE_GYROSCOPE_UNCALIBRATED:
    case ASENSOR_TYPE_GYROSCOPE: {
      const odo_imu imu = gyroscope(t_ns, event.data, event.type == ASENSOR_TYPE_GYROSCOPE);
      odo_session_push(session, &imu.header);
      break;
    }
    case ASENSOR_TYPE_ACCELEROMETER_UNCALIBRATED:
    case ASENSOR_TYPE_ACCELEROMETER: {
      const odo_imu imu = accelerometer(t_ns, event.data, event.type == ASENSOR_TYPE_ACCELEROMETER);
      odo_session_push(session, &imu.header);
      break;
    }
    case ASENSOR_TYPE_MAGNETIC_FIELD_UNCALIBRATED: {
      const odo_magnetometer field = magnetometer(t_ns, event.data);
      odo_session_push(session, &field.header);
      break;
    }
    case ASENSOR_TYPE_PRESSURE: {
      const odo_barometer pressure = barometer(t_ns, event.data[0]);
      odo_session_push(session, &pressure.header);
      break;
    }
    default: break;
  }
}

/// Enables the first of two sensors that the phone has, at the requested or the fastest rate.
void enable(ASensorManager* manager, ASensorEventQueue* queue, int wanted, int otherwise, int32_t period_us) {
  const ASensor* sensor = ASensorManager_getDefaultSensor(manager, wanted);
  if (!sensor && otherwise != 0) sensor = ASensorManager_getDefaultSensor(manager, otherwise);
  if (!sensor || ASensorEventQueue_enableSensor(queue, sensor) < 0) return;
  ASensorEventQueue_setEventRate(queue, sensor, period_us);
}

}  // namespace

Sensors::Sensors(odo_session* session, const char* package) : session_(session) {
  thread_ = std::thread([this, package] { run(package); });
}

Sensors::~Sensors() {
  stop_ = true;
  thread_.join();
}

void Sensors::run(const char* package) {
  ASensorManager* manager = ASensorManager_getInstanceForPackage(package);
  ALooper* looper = ALooper_prepare(ALOOPER_PREPARE_ALLOW_NON_CALLBACKS);
  ASensorEventQueue* queue = ASensorManager_createEventQueue(manager, looper, 1, nullptr, nullptr);
  if (!queue) return;
  enable(manager, queue, ASENSOR_TYPE_GYROSCOPE_UNCALIBRATED, ASENSOR_TYPE_GYROSCOPE, 5000);
  enable(manager, queue, ASENSOR_TYPE_ACCELEROMETER_UNCALIBRATED, ASENSOR_TYPE_ACCELEROMETER, 5000);
  enable(manager, queue, ASENSOR_TYPE_MAGNETIC_FIELD_UNCALIBRATED, 0, 20000);
  enable(manager, queue, ASENSOR_TYPE_PRESSURE, 0, 100000);
  ASensorEvent events[32];
  while (!stop_) {
    ALooper_pollOnce(100, nullptr, nullptr, nullptr);
    for (ssize_t count; (count = ASensorEventQueue_getEvents(queue, events, 32)) > 0;)
      for (ssize_t i = 0; i < count; ++i) push(session_, events[i]);
  }
  ASensorManager_destroyEventQueue(manager, queue);
}

}  // namespace phone
