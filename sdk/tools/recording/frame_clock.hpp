// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/tools/recording/read_table.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/video.hpp"

namespace odograph::phone {

/// When a frame was taken, on the sensors' clock, and its row in the table of frames (SIZE_MAX: none).
struct FrameTime {
  std::optional<int64_t> t_ns;  ///< nothing: not known, the frame is left out
  size_t row = SIZE_MAX;
};

/// Times of a video's frames: from the app's table, from the video's own track of metadata, or from its name. Every
/// guess goes into the recording's warnings. ODO_E_DATA in words where there is none to be had.
Result<std::vector<FrameTime>> frame_clock(Recording& recording, const Format& format, const Video& video,
                                           const std::string& name, const Rows* times);

/// The Unix time (ns) that a sample of timed metadata holds, `near_ns` within a day: Apple's keyed items of a signed
/// 64-bit number, the bare number, or decimal digits.
std::optional<int64_t> unix_time_in(const std::vector<unsigned char>& sample, int64_t near_ns);

/// Of each frame the row of a table that may have more or fewer of them: of all shifts the one at which the rows follow
/// the video's own times best. ODO_E_DATA where none does within a third of a frame.
Result<std::vector<size_t>> match_rows(const std::vector<int64_t>& video_ns, const std::vector<int64_t>& rows_ns);

}  // namespace odograph::phone
