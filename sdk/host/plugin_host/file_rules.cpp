// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/file_rules.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace odograph {
namespace {

// Landlock's interface; the C library's headers may be older than the kernel.
constexpr long kCreateRuleset = 444, kAddRule = 445, kRestrictSelf = 446;
constexpr unsigned kAskForVersion = 1, kPathBeneath = 1;
constexpr uint64_t kReadFile = 1u << 2, kReadFolder = 1u << 3;
struct Ruleset {
  uint64_t files, network, scopes;
};
struct __attribute__((packed)) PathBeneath {
  uint64_t allowed;
  int32_t folder;
};

Ruleset everything_known_to(long version) {
  constexpr uint64_t kFiles[] = {0, 1 << 13, 1 << 14, 1 << 15, 1 << 15, 1 << 16};  // each version's number of rights
  const uint64_t files = kFiles[version < 5 ? version : 5] - 1;
  return {files, version >= 4 ? 3u : 0u, version >= 6 ? 3u : 0u};
}
size_t size_known_to(long version) {
  return version < 4 ? offsetof(Ruleset, network) : version < 6 ? offsetof(Ruleset, scopes) : sizeof(Ruleset);
}

void allow_reading(int rules, const std::string& path) {
  const int fd = open(path.c_str(), O_PATH | O_CLOEXEC);
  struct stat kind {};
  if (fd >= 0 && fstat(fd, &kind) == 0) {
    const PathBeneath rule{S_ISDIR(kind.st_mode) ? kReadFile | kReadFolder : kReadFile, fd};
    syscall(kAddRule, rules, kPathBeneath, &rule, 0);
  }
  if (fd >= 0) close(fd);
}

void allow_all(int rules) {
  for (const char* path : {"/proc/self", "/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/filesystems",
                           "/sys/devices/system", "/dev/null", "/dev/zero", "/dev/random", "/dev/urandom"})
    allow_reading(rules, path);
  DIR* root = opendir("/");
  while (const dirent* entry = root ? readdir(root) : nullptr) {
    const std::string name = entry->d_name;
    if (name != "." && name != ".." && name != "proc" && name != "sys" && name != "dev" && name != "run")
      allow_reading(rules, "/" + name);
  }
  if (root) closedir(root);
}

}  // namespace

bool restrict_files() {
  const long version = syscall(kCreateRuleset, nullptr, 0, kAskForVersion);
  if (version < 1) return false;
  const Ruleset handled = everything_known_to(version);
  const int rules = static_cast<int>(syscall(kCreateRuleset, &handled, size_known_to(version), 0));
  if (rules < 0) return false;
  allow_all(rules);
  const bool restricted = syscall(kRestrictSelf, rules, 0) == 0;
  close(rules);
  return restricted;
}

}  // namespace odograph
