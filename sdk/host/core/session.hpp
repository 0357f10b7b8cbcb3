// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/host/base/snapshot.hpp"
#include "sdk/host/core/camera_table.hpp"
#include "sdk/host/core/intake.hpp"
#include "sdk/host/core/outbox.hpp"
#include "sdk/host/core/pipeline.hpp"
#include "sdk/host/core/world_view.hpp"
#include "sdk/host/plugin_host/call_watchdog.hpp"

namespace odograph {

/// Implementation of odo_session: passes the intake's messages to the pipeline.
///
/// The pipeline has one owner, one thread at a time: the session's own thread when live, the thread that pushes or
/// flushes in replay, and save and load. The lock guards only the ownership flag, so plugins, callbacks and frame
/// releases run without a lock. Reading poses and counters needs no ownership.
class Session {
 public:
  static Result<std::unique_ptr<Session>> make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed, AppServices app = {});
  ~Session();

  /// Whether this is a copy of a live session whose threads and plugins' processes are those of the process that made
  /// it: it must not be destroyed.
  bool is_forked_child() const;
  int32_t push(const odo_header& sample);
  int32_t flush();
  void set_callback(TypeSet types, odo_callback callback, void* user);
  odo_statistics statistics() const;
  /// See Outbox.
  Failure take_last_error() { return outbox_.take_last_error(); }
  /// ODO_E_STATE from within a callback.
  int64_t save(void* data, uint64_t capacity);
  int32_t load(const void* data, uint64_t size);
  int64_t save_maps(void* data, uint64_t capacity);
  int32_t load_maps(const void* data, uint64_t size);
  WorldView& world() { return world_; }

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// Acquires ownership, waiting for other owners, and releases it at the end of the scope.
  class Ownership {
   public:
    Ownership(Session& session, Lock& lock);
    ~Ownership();
    Ownership(const Ownership&) = delete;
    Ownership& operator=(const Ownership&) = delete;

   private:
    Session& session_;
    Lock& lock_;
  };

  Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed, AppServices app);

  bool is_owner() const { return owned_ && owner_ == std::this_thread::get_id(); }
  template <class Use>
  auto between_messages(Use&& use) -> decltype(use());
  static int64_t written(const std::vector<uint8_t>& blob, void* data, uint64_t capacity);
  int32_t reported(const char* key, const Result<bool>& loaded);
  bool work_is_waiting() const;
  void process_waiting(Lock& lock, int64_t flush_until_ns);
  void publish_progress();
  void work();
  void notify();

  const PipelineConfig config_;
  const bool live_;
  const int64_t process_;  // a forked child does not have this session's thread
  std::mutex mutex_;       // guards the intake's time order and the ownership below; held only briefly
  Outbox outbox_;
  HostServices host_;
  CameraTable cameras_;
  InputChecks checks_;
  WorldView world_;
  Intake intake_;

  std::unique_ptr<Pipeline> pipeline_;  // used by the owner only, as are the next two
  uint64_t processed_ = 0;
  int64_t newest_ns_ = INT64_MIN;      // of the processed messages
  Snapshot<odo_statistics> progress_;  // without the intake's counters

  // Guarded by the mutex:
  std::condition_variable work_waiting_, owner_changed_;
  bool stopping_ = false;
  uint64_t flushes_requested_ = 0, flushes_done_ = 0;
  bool owned_ = false;
  std::thread::id owner_;

  std::thread thread_;
  std::unique_ptr<CallWatchdog> call_watchdog_;  // last: it reports to this session
};

}  // namespace odograph
