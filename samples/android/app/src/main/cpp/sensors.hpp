// SPDX-License-Identifier: Apache-2.0
//
// Gyroscope, accelerometer, magnetometer and barometer by the NDK's ASensor, on a separate thread.
#ifndef PHONE_SENSORS_HPP
#define PHONE_SENSORS_HPP

#include <atomic>
#include <thread>

#include <odograph/odograph.h>

namespace phone {

class Sensors {
 public:
  Sensors(odo_session* session, const char* package);
  ~Sensors();
  Sensors(const Sensors&) = delete;

 private:
  void run(const char* package);
  odo_session* session_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace phone

#endif
