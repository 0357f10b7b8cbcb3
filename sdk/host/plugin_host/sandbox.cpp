// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/sandbox.hpp"

#include <sys/resource.h>

#if defined(__linux__)
#include <cstddef>
#include <vector>

#include <cerrno>

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC says so, clang by __has_feature
#define ODOGRAPH_SANITIZERS
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ODOGRAPH_SANITIZERS
#endif
#endif

namespace odograph {
namespace {

void limit(int what, uint64_t value) {
  const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))
#if defined(__x86_64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#else
constexpr uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

/// Refused with EPERM, whatever their arguments.
constexpr long kRefused[] = {
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_unlinkat,
    SYS_renameat2,
    SYS_mkdirat,
    SYS_linkat,
    SYS_symlinkat,
    SYS_mknodat,
    SYS_truncate,
    SYS_ftruncate,
    SYS_fallocate,
    SYS_fchmod,
    SYS_fchmodat,
    SYS_fchown,
    SYS_fchownat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_utimensat,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_setns,
    SYS_unshare,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_setuid,
    SYS_setgid,
    SYS_setresuid,
    SYS_setresgid,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_sethostname,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_name_to_handle_at,
    SYS_open_by_handle_at,
#if defined(__x86_64__)
    SYS_fork,
    SYS_vfork,
    SYS_creat,
    SYS_unlink,
    SYS_rename,
    SYS_renameat,
    SYS_mkdir,
    SYS_rmdir,
    SYS_link,
    SYS_symlink,
    SYS_mknod,
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
    SYS_iopl,
    SYS_ioperm,
#endif
};
/// Said to be unknown, so that libraries take the older call, whose arguments can be looked at.
constexpr long kUnknown[] = {SYS_clone3, SYS_openat2, SYS_io_uring_setup, SYS_io_uring_enter, SYS_io_uring_register};

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kArchitecture, 1, 0);
    give(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
    jump(BPF_JGE, 0x40000000u, 0, 1);  // the x32 numbers
    give(SECCOMP_RET_ERRNO | ENOSYS);
#endif
    for (const long number : kRefused) refuse(number, EPERM);
    for (const long number : kUnknown) refuse(number, ENOSYS);
    only_for_reading(SYS_openat, 2);
#if defined(__x86_64__)
    only_for_reading(SYS_open, 1);
#endif
    only_if(SYS_clone, 0, BPF_JSET, CLONE_THREAD);
    const auto self = static_cast<uint32_t>(getpid());
    only_if(SYS_kill, 0, BPF_JEQ, self);
    only_if(SYS_tgkill, 0, BPF_JEQ, self);
    refuse(SYS_tkill, EPERM);
    refuse(SYS_rt_sigqueueinfo, EPERM);
    refuse(SYS_rt_tgsigqueueinfo, EPERM);
    give(SECCOMP_RET_ALLOW);
  }
  bool install() {
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
  }

 private:
  static constexpr uint32_t argument(int i) { return static_cast<uint32_t>(offsetof(seccomp_data, args)) + 8u * i; }
  void load(size_t offset) { code_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<uint32_t>(offset))); }
  void give(uint32_t verdict) { code_.push_back(BPF_STMT(BPF_RET | BPF_K, verdict)); }
  void jump(uint16_t how, uint32_t value, uint8_t yes, uint8_t no) {
    code_.push_back(BPF_JUMP(static_cast<uint16_t>(BPF_JMP | how | BPF_K), value, yes, no));
  }
  void refuse(long number, uint32_t error) {
    jump(BPF_JEQ, static_cast<uint32_t>(number), 0, 1);
    give(SECCOMP_RET_ERRNO | error);
  }
  /// Of a call the verdict by one argument, then back to the number for the next test.
  void only_for_reading(long number, int i) {
    jump(BPF_JEQ, static_cast<uint32_t>(number), 0, 4);
    load(argument(i));
    jump(BPF_JSET, O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND, 0, 1);
    give(SECCOMP_RET_ERRNO | EPERM);
    give(SECCOMP_RET_ALLOW);
  }
  /// Allowed where the argument passes: BPF_JEQ, it is the value; BPF_JSET, it has one of its bits.
  void only_if(long number, int i, uint16_t how, uint32_t value) {
    jump(BPF_JEQ, static_cast<uint32_t>(number), 0, 4);
    load(argument(i));
    jump(how, value, 1, 0);
    give(SECCOMP_RET_ERRNO | EPERM);
    give(SECCOMP_RET_ALLOW);
  }
  std::vector<sock_filter> code_;
};

bool filter_calls() { return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && Filter().install(); }
#else
bool filter_calls() { return false; }
#endif

}  // namespace

bool enter_sandbox(uint64_t memory_bytes) {
#if defined(ODOGRAPH_SANITIZERS)  // they reserve terabytes of address space
  (void)memory_bytes;
#else
  limit(RLIMIT_AS, memory_bytes);
#endif
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, 256);
#if defined(__linux__)
  prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);  // nobody of the same user traces it
#endif
  return filter_calls();
}

}  // namespace odograph
