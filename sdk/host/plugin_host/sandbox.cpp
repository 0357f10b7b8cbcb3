// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/sandbox.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "sdk/host/plugin_host/call_filter.hpp"
#include "sdk/host/plugin_host/file_rules.hpp"
#include "sdk/host/plugin_host/thread_gate.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC's macros; clang uses __has_feature
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

void limit_resources(uint64_t memory_bytes) {
#if defined(ODOGRAPH_SANITIZERS)  // sanitizers reserve terabytes of address space
  (void)memory_bytes;
#else
  limit(RLIMIT_AS, memory_bytes);
#endif
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_MEMLOCK, 0);
  limit(RLIMIT_MSGQUEUE, 0);
  limit(RLIMIT_SIGPENDING, 64);
  limit(RLIMIT_NOFILE, 256);
}

/// Drops the capabilities of root and of a user namespace's first process.
void drop_capabilities() {
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  const __user_cap_data_struct none[2] = {};
  syscall(SYS_capset, &head, none);
}

}  // namespace

std::vector<std::string> enter_sandbox(uint64_t memory_bytes, int gate) {
  std::vector<std::string> lacks;
  const auto done = [&](bool ok, const char* what) {
    if (!ok) lacks.push_back(std::string(what) + " (" + std::strerror(errno) + ")");
  };
  limit_resources(memory_bytes);
  drop_capabilities();
  prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);  // no process of the same user may trace it
  prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
  prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);  // a partly returned huge page would be held without being counted
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  done(restrict_files(), "no Landlock: files of other processes and devices can be read");
  done(require_thread_approval(gate), "no limit of threads");
  done(filter_calls(), "no filter of system calls");
  return lacks;
}

}  // namespace odograph
