// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <odograph/recording.h>

#include "tests/support/support.hpp"

namespace odograph {

inline odo_string text(const std::string& s) { return {s.data(), s.size()}; }

inline odo_recorder* recorder(const std::filesystem::path& path) {
  odo_recorder* made = nullptr;
  const std::string name = path.string();
  const odo_string file = text(name);
  REQUIRE(odo_recorder_create(&file, &made, nullptr) == ODO_OK);
  return made;
}

inline odo_recording* recording(const std::filesystem::path& path, int32_t expected = ODO_OK) {
  odo_recording* made = nullptr;
  const std::string name = path.string();
  const odo_string file = text(name);
  CHECK(odo_recording_open(&file, &made, nullptr) == expected);
  return made;
}

}  // namespace odograph
