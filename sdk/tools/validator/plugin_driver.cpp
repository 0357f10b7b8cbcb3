// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/plugin_driver.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>

#include <sys/mman.h>
#include <unistd.h>

#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

/// Guarded pages. Data ends at the end of a page with nothing mapped behind it, is readable during a call and unmapped
/// afterwards; the next data is elsewhere.
class GuardedPages {
 public:
  GuardedPages() {
    page_ = static_cast<size_t>(sysconf(_SC_PAGESIZE));
    base_ = static_cast<unsigned char*>(
        mmap(nullptr, kBlocks * kPages * page_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  }
  ~GuardedPages() { munmap(base_, kBlocks * kPages * page_); }
  GuardedPages(const GuardedPages&) = delete;

  const void* put(const void* data, size_t size) {
    block_ = base_ + next_++ % kBlocks * kPages * page_;
    mprotect(block_, (kPages - 1) * page_, PROT_READ | PROT_WRITE);
    unsigned char* to = block_ + (kPages - 1) * page_ - (size + 7) / 8 * 8;
    std::memcpy(to, data, size);
    mprotect(block_, (kPages - 1) * page_, PROT_READ);
    return to;
  }
  void unmap() {
    if (block_) mprotect(block_, (kPages - 1) * page_, PROT_NONE);
  }

 private:
  static constexpr size_t kPages = 18;   // 64 KiB, the largest message, and the guard
  static constexpr size_t kBlocks = 16;  // an address is reused after this many calls
  size_t page_, next_ = 0;
  unsigned char* base_;
  unsigned char* block_ = nullptr;
};

constexpr size_t kMaxEvents = 256;

}  // namespace

PluginDriver::PluginDriver(const odo_plugin& table, const odo_host& host, const std::string& interface_id)
    : table_(table), host_(host), interface_id_(interface_id), thread_(std::this_thread::get_id()) {
  for (const uint32_t type : plugin_types(interface_id, table).outputs) outputs_.add(type);
  sink_.emit = [](const odo_sink* sink, const odo_header* event) -> int32_t {
    return static_cast<const Sink*>(sink)->owner->emit(event);
  };
  sink_.owner = this;
}

void PluginDriver::violation(const std::string& text) {
  if (violations.size() < 20) violations.push_back(text);
}

int32_t PluginDriver::emit(const odo_header* event) {
  if (!event) return violation("emitted null"), ODO_E_ARGUMENT;
  if (std::this_thread::get_id() != thread_)
    return violation("thread: emitted on the plugin's own thread"), ODO_E_STATE;
  if (!in_process_) return violation("phase: emitted outside of process"), ODO_E_STATE;
  if (++events_in_call_ > kMaxEvents)
    return violation("count: more than " + std::to_string(kMaxEvents) + " events in one call"), ODO_E_EXHAUSTED;
  if (!outputs_.has(event->type)) {
    violation("type: emitted " + message_name(event->type) + ", which neither its kind emits nor its table declares");
    return ODO_E_ARGUMENT;
  }
  SeenEvent seen;
  if (!seen.message.assign(*event)) {
    violation("size: emitted a " + message_name(event->type) +
              " with struct_size = " + std::to_string(event->struct_size));
    return ODO_E_STRUCT_SIZE;
  }
  if (const std::string fault = message_fault(seen.message.header()); !fault.empty()) {
    violation("numbers: emitted a " + message_name(event->type) + " with " + fault);
    return ODO_E_ARGUMENT;
  }
  seen.message.header().source = 1;
  seen.input_ns = input_ns_, seen.input_type = input_type_, seen.call = calls_;
  events.push_back(std::move(seen));
  return ODO_OK;
}

int32_t PluginDriver::create() {
  note_phase("create");
  const odo_string id{interface_id_.data(), interface_id_.size()};
  const int32_t status = table_.create(&host_, 1, &id, &instance_);
  if (status >= 0 && !instance_) return ODO_E_ERROR;
  return status;
}

int32_t PluginDriver::configure(const std::vector<odo_value>& values) {
  note_phase("configure");
  return table_.configure(instance_, values.data(), static_cast<uint32_t>(values.size()), sizeof(odo_value));
}

int32_t PluginDriver::activate() {
  note_phase("activate");
  sink_.struct_size = sink_size;
  sink_.instance = 1;
  return table_.activate(instance_, &sink_);
}

int32_t PluginDriver::start(const std::vector<odo_value>& values) {
  int32_t status = create();
  if (status >= 0) status = configure(values);
  if (status >= 0) status = activate();
  return status;
}

int32_t PluginDriver::call(const odo_batch& batch) {
  ++calls_;
  events_in_call_ = 0;
  in_process_ = true;
  thread_ = std::this_thread::get_id();
  const auto before = std::chrono::steady_clock::now();
  const int32_t status = table_.process(instance_, &batch);
  call_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
  in_process_ = false;
  ++statuses[status];
  return status;
}

int32_t PluginDriver::process(const std::vector<AnyMessage>& messages, const MessageLayout& layout) {
  int32_t worst = ODO_OK;
  GuardedPages message_pages, pixel_pages;
  for (size_t i = 0; i < messages.size(); i += layout.batch) {
    std::vector<AnyMessage> copies(
        messages.begin() + static_cast<std::ptrdiff_t>(i),
        messages.begin() + static_cast<std::ptrdiff_t>(std::min(i + layout.batch, messages.size())));
    std::vector<const odo_header*> pointers;
    for (AnyMessage& copy : copies) {
      if (layout.change) layout.change(copy);
      const odo_header& header = copy.header();
      note_phase("process", "of " + message_name(header.type) + " at t_ns = " + std::to_string(header.t_ns));
      input_ns_ = std::max(input_ns_, header.t_ns);
      input_type_ = header.type;
      if (!layout.guarded) {
        pointers.push_back(&header);
        continue;
      }
      auto& frame = reinterpret_cast<odo_frame&>(copy.header());
      if (header.type == ODO_TYPE_FRAME && frame.format == ODO_FORMAT_GREY8)
        frame.planes[0].data = static_cast<const uint8_t*>(
            pixel_pages.put(frame.planes[0].data, static_cast<size_t>(frame.planes[0].row_stride) * frame.height));
      pointers.push_back(static_cast<const odo_header*>(message_pages.put(&header, header.struct_size)));
    }
    const odo_batch batch{sizeof batch, static_cast<uint32_t>(pointers.size()), pointers.data()};
    const int32_t status = call(batch);
    if (status <= ODO_E_MEMORY) worst = std::min(worst, status);
    if (layout.guarded) message_pages.unmap(), pixel_pages.unmap();
    // Overwrites unguarded copies, so that a late read returns garbage.
    for (AnyMessage& copy : copies) std::memset(static_cast<void*>(&copy.header()), 0xA5, sizeof(odo_header));
    for (AnyMessage& copy : copies) copy = AnyMessage();
  }
  note_phase("", "between calls");
  return worst;
}

int32_t PluginDriver::reset() {
  note_phase("reset");
  input_ns_ = INT64_MIN;
  return table_.reset ? table_.reset(instance_) : ODO_E_UNSUPPORTED;
}

void PluginDriver::destroy() {
  if (!instance_) return;
  note_phase("destroy");
  table_.destroy(instance_);
  instance_ = nullptr;
  note_phase("", "after destroy");
}

std::vector<std::vector<unsigned char>> PluginDriver::bytes() const {
  std::vector<std::vector<unsigned char>> all;
  for (const SeenEvent& event : events) {
    const auto bytes = event.message.bytes();
    all.emplace_back(bytes.begin(), bytes.end());
  }
  return all;
}

int32_t LoanCounter::retain(void* owner) {
  auto& loans = *static_cast<LoanCounter*>(owner);
  if (loans.refuse) return ODO_E_EXHAUSTED;
  ++loans.retained;
  return ODO_OK;
}

void LoanCounter::release(void* owner) { ++static_cast<LoanCounter*>(owner)->released; }

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace odograph
