// SPDX-License-Identifier: Apache-2.0
// A scale source that executes the orders in ODO_TYPE_VENDOR(0, 1): tests/support/obeys.hpp has their struct.
#define HOSTILE_ID "test/obeys"
#include <cfenv>

#include <time.h>
#include <unistd.h>

#include "tests/hostile/table.hpp"
#include "tests/support/obeys.hpp"

namespace {

struct State {
  const odo_sink* sink = nullptr;
  uint32_t learnt = 0;     // 0: nothing
  uint32_t processed = 0;  // orders since activation or reset
};

State& of(odo_instance* instance) { return *reinterpret_cast<State*>(instance); }

void emit(const State& state, const odo_header& order) {
  auto scale = hostile::make<odo_scale>(ODO_TYPE_SCALE, order.t_ns);
  scale.scale = 1 + state.learnt, scale.sigma = 0.1, scale.displacement_m = state.processed;
  state.sink->emit(state.sink, &scale.header);
}

}  // namespace

HOSTILE_PLUGIN {
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(0, 1)};
  t.inputs = inputs, t.input_count = 1;
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance** instance) -> int32_t {
    *instance = reinterpret_cast<odo_instance*>(new State);
    return ODO_OK;
  };
  t.destroy = [](odo_instance* instance) { delete &of(instance); };
  t.activate = [](odo_instance* instance, const odo_sink* sink) -> int32_t { return of(instance).sink = sink, ODO_OK; };
  t.reset = [](odo_instance* instance) -> int32_t { return of(instance).processed = 0, ODO_OK; };
  t.save = [](odo_instance* instance, void* data, uint64_t capacity) -> int64_t {
    const uint32_t learnt = of(instance).learnt;
    if (learnt == 0) return 0;
    if (capacity >= sizeof learnt) std::memcpy(data, &learnt, sizeof learnt);
    return sizeof learnt;
  };
  t.load = [](odo_instance* instance, const void* data, uint64_t size) -> int32_t {
    if (size != sizeof(uint32_t)) return ODO_E_DATA;
    return std::memcpy(&of(instance).learnt, data, size), ODO_OK;
  };
  t.process = [](odo_instance* instance, const odo_batch* batch) -> int32_t {
    const odo_header& told = *batch->messages[0];  // messages for test/echo have the same type and another size
    if (told.type != ODO_TYPE_VENDOR(0, 1) || told.struct_size != sizeof(odograph::Order)) return ODO_OK;
    const auto& order = *reinterpret_cast<const odograph::Order*>(batch->messages[0]);
    State& state = of(instance);
    ++state.processed;
    if (order.learn != 0) state.learnt = order.learn;
    const timespec pause{static_cast<time_t>(order.sleep_ms / 1000),
                         static_cast<long>(order.sleep_ms % 1000) * 1'000'000};
    nanosleep(&pause, nullptr);
    for (uint32_t i = 0; i < order.emits; ++i) emit(state, order.header);
    if (order.rounds_up != 0) std::fesetround(FE_UPWARD);
    if (order.ends != 0) _exit(1);
    return order.status;
  };
}
