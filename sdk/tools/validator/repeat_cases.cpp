// SPDX-License-Identifier: Apache-2.0
//
// Reproducibility across batches, instances and processes; structs of other versions.
#include <cstring>

#include "sdk/tools/validator/bench.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

Verdict run_twice(Bench& bench) {
  const auto one = bench.run(bench.input, {}), other = bench.run(bench.input, {});
  return difference(one, other);
}

Verdict cut(Bench& bench, size_t batch) {
  Handling handling;
  handling.batch = batch;
  const auto one = bench.run(bench.input, {}), other = bench.run(bench.input, handling);
  return difference(one, other);
}
Verdict cut_small(Bench& bench) { return cut(bench, 2); }
Verdict cut_odd(Bench& bench) { return cut(bench, 17); }

Verdict after_reset(Bench& bench) {
  if (!bench.table().reset) return not_applicable("it has no reset: the host makes a new instance");
  const auto subject = bench.started();
  subject->process(bench.input);
  const auto first = subject->bytes();
  if (const int32_t status = subject->reset(); status < 0) return "reset gave status " + std::to_string(status);
  subject->events.clear();
  subject->process(bench.input);
  return difference(first, subject->bytes());
}

Verdict reset_first(Bench& bench) {
  if (!bench.table().reset) return not_applicable("it has no reset: the host makes a new instance");
  const auto plain = bench.run(bench.input, {});
  const auto subject = bench.started();
  for (int i = 0; i < 3; ++i)
    if (const int32_t status = subject->reset(); status < 0) return "reset gave status " + std::to_string(status);
  subject->process(bench.input);
  return difference(plain, subject->bytes());
}

/// Passed, with the FNV-1a hash of all events of a child process as its detail.
Verdict fingerprint(Bench& bench) {
  const auto hashed = [](Bench& b) -> Verdict {
    uint64_t hash = 14695981039346656037u;
    for (const auto& event : b.run(b.input, {}))
      for (const unsigned char byte : event) hash = (hash ^ byte) * 1099511628211u;
    return {PluginCheck::Outcome::passed, std::to_string(hash)};
  };
  const ChildResult result = run_in_child(20, [&] { return encoded(Case{"", "", 20, 0, true, +hashed}.run(bench)); });
  return result.finished ? decoded(result.text) : Verdict(result.text);
}

Verdict other_process(Bench& bench) {
  const Verdict one = fingerprint(bench), other = fingerprint(bench);
  if (one.outcome != PluginCheck::Outcome::passed) return one;
  return one.detail == other.detail ? "" : "two processes gave different events";
}

Verdict shuffled_memory(Bench& bench) {
  const auto one = bench.run(bench.input, {});
  std::vector<std::vector<char>> holes;
  for (size_t i = 1; i < 2000; ++i) holes.emplace_back(i * 37 % 5000, static_cast<char>(0xA5));
  for (size_t i = 0; i < holes.size(); i += 2) holes[i] = {};  // memory that is neither fresh nor zero
  const auto other = bench.run(bench.input, {});
  return difference(one, other);
}

Verdict guarded(Bench& bench) {
  Handling handling;
  handling.guarded = true;
  const auto one = bench.run(bench.input, {}), other = bench.run(bench.input, handling);
  return difference(one, other);
}

Verdict empty_batch(Bench& bench) {
  const auto subject = bench.started();
  note_phase("process of an empty batch");
  const odo_batch batch{sizeof batch, 0, nullptr};
  const int32_t status = subject->call(batch);
  return status >= 0 ? "" : "an empty batch gave status " + std::to_string(status);
}

/// Inserts messages of a type, of any size, between the others.
Verdict with_strange(Bench& bench, uint32_t type) {
  const auto plain = bench.run(bench.input, {});
  std::vector<AnyMessage> mixed;
  for (const AnyMessage& message : bench.input) {
    alignas(8) unsigned char strange[96] = {};
    auto& header = *reinterpret_cast<odo_header*>(strange);
    header.struct_size = mixed.size() % 2 ? 96 : 32;
    header.type = type;
    header.t_ns = message.header().t_ns;
    mixed.push_back(message);
    mixed.emplace_back(header);
  }
  const auto other = bench.run(mixed, {});
  return difference(plain, other);
}
Verdict newer_type(Bench& bench) { return with_strange(bench, 0x07ED); }
Verdict vendor_type(Bench& bench) { return with_strange(bench, ODO_TYPE_VENDOR(77777, 42)); }

/// The events and statuses must be the same for original and modified messages.
Verdict same_for(Bench& bench, const Handling& handling) {
  const auto plain = bench.started(), other = bench.started();
  plain->process(bench.input);
  other->process(bench.input, handling);
  for (const auto& [status, times] : other->statuses)
    if (status < 0 && plain->statuses[status] < times)
      return std::to_string(times) + " times status " + std::to_string(status) + ", " +
             std::to_string(plain->statuses[status]) + " times without the change";
  return difference(plain->bytes(), other->bytes());
}

/// Messages from a host of version 1.0: later members are missing, and no memory is mapped behind them.
Verdict older_messages(Bench& bench) {
  const auto grown = [](const AnyMessage& m) {
    const MessageInfo* info = message_info(m.header().type);
    return info && info->min_size < info->size;
  };
  if (std::none_of(bench.input.begin(), bench.input.end(), grown))
    return not_applicable("none of its messages has grown since version 1.0");
  Handling handling;
  handling.guarded = true;
  handling.change = [](AnyMessage& message) {
    if (const MessageInfo* info = message_info(message.header().type))
      message.header().struct_size =
          static_cast<uint32_t>(std::min(info->min_size, size_t(message.header().struct_size)));
  };
  return same_for(bench, handling);
}

/// Messages of a later version, with more members at the end.
Verdict newer_messages(Bench& bench) {
  Handling handling;
  handling.change = [](AnyMessage& message) {
    const auto bytes = message.bytes();
    std::vector<uint64_t> larger((bytes.size() + 7) / 8 + 5, ~0ull);
    std::memcpy(larger.data(), bytes.data(), bytes.size());
    auto& header = *reinterpret_cast<odo_header*>(larger.data());
    header.struct_size = static_cast<uint32_t>(larger.size() * 8);
    message = AnyMessage(header);
  };
  return same_for(bench, handling);
}

/// Compared without services on both sides: they need the real host.
Verdict newer_host(Bench& bench) {
  struct LaterHost : odo_host {
    uint64_t more[4];
  } host;
  std::memset(static_cast<void*>(&host), 0xEE, sizeof host);
  static_cast<odo_host&>(host) = bench.host;
  host.get_service = [](const odo_host*, const char*, uint64_t) -> const void* { return nullptr; };
  Subject plain(bench.table(), host, bench.interface_id);
  const int32_t alone = plain.start(bench.values);
  if (alone == ODO_E_CONFIG || alone == ODO_E_NOT_FOUND)
    return not_applicable("it needs services that only the real host provides");
  plain.process(bench.input);
  host.struct_size = sizeof(LaterHost);
  Subject later(bench.table(), host, bench.interface_id);
  later.sink_size = sizeof(odo_sink) + 32;
  if (const int32_t status = later.start(bench.values); status < 0)
    return "starting with a newer host gave status " + std::to_string(status);
  later.process(bench.input);
  return difference(plain.bytes(), later.bytes());
}

/// A batch struct of a later version, in memory that ends with it.
Verdict newer_batch(Bench& bench) {
  const auto plain = bench.run(bench.input, {});
  const auto subject = bench.started();
  for (const AnyMessage& message : bench.input) {
    const odo_header* messages[] = {&message.header()};
    struct {
      odo_batch batch;
      uint64_t more[4];
    } later{{sizeof later, 1, messages}, {~0ull, ~0ull, ~0ull, ~0ull}};
    subject->call(later.batch);
  }
  return difference(plain, subject->bytes());
}

}  // namespace

std::vector<Case> repeat_cases() {
  return {
      {"repeat.instance", "emits the same events again", 20, 4, true, run_twice},
      {"repeat.process", "emits the same events in another process", 45, 4, true, other_process},
      {"repeat.memory", "does not depend on previous memory contents", 20, 4, true, shuffled_memory},
      {"repeat.batches_of_2", "emits the same events with two messages per call", 20, 4, true, cut_small},
      {"repeat.batches_of_17", "emits the same events with 17 messages per call", 20, 4, true, cut_odd},
      {"repeat.reset", "emits the same events after a reset", 20, 4, true, after_reset},
      {"repeat.reset_first", "has the same state after resets as after activate", 20, 3, true, reset_first},
      {"batch.empty", "accepts an empty batch", 10, 0, true, empty_batch},
      {"batch.read_only", "writes to no message, reads none beyond its end, retains none after the call", 20, 4, true,
       guarded},
      {"growth.newer_type", "ignores messages of unknown types", 20, 3, true, newer_type},
      {"growth.vendor_type", "ignores vendors' messages", 20, 3, true, vendor_type},
      {"growth.older_messages", "accepts messages of a host of version 1.0", 20, 3, true, older_messages},
      {"growth.newer_messages", "accepts messages with more members at the end", 20, 3, true, newer_messages},
      {"growth.newer_host", "accepts a host and a sink with more members at the end", 20, 3, true, newer_host},
      {"growth.newer_batch", "accepts a batch with more members at the end", 20, 3, true, newer_batch},
  };
}

}  // namespace odograph
