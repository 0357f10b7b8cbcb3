// SPDX-License-Identifier: Apache-2.0
//
// What the languages are compared with.
//   odograph-reference pictures IN.odo OUT.odo        the same recording with pictures that need no library: PGM
//   odograph-reference poses CONFIG RECORDING FOLDER  every pose of `odograph run` with all its digits, after a look
//   whether
//                                                     FOLDER/trajectory.tum is made of the same ones
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include <odograph/recording.h>

#include "sdk/tools/recording/trajectory.hpp"
#include "sdk/tools/replay/runner.hpp"

using namespace odograph;

namespace {

int fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  return 1;
}

std::string pgm_of(const odo_frame& frame) {
  std::string bytes = "P5\n" + std::to_string(frame.width) + ' ' + std::to_string(frame.height) + "\n255\n";
  for (uint32_t row = 0; row < frame.height; ++row)
    bytes.append(reinterpret_cast<const char*>(frame.planes[0].data) + row * frame.planes[0].row_stride, frame.width);
  return bytes;
}

int write_pictures(const std::string& from, const std::string& to) {
  const auto recording = read_recording(from);
  if (!recording) return fail(recording.failure().text);
  const odo_string path = {to.data(), to.size()};
  odo_recorder* recorder = nullptr;
  if (odo_recorder_create(&path, &recorder, nullptr) != ODO_OK) return fail(to + ": cannot be written");
  for (const RecordedMessage& message : recording->messages) {
    std::string picture;
    if (message.message.header().type == ODO_TYPE_FRAME) {
      const auto frame = load_frame(message);
      if (!frame || frame->format != ODO_FORMAT_GREY8) return fail("a picture that is not grey");
      picture = pgm_of(*frame);
      frame->loan.release(frame->loan.owner);
    }
    odo_recorder_write(recorder, &message.message.header(), picture.data(), picture.size());
  }
  return odo_recorder_close(recorder) == ODO_OK ? 0 : fail(to + ": cannot be written");
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
  write_tum(tum, Trajectory(result->track.begin() + static_cast<std::ptrdiff_t>(from), result->track.end()));
  if (tum.str() != text_of(folder + "/trajectory.tum")) return fail("these are not the poses of the command line");
  for (const odo_pose& x : result->poses)
    std::printf("pose %" PRId64 " %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", x.header.t_ns, x.p_n[0], x.p_n[1],
                x.p_n[2], x.q_n[1], x.q_n[2], x.q_n[3], x.q_n[0]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "pictures" && argc == 4) return write_pictures(argv[2], argv[3]);
  if (what == "poses" && argc == 5) return print_poses(argv[2], argv[3], argv[4]);
  return fail("usage: odograph-reference pictures IN OUT | poses CONFIG RECORDING FOLDER");
}
