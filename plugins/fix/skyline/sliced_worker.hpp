// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace odograph::skyline {

/// Called with the amount of work that follows, in directions compared or edges tested (about 5 ns each).
using Spend = std::function<void(uint64_t work)>;

/// A thread on which a long job runs in slices of work. The owner calls advance() once per frame: it waits for the end
/// of the previous slice, at most for one slice's time, and releases the next. The number of frames until a job is done
/// therefore depends only on its work and never on the wall clock: a replay gives the same results at the same frames
/// as the live run, at any speed.
class SlicedWorker {
 public:
  SlicedWorker() = default;
  /// Cancels an unfinished job.
  ~SlicedWorker();
  SlicedWorker(const SlicedWorker&) = delete;
  SlicedWorker& operator=(const SlicedWorker&) = delete;

  /// Starts a job with its first slice. Not while busy().
  void start(std::function<void(const Spend&)> job, uint64_t slice);
  /// Whether a job has started that advance() has not reported as done.
  bool busy() const { return busy_; }
  /// True once the job is done; otherwise releases the next slice. Rethrows the job's exception.
  bool advance(uint64_t slice);

 private:
  struct Cancelled {};

  void work();
  void spend(uint64_t amount);

  bool busy_ = false;  // used by the owner's thread only
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void(const Spend&)> job_;  // unfinished
  uint64_t granted_ = 0, spent_ = 0;
  bool waiting_ = false, cancelled_ = false;  // waiting for the next slice; cancelled by the destructor
  std::exception_ptr thrown_;
  std::thread thread_;  // started with the first job
};

}  // namespace odograph::skyline
