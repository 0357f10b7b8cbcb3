// SPDX-License-Identifier: Apache-2.0
//
// Saved maps with a corrected checksum: the container, its anchors, and the map of fix/map, whose own checksum is left
// (map_section corrects it).
#include <utility>
#include <vector>

#include <odograph/anchor.h>
#include <odograph/map.h>

#include "tests/fuzz/session.hpp"

extern "C" int32_t ODO_CALL odo_plugin_entry_fix_map(const odo_host*, odo_plugin*);

namespace {

odo_session* opened() {
  static const bool registered = odo_register_plugin(odo_plugin_entry_fix_map, nullptr) == ODO_OK;
  fuzz::require(registered, "fix/map is registered");
  return fuzz::open("attitude: {plugin: attitude/vqf}\nabsolute_fixers: {plugin: fix/map}\n");
}

std::vector<uint8_t> saved_map(odo_session* session) {
  std::vector<uint8_t> saved(static_cast<size_t>(odo_map_save(session, nullptr, 0)));
  fuzz::require(odo_map_save(session, saved.data(), saved.size()) == static_cast<int64_t>(saved.size()),
                "a map has the size that was said");
  return saved;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static odo_session* empty = opened();
  std::vector<uint8_t> blob(data, data + size);
  fuzz::correct_checksum(blob);
  if (odo_map_load(empty, blob.data(), blob.size()) != ODO_OK) {
    fuzz::require(odo_map_save(empty, nullptr, 0) == 0 && odo_anchor_list(empty, nullptr, 0) == 0,
                  "a refused map changes nothing");
    return 0;
  }
  odo_session *session = std::exchange(empty, opened()), *later = opened();
  const auto saved = saved_map(session);
  fuzz::require(saved.empty() || odo_map_load(later, saved.data(), saved.size()) == ODO_OK, "a saved map is accepted");
  fuzz::require(saved_map(later) == saved, "a map that is not recognised is saved as it was");
  odo_session_destroy(later), odo_session_destroy(session);
  return 0;
}
