// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <odograph/odograph.h>

#include "sdk/core/frame_store.hpp"
#include "sdk/core/pipeline.hpp"
#include "sdk/core/time_order.hpp"

namespace odograph {

/// What is behind odo_session: the queue, the thread (when live), the locks. Three locks, always taken in this order
/// and never two of the same: work (the pipeline), queue (samples waiting), answers (poses, counters, last error).
class Session {
 public:
  static Result<std::unique_ptr<Session>> make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed);
  ~Session();

  int32_t push(const odo_header& sample);
  int32_t flush();
  int32_t pose(int64_t t_ns, odo_pose& out) const;
  void set_callback(uint32_t mask, odo_callback callback, void* user);
  void statistics(odo_statistics& out) const;
  int32_t last_error(odo_error& out);
  int64_t save(void* data, uint64_t capacity) const;
  int32_t load(const void* data, uint64_t size);
  int32_t to_geodetic(const double* p_n, double* geodetic) const;
  int32_t from_geodetic(const double* geodetic, double* p_n) const;
  /// A second listener for everything that is reported, for the command line. [control]
  void set_report_listener(HostServices::Listener listener);
  const PipelineConfig& config() const { return config_; }

 private:
  Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed);

  int32_t check(const odo_header& sample);
  int32_t enqueue(const odo_header& sample);
  void process_ready(bool flush);
  void publish(const odo_header& event);
  void work();
  void reported(const Report& report);
  void restart_clock();
  odo_calibration with_own(const odo_calibration& calibration) const;
  void note_timing(const odo_calibration& calibration);
  void put_timing(odo_frame& frame);

  PipelineConfig config_;
  bool live_;
  HostServices host_;
  Geodesy geodesy_;
  FrameStore frames_;

  mutable std::recursive_mutex work_mutex_;  // recursive: a callback may ask for statistics
  std::unique_ptr<Pipeline> pipeline_;
  odo_callback callback_ = nullptr;
  void* callback_user_ = nullptr;
  std::atomic<uint32_t> callback_mask_{0};

  std::mutex queue_mutex_;
  std::condition_variable queue_changed_;
  TimeOrder order_;
  struct CameraTiming {
    int64_t offset_ns = 0;  // IMU time minus camera time
    int64_t line_time_ns = 0;
    bool line_time = false;     // given
    bool above_frames = false;  // by the config, which stands above what frames say
  };
  std::map<uint32_t, CameraTiming> camera_timing_;  // by calibration id
  bool restart_pending_ = false;
  bool stopping_ = false;

  mutable std::mutex answers_mutex_;
  odo_statistics statistics_{};
  odo_error last_error_{};
  uint64_t errors_ = 0;
  HostServices::Listener listener_;

  std::thread thread_;
};

}  // namespace odograph
