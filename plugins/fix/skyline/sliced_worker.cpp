// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sliced_worker.hpp"

#include <csignal>
#include <utility>

namespace odograph::skyline {

SlicedWorker::~SlicedWorker() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SlicedWorker::start(std::function<void(const Spend&)> job, uint64_t slice) {
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
    granted_ = slice, spent_ = 0;
    busy_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) return;
  sigset_t none_of_ours, before;  // the app's signals go to its own threads, except those of a crash here
  sigfillset(&none_of_ours);
  for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS}) sigdelset(&none_of_ours, crash);
  pthread_sigmask(SIG_SETMASK, &none_of_ours, &before);
  thread_ = std::thread([this] { work(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

bool SlicedWorker::advance(uint64_t slice) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_ || !job_; });
  if (!job_) {
    busy_ = false;
    if (const auto thrown = std::exchange(thrown_, nullptr)) std::rethrow_exception(thrown);
    return true;
  }
  granted_ += slice;
  waiting_ = false;
  lock.unlock();
  changed_.notify_all();
  return false;
}

void SlicedWorker::spend(uint64_t amount) {
  std::unique_lock lock(mutex_);
  spent_ += amount;
  while (spent_ > granted_ && !cancelled_) {
    waiting_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !waiting_ || cancelled_; });
  }
  if (cancelled_) throw Cancelled();
}

void SlicedWorker::work() {
  const Spend spend = [this](uint64_t amount) { this->spend(amount); };
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return job_ || cancelled_; });
    if (cancelled_) return;
    const auto job = job_;
    lock.unlock();
    std::exception_ptr thrown;
    try {
      job(spend);
    } catch (const Cancelled&) {
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
    thrown_ = thrown;
    job_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace odograph::skyline
