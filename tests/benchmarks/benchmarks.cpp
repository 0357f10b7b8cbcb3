// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <cmath>
#include <fstream>

#include <odograph/attitude.h>
#include <odograph/odograph.h>

#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/replay_session.hpp"

namespace {

using namespace odograph;

odo_imu sample(int64_t i) {
  return imu_at(i * 5'000'000, {0.1 * std::sin(0.01 * static_cast<double>(i)), 0, 0},
                {0, 0, 9.81 + 2 * std::sin(0.06 * static_cast<double>(i))});
}

/// Cost of the same call without the ABI.
struct Direct {
  virtual ~Direct() = default;
  virtual void on(const odo_imu& imu) = 0;
};
struct DirectNoop final : Direct {
  double sum = 0;
  void on(const odo_imu& imu) override { sum += imu.gyro_b[0]; }
};

void virtual_call(benchmark::State& state) {
  DirectNoop object;
  Direct* direct = &object;
  benchmark::DoNotOptimize(direct);
  const odo_imu imu = sample(1);
  for ([[maybe_unused]] auto _ : state) {
    direct->on(imu);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(virtual_call);

std::unique_ptr<PluginInstance> noop(HostServices& host) {
  PluginChoice choice;
  choice.manifest.id = "bench/noop";
  choice.manifest.library = ODOGRAPH_BUILD "/tests/benchmarks/bench_noop.so";
  choice.manifest.abi_major = ODO_ABI_MAJOR, choice.manifest.abi_minor = ODO_ABI_MINOR;
  choice.interface_id = ODO_INTERFACE_ATTITUDE;
  return std::move(*PluginInstance::make(choice, LibraryCheck::none, 1, host));
}

void plugin_call(benchmark::State& state) {
  HostServices host(0, {"."}, nullptr);
  const auto instance = noop(host);
  const odo_imu imu = sample(1);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(instance->process(imu.header).size());
}
BENCHMARK(plugin_call);

/// Latency from an IMU sample's push to its attitude in the callback (attitude/vqf); with steps for the second config.
void imu_push(benchmark::State& state, const char* yaml) {
  const std::string text = yaml, plugins = ODOGRAPH_BUILD "/lib/odograph/plugins";
  const odo_session_options options = replay_options(text, plugins);
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, nullptr) != ODO_OK) return state.SkipWithError("no session");
  int64_t attitudes = 0;
  const uint32_t wanted = ODO_TYPE_ATTITUDE;
  odo_session_set_callback(
      session, &wanted, 1, [](void* user, const odo_header*) { ++*static_cast<int64_t*>(user); }, &attitudes);
  int64_t i = 0;
  for ([[maybe_unused]] auto _ : state) {
    const odo_imu imu = sample(++i);
    odo_session_push(session, &imu.header);
  }
  state.counters["attitudes"] = static_cast<double>(attitudes);
  odo_session_destroy(session);
}
BENCHMARK_CAPTURE(imu_push, attitude,
                  "odograph: 1\nattitude:\n  plugin: attitude/vqf\ntime_ordering:\n  max_wait: 0\n");
BENCHMARK_CAPTURE(imu_push, magyq, "odograph: 1\nattitude:\n  plugin: attitude/magyq\ntime_ordering:\n  max_wait: 0\n");
BENCHMARK_CAPTURE(imu_push, attitude_and_steps,
                  "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n"
                  "time_ordering:\n  max_wait: 0\n");
BENCHMARK_CAPTURE(imu_push, attitude_and_steps_renaudin2012,
                  "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n"
                  "time_ordering:\n  max_wait: 0\n");

/// Complete frames through the session, without decoding. One iteration is the whole clip.
void vo_frames(benchmark::State& state, const char* config) {
  const auto recording = read_recording(std::filesystem::path(ODOGRAPH_DATA) / "tsukuba_90");
  if (!recording) return state.SkipWithError("no tsukuba_90");
  RunOptions options;
  options.config = std::string(ODOGRAPH_SOURCE "/samples/configs/") + config;
  options.plugin_path = ODOGRAPH_BUILD "/lib/odograph/plugins";
  std::vector<double> ms;
  for ([[maybe_unused]] auto _ : state) {
    const auto result = replay(*recording, options);
    ms.insert(ms.end(), result->frame_ms.begin() + 1, result->frame_ms.end());
  }
  state.counters["frame_ms_median"] = percentile(ms, 0.5);
  state.counters["frame_ms_p99"] = percentile(ms, 0.99);
  state.counters["frames_per_s"] = 1000.0 / percentile(ms, 0.5);
}
BENCHMARK_CAPTURE(vo_frames, five_point, "monocular.yaml")->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK_CAPTURE(vo_frames, odograph, "monocular_odograph.yaml")->Unit(benchmark::kMillisecond)->Iterations(5);

/// Resident memory of a session with attitude and steps: initially, and after an hour of IMU samples at 200 Hz.
double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096 / 1e6;
}

void memory(benchmark::State& state) {
  const std::string text =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n";
  const std::string plugins = ODOGRAPH_BUILD "/lib/odograph/plugins";
  const odo_session_options options = replay_options(text, plugins);
  for ([[maybe_unused]] auto _ : state) {
    odo_session* session = nullptr;
    const double before = resident_mb();
    if (odo_session_create(&options, &session, nullptr) != ODO_OK) return state.SkipWithError("no session");
    const double rest = resident_mb();
    for (int64_t i = 1; i <= 720000; ++i) {
      const odo_imu imu = sample(i);
      odo_session_push(session, &imu.header);
    }
    state.counters["session_mb_at_rest"] = rest - before;
    state.counters["session_mb_after_1h"] = resident_mb() - before;
    odo_session_destroy(session);
  }
}
BENCHMARK(memory)->Iterations(1)->Unit(benchmark::kMillisecond);

void render_frame(benchmark::State& state) {
  const Scenario scenario;
  const World world(scenario, 1);
  const SimCamera camera(scenario.camera, 1.0, 1);
  const Motion phone = make_walk(scenario, 1).phone;
  View view(world, camera, scenario);
  double t = 2;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(camera.develop(view.render(phone, t += 0.1), 1).data);
}
BENCHMARK(render_frame)->Unit(benchmark::kMillisecond);

}  // namespace
