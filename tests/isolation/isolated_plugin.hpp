// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "sdk/host/plugin_host/instance.hpp"
#include "tests/support/session_app.hpp"

namespace odograph {

/// An attitude filter or a front-end in a separate process, without a session.
struct IsolatedPlugin {
  std::vector<std::string> said;
  HostServices host{0, {"."}, [this](const Report& report) { said.push_back(report.text); }};
  std::unique_ptr<PluginInstance> plugin;
  int64_t t_ns = 1'000'000'000;

  explicit IsolatedPlugin(const std::string& yaml = "attitude: {plugin: attitude/vqf, isolation: process}\n",
                          const std::string& plugins = ".") {
    const auto config = required(read_pipeline_config("odograph: 1\n" + yaml, "<text>", {plugin_folder(), plugins}));
    const auto& choices = config->attitudes.empty() ? config->vo_frontends : config->attitudes;
    auto made = required(PluginInstance::make(choices.front(), LibraryCheck::sealed, 1, host));
    plugin = std::move(*made);
  }
  size_t sample() {
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns += 10'000'000);
    imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    imu.accel_b[1] = 9.81;
    return plugin->process(imu.header).size();
  }
};

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace odograph
