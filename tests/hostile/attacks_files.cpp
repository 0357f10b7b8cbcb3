// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/attacks.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/utsname.h>
#include <sys/xattr.h>
#include <unistd.h>

namespace hostile {
namespace {

template <class... T>
bool call(long number, T... arguments) {
  return syscall(number, arguments...) >= 0;
}
std::string in_target_folder(const char* name) { return std::string(target_folder()) + "/" + name; }
const char* file() {
  static const std::string path = in_target_folder("file");
  return path.c_str();
}
const char* fresh() {
  static const std::string path = in_target_folder("fresh");
  return path.c_str();
}
bool opens(const char* path, int flags) {
  const int fd = open(path, flags | O_NONBLOCK, 0600);
  if (fd >= 0) close(fd);
  return fd >= 0;
}
int readable() {
  static const int fd = open(file(), O_RDONLY);
  return fd;
}
/// Whether the operation succeeds on the memory of the host's pixels.
template <class Attack>
bool to_pixels(Attack attack) {
  std::FILE* maps = std::fopen("/proc/self/maps", "r");
  char line[512];
  bool done = false;
  while (maps && std::fgets(line, sizeof line, maps)) {
    unsigned long from = 0, to = 0;
    if (std::strstr(line, "odograph-pixels") && std::sscanf(line, "%lx-%lx", &from, &to) == 2)
      done = done || attack(reinterpret_cast<void*>(from), to - from);
  }
  if (maps) std::fclose(maps);
  return done;
}
bool writes_pixels() {
  return to_pixels([](void* at, size_t bytes) { return mprotect(at, bytes, PROT_READ | PROT_WRITE) == 0; });
}
/// The space would count for other memory. Linux before 6.10 cannot forbid it.
bool gives_pixels_back() {
  utsname system{};
  int major = 0, minor = 0;
  uname(&system);
  std::sscanf(system.release, "%d.%d", &major, &minor);
  return (major > 6 || (major == 6 && minor >= 10)) &&
         to_pixels([](void* at, size_t bytes) { return munmap(at, bytes) == 0; });
}

const Attempt kAttempts[] = {
    {"open for writing", [] { return opens(file(), O_WRONLY) || opens(file(), O_RDWR) || opens(file(), 3); }},
    {"open and cut", [] { return opens(file(), O_RDONLY | O_TRUNC); }},
    {"open to append", [] { return opens(file(), O_RDONLY | O_APPEND); }},
    {"create", [] { return opens(fresh(), O_RDONLY | O_CREAT) || creat(fresh(), 0600) >= 0; }},
    {"create without a name", [] { return opens(target_folder(), O_TMPFILE | O_RDWR); }},
    {"open by openat2",
     [] {
       const unsigned long long how[3] = {O_RDWR, 0, 0};
       return call(437, AT_FDCWD, file(), how, sizeof how);
     }},
    {"open by its handle", [] { return call(SYS_name_to_handle_at, AT_FDCWD, file(), nullptr, nullptr, 0); }},
    {"make a folder, a pipe, a link",
     [] {
       return mkdir(fresh(), 0700) == 0 || mkfifo(fresh(), 0600) == 0 || link(file(), fresh()) == 0 ||
              symlink(file(), fresh()) == 0;
     }},
    {"remove, rename",
     [] {
       return unlink(file()) == 0 || rename(file(), fresh()) == 0 ||
              call(SYS_renameat2, AT_FDCWD, file(), AT_FDCWD, fresh(), 0);
     }},
    {"cut", [] { return truncate(file(), 0) == 0 || ftruncate(readable(), 0) == 0; }},
    {"dig a hole", [] { return fallocate(readable(), 3, 0, 1) == 0; }},
    {"change its mode",
     [] {
       return chmod(file(), 0777) == 0 || fchmod(readable(), 0777) == 0 || fchmodat(AT_FDCWD, file(), 0777, 0) == 0 ||
              call(452 /* fchmodat2 */, AT_FDCWD, file(), 0777, 0);
     }},
    {"change its owner",
     [] { return chown(file(), getuid(), getgid()) == 0 || lchown(file(), getuid(), getgid()) == 0; }},
    {"set an attribute",
     [] {
       return setxattr(file(), "user.new", "x", 1, 0) == 0 || lsetxattr(file(), "user.new", "x", 1, 0) == 0 ||
              fsetxattr(readable(), "user.new", "x", 1, 0) == 0 ||
              call(463 /* setxattrat */, AT_FDCWD, file(), 0, "user.new", nullptr, 0);
     }},
    {"remove an attribute",
     [] {
       return removexattr(file(), "user.keep") == 0 || lremovexattr(file(), "user.keep") == 0 ||
              fremovexattr(readable(), "user.keep") == 0 ||
              call(466 /* removexattrat */, AT_FDCWD, file(), 0, "user.keep");
     }},
    {"set its times",
     [] {
       const timespec times[2] = {};
       const timeval old[2] = {};
       return utimensat(AT_FDCWD, file(), times, 0) == 0 || futimens(readable(), times) == 0 ||
              utimes(file(), old) == 0;
     }},
    {"set its flags",
     [] {
       int flags = FS_NODUMP_FL;
       return ioctl(readable(), FS_IOC_SETFLAGS, &flags) == 0 ||
              call(469 /* file_setattr */, AT_FDCWD, file(), nullptr, 0, 0);
     }},
    {"lock",
     [] {
       struct flock whole {};
       whole.l_type = F_RDLCK;
       return flock(readable(), LOCK_EX | LOCK_NB) == 0 || fcntl(readable(), F_SETLK, &whole) == 0 ||
              fcntl(readable(), F_OFD_SETLK, &whole) == 0;
     }},
    {"a lease, a notice",
     [] { return fcntl(readable(), F_SETLEASE, F_RDLCK) == 0 || fcntl(readable(), F_NOTIFY, DN_ACCESS) == 0; }},
    {"watch a folder", [] { return inotify_init1(0) >= 0 || call(SYS_fanotify_init, 0, 0); }},
    {"copy into it", [] { return call(SYS_copy_file_range, readable(), nullptr, readable(), nullptr, 1, 0); }},
    {"splice", [] { return call(SYS_splice, readable(), nullptr, 1, nullptr, 1, 0) || call(SYS_tee, 1, 2, 1, 0); }},
    {"send a file out", [] { return call(SYS_sendfile, 1, readable(), nullptr, 1); }},
    {"map and write",
     [] { return mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, readable(), 0) != MAP_FAILED; }},
    {"write into the host's pictures", writes_pixels},
    {"give the memory of the pixels back", gives_pixels_back},
    {"write to disk now", [] { return fsync(readable()) == 0 || call(SYS_syncfs, readable()) || call(SYS_sync); }},
    {"mount",
     [] {
       return mount("none", fresh(), "tmpfs", 0, nullptr) == 0 || errno != EPERM ||
              call(430 /* fsopen */, "tmpfs", 0) || call(428 /* open_tree */, AT_FDCWD, "/", 1) ||
              call(SYS_umount2, fresh(), 0) || errno != EPERM;
     }},
    {"another root", [] { return chroot("/") == 0 || call(SYS_pivot_root, fresh(), fresh()) || errno != EPERM; }},
    {"a terminal",
     [] { return opens("/dev/tty", O_RDONLY) || opens("/dev/ptmx", O_RDONLY) || opens("/dev/pts", O_RDONLY); }},
    {"type for the user", [] { return ioctl(0, TIOCSTI, "") == 0 || ioctl(1, TIOCSTI, "") == 0; }},
    {"a device",
     [] { return opens("/dev/kmsg", O_RDONLY) || opens("/dev/vda", O_RDONLY) || opens("/dev/shm", O_RDONLY); }},
    {"open its output anew", [] { return opens("/proc/self/fd/1", O_WRONLY) || opens("/dev/stderr", O_RDWR); }},
    {"go back in its output",
     [] { return lseek(1, 0, SEEK_SET) >= 0 || pwrite(1, "x", 1, 0) >= 0 || ftruncate(1, 0) == 0; }},
    {"a quota, a swap, an account",
     [] {
       return call(SYS_quotactl, 0x80000800, 0, 0, 0) || call(SYS_swapon, file(), 0) || call(SYS_acct, fresh()) ||
              errno != EPERM;
     }},
};

}  // namespace

Attempts on_files() { return {kAttempts, sizeof kAttempts / sizeof kAttempts[0]}; }

}  // namespace hostile
