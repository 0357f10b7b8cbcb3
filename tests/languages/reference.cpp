// SPDX-License-Identifier: Apache-2.0
//
// Reference for the language bindings: every pose of `odograph run` with all its digits, after checking that
// FOLDER/trajectory.tum contains the same ones.
// odograph-reference CONFIG RECORDING FOLDER
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "sdk/tools/recording/trajectory.hpp"
#include "sdk/tools/replay/runner.hpp"

using namespace odograph;

namespace {

int fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  return 1;
}

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

int print_poses(const std::string& config, const std::string& path, const std::string& folder) {
  const auto recording = read_recording(path);
  if (!recording) return fail(recording.failure().text);
  RunOptions options;
  options.config = config;
  options.collect_poses = true;
  const auto result = replay(*recording, options);
  if (!result) return fail(result.failure().text);
  std::ostringstream tum;
  const size_t from = result->first_metric < result->track.size() ? result->first_metric : 0;
  write_tum(tum, StampedPoses(result->track.begin() + static_cast<std::ptrdiff_t>(from), result->track.end()));
  if (tum.str() != text_of(folder + "/trajectory.tum")) return fail("these are not the poses of the command line");
  for (const odo_pose& x : result->poses)
    std::printf("pose %" PRId64 " %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", x.header.t_ns, x.p_n[0], x.p_n[1],
                x.p_n[2], x.q_n[1], x.q_n[2], x.q_n[3], x.q_n[0]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) return print_poses(argv[1], argv[2], argv[3]);
  return fail("usage: odograph-reference CONFIG RECORDING FOLDER");
}
