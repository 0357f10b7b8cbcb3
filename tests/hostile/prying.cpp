// SPDX-License-Identifier: Apache-2.0
// Tries what a plugin has no business with, and reports what it was let do.
#define HOSTILE_ID "test/prying"
#include <cerrno>
#include <csignal>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <odograph/attitude.h>

#include "tests/hostile/table.hpp"

static const odo_host* host = nullptr;

static const char* word(bool let) { return let ? " yes" : " no"; }

static std::string try_all() {
  std::string said = std::string("socket") + word(socket(AF_INET, SOCK_STREAM, 0) >= 0);
  const int file = open("/tmp/odograph-prying-test", O_WRONLY | O_CREAT, 0600);
  if (file >= 0) unlink("/tmp/odograph-prying-test");
  said += std::string(", write") + word(file >= 0);
  const pid_t child = fork();
  if (child == 0) _exit(0);
  if (child > 0) waitpid(child, nullptr, 0);
  said += std::string(", fork") + word(child > 0);
  said += std::string(", kill") + word(kill(getppid(), 0) == 0);
  char name[] = "/nonexistent";
  char* arguments[] = {name, nullptr};
  execv(name, arguments);
  said += std::string(", exec") + word(errno != EPERM);
  said += std::string(", read") + word(open("/proc/self/maps", O_RDONLY) >= 0);
  bool ran = false;
  std::thread([&] { ran = true; }).join();
  return said + ", thread" + word(ran);
}

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string interfaces[] = {{ODO_INTERFACE_ATTITUDE, sizeof(ODO_INTERFACE_ATTITUDE) - 1}};
  odo_plugin t = hostile::table();
  t.interfaces = interfaces;
  t.create = [](const odo_host* given, uint32_t, const odo_string*, odo_instance** instance) -> int32_t {
    host = given;
    *instance = reinterpret_cast<odo_instance*>(&hostile::instance());
    return ODO_OK;
  };
  t.process = [](odo_instance*, const odo_batch*) -> int32_t {
    static bool done = false;
    if (done) return ODO_OK;
    done = true;
    const std::string said = try_all();
    const auto* reports = static_cast<const odo_report_service*>(
        host->get_service(host, ODO_SERVICE_REPORT, sizeof(ODO_SERVICE_REPORT) - 1));
    const odo_string key{"prying", 6}, text{said.data(), said.size()};
    reports->report(host, 1, ODO_SEVERITY_WARNING, &key, &text);
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
