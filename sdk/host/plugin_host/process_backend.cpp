// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/process_backend.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <odograph/messages.h>

#include "sdk/host/base/pixels.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/host/plugin_host/shared_memory.hpp"
#include "sdk/host/plugin_host/shared_pixels.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr double kEndLimit_s = 0.5;  // an app that destroys its session waits for no more than a second
constexpr int kPaceLook_ms = 20;     // interval at which a waiting call looks whether its session ends
constexpr int kEndPolls = 100;       // of 1 ms: a process that closed its socket should have ended by then
constexpr int kSupervisorPolls =
    1000;                             // of 1 ms: for the supervisor to end the plugin and its namespace's first process
constexpr size_t kMaxRecords = 4096;  // of one call: 256 events, reports and refused events

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Starts the program with the three descriptors in place and no signal blocked or ignored.
pid_t spawn(const fs::path& program, int socket_fd, int control_fd, int pixels_fd) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&files, socket_fd, wire::kSocket);
  posix_spawn_file_actions_adddup2(&files, control_fd, wire::kControl);
  posix_spawn_file_actions_adddup2(&files, pixels_fd, wire::kPixels);
  sigset_t all, none;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::string name = program.string();
  char* arguments[] = {name.data(), nullptr};
  pid_t child = -1;
  const int error = posix_spawn(&child, name.c_str(), &files, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) child = -1, errno = error;
  return child;
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) return std::string("was ended by a signal (") + strsignal(WTERMSIG(status)) + ")";
  return "ended its process with status " + std::to_string(WEXITSTATUS(status));
}

void put_values(wire::Writer& out, const PluginChoice& choice) {
  const auto values = values_of(choice);
  out.put(static_cast<uint32_t>(values.size()));
  for (const odo_value& value : values) {
    out.put(value.type);
    out.put_bytes(value.name.data, value.name.size);
    out.put_bytes(value.text.data, value.text.size);
    out.put_bytes(value.reals, value.count * sizeof(double));
    out.put(value.integer);
  }
}

}  // namespace

fs::path plugin_host_program() {
  const fs::path binary = own_file();
  if (binary.empty()) return {};
  for (const char* folder : {".", "odograph", "../bin", ODOGRAPH_FROM_BIN})
    if (fs::path place = binary.parent_path() / folder / "odograph-plugin-host"; access(place.c_str(), X_OK) == 0)
      return place;
  return {};
}

Result<std::unique_ptr<PluginBackend>> open_process(const PluginChoice& choice, LibraryCheck check, HostServices& host,
                                                    const odo_sink& sink) {
  auto made = ProcessBackend::load(choice, check, host, sink);
  if (!made) return made.failure();
  return std::unique_ptr<PluginBackend>(std::move(*made));
}

Result<std::unique_ptr<ProcessBackend>> ProcessBackend::load(const PluginChoice& choice, LibraryCheck check,
                                                             HostServices& host, const odo_sink& sink) {
  const std::string origin = choice.manifest.library.string() + ": ";
  if (host.shared_pixels().descriptor() < 0)
    return Failure{ODO_E_EXHAUSTED,
                   origin + (errno == EINVAL || errno == ENOSYS
                                 ? "isolation: process needs memory that can be sealed (memfd_create with "
                                   "F_SEAL_FUTURE_WRITE: Linux 5.1 or later)"
                                 : std::string("no memory can be shared with its process: ") + std::strerror(errno))};
  const fs::path program = choice.isolation.program.empty() ? plugin_host_program() : choice.isolation.program;
  if (program.empty())
    return Failure{ODO_E_NOT_FOUND, origin +
                                        "isolation: process needs the program odograph-plugin-host beside the "
                                        "library; expected it there, or its path as plugins.host"};
  std::unique_ptr<ProcessBackend> made(new ProcessBackend(choice, host, sink));
  if (!made->launch(program))
    return Failure{ODO_E_EXHAUSTED,
                   origin + "no process could be started with " + program.string() + ": " + std::strerror(errno)};
  auto out = made->request();
  out.put_text(choice.manifest.path.string());
  out.put_text(choice.manifest.text);  // the file may have changed meanwhile
  out.put_text(choice.interface_id);
  out.put(sink.instance);
  out.put(static_cast<uint32_t>(check));
  out.put(host.seed());
  out.put(static_cast<uint32_t>(host.live()));
  out.put(choice.isolation.memory_bytes);
  out.put(static_cast<uint32_t>(host.assets().size()));
  for (const fs::path& folder : host.assets()) out.put_text(folder.string());
  put_values(out, choice);
  if (!made->exchange_to_start(wire::enter, out)) return Failure{ODO_E_FATAL, origin + made->ended_};
  if (const std::string lacks = made->answer().get_text(); !lacks.empty())
    host.report(sink.instance, ODO_SEVERITY_WARNING, "sandbox",
                "its process is not fully sandboxed; this system has " + lacks);
  if (!made->exchange_to_start(wire::open, made->request())) return Failure{ODO_E_FATAL, origin + made->ended_};
  if (Failure failure = made->opened(origin); failure.status < 0) return failure;
  return made;
}

/// Reads the library's types from the answer, or the reason why it was not loaded; ODO_E_FATAL for an invalid answer.
Failure ProcessBackend::opened(const std::string& origin) {
  constexpr size_t kLongestText = 4096;
  const Failure no_answer{ODO_E_FATAL, origin + "broke the protocol in load"};
  wire::Reader reader = answer();
  const auto status = reader.get<int32_t>();
  const std::string why = one_line(reader.get_text(), kLongestText);
  for (auto* types : {&types_.inputs, &types_.outputs}) {
    const auto bytes = reader.get_bytes();
    if (bytes.size() > 2 * kMaxTypes * sizeof(uint32_t)) return no_answer;  // its kind's and its table's types
    types->resize(bytes.size() / sizeof(uint32_t));
    if (!bytes.empty()) std::memcpy(types->data(), bytes.data(), types->size() * sizeof(uint32_t));
  }
  types_.flags = reader.get<uint32_t>();
  if (!reader.good() || status == ODO_OK) return reader.good() ? Failure{status, why} : no_answer;
  return {status, why.starts_with(origin) ? why : origin + why};
}

bool ProcessBackend::launch(const fs::path& program) {
  int ends[2] = {-1, -1};
  const int control_fd = shared_memory("odograph-control", sizeof(wire::Control));
  control_ = static_cast<wire::Control*>(map_shared(control_fd, sizeof(wire::Control)));
  if (control_ && socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0) {
    socket_ = ends[0];
    ends[1] = high_descriptor(ends[1]);
    control_->version = wire::kVersion;
    child_ = spawn(program, ends[1], control_fd, host_.shared_pixels().descriptor());
    const int why = errno;
    close(ends[1]);
    errno = why;
  }
  const int why = errno;
  if (control_fd >= 0) close(control_fd);
  errno = why;
  return child_ > 0;
}

ProcessBackend::~ProcessBackend() {
  for (FrameSlot& entry : frames_) release_frame(entry);
  if (child_ > 0 && ended_.empty()) {
    const bool in_order = exchange(wire::end, request(), kEndLimit_s);
    if (!in_order)
      host_.report(sink_.instance, ODO_SEVERITY_WARNING, "isolated", ended_, ODO_E_ERROR);
    else
      reap(false, "");
  }
  if (socket_ >= 0) close(socket_);
  if (control_) munmap(control_, sizeof(wire::Control));
}

/// Sends a request and waits for the answer, which is then copied to answer_. False, with ended_ set, if there is none.
bool ProcessBackend::exchange(wire::Call call, const wire::Writer& asked, double limit_s, Clock::time_point since) {
  if (!ended_.empty()) return false;
  if (asked.full()) return give_up("was asked for more than the shared memory holds"), false;
  control_->call = call;
  control_->request_size = asked.size();
  control_->response_size = 0;
  char word = 0;
  if (const ssize_t got = recv(socket_, &word, 1, MSG_DONTWAIT | MSG_PEEK); got == 1 || (got == 0 && !hung_up()))
    return give_up("broke the protocol: an unrequested answer"), false;
  word = 'c';
  while (send(socket_, &word, 1, MSG_NOSIGNAL | MSG_DONTWAIT) != 1) {
    if (errno == EINTR) continue;
    return errno == EAGAIN ? give_up("does not accept requests") : reap(false, ""), false;
  }
  if (!wait_for_answer(call, limit_s, since)) return false;
  const uint64_t size = *static_cast<volatile uint64_t*>(&control_->response_size);
  if (size > wire::kAreaBytes)
    return give_up("broke the protocol: an answer of " + std::to_string(size) + " bytes"), false;
  answer_size_ = static_cast<size_t>(size);
  answer_.resize((answer_size_ + 7) / 8);
  if (answer_size_ > 0) std::memcpy(answer_.data(), control_->response, answer_size_);
  return true;
}

bool ProcessBackend::wait_for_answer(wire::Call call, double limit_s, Clock::time_point since) {
  const auto until = since + std::chrono::duration<double>(limit_s);
  for (;;) {
    const double left_s = std::chrono::duration<double>(until - Clock::now()).count();
    pollfd wait{socket_, POLLIN, 0};
    const int ready =
        left_s > 0 ? poll(&wait, 1, static_cast<int>(std::min(left_s * 1e3 + 1, double{kPaceLook_ms}))) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || left_s <= 0) return give_up("took longer than " + number(limit_s) + " s"), false;
    if (ready == 0) {
      if (call == wire::end || host_.pace() != HostServices::Pace::ending) continue;
      return give_up("was ended with its session"), false;
    }
    char word = 0;
    const ssize_t got = recv(socket_, &word, 1, 0);
    if (got == 1) return true;
    if (got < 0 && errno == EINTR) continue;
    if (got == 0 && !hung_up()) return give_up("broke the protocol: an empty answer"), false;
    return reap(false, ""), false;
  }
}

/// Waits for the process, at most `polls` times 1 ms. Returns as waitpid().
pid_t ProcessBackend::wait_for_end(int polls, int& status) {
  pid_t gone = 0;
  for (int i = 0; i < polls && gone == 0; ++i) {
    gone = waitpid(child_, &status, WNOHANG);
    if (gone == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return gone;
}

/// Ends the process for a violation.
void ProcessBackend::give_up(std::string what) { reap(true, what); }

void ProcessBackend::reap(bool killed_by_us, const std::string& what) {
  char phase[wire::kPhaseBytes + 1] = {};
  std::memcpy(phase, control_->phase, wire::kPhaseBytes);
  std::replace_if(
      std::begin(phase), std::end(phase) - 1, [](char c) { return c != 0 && !std::islower(c); }, '?');
  int status = 0;
  pid_t gone = killed_by_us ? 0 : wait_for_end(kEndPolls, status);
  ended_ = killed_by_us ? what : gone > 0 ? how_it_ended(status) : gone < 0 ? "ended its process" : "left the host";
  if (gone == 0) {
    kill(child_, SIGTERM);  // its supervisor ends the others and then itself
    gone = wait_for_end(kSupervisorPolls, status);
  }
  if (gone == 0) {
    kill(child_, SIGKILL);
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  child_ = -1;
  if (*phase) ended_ += std::string(" in ") + phase;
}

/// Returns the status of an answer, after passing on its events and reports.
int32_t ProcessBackend::answered(bool may_emit) {
  wire::Reader reader = answer();
  const auto status = reader.get<int32_t>();
  if (!take_records(reader, may_emit) || !reader.good()) {
    give_up("broke the protocol");
    return ODO_E_ERROR;
  }
  return status;
}

bool ProcessBackend::take_records(wire::Reader& reader, bool may_emit) {
  alignas(8) unsigned char bytes[ODO_LARGEST_MESSAGE];
  for (size_t count = 0; reader.good() && !reader.empty(); ++count) {
    if (count >= kMaxRecords) return false;
    const auto kind = reader.get<uint32_t>();
    if (kind == wire::report) {
      const auto severity = reader.get<uint32_t>();
      const auto status = reader.get<int32_t>();
      const std::string key = reader.get_text(), text = reader.get_text();
      if (!reader.good()) return false;
      host_.report(sink_.instance, std::min(severity, ODO_SEVERITY_ERROR), key, text, status,
                   HostServices::Author::plugin);
      continue;
    }
    if (kind == wire::state) {
      const auto data = reader.get_bytes();
      if (!reader.good() || data.size() > ODO_LARGEST_STATE) return false;
      state_.assign(data.begin(), data.end());
      continue;
    }
    const auto event = reader.get_bytes();
    if (kind != wire::event || !may_emit || !reader.good() || event.size() > sizeof bytes) return false;
    if (event.empty()) {
      sink_.emit(&sink_, nullptr);
      continue;
    }
    if (event.size() < sizeof(odo_header)) return false;
    std::memcpy(bytes, event.data(), event.size());
    const auto& header = *reinterpret_cast<const odo_header*>(bytes);
    const bool takeable = header.struct_size >= sizeof(odo_header) && header.struct_size <= ODO_LARGEST_MESSAGE;
    if (takeable && header.struct_size != event.size()) return false;
    sink_.emit(&sink_, &header);
  }
  return true;
}

int32_t ProcessBackend::start() { return exchange_to_start(wire::start, request()) ? answered() : ODO_E_ERROR; }

int32_t ProcessBackend::process(const odo_header& message) {
  reclaim_frames();
  auto out = request();
  out.put_bytes(&message, message.struct_size);
  if (message.type == ODO_TYPE_FRAME && !put_frame(message, out)) return ODO_E_EXHAUSTED;
  const int32_t status = exchange(wire::process, out, choice_.isolation.time_s) ? answered(true) : ODO_E_ERROR;
  reclaim_frames();
  return status;
}

/// Describes the pixels to the plugin and holds them as long as the plugin does: through the frame's own reference if
/// they are in shared memory, otherwise in a copy there.
bool ProcessBackend::put_frame(const odo_header& message, wire::Writer& out) {
  const auto free = std::find_if(std::begin(frames_), std::end(frames_), [](const auto& entry) { return !entry.used; });
  if (free == std::end(frames_)) return false;
  SharedPixels& shared = host_.shared_pixels();
  odo_frame frame = copy_as<odo_frame>(message);
  FrameSlot entry{true, false, frame, {}};
  if (shared.offset_of(frame.planes[0].data)) {
    entry.retained = frame.loan.retain && frame.loan.release && frame.loan.retain(frame.loan.owner) >= 0;
  } else {
    const size_t bytes = pixel_bytes(frame);
    entry.copy = shared.take(bytes);
    if (entry.copy.empty() || !copy_pixels(frame, entry.copy.first(bytes))) return release_frame(entry), false;
  }
  *free = entry;
  const auto slot = static_cast<uint32_t>(free - std::begin(frames_));
  control_->holds[slot] = 1;  // the plugin's process clears it
  out.put(slot);
  out.put(static_cast<uint32_t>(entry.retained || !entry.copy.empty()));
  const bool masked = (frame.header.flags & ODO_FRAME_MASK) != 0;
  for (const odo_plane* plane : {&frame.planes[0], &frame.planes[1], &frame.planes[2], &frame.planes[3], &frame.mask}) {
    const bool used = plane != &frame.mask || masked;
    out.put(used ? shared.offset_of(plane->data).value_or(UINT64_MAX) : UINT64_MAX);
    out.put(plane->row_stride);
    out.put(plane->pixel_stride);
  }
  return true;
}

/// Releases the frames that the plugin no longer holds.
void ProcessBackend::reclaim_frames() {
  for (size_t slot = 0; slot < wire::kFrameSlots; ++slot)
    if (!ended_.empty() || control_->holds[slot].load(std::memory_order_acquire) == 0) release_frame(frames_[slot]);
}

void ProcessBackend::release_frame(FrameSlot& entry) {
  if (!entry.used) return;
  if (entry.retained) entry.frame.loan.release(entry.frame.loan.owner);
  host_.shared_pixels().give_back(entry.copy);
  entry = {};
}

int32_t ProcessBackend::reset() {
  return exchange(wire::reset, request(), choice_.isolation.time_s) ? answered() : ODO_E_ERROR;
}

}  // namespace odograph
