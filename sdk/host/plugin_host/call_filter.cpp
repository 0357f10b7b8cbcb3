// SPDX-License-Identifier: Apache-2.0
//
// Written without libseccomp: about a hundred call numbers and a dozen argument checks, and one library less in the
// process that runs foreign code.
#include "sdk/host/plugin_host/call_filter.hpp"

#include <cerrno>

#if defined(__x86_64__) || defined(__aarch64__)
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/futex.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace odograph {

#if defined(__x86_64__) || defined(__aarch64__)
namespace {

#if defined(__x86_64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#else
constexpr uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

// Linux's numbers, in case the C library's headers are older than the kernel.
constexpr int kCloseRange = 436, kFaccessat2 = 439, kFutexWaitv = 449;
constexpr int kSetVirtualMemoryName = 0x53564d41;  // PR_SET_VMA
constexpr uint32_t kFirstOfOneTable = 424;         // from Linux 5.1 on, all architectures use the same numbers

/// Allowed with any arguments, the most frequent first.
constexpr int kAllowed[] = {
    // The host's socket and standard output: the descriptors are its own (supervisor.hpp). Reading files.
    SYS_read,
    SYS_write,
    SYS_clock_gettime,
    // Its own memory, limited by RLIMIT_AS; MMAP is checked below; libraries and run-time compilers need executable
    // pages.
    SYS_munmap,
    SYS_mprotect,
    SYS_mremap,
    SYS_madvise,
    SYS_brk,
    SYS_mincore,
    SYS_membarrier,
    SYS_get_mempolicy,
    // Threads, limited by thread_gate.hpp; CLONE itself is checked below.
    SYS_exit,
    SYS_exit_group,
    SYS_set_robust_list,
    SYS_set_tid_address,
    SYS_rseq,
    kFutexWaitv,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_sched_getparam,
    SYS_sched_getscheduler,
    SYS_sched_get_priority_max,
    SYS_sched_get_priority_min,
    SYS_getcpu,
    // Identity, run time, random numbers.
    SYS_gettid,
    SYS_getpid,
    SYS_getppid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_uname,
    SYS_sysinfo,
    SYS_getrusage,
    SYS_times,
    SYS_getrandom,
    // Time and waiting.
    SYS_gettimeofday,
    SYS_clock_getres,
    SYS_clock_nanosleep,
    SYS_nanosleep,
    SYS_ppoll,
    SYS_pselect6,
    // Its own signals. Signal and target are checked below.
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_rt_sigpending,
    SYS_rt_sigsuspend,
    SYS_rt_sigtimedwait,
    SYS_sigaltstack,
    SYS_restart_syscall,
    // Reading files and folders; OPEN is checked below.
    SYS_readv,
    SYS_pread64,
    SYS_preadv,
    SYS_writev,
    SYS_lseek,
    SYS_close,
    kCloseRange,
    SYS_fstat,
    SYS_newfstatat,
    SYS_statx,
    SYS_statfs,
    SYS_fstatfs,
    SYS_faccessat,
    kFaccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_getcwd,
    SYS_fadvise64,
    SYS_dup,
    SYS_dup3,
    // Wake-ups between its own threads.
    SYS_pipe2,
    SYS_eventfd2,
#if defined(__x86_64__)
    SYS_time,
    SYS_poll,
    SYS_select,
    SYS_pause,
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_getdents,
    SYS_dup2,
    SYS_pipe,
    SYS_eventfd,
    SYS_getrlimit,
#endif
};

/// Flags that open a file for more than reading.
constexpr uint32_t kOpensForMore =
    O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND | O_ASYNC | O_DIRECT | (O_TMPFILE & ~O_DIRECTORY);
/// Creates a thread of this process, as the C libraries do, and nothing else.
constexpr uint32_t kOneProcess = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD;
constexpr uint32_t kThread = kOneProcess | CLONE_SYSVSEM | CLONE_SETTLS | CLONE_PARENT_SETTID | CLONE_CHILD_CLEARTID |
                             CLONE_CHILD_SETTID | CLONE_DETACHED;

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kArchitecture, 1, 0);
    give(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
    jump(BPF_JGE, 0x40000000u, 0, 1);  // the x32 numbers
    give(refused(ENOSYS));
#endif
    for (const int number : kAllowed) {
      jump(BPF_JEQ, static_cast<uint32_t>(number), 0, 1);
      give(SECCOMP_RET_ALLOW);
    }
    check_arguments();
    jump(BPF_JGE, kFirstOfOneTable, 0, 1);
    give(refused(ENOSYS));
    give(refused(EPERM));
  }
  bool install() {
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
  }

 private:
  static constexpr uint32_t refused(int error) { return SECCOMP_RET_ERRNO | static_cast<uint32_t>(error); }
  /// The lower half of an argument: all that the kernel reads of an int.
  static constexpr uint32_t argument(int i) { return static_cast<uint32_t>(offsetof(seccomp_data, args)) + 8u * i; }
  void load(uint32_t offset) { code_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offset)); }
  void keep(uint32_t bits) { code_.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, bits)); }
  void give(uint32_t verdict) { code_.push_back(BPF_STMT(BPF_RET | BPF_K, verdict)); }
  void jump(uint16_t how, uint32_t value, uint8_t yes, uint8_t no) {
    code_.push_back(BPF_JUMP(static_cast<uint16_t>(BPF_JMP | how | BPF_K), value, yes, no));
  }
  /// Applies the instructions that `body` writes, which end with a verdict, to one call.
  template <class Body>
  void of(int number, Body&& body) {
    const size_t at = code_.size();
    jump(BPF_JEQ, static_cast<uint32_t>(number), 0, 0);
    body();
    code_[at].jf = static_cast<uint8_t>(code_.size() - at - 1);
  }
  void only_values(int number, int i, std::initializer_list<uint32_t> values) {
    of(number, [&] {
      load(argument(i));
      allow_values(values);
      give(refused(EPERM));
    });
  }
  void allow_values(std::initializer_list<uint32_t> values) {
    for (const uint32_t value : values) {
      jump(BPF_JEQ, value, 0, 1);
      give(SECCOMP_RET_ALLOW);
    }
  }
  void only_without(int number, int i, uint32_t bits) {
    of(number, [&] { allow_without(i, bits); });
  }
  void allow_without(int i, uint32_t bits) {
    load(argument(i));
    jump(BPF_JSET, bits, 0, 1);
    give(refused(EPERM));
    give(SECCOMP_RET_ALLOW);
  }
  void check_arguments() {
    only_without(SYS_openat, 2, kOpensForMore);
#if defined(__x86_64__)
    only_without(SYS_open, 1, kOpensForMore);
#endif
    of(SYS_futex, [&] {  // on memory shared with another process, only what a thread join needs
      load(argument(1));
      jump(BPF_JSET, FUTEX_PRIVATE_FLAG, 0, 1);
      give(SECCOMP_RET_ALLOW);
      keep(~static_cast<uint32_t>(FUTEX_CLOCK_REALTIME));
      allow_values({FUTEX_WAIT, FUTEX_WAKE, FUTEX_WAIT_BITSET});
      give(refused(EPERM));
    });
    of(SYS_mmap, [&] {  // excludes memory that RLIMIT_AS does not count while in use
      load(argument(3));
      jump(BPF_JSET, MAP_HUGETLB, 2, 0);
      jump(BPF_JSET, MAP_ANONYMOUS, 0, 2);
      jump(BPF_JSET, MAP_SHARED, 0, 1);
      give(refused(EPERM));
      give(SECCOMP_RET_ALLOW);
    });
    of(SYS_clone, [&] {  // excludes processes, namespaces and separate descriptor tables
      load(argument(0));
      keep(kOneProcess);
      jump(BPF_JEQ, kOneProcess, 1, 0);
      give(refused(EPERM));
      allow_without(0, ~kThread);
    });
    const auto self = static_cast<uint32_t>(getpid());  // for abort() and similar calls
    only_values(SYS_kill, 0, {self});
    only_values(SYS_tgkill, 0, {self});
    of(SYS_fcntl, [&] {  // excludes owners and signals of descriptors, locks, leases, seals and larger pipes
      load(argument(1));
      allow_values({F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL});
      jump(BPF_JEQ, F_SETFL, 1, 0);
      give(refused(EPERM));
      allow_without(2, O_ASYNC | O_DIRECT);
    });
    only_values(SYS_ioctl, 1, {TCGETS, TIOCGWINSZ, FIONREAD, FIOCLEX, FIONCLEX, FIONBIO});  // isatty() and reading
    only_values(SYS_prctl, 0, {PR_SET_NAME, PR_GET_NAME, kSetVirtualMemoryName});
    only_values(SYS_sched_setaffinity, 0, {0});
    of(SYS_prlimit64, [&] {  // read its own limits
      for (const uint32_t offset : {argument(0), argument(2), argument(2) + 4}) {
        load(offset);
        jump(BPF_JEQ, 0, 1, 0);
        give(refused(EPERM));
      }
      give(SECCOMP_RET_ALLOW);
    });
  }
  std::vector<sock_filter> code_;
};

}  // namespace

bool filter_calls() { return Filter().install(); }
#else
bool filter_calls() {
  errno = ENOSYS;
  return false;
}
#endif

}  // namespace odograph
