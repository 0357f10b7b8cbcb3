// SPDX-License-Identifier: Apache-2.0
//
// Reproducibility across batches, instances and processes; structs of other versions.
#include <cstring>
#include <limits>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
CASES(repeat)
namespace {

template <size_t batch>
Verdict cut(CaseFixture& fixture) {
  MessageLayout layout;
  layout.batch = batch;
  const auto one = fixture.run(fixture.input, {}), other = fixture.run(fixture.input, layout);
  return difference(one, other);
}

/// Passed, with the FNV-1a hash of all events of a child process as its detail.
Verdict fingerprint(CaseFixture& fixture) {
  const auto hashed = [](CaseFixture& b) -> Verdict {
    uint64_t hash = 14695981039346656037u;
    for (const auto& event : b.run(b.input, {}))
      for (const unsigned char byte : event) hash = (hash ^ byte) * 1099511628211u;
    return {PluginCheck::Outcome::passed, std::to_string(hash)};
  };
  constexpr double kNone = std::numeric_limits<double>::infinity();  // the case's own limit ends this child too
  const ChildResult result = run_in_child(kNone, [&] { return encoded(Case{.test = hashed}.run(fixture)); });
  return result.finished ? decoded(result.text) : Verdict(result.text);
}

/// Inserts messages of a type, of any size, between the others.
template <uint32_t type>
Verdict with_unknown_type(CaseFixture& fixture) {
  const auto plain = fixture.run(fixture.input, {});
  std::vector<AnyMessage> mixed;
  for (const AnyMessage& message : fixture.input) {
    alignas(8) unsigned char storage[96] = {};
    auto& header = *reinterpret_cast<odo_header*>(storage);
    header.struct_size = mixed.size() % 2 ? 96 : 32;
    header.type = type;
    header.t_ns = message.header().t_ns;
    mixed.push_back(message);
    mixed.emplace_back(header);
  }
  const auto other = fixture.run(mixed, {});
  return difference(plain, other);
}

/// The events and statuses must be the same for original and modified messages.
Verdict same_for(CaseFixture& fixture, const MessageLayout& layout) {
  const auto plain = fixture.start_instance(), other = fixture.start_instance();
  plain->process(fixture.input);
  other->process(fixture.input, layout);
  for (const auto& [status, times] : other->statuses)
    if (status < 0 && plain->statuses[status] < times)
      return std::to_string(times) + " times status " + std::to_string(status) + ", " +
             std::to_string(plain->statuses[status]) + " times without the change";
  return difference(plain->bytes(), other->bytes());
}

CASE(repeat, "repeat.instance", "emits the same events again", 20, 4) {
  const auto one = fixture.run(fixture.input, {}), other = fixture.run(fixture.input, {});
  return difference(one, other);
}

CASE(repeat, "repeat.process", "emits the same events in another process", 45, 4) {
  const Verdict one = fingerprint(fixture), other = fingerprint(fixture);
  if (one.outcome != PluginCheck::Outcome::passed) return one;
  return one.detail == other.detail ? "" : "two processes gave different events";
}

CASE(repeat, "repeat.memory", "does not depend on previous memory contents", 20, 4) {
  const auto one = fixture.run(fixture.input, {});
  std::vector<std::vector<char>> holes;
  for (size_t i = 1; i < 2000; ++i) holes.emplace_back(i * 37 % 5000, static_cast<char>(0xA5));
  for (size_t i = 0; i < holes.size(); i += 2) holes[i] = {};  // memory that is neither fresh nor zero
  const auto other = fixture.run(fixture.input, {});
  return difference(one, other);
}

CASE_OF(repeat, "repeat.batches_of_2", "emits the same events with two messages per call", 20, 4, cut<2>);
CASE_OF(repeat, "repeat.batches_of_17", "emits the same events with 17 messages per call", 20, 4, cut<17>);
CASE(repeat, "repeat.reset", "emits the same events after a reset", 20, 4) {
  if (!fixture.table().reset) return not_applicable("it has no reset: the host makes a new instance");
  const auto driver = fixture.start_instance();
  driver->process(fixture.input);
  const auto first = driver->bytes();
  if (const int32_t status = driver->reset(); status < 0) return "reset gave status " + std::to_string(status);
  driver->events.clear();
  driver->process(fixture.input);
  return difference(first, driver->bytes());
}

CASE(repeat, "repeat.reset_first", "has the same state after resets as after activate", 20, 3) {
  if (!fixture.table().reset) return not_applicable("it has no reset: the host makes a new instance");
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = fixture.start_instance();
  for (int i = 0; i < 3; ++i)
    if (const int32_t status = driver->reset(); status < 0) return "reset gave status " + std::to_string(status);
  driver->process(fixture.input);
  return difference(plain, driver->bytes());
}

CASE(repeat, "batch.empty", "accepts an empty batch", 10, 0) {
  const auto driver = fixture.start_instance();
  note_phase("process", "of an empty batch");
  const odo_batch batch{sizeof batch, 0, nullptr};
  const int32_t status = driver->call(batch);
  return status >= 0 ? "" : "an empty batch gave status " + std::to_string(status);
}

CASE(repeat, "batch.read_only", "writes to no message, reads none beyond its end, retains none after the call", 20, 4) {
  MessageLayout layout;
  layout.guarded = true;
  const auto one = fixture.run(fixture.input, {}), other = fixture.run(fixture.input, layout);
  return difference(one, other);
}

CASE_OF(repeat, "growth.newer_type", "ignores messages of unknown types", 20, 3, with_unknown_type<0x07ED>);
CASE_OF(repeat, "growth.vendor_type", "ignores vendors' messages", 20, 3,
        with_unknown_type<ODO_TYPE_VENDOR(77777, 42)>);
/// Messages from a host of version 1.0: later members are missing, and no memory is mapped behind them.
CASE(repeat, "growth.older_messages", "accepts messages of a host of version 1.0", 20, 3) {
  const auto grown = [](const AnyMessage& m) {
    const MessageInfo* info = message_info(m.header().type);
    return info && info->min_size < info->size;
  };
  if (std::none_of(fixture.input.begin(), fixture.input.end(), grown))
    return not_applicable("none of its messages has grown since version 1.0");
  MessageLayout layout;
  layout.guarded = true;
  layout.change = [](AnyMessage& message) {
    if (const MessageInfo* info = message_info(message.header().type))
      message.header().struct_size =
          static_cast<uint32_t>(std::min(info->min_size, size_t(message.header().struct_size)));
  };
  return same_for(fixture, layout);
}

/// Messages of a later version, with more members at the end.
CASE(repeat, "growth.newer_messages", "accepts messages with more members at the end", 20, 3) {
  MessageLayout layout;
  layout.change = [](AnyMessage& message) {
    const auto bytes = message.bytes();
    std::vector<uint64_t> larger((bytes.size() + 7) / 8 + 5, ~0ull);
    std::memcpy(larger.data(), bytes.data(), bytes.size());
    auto& header = *reinterpret_cast<odo_header*>(larger.data());
    header.struct_size = static_cast<uint32_t>(larger.size() * 8);
    message = AnyMessage(header);
  };
  return same_for(fixture, layout);
}

/// Compared without services on both sides: they need the real host.
CASE(repeat, "growth.newer_host", "accepts a host and a sink with more members at the end", 20, 3) {
  struct LaterHost : odo_host {
    uint64_t more[4];
  } host;
  std::memset(static_cast<void*>(&host), 0xEE, sizeof host);
  static_cast<odo_host&>(host) = fixture.host;
  host.get_service = [](const odo_host*, const char*, uint64_t) -> const void* { return nullptr; };
  PluginDriver plain(fixture.table(), host, fixture.interface_id);
  const int32_t alone = plain.start(fixture.values);
  if (alone == ODO_E_CONFIG || alone == ODO_E_NOT_FOUND)
    return not_applicable("it needs services that only the real host provides");
  plain.process(fixture.input);
  host.struct_size = sizeof(LaterHost);
  PluginDriver later(fixture.table(), host, fixture.interface_id);
  later.sink_size = sizeof(odo_sink) + 32;
  if (const int32_t status = later.start(fixture.values); status < 0)
    return "starting with a newer host gave status " + std::to_string(status);
  later.process(fixture.input);
  return difference(plain.bytes(), later.bytes());
}

/// A batch struct of a later version, in memory that ends with it.
CASE(repeat, "growth.newer_batch", "accepts a batch with more members at the end", 20, 3) {
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = fixture.start_instance();
  for (const AnyMessage& message : fixture.input) {
    const odo_header* messages[] = {&message.header()};
    struct {
      odo_batch batch;
      uint64_t more[4];
    } later{{sizeof later, 1, messages}, {~0ull, ~0ull, ~0ull, ~0ull}};
    driver->call(later.batch);
  }
  return difference(plain, driver->bytes());
}

}  // namespace

}  // namespace odograph
