// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/thread_gate.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace odograph {
namespace {

/// A message of one byte that carries one descriptor.
struct Parcel {
  char byte = 0;
  iovec part{&byte, 1};
  alignas(cmsghdr) char storage[CMSG_SPACE(sizeof(int))] = {};
  msghdr message{nullptr, 0, &part, 1, storage, sizeof storage, 0};
};

bool send_descriptor(int socket, int fd) {
  Parcel parcel;
  cmsghdr* head = CMSG_FIRSTHDR(&parcel.message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof fd);
  std::memcpy(CMSG_DATA(head), &fd, sizeof fd);
  return sendmsg(socket, &parcel.message, MSG_NOSIGNAL) == 1;
}

int receive_descriptor(int socket) {
  Parcel parcel;
  if (recvmsg(socket, &parcel.message, MSG_CMSG_CLOEXEC) != 1) return -1;
  const cmsghdr* head = CMSG_FIRSTHDR(&parcel.message);
  if (!head || head->cmsg_type != SCM_RIGHTS) return -1;
  int fd = -1;
  std::memcpy(&fd, CMSG_DATA(head), sizeof fd);
  return fd;
}

}  // namespace

bool require_thread_approval(int gate) {
  sock_filter code[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{sizeof code / sizeof code[0], code};
  const auto listener =
      static_cast<int>(syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program));
  const int why = errno;
  const bool asked = listener >= 0 && send_descriptor(gate, listener);
  if (listener >= 0) close(listener);
  close(gate);
  errno = why;
  return asked;
}

void ThreadGate::answer() {
  if (!listening_) {
    const int listener = receive_descriptor(fd_);
    close(fd_);
    fd_ = listener;
    listening_ = true;
    return;
  }
  alignas(seccomp_notif) char question[1024] = {};  // larger, for newer kernels
  alignas(seccomp_notif_resp) char storage[1024] = {};
  if (ioctl(fd_, SECCOMP_IOCTL_NOTIF_RECV, question) != 0) {
    if (errno == EINTR || errno == ENOENT) return;
    close(fd_);
    fd_ = -1;
    return;
  }
  struct stat tasks {};
  const std::string folder = "/proc/" + std::to_string(process_) + "/task";
  const bool seen = stat(folder.c_str(), &tasks) == 0 && tasks.st_nlink > 2;
  const auto threads = seen ? static_cast<unsigned>(tasks.st_nlink) - 2 : approved_;
  auto& reply = reinterpret_cast<seccomp_notif_resp&>(storage);
  reply.id = reinterpret_cast<const seccomp_notif&>(question).id;
  if (threads < kMaxThreads)
    reply.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE, ++approved_;
  else
    reply.error = -EAGAIN;
  ioctl(fd_, SECCOMP_IOCTL_NOTIF_SEND, storage);
}

}  // namespace odograph
