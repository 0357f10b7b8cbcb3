// SPDX-License-Identifier: Apache-2.0
//
// The n-th allocation fails, for every n during a plugin's life: create, configure, activate, process, save, destroy.
// Nothing may crash, every failure is a status, and no memory leaks.
// odograph-nth-allocation PLUGINS ID...
#include <malloc.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <odograph/messages.h>
#include <odograph/odograph.h>

#include "sdk/host/config/registry.hpp"
#include "sdk/host/core/c_guard.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/library_backend.hpp"
#include "tests/support/messages.hpp"

extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* pointer, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
}

namespace {

thread_local long left = 0;  // allocations until the one that fails; 0: none does

bool fails_now() {
  if (left == 0 || --left > 0) return false;
  errno = ENOMEM;
  return true;
}

}  // namespace

extern "C" {
void* malloc(size_t size) { return fails_now() ? nullptr : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return fails_now() ? nullptr : __libc_calloc(count, size); }
void* realloc(void* pointer, size_t size) { return fails_now() ? nullptr : __libc_realloc(pointer, size); }
void* memalign(size_t alignment, size_t size) { return fails_now() ? nullptr : __libc_memalign(alignment, size); }
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void** out, size_t alignment, size_t size) {
  void* memory = memalign(alignment, size);
  if (memory) *out = memory;
  return memory ? 0 : ENOMEM;
}
}

using namespace odograph;

namespace {

constexpr int kSamples = 60;
constexpr uint32_t kWidth = 64, kHeight = 48;
long at_work = 0;  // present n

std::vector<AnyMessage> input() {
  std::vector<AnyMessage> all;
  auto lens = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 1'000'000'000);
  lens.model = ODO_CAMERA_PINHOLE;
  lens.width = kWidth, lens.height = kHeight;
  lens.fx = lens.fy = kWidth, lens.cx = kWidth / 2.0, lens.cy = kHeight / 2.0;
  lens.q_b_c[0] = 1;
  all.emplace_back(lens.header);
  static std::vector<uint8_t> pixels[3];
  for (int i = 0; i < kSamples; ++i) {
    const int64_t t_ns = 1'000'000'000 + i * 10'000'000LL;
    all.emplace_back(imu_at(t_ns, {0, 0, 0.1}, {0, 9.81 + 2.2 * std::sin(0.12 * i), 0}).header);
    auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, t_ns);
    attitude.q_n_b[0] = attitude.q_n_b[1] = 0.70710678118654757;
    for (int k = 0; k < 3; ++k) attitude.covariance_n[4 * k] = 1e-3;
    all.emplace_back(attitude.header);
    if (i % 20 == 10) {
      auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
      gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
      gnss.latitude_rad = 0.8, gnss.longitude_rad = 0.1;
      for (int k = 0; k < 3; ++k) gnss.covariance_n[4 * k] = 4;
      all.emplace_back(gnss.header);
      auto step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
      step.t_start_ns = t_ns - 500'000'000, step.t_end_ns = t_ns;
      step.length_m = 0.7, step.sigma_m = 0.05, step.frequency_hz = 2;
      all.emplace_back(step.header);
      all.emplace_back(motion_between(t_ns - 200'000'000, t_ns, {0, 0, 0.2}).header);
      all.emplace_back(pressure_at(t_ns, 95000).header);
      auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, t_ns);
      waypoint.sigma_m = 0.5;
      all.emplace_back(waypoint.header);
      auto& picture = pixels[i / 20];
      picture.resize(kWidth * kHeight);
      for (uint32_t k = 0; k < picture.size(); ++k) picture[k] = static_cast<uint8_t>((k / 7 + i) * (k / 500) * 37);
      all.emplace_back(grey_frame_at(t_ns, picture.data(), kWidth, kHeight).header);
    }
  }
  return all;
}

/// A whole life. False if the failing allocation was not reached.
bool live(LibraryBackend& backend, long n, const std::vector<AnyMessage>& messages, size_t& told) {
  left = n;
  int32_t worst = guarded([&] { return backend.start(); });  // as in the C API
  if (worst >= 0) {
    for (const AnyMessage& message : messages) {
      const auto& types = backend.types().inputs;
      if (std::find(types.begin(), types.end(), message.header().type) == types.end()) continue;
      const int32_t status = guarded([&] { return backend.process(message.header()); });
      worst = std::min(worst, status == ODO_E_DISCARD ? ODO_OK : status);
      if (status == ODO_E_MEMORY || status == ODO_E_ERROR) guarded([&] { return backend.reset(); });
    }
    guarded([&] { return backend.save(), ODO_OK; });
  }
  backend.close();
  const bool reached = left == 0;
  left = 0;
  told += reached && worst < 0 ? 1 : 0;
  return reached;
}

int check(const Manifest& manifest, const std::vector<AnyMessage>& messages) {
  HostServices host(0, {}, nullptr);
  odo_sink sink{};
  sink.struct_size = sizeof sink;
  sink.instance = 1;
  sink.emit = [](const odo_sink*, const odo_header*) -> int32_t { return ODO_OK; };
  PluginChoice choice;
  choice.manifest = manifest;
  choice.interface_id = manifest.interfaces.front();
  for (const Spec& spec : manifest.parameters) choice.parameters.emplace_back(spec, default_value(spec));
  const auto loaded = LibraryBackend::load(choice, LibraryCheck::none, host, sink);
  if (!loaded) return std::printf("FAILED: %s\n", loaded.failure().text.c_str()), 1;
  LibraryBackend& backend = const_cast<LibraryBackend&>(**loaded);
  size_t told = 0;
  for (int i = 0; i < 3; ++i) live(backend, 0, messages, told);
  told = 0;
  const auto before = static_cast<double>(mallinfo2().uordblks);
  for (at_work = 1; live(backend, at_work, messages, told); ++at_work) {
  }
  const double grown_kb = (static_cast<double>(mallinfo2().uordblks) - before) / 1024;
  std::printf("%s: each of %ld allocations failed once, %zu times with a status; %+.1f kB kept\n", manifest.id.c_str(),
              at_work - 1, told, grown_kb);
  return grown_kb < 64 ? 0 : 1;  // permanent allocations of a library at first use
}

}  // namespace

int main(int count, char** arguments) {
  std::set_terminate([] {
    left = 0;
    std::fprintf(stderr, "FAILED: terminated when allocation %ld failed\n", at_work);
    std::abort();
  });
  if (count < 3) return std::printf("FAILED: expected a folder of plugins and their ids\n"), 1;
  const auto messages = input();
  int failed = 0;
  for (int i = 2; i < count; ++i) {
    std::string file = arguments[i];
    file[file.find('/')] = '_';
    const auto manifest = read_manifest(std::string(arguments[1]) + "/" + file + ".odoplugin.json");
    if (!manifest) return std::printf("FAILED: %s\n", manifest.failure().text.c_str()), 1;
    failed += check(*manifest, messages);
  }
  return failed;
}
