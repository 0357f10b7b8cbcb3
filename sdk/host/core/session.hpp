// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/host/base/snapshot.hpp"
#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/frame_store.hpp"
#include "sdk/host/core/pipeline.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/sample_gate.hpp"
#include "sdk/host/core/time_order.hpp"
#include "sdk/host/plugin_host/hang_watch.hpp"

namespace odograph {

/// What is behind odo_session: the queue, the thread (when live), who owns the pipeline.
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
  /// PoseStream::at, of the body or the camera: ODO_OF_*.
  int32_t pose_of(uint32_t of, bool smooth, int64_t t_ns, odo_pose& out) const;
  void set_callback(TypeSet types, odo_callback callback, void* user);
  void statistics(odo_statistics& out) const;
  int32_t last_error(odo_error& out);
  /// ODO_E_STATE from within a callback.
  int64_t save(void* data, uint64_t capacity);
  int32_t load(const void* data, uint64_t size);
  int32_t to_geodetic(const double* p_n, double* geodetic) const;
  int32_t from_geodetic(const double* geodetic, double* p_n) const;
  // session_anchors.cpp: anchor.h says what they do.
  int32_t create_anchor(const odo_anchor_place& place, uint64_t& id);
  int32_t anchor(uint64_t id, uint32_t world, int64_t t_ns, odo_anchor& out) const;
  std::vector<uint64_t> anchor_ids() const { return anchors_.ids(); }
  int32_t remove_anchor(uint64_t id) { return anchors_.remove(id) ? ODO_OK : ODO_E_NOT_FOUND; }
  /// A second listener for everything that is reported, for the command line. [control]
  void set_report_listener(HostServices::Listener listener);
  const PipelineConfig& config() const { return config_; }

 private:
  /// Of what is pushed; counted by any thread.
  struct Intake {
    std::atomic<uint64_t> pushed{0}, processed{0}, late{0}, duplicate{0}, invalid{0}, overflow{0}, wild{0};
    std::atomic<int64_t> newest_ns{INT64_MIN};
  };
  /// What the pipeline counts, as its last sample left it.
  struct Progress {
    Pipeline::Counters counters;
    uint64_t gaps = 0, plugin_faults = 0;
    double distance_m = 0;
    ScaleKnowledge scale;
  };
  using Lock = std::unique_lock<std::mutex>;

  Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed, AppServices app);

  int32_t take(const odo_header& sample, OwnedMessage& out);
  int32_t own(AnyMessage&& sample, OwnedMessage& out);
  int32_t enqueue(OwnedMessage message);
  TimeOrder::Verdict order(OwnedMessage message, std::vector<OwnedMessage>& given_up);
  void restart_clock(std::vector<OwnedMessage>& given_up);
  int32_t refuse_invalid(const odo_header& sample, int32_t status, const std::string& why);
  int32_t refuse_wild(const odo_header& sample, const char* what);
  int32_t note_verdict(TimeOrder::Verdict verdict, const odo_header& sample);

  /// Ownership, from taking it to the end of the scope, however that is left.
  class Ownership {
   public:
    Ownership(Session& session, Lock& lock) : session_(session), lock_(lock) { session_.acquire(lock_); }
    ~Ownership() {
      if (!lock_.owns_lock()) lock_.lock();
      session_.release_ownership();
    }
    Ownership(const Ownership&) = delete;
    Ownership& operator=(const Ownership&) = delete;

   private:
    Session& session_;
    Lock& lock_;
  };

  bool is_owner() const { return owned_ && owner_ == std::this_thread::get_id(); }
  void acquire(Lock& lock);
  void release_ownership();
  bool work_is_waiting() const;
  void process_waiting(Lock& lock, int64_t flush_until_ns);
  void publish_progress();
  void work();
  /// Wakes the session's thread, where it has one.
  void notify();

  void publish(const odo_header& event);
  void reported(const Report& report);
  bool report_is_waiting() const;
  void publish_reports();
  int32_t borrow(odo_borrowed& message);
  void take_calibration(odo_calibration& calibration);
  void note_camera(const odo_calibration& calibration, bool line_time_above_frames);
  void put_timing(odo_frame& frame);
  std::string size_fault(const odo_frame& frame) const;

  PipelineConfig config_;
  bool live_;
  HostServices host_;
  Geodesy geodesy_;
  FrameStore frames_;
  PoseStream poses_;
  Anchors anchors_{geodesy_};
  mutable std::mutex world_mutex_;      // poses and anchors are corrected together
  std::unique_ptr<Pipeline> pipeline_;  // the owner's

  mutable std::mutex mutex_;  // for what follows; held for moments only
  std::condition_variable work_waiting_, owner_changed_;
  SampleGate gate_;
  TimeOrder order_;
  struct Camera {
    uint32_t width = 0, height = 0;  // that the calibration is for
    int64_t offset_ns = 0;           // IMU time minus camera time
    int64_t line_time_ns = 0;
    bool line_time = false;     // given
    bool above_frames = false;  // by the config, whose row time replaces the frames'
    Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();
  };
  std::map<uint32_t, Camera> cameras_;  // by header.source
  bool restart_pending_ = false;
  bool stopping_ = false;
  uint64_t flushes_asked_ = 0, flushes_done_ = 0;
  bool owned_ = false;
  std::thread::id owner_;
  odo_callback callback_ = nullptr;
  void* callback_user_ = nullptr;
  bool callback_runs_ = false;
  std::thread::id callback_thread_;
  TypeSet callback_types_;
  std::atomic<bool> has_callback_{false};

  Intake intake_;
  Snapshot<Progress> progress_;
  mutable std::mutex error_mutex_;
  odo_error last_error_{};
  uint64_t errors_ = 0;
  HostServices::Listener listener_;
  static constexpr size_t kMaxReports = 64;  // that wait to be told; more are only the last error
  std::vector<Report> reports_;
  std::atomic<bool> has_reports_{false};

  std::thread thread_;
  std::unique_ptr<HangWatch> hang_watch_;  // the last: it reports to this session
};

}  // namespace odograph
