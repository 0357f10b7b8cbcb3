// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/attacks.hpp"

#include <cerrno>
#include <csignal>
#include <ctime>
#include <string>

#include <fcntl.h>
#include <linux/futex.h>
#include <linux/sched.h>
#include <mqueue.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hostile {
namespace {

template <class... T>
bool call(long number, T... arguments) {
  return syscall(number, arguments...) >= 0;
}
int one_pipe() {
  static int ends[2] = {-1, -1};
  if (ends[0] < 0 && pipe(ends) != 0) ends[0] = -1;
  return ends[0];
}
bool opens(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK);
  if (fd >= 0) close(fd);
  return fd >= 0;
}
std::string of_host(const char* name) { return "/proc/" + std::to_string(host_process()) + "/" + name; }
// An attempt that succeeds, with a broken sandbox, harms the test only.
/// Whether a process was created; it ends at once.
bool child(long made) {
  if (made == 0) _exit(0);
  if (made > 0) waitpid(static_cast<pid_t>(made), nullptr, 0);
  return made > 0;
}
bool sets_limit(int what, rlim_t soft) {
  rlimit old{};
  if (!call(SYS_prlimit64, host_process(), what, nullptr, &old)) return false;
  const rlimit set{soft, old.rlim_max};
  const bool done = call(SYS_prlimit64, host_process(), what, &set, nullptr);
  if (done) call(SYS_prlimit64, host_process(), what, &old, nullptr);
  return done;
}

const Attempt kAttempts[] = {
    {"own a descriptor's signals by the host (F_SETOWN)",
     [] { return fcntl(one_pipe(), F_SETOWN, host_process()) == 0 && fcntl(one_pipe(), F_SETSIG, SIGURG) == 0; }},
    {"own by F_SETOWN_EX",
     [] {
       const f_owner_ex owner{F_OWNER_PID, host_process()};
       return fcntl(one_pipe(), F_SETOWN_EX, &owner) == 0;
     }},
    {"own by FIOSETOWN",
     [] {
       int owner = host_process();
       return ioctl(one_pipe(), 0x8901, &owner) == 0;
     }},
    {"signal on input (O_ASYNC)", [] { return fcntl(one_pipe(), F_SETFL, O_ASYNC) == 0; }},
    {"signal on input (FIOASYNC)",
     [] {
       int on = 1;
       return ioctl(one_pipe(), FIOASYNC, &on) == 0;
     }},
    {"memory that no limit counts (shared, of no file)",
     [] {
       void* got = mmap(nullptr, 1 << 20, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
       return got != MAP_FAILED && munmap(got, 1 << 20) == 0;
     }},
    {"memory that no limit counts (huge pages)",
     [] {
       void* got = mmap(nullptr, 2 << 20, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_HUGETLB, -1, 0);
       return got != MAP_FAILED || errno != EPERM;
     }},
    {"a thread with descriptors of its own",  // without signal handlers, so that the kernel refuses what the list lets
                                              // by
     [] { return !call(SYS_clone, CLONE_VM | CLONE_THREAD, nullptr) && errno != EPERM; }},
    {"move who waits at a lock in a shared file",
     [] {
       static uint32_t from = 0, to = 0;
       return call(SYS_futex, &from, FUTEX_REQUEUE, 0, 1, &to, 0);
     }},
    {"kill the host", [] { return kill(host_process(), 0) == 0; }},
    {"kill the parent", [] { return getppid() > 0 && kill(getppid(), 0) == 0; }},
    {"kill the first process", [] { return kill(1, 0) == 0; }},
    {"kill the group", [] { return kill(0, 0) == 0; }},
    {"kill everybody", [] { return kill(-1, 0) == 0; }},
    {"tgkill the host", [] { return call(SYS_tgkill, host_process(), host_process(), 0); }},
    {"tkill the host", [] { return call(SYS_tkill, host_process(), 0); }},
    {"queue a signal",
     [] {
       siginfo_t info{};
       info.si_code = SI_QUEUE;
       return call(SYS_rt_sigqueueinfo, host_process(), SIGURG, &info);
     }},
    {"name the host by a descriptor", [] { return call(434 /* pidfd_open */, host_process(), 0); }},
    {"name itself by a descriptor", [] { return call(434, getpid(), 0); }},
    {"read the host's limits",
     [] {
       rlimit old{};
       return call(SYS_prlimit64, host_process(), RLIMIT_NOFILE, nullptr, &old);
     }},
    {"set the host's descriptors", [] { return sets_limit(RLIMIT_NOFILE, 7); }},
    {"set the host's stack", [] { return sets_limit(RLIMIT_STACK, 4096); }},
    {"set its own limits",
     [] {
       const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
       return setrlimit(RLIMIT_AS, &all) == 0 || setrlimit(RLIMIT_FSIZE, &all) == 0;
     }},
    {"the host's processors",
     [] {
       cpu_set_t one;
       CPU_ZERO(&one);
       CPU_SET(0, &one);
       return sched_setaffinity(host_process(), sizeof one, &one) == 0;
     }},
    {"the host's scheduling",
     [] {
       const sched_param none{};
       return sched_setscheduler(host_process(), SCHED_IDLE, &none) == 0;
     }},
    {"the host's priority",
     [] {
       const auto host = static_cast<id_t>(host_process());
       return setpriority(PRIO_PROCESS, host, getpriority(PRIO_PROCESS, host)) == 0;
     }},
    {"a user's priority", [] { return setpriority(PRIO_USER, 54321, 19) == 0 || errno != EPERM; }},  // who has nothing
    {"the host's input and output", [] { return call(SYS_ioprio_set, 1, host_process(), (3 << 13)); }},
    {"move the host's pages", [] { return call(SYS_migrate_pages, host_process(), 0, nullptr, nullptr); }},
    {"compare with the host", [] { return call(SYS_kcmp, host_process(), getpid(), 0, 0, 0); }},
    {"the host's group", [] { return setpgid(host_process(), 0) == 0; }},
    {"a session of its own", [] { return setsid() >= 0; }},
    {"trace the host", [] { return ptrace(PTRACE_SEIZE, host_process(), 0, 0) == 0; }},
    {"read the host's memory",
     [] {
       char byte;
       const iovec here{&byte, 1}, there{reinterpret_cast<void*>(0x400000), 1};
       return process_vm_readv(host_process(), &here, 1, &there, 1, 0) >= 0 || errno == EFAULT;
     }},
    {"open the host's memory", [] { return opens(of_host("mem")); }},
    {"open the host's environment", [] { return opens(of_host("environ")); }},
    {"open the host's maps", [] { return opens(of_host("maps")); }},
    {"open the host's arguments", [] { return opens(of_host("cmdline")); }},
    {"open the host's descriptors", [] { return opens(of_host("fd")); }},
    {"open the first process", [] { return opens("/proc/1/cmdline"); }},
    {"open a kernel's log", [] { return opens("/proc/kmsg") || call(SYS_syslog, 10, nullptr, 0); }},
    {"fork", [] { return child(syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0)); }},
    {"clone into a namespace", [] { return child(syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, 0, 0, 0, 0)); }},
    {"clone a thread with a descriptor", [] { return child(syscall(SYS_clone, CLONE_VM | CLONE_PIDFD, 0, 0, 0, 0)); }},
    {"clone3",
     [] {
       clone_args args{};
       args.exit_signal = SIGCHLD;
       return child(syscall(SYS_clone3, &args, sizeof args));
     }},
    {"unshare", [] { return unshare(CLONE_NEWUSER) == 0; }},
    {"execute",
     [] {
       char name[] = "/nonexistent";
       char* arguments[] = {name, nullptr};
       execv(name, arguments);
       return errno != EPERM;
     }},
    {"outlive the keeper", [] { return prctl(PR_SET_PDEATHSIG, 0) == 0; }},
    {"let itself be traced", [] { return prctl(PR_SET_DUMPABLE, 1) == 0; }},
    {"a tracer of its choice", [] { return prctl(0x59616d61 /* PR_SET_PTRACER */, -1L) == 0; }},
    {"another filter", [] { return prctl(PR_SET_SECCOMP, 2, nullptr) == 0 || errno == EFAULT; }},
    {"another user", [] { return setuid(0) == 0 || setreuid(0, 0) == 0 || setgid(0) == 0; }},
    {"another personality", [] { return call(SYS_personality, 0x0040000); }},
    {"System V memory",
     [] {
       const int made = shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600);
       return made >= 0 && shmctl(made, IPC_RMID, nullptr) == 0;
     }},
    {"a System V queue",
     [] {
       const int made = msgget(IPC_PRIVATE, IPC_CREAT | 0600);
       return made >= 0 && msgctl(made, IPC_RMID, nullptr) == 0;
     }},
    {"a System V semaphore",
     [] {
       const int made = semget(IPC_PRIVATE, 1, IPC_CREAT | 0600);
       return made >= 0 && semctl(made, 0, IPC_RMID) == 0;
     }},
    {"a POSIX queue",
     [] {
       const mqd_t made = mq_open("/odograph-escape", O_CREAT | O_RDWR, 0600, nullptr);
       return made >= 0 && mq_unlink("/odograph-escape") == 0;
     }},
    {"a file in memory", [] { return memfd_create("x", 0) >= 0; }},
    {"a secret file in memory", [] { return call(447 /* memfd_secret */, 0); }},
    {"a larger pipe", [] { return fcntl(one_pipe(), F_SETPIPE_SZ, 1 << 20) > 0; }},
    {"locked memory",
     [] {
       static char page[4096];
       return mlock(page, sizeof page) == 0;
     }},
    {"page faults of its own", [] { return call(SYS_userfaultfd, 1); }},
    {"a key", [] { return call(SYS_add_key, "user", "odograph", "x", 1, -4) || call(SYS_keyctl, 0, -3, 0); }},
    {"the internet", [] { return socket(AF_INET, SOCK_STREAM, 0) >= 0 || socket(AF_INET6, SOCK_DGRAM, 0) >= 0; }},
    {"a local socket", [] { return socket(AF_UNIX, SOCK_DGRAM, 0) >= 0; }},
    {"a pair of sockets",
     [] {
       int ends[2];
       return socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0;
     }},
    {"netlink, packets, vsock",
     [] { return socket(AF_NETLINK, SOCK_RAW, 0) >= 0 || socket(17, SOCK_RAW, 0) >= 0 || socket(40, 1, 0) >= 0; }},
    {"send over the host's socket", [] { return send(3, "c", 1, MSG_DONTWAIT) >= 0 || errno != EPERM; }},
    {"shut the host's socket", [] { return shutdown(3, SHUT_RDWR) == 0; }},
    {"io_uring",
     [] {
       char parameters[256] = {};
       return call(425, 1, parameters);
     }},
    {"bpf", [] { return call(SYS_bpf, 0, nullptr, 0) || errno != EPERM; }},
    {"performance counters", [] { return call(SYS_perf_event_open, nullptr, 0, -1, -1, 0) || errno != EPERM; }},
    {"a timer's signal to a thread", [] { return call(SYS_timer_create, 0, nullptr, nullptr) || errno != EPERM; }},
    // With arguments that the system would reject with another error if it checked them.
    {"the clock", [] { return call(SYS_clock_settime, CLOCK_MONOTONIC, nullptr) || errno != EPERM; }},
    {"the machine's name",
     [] {
       return call(SYS_sethostname, "x", -1) || errno != EPERM || call(SYS_setdomainname, "x", -1) || errno != EPERM;
     }},
};

}  // namespace

Attempts on_processes() { return {kAttempts, sizeof kAttempts / sizeof kAttempts[0]}; }

}  // namespace hostile
