// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <poll.h>
#include <sys/types.h>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "sdk/host/plugin_host/wire.hpp"

namespace odograph {

/// An instance in its own sandboxed process (sandbox.hpp), running `odograph-plugin-host`. Messages and events pass
/// through shared memory, wake-ups through a socket; a frame's pixels stay in place if they are in memory that the
/// plugin maps (FrameStore), and are copied there otherwise. A fault of the plugin ends only its own process: then
/// ended() states the reason, every call returns ODO_E_ERROR, and a new backend must be created. Once the host's pace
/// is `ending`, a process that does not answer a call is ended at once.
class ProcessBackend : public PluginBackend {
 public:
  /// Starts the process and loads the library in it. A failure names the plugin and its fault. `choice` and `sink`
  /// outlive it; the sink's emit receives every event within process().
  static Result<std::unique_ptr<ProcessBackend>> load(const PluginChoice& choice, LibraryCheck check,
                                                      HostServices& host, const odo_sink& sink);
  ~ProcessBackend() override;

  int32_t start() override;
  int32_t process(const odo_header& message) override;
  int32_t reset() override;
  std::vector<uint8_t> save() override;
  bool load(std::span<const uint8_t> data) override;
  std::vector<uint8_t> map_piece(uint64_t offset) override;
  bool take_map_piece(uint64_t offset, std::span<const uint8_t> piece) override;
  const KindTypes& types() const override { return types_; }
  void quarantine() override { quarantined_ = true; }
  bool quarantined() const override { return quarantined_; }
  std::string ended() const override { return ended_; }
  int process_id() const override { return child_; }

 private:
  ProcessBackend(const PluginChoice& choice, HostServices& host, const odo_sink& sink)
      : choice_(choice), host_(host), sink_(sink) {}
  bool launch(const std::filesystem::path& program);
  using Clock = std::chrono::steady_clock;
  bool exchange(wire::Call call, const wire::Writer& request, double limit_s, Clock::time_point since = Clock::now());
  bool exchange_to_start(wire::Call call, const wire::Writer& request) {
    return exchange(call, request, choice_.isolation.start_s, launched_);
  }
  bool wait_for_answer(wire::Call call, double limit_s, Clock::time_point since);
  /// Distinguishes an empty packet from the end of the connection when nothing was received.
  bool hung_up() const {
    pollfd end{socket_, 0, 0};
    return poll(&end, 1, 0) != 0;
  }
  wire::Reader answer() const { return wire::Reader({reinterpret_cast<const uint8_t*>(answer_.data()), answer_size_}); }
  Failure opened(const std::string& origin);
  int32_t answered(bool may_emit = false);
  bool take_records(wire::Reader& reader, bool may_emit);
  /// A frame that the plugin's process may hold.
  struct FrameSlot {
    bool used = false;
    bool retained = false;  ///< through its own reference
    odo_frame frame{};
    std::span<uint8_t> copy;  ///< in shared memory; empty if the frame itself is there
  };

  bool put_frame(const odo_header& message, wire::Writer& request);
  void reclaim_frames();
  void release_frame(FrameSlot& entry);
  void give_up(std::string what);
  pid_t wait_for_end(int polls, int& status);
  void reap(bool killed_by_us, const std::string& what);
  wire::Writer request() { return wire::Writer({control_->request, wire::kAreaBytes}); }

  const PluginChoice& choice_;
  HostServices& host_;
  const odo_sink& sink_;
  KindTypes types_;
  std::string ended_;
  bool quarantined_ = false;
  Clock::time_point launched_ = Clock::now();
  pid_t child_ = -1;
  int socket_ = -1;
  wire::Control* control_ = nullptr;
  FrameSlot frames_[wire::kFrameSlots];
  std::vector<uint64_t> answer_;  // copied before it is checked
  size_t answer_size_ = 0;
  std::vector<uint8_t> state_;  // of the last save
};

/// The program that runs plugins: beside this library or program, or where it is installed. Empty if missing.
std::filesystem::path plugin_host_program();

}  // namespace odograph
