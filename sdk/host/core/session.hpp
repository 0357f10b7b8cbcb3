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
#include "sdk/host/plugin_host/hang_watch.hpp"

namespace odograph {

/// What is behind odo_session: brings what the intake has to the pipeline.
///
/// The pipeline belongs to one owner, one thread at a time: the session's own when live, whoever pushes or
/// flushes in replay, and save and load. Only the owner's flag is under the lock, so that plugins work, callbacks are
/// called and frames are given back with no lock held. Poses and counters are read without owning it.
class Session {
 public:
  static Result<std::unique_ptr<Session>> make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed, AppServices app = {});
  ~Session();

  int32_t push(const odo_header& sample);
  int32_t flush();
  void set_callback(TypeSet types, odo_callback callback, void* user);
  odo_statistics statistics() const;
  /// As Outbox has it.
  Failure take_last_error() { return outbox_.take_last_error(); }
  /// ODO_E_STATE from within a callback.
  int64_t save(void* data, uint64_t capacity);
  int32_t load(const void* data, uint64_t size);
  WorldView& world() { return world_; }

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// Ownership, once nobody else has it, to the end of the scope, however that is left.
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

  bool is_in_a_child() const;
  bool is_owner() const { return owned_ && owner_ == std::this_thread::get_id(); }
  bool work_is_waiting() const;
  void process_waiting(Lock& lock, int64_t flush_until_ns);
  void publish_progress();
  void work();
  void notify();

  const PipelineConfig config_;
  const bool live_;
  const int64_t process_;  // a child that was forked has no thread of this session
  Outbox outbox_;
  HostServices host_;
  CameraTable cameras_;
  WorldView world_;
  Intake intake_;

  std::unique_ptr<Pipeline> pipeline_;  // the owner's, as are the next two
  uint64_t processed_ = 0;
  int64_t newest_ns_ = INT64_MIN;      // of what was processed
  Snapshot<odo_statistics> progress_;  // without what the intake counts

  std::mutex mutex_;  // for what follows; held for moments only
  std::condition_variable work_waiting_, owner_changed_;
  bool stopping_ = false;
  uint64_t flushes_asked_ = 0, flushes_done_ = 0;
  bool owned_ = false;
  std::thread::id owner_;

  std::thread thread_;
  std::unique_ptr<HangWatch> hang_watch_;  // the last: it reports to this session
};

}  // namespace odograph
