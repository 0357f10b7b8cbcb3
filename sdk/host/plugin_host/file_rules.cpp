// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/file_rules.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace odograph {
namespace {

// Landlock's system calls; the C library's headers may be older than the kernel.
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

Ruleset supported_rights(long version) {
  constexpr uint64_t kFiles[] = {0,       1 << 13, 1 << 14,
                                 1 << 15, 1 << 15, 1 << 16};  // number of access rights in each version
  const uint64_t files = kFiles[version < 5 ? version : 5] - 1;
  return {files, version >= 4 ? 3u : 0u, version >= 6 ? 3u : 0u};
}
size_t ruleset_size(long version) {
  return version < 4 ? offsetof(Ruleset, network) : version < 6 ? offsetof(Ruleset, scopes) : sizeof(Ruleset);
}

void allow_reading(int rules, const std::string& path) {
  // Do not follow links: their target has its own name.
  const int fd = open(path.c_str(), O_PATH | O_CLOEXEC | O_NOFOLLOW);
  struct stat kind {};
  if (fd >= 0 && fstat(fd, &kind) == 0 && !S_ISLNK(kind.st_mode)) {
    const PathBeneath rule{S_ISDIR(kind.st_mode) ? kReadFile | kReadFolder : kReadFile, fd};
    syscall(kAddRule, rules, kPathBeneath, &rule, 0);
  }
  if (fd >= 0) close(fd);
}

/// mountinfo encodes blanks, tabs, line feeds and backslashes as \NNN in octal.
std::string unescaped(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\\' && i + 3 < text.size())
      out += static_cast<char>(std::stoi(text.substr(i + 1, 3), nullptr, 8)), i += 3;
    else
      out += text[i];
  return out;
}

/// Mount points at which the kernel exposes processes, devices and its own state.
std::set<std::string> kernel_folders() {
  static const std::set<std::string> kKinds = {"proc",     "sysfs",   "devtmpfs", "devpts",     "cgroup",
                                               "cgroup2",  "debugfs", "tracefs",  "securityfs", "configfs",
                                               "efivarfs", "pstore",  "bpf",      "mqueue"};
  std::set<std::string> found = {"/proc", "/sys", "/dev", "/run"};
  std::ifstream mounts("/proc/self/mountinfo");
  for (std::string line; std::getline(mounts, line);) {
    std::istringstream fields(line);
    std::string place, kind;
    for (int i = 0; i < 5; ++i) fields >> place;
    while (fields >> kind && kind != "-") continue;
    if (fields >> kind && kKinds.count(kind) > 0) found.insert(unescaped(place));
  }
  return found;
}

bool lies_below(const std::string& path, const std::string& folder) {
  return folder == "/" || path.compare(0, folder.size() + 1, folder + "/") == 0;
}

/// Allows the folder's contents except the closed ones. A folder that contains a closed one cannot be listed itself.
void allow_reading_except(const std::set<std::string>& closed, int rules, const std::string& folder) {
  if (closed.count(folder) > 0) return;
  const bool holds_closed =
      std::any_of(closed.begin(), closed.end(), [&](const auto& each) { return lies_below(each, folder); });
  if (!holds_closed) return allow_reading(rules, folder);
  DIR* entries = opendir(folder.c_str());
  while (const dirent* entry = entries ? readdir(entries) : nullptr)
    if (const std::string name = entry->d_name; name != "." && name != "..")
      allow_reading_except(closed, rules, (folder == "/" ? "" : folder) + "/" + name);
  if (entries) closedir(entries);
}

void allow_all(int rules) {
  char self[32] = "/proc/";  // the target of the link; the link itself is not followed
  const ssize_t length = readlink("/proc/self", self + 6, sizeof self - 7);
  if (length > 0) allow_reading(rules, std::string(self, 6 + static_cast<size_t>(length)));
  for (const char* path : {"/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/filesystems", "/sys/devices/system",
                           "/dev/null", "/dev/zero", "/dev/random", "/dev/urandom"})
    allow_reading(rules, path);
  allow_reading_except(kernel_folders(), rules, "/");
}

}  // namespace

bool restrict_files() {
  const long version = syscall(kCreateRuleset, nullptr, 0, kAskForVersion);
  if (version < 1) return false;
  const Ruleset handled = supported_rights(version);
  const int rules = static_cast<int>(syscall(kCreateRuleset, &handled, ruleset_size(version), 0));
  if (rules < 0) return false;
  allow_all(rules);
  const bool restricted = syscall(kRestrictSelf, rules, 0) == 0;
  close(rules);
  return restricted;
}

}  // namespace odograph
