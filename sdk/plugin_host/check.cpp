// SPDX-License-Identifier: Apache-2.0
#include "sdk/plugin_host/check.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <sys/wait.h>
#include <unistd.h>

#include "sdk/core/messages.hpp"
#include "sdk/plugin_host/instance.hpp"
#include "sdk/plugin_host/library.hpp"

namespace odograph {
namespace {

/// Runs a test in a child; it passes when it returns an empty text.
PluginCheck in_child(const std::string& what, const std::function<std::string()>& test) {
  int ends[2];
  if (pipe(ends) != 0) return {what, false, "no pipe"};
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    alarm(20);
    const std::string text = test();
    if (write(ends[1], text.data(), text.size()) < 0) _exit(2);
    _exit(text.empty() ? 0 : 1);
  }
  close(ends[1]);
  std::string text(4096, '\0');
  const ssize_t count = read(ends[0], text.data(), text.size());
  text.resize(count > 0 ? static_cast<size_t>(count) : 0);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return {what, false, std::string("killed by ") + strsignal(WTERMSIG(status))};
  return {what, WIFEXITED(status) && WEXITSTATUS(status) == 0, text};
}

/// Ten seconds of walking-like input of every kind, with 64x48 pictures of a moving pattern.
class TestInput {
 public:
  TestInput() : pixels_(kFrames, std::vector<uint8_t>(64 * 48)) {
    auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    calibration.model = ODO_CAMERA_PINHOLE;
    calibration.width = 64, calibration.height = 48;
    calibration.fx = calibration.fy = 60, calibration.cx = 31.5, calibration.cy = 23.5;
    add(calibration);
    for (int i = 0; i < 1000; ++i) {
      const double t = i * 0.01;
      const int64_t t_ns = 1'000'000'000 + i * 10'000'000LL;
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
      imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
      imu.gyro_b[2] = 0.1 * std::sin(t);
      imu.accel_b[2] = 9.81 + 2.0 * std::sin(12.0 * t);
      add(imu);
      auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, t_ns);
      attitude.q_n_b[0] = 1.0;
      add(attitude);
      if (i % 50 == 0 && i > 0) {
        auto step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
        step.header.flags = ODO_STEP_HEADING;
        step.t_start_ns = t_ns - 500'000'000, step.t_end_ns = t_ns;
        step.length_m = 0.7, step.sigma_m = 0.05, step.frequency_hz = 2.0;
        add(step);
      }
      if (i % 10 == 0) add_camera(i / 10, t_ns);
      if (i % 100 == 0) {
        auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
        gnss.header.flags = ODO_GNSS_POSITION;
        gnss.latitude_rad = 0.8 + 1e-7 * i;
        add(gnss);
        auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, t_ns);
        waypoint.sigma_m = 0.1;
        add(waypoint);
      }
    }
  }
  std::vector<AnyMessage> messages;

 private:
  static constexpr size_t kFrames = 100;

  template <class M>
  void add(const M& message) {
    messages.emplace_back().assign(message.header);
  }

  void add_camera(int k, int64_t t_ns) {
    auto& pixels = pixels_[static_cast<size_t>(k)];
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        pixels[static_cast<size_t>(y) * 64 + static_cast<size_t>(x)] =
            static_cast<uint8_t>((((x + k / 4) / 8 + y / 8) % 2) * 180 + 30 + (x * 7 + y * 13) % 20);
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
    frame.format = ODO_FORMAT_GREY8;
    frame.width = 64, frame.height = 48;
    frame.planes[0] = {pixels.data(), 64, 1, 0};
    add(frame);
    if (k == 0) return;
    auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
    motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_NAVIGATION;
    motion.t_from_ns = t_ns - 100'000'000;
    motion.q_c0_c1[0] = motion.q_n_c0[0] = 1.0;
    motion.p_c0_c1[0] = 0.1;
    motion.state = ODO_TRACKING;
    add(motion);
  }

  std::vector<std::vector<uint8_t>> pixels_;
};

/// An instance driven by hand, with everything it emits.
class Subject {
 public:
  Subject(const odo_plugin& table, const HostServices& host, const std::vector<odo_value>& values) : table_(table) {
    sink_.struct_size = sizeof(odo_sink);
    sink_.instance = 1;
    sink_.emit = [](const odo_sink* sink, const odo_header* event) -> int32_t {
      AnyMessage copy;
      if (!event || !copy.assign(*event)) return ODO_E_STRUCT_SIZE;
      const auto* bytes = copy.bytes;
      static_cast<const Sink*>(sink)->owner->events.emplace_back(bytes, bytes + copy.header().struct_size);
      if (!message_is_finite(copy.header())) static_cast<const Sink*>(sink)->owner->all_finite = false;
      return ODO_OK;
    };
    sink_.owner = this;
    status = table_.create(&host, 1, &table_.interfaces[0], &instance_);
    if (status >= 0)
      status = table_.configure(instance_, values.data(), static_cast<uint32_t>(values.size()), sizeof(odo_value));
    if (status >= 0) status = table_.activate(instance_, &sink_);
  }
  ~Subject() {
    if (instance_) table_.destroy(instance_);
  }
  int32_t process(const std::vector<AnyMessage>& messages, size_t cut) {
    int32_t worst = ODO_OK;
    for (size_t i = 0; i < messages.size(); i += cut) {
      std::vector<const odo_header*> batch;
      for (size_t k = i; k < std::min(i + cut, messages.size()); ++k) batch.push_back(&messages[k].header());
      const odo_batch b{sizeof b, static_cast<uint32_t>(batch.size()), batch.data()};
      worst = std::min(worst, table_.process(instance_, &b));
    }
    return worst;
  }
  odo_instance* instance() { return instance_; }
  std::vector<std::vector<uint8_t>> events;
  bool all_finite = true;
  int32_t status = ODO_OK;

 private:
  struct Sink : odo_sink {
    Subject* owner;
  };
  const odo_plugin& table_;
  Sink sink_{};
  odo_instance* instance_ = nullptr;
};

/// Only what the plugin's kind is given.
std::vector<AnyMessage> inputs_of(const odo_plugin& table, const std::vector<AnyMessage>& all) {
  uint32_t mask = 0;
  for (uint32_t i = 0; i < table.interface_count; ++i)
    mask |= kind_types(std::string(table.interfaces[i].data, table.interfaces[i].size)).inputs;
  std::vector<AnyMessage> some;
  for (const auto& m : all)
    if (mask >> m.header().type & 1) some.push_back(m);
  return some;
}

}  // namespace

std::vector<PluginCheck> check_plugin(const std::filesystem::path& path,
                                      const std::vector<std::pair<std::string, std::string>>& settings) {
  std::vector<PluginCheck> checks;
  const auto file = check_shared_library(path);
  checks.push_back({"is a shared library for this machine", file.ok(), file ? "" : file.failure().text});
  if (!file) return checks;
  const HostServices host(1, {std::filesystem::current_path()}, nullptr);
  checks.push_back(in_child("loads and fills a good table", [&] {
    const auto library = PluginLibrary::load(path, &host);
    return library ? std::string() : library.failure().text;
  }));
  if (!checks.back().passed) return checks;

  const TestInput input;
  const auto with = [&](const std::function<std::string(const odo_plugin&, const std::vector<odo_value>&,
                                                        const std::vector<AnyMessage>&)>& test) {
    return [&, test] {
      const auto library = PluginLibrary::load(path, &host);
      const odo_plugin& table = (*library)->table();
      PluginChoice choice;
      choice.manifest.parameters = *parameter_specs(table);
      for (Spec spec : choice.manifest.parameters) {
        for (const auto& [name, value] : settings)
          if (spec.name == name) spec.fallback = value;
        choice.parameters.emplace_back(spec, default_value(spec));
      }
      return test(table, values_of(choice), inputs_of(table, input.messages));
    };
  };
  checks.push_back(in_child("refuses a host that speaks only a newer ABI", [&] {
    const auto library = PluginLibrary::load(path, &host);
    odo_host future = host;
    future.abi_major_min = future.abi_major_max = ODO_ABI_MAJOR + 7;
    const auto refused = PluginLibrary::load(path, &future);
    return refused ? std::string("it started") : std::string();
  }));
  checks.push_back(in_child("lives from create to destroy with its default parameters",
                            with([&](const odo_plugin& table, const auto& values, const auto&) -> std::string {
                              const Subject subject(table, host, values);
                              return subject.status >= 0 ? "" : "status " + std::to_string(subject.status);
                            })));
  checks.push_back(in_child("processes ten seconds of input and emits good events",
                            with([&](const odo_plugin& table, const auto& values, const auto& messages) -> std::string {
                              Subject subject(table, host, values);
                              const int32_t status = subject.process(messages, 1);
                              if (status <= ODO_E_MEMORY) return "status " + std::to_string(status);
                              if (!subject.all_finite) return "an event has numbers that are not finite";
                              return "";
                            })));
  checks.push_back(in_child("gives the same events however the input is cut",
                            with([&](const odo_plugin& table, const auto& values, const auto& messages) -> std::string {
                              Subject one(table, host, values), other(table, host, values);
                              one.process(messages, 1);
                              other.process(messages, 17);
                              return one.events == other.events
                                         ? ""
                                         : std::to_string(one.events.size()) + " events differ from " +
                                               std::to_string(other.events.size());
                            })));
  checks.push_back(in_child("gives the same events after reset",
                            with([&](const odo_plugin& table, const auto& values, const auto& messages) -> std::string {
                              if (!ODO_HAS(&table, reset) || !table.reset) return "";
                              Subject subject(table, host, values);
                              subject.process(messages, 1);
                              const auto first = std::exchange(subject.events, {});
                              if (table.reset(subject.instance()) < 0) return "reset failed";
                              subject.process(messages, 1);
                              return subject.events == first ? "" : "events differ";
                            })));
  checks.push_back(in_child("survives an empty batch and messages of unknown types",
                            with([&](const odo_plugin& table, const auto& values, const auto&) -> std::string {
                              Subject subject(table, host, values);
                              const odo_batch empty{sizeof empty, 0, nullptr};
                              auto strange = make_message<odo_pose>(29, 5);
                              const odo_header* messages[] = {&strange.header};
                              const odo_batch batch{sizeof batch, 1, messages};
                              if (subject.status < 0) return "status " + std::to_string(subject.status);
                              const auto library = PluginLibrary::load(path, &host);
                              (*library)->table().process(subject.instance(), &empty);
                              (*library)->table().process(subject.instance(), &batch);
                              return "";
                            })));
  return checks;
}

}  // namespace odograph
