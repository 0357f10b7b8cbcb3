// SPDX-License-Identifier: Apache-2.0
//
// An app that walks for two seconds with attitude/vqf and test/fault_phase; the library prints to standard error
// itself. It exits with status 77 if it gets poses or a reason for their absence. After a timeout it asks the library
// for the plugin call in progress, prints it to standard error and exits with status 3.
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>

#include <unistd.h>

#include <odograph/odograph.h>
#include "tests/support/replay_session.hpp"

namespace {

void too_late(int) {
  char call[128];
  const uint64_t size = odo_current_plugin_call(call, sizeof call - 1);
  call[size] = '\n';
  (void)!write(STDERR_FILENO, call, size + 1);
  _exit(3);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  std::signal(SIGALRM, too_late);
  alarm(5);
  const std::string yaml =
      "odograph: 1\nattitude:\n  - plugin: attitude/vqf\n  - {plugin: test/fault_phase, time_limit: 0.05 s}\n"
      "step_estimator:\n  plugin: step/renaudin2012\n";
  const std::string folders = arguments[1];
  odo_session_options options = odograph::replay_options(yaml, folders);
  options.flags = ODO_SESSION_CRASH_NOTES;
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) < 0) {
    std::fprintf(stderr, "%s\n", error.message);
    return 77;
  }
  for (int i = 0; i < 200; ++i) {
    const double t = 0.01 * i;
    const double gyro[3] = {0.05 * std::sin(6 * t), 0.01, 0.1 * std::sin(3 * t)};
    const double accel[3] = {0.1, 9.81 + 2.2 * std::sin(2 * 3.14159265 * 1.9 * t), 0.4};
    odo_session_push_imu(session, static_cast<int64_t>(t * 1e9) + 1'000'000'000, gyro, accel);
  }
  odo_session_flush(session);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  const bool posed = odo_session_get_pose(session, ODO_TIME_LATEST, &pose) == ODO_OK;
  odo_session_destroy(session);
  return posed ? 77 : 1;
}
