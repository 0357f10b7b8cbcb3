// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace odograph::skyline {

/// Called with the amount of work that comes next, in directions compared or edges tested (about 5 ns each).
using Spend = std::function<void(uint64_t work)>;

/// A thread on which a long job runs in slices of work. Whoever gave the job asks for it once a frame, advance(): that
/// waits until the slice before is worked off, at most as long as one slice takes, and hands out the next. After how
/// many frames a job is done is so a function of its work alone, and never of the wall clock: a replay gives the same
/// results at the same frames as the live run did, however fast either goes.
class SlicedWorker {
 public:
  SlicedWorker() = default;
  /// Ends a job that has not been asked for any more.
  ~SlicedWorker();
  SlicedWorker(const SlicedWorker&) = delete;
  SlicedWorker& operator=(const SlicedWorker&) = delete;

  /// Begins a job with its first slice. Not while busy().
  void start(std::function<void(const Spend&)> job, uint64_t slice);
  /// A job has begun that advance() has not told to be done.
  bool busy() const { return busy_; }
  /// True once the job is done, otherwise it gets the next slice. What it threw is thrown here.
  bool advance(uint64_t slice);

 private:
  struct Cancelled {};

  void work();
  void spend(uint64_t amount);

  bool busy_ = false;  // of the thread that gives jobs alone
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void(const Spend&)> job_;  // that the thread has not finished
  uint64_t granted_ = 0, spent_ = 0;
  bool waiting_ = false, cancelled_ = false;  // for the next slice; by the destructor
  std::exception_ptr thrown_;
  std::thread thread_;  // from the first job on
};

}  // namespace odograph::skyline
