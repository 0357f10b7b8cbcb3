// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <set>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/hostile/attacks.hpp"

namespace hostile {

/// Random system calls with random arguments, including the target's names, the host's process number, the first
/// descriptors, and buffers that can be read and written.
class RandomCalls {
 public:
  RandomCalls() {
    // Never outside the sandbox: this would destroy the user's files. In the sandbox fork() is refused.
    if (prctl(PR_GET_SECCOMP) >= 0 || errno != EPERM || fork() >= 0) std::abort();
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    state_ = static_cast<uint64_t>(now.tv_nsec) * 0x9e3779b97f4a7c15u + static_cast<uint64_t>(now.tv_sec);
    file_ = std::string(target_folder()) + "/file";
    fresh_ = std::string(target_folder()) + "/fresh";
    readable_ = open(file_.c_str(), O_RDONLY);
    // Writes through a pointer into the arena end at an inaccessible page.
    arena_ =
        static_cast<char*>(mmap(nullptr, kArena + kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    mprotect(arena_ + kArena, kPage, PROT_NONE);
  }
  void one() {
    long number = static_cast<long>(random() % 480);
    if (random() % 64 == 0) number |= 0x40000000;
    if (random() % 64 == 0) number = static_cast<long>(random());
    // Calls that end, stop or damage this process are tried rarely, since it must be restarted.
    if (ends_own_process().count(number) && random() % 4096 != 0) return;
    long a[6];
    for (long& each : a) each = argument();
    if ((number == SYS_kill || number == SYS_tgkill || number == SYS_tkill) && a[0] == getpid()) return;
    syscall(number, a[0], a[1], a[2], a[3], a[4], a[5]);
  }

 private:
  static const std::set<long>& ends_own_process() {
    static const std::set<long> calls = {
      SYS_exit,
      SYS_exit_group,
      SYS_rt_sigreturn,
      SYS_rt_sigsuspend,
      SYS_rt_sigtimedwait,
      SYS_futex,
      449,
      SYS_ppoll,
      SYS_pselect6,
      SYS_nanosleep,
      SYS_read,
      SYS_readv,
      SYS_write,
      SYS_writev,
      SYS_clock_nanosleep,
      SYS_munmap,
      SYS_mremap,
      SYS_mprotect,
      SYS_brk,
#if defined(SYS_mmap2)  // 32 bits
      SYS_mmap2,
#else
      SYS_mmap,
#endif
      SYS_madvise,
      SYS_close,
      SYS_close_range,
      SYS_dup3,
      SYS_clone,
      SYS_sigaltstack,
      SYS_set_robust_list,
      SYS_set_tid_address,
      SYS_rseq,
      SYS_rt_sigaction,
      SYS_rt_sigprocmask,
      335,  // uretprobe: a signal
#if defined(__x86_64__)
      SYS_pause,
      SYS_poll,
      SYS_select,
      SYS_dup2,
#endif
    };
    return calls;
  }
  uint64_t random() {  // SplitMix64
    uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  long argument() {
    switch (random() % 16) {
      case 0: return 0;
      case 1: return -1;
      case 2: return static_cast<long>(random() % 16);
      case 3: return host_process();
      case 4: return 1L << (random() % 32);
      case 5: return static_cast<long>(random() & random());
      case 6: return static_cast<long>(random());
      case 7: return AT_FDCWD;
      case 8: return readable_;
      case 9: return text(target_folder(), 0);
      case 10: return text(file_.c_str(), 1);
      case 11: return text(fresh_.c_str(), 2);
      case 12: return reinterpret_cast<long>(std::memset(arena_ + 3 * kPage, 0, kPage));
      case 13:
        for (size_t i = 0; i < 256; ++i) arena_[4 * kPage + i] = static_cast<char>(random());
        return reinterpret_cast<long>(arena_ + 4 * kPage);
      case 14: return getpid();
      default: return O_RDWR | O_CREAT | O_TRUNC;
    }
  }
  long text(const char* what, size_t page) {
    return reinterpret_cast<long>(std::strncpy(arena_ + page * kPage, what, kPage));
  }
  static constexpr size_t kPage = 4096, kArena = 8 * kPage;
  uint64_t state_ = 0;
  std::string file_, fresh_;
  int readable_ = -1;
  char* arena_ = nullptr;
};

inline void random_calls(long count) {
  static RandomCalls calls;
  for (long i = 0; i < count; ++i) calls.one();
}

}  // namespace hostile
