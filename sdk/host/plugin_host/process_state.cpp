// SPDX-License-Identifier: Apache-2.0
//
// State and maps of a plugin in its own process.
#include "sdk/host/plugin_host/process_backend.hpp"
#include "sdk/host/plugin_host/wire.hpp"

namespace odograph {

std::vector<uint8_t> ProcessBackend::save() {
  state_.clear();
  if (!exchange(wire::save, request(), choice_.isolation.time_s) || answered() < 0) return {};
  return std::move(state_);
}

std::vector<uint8_t> ProcessBackend::map_piece(uint64_t offset) {
  state_.clear();
  auto out = request();
  out.put(offset);
  if (!exchange(wire::save_map, out, choice_.isolation.time_s) || answered() < 0) return {};
  if (state_.size() > ODO_LARGEST_PIECE) return {};
  return std::move(state_);
}

bool ProcessBackend::take_map_piece(uint64_t offset, std::span<const uint8_t> piece) {
  auto out = request();
  out.put(offset);
  out.put_bytes(piece.data(), piece.size());
  return !out.full() && exchange(wire::load_map, out, choice_.isolation.time_s) && answered() >= 0;
}

bool ProcessBackend::load(std::span<const uint8_t> data) {
  auto out = request();
  out.put_bytes(data.data(), data.size());
  return !out.full() && exchange(wire::load, out, choice_.isolation.time_s) && answered() >= 0;
}

}  // namespace odograph
