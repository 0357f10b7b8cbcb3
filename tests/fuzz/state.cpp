// SPDX-License-Identifier: Apache-2.0
//
// Saved states with a corrected checksum, which would otherwise hide the code behind it.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/fuzz/session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static odo_session* const session = fuzz::open(
      "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  - plugin: step/odograph\n"
      "  - plugin: step/renaudin2012\nabsolute_fixers:\n  plugin: fix/barometer\n");
  std::vector<uint8_t> blob(data, data + size);
  fuzz::correct_checksum(blob);
  if (odo_session_load(session, blob.data(), blob.size()) != ODO_OK) return 0;
  std::vector<uint8_t> saved(static_cast<size_t>(odo_session_save(session, nullptr, 0)));
  odo_session_save(session, saved.data(), saved.size());
  if (odo_session_load(session, saved.data(), saved.size()) != ODO_OK) std::abort();  // a saved state must be accepted
  return 0;
}
