// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/tools/recording/read_table.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/video.hpp"

namespace odograph::phone {

/// Time of a frame on the sensors' clock, and its row in the table of frames (SIZE_MAX: none).
struct FrameTime {
  std::optional<int64_t> t_ns;  ///< nothing: unknown, the frame is skipped
  size_t row = SIZE_MAX;
};

/// Times of a video's frames: from the app's table, the video's metadata track, or its file name. Every assumption is
/// added to the recording's warnings. ODO_E_DATA, with the reason, if there is no source.
Result<std::vector<FrameTime>> frame_clock(Recording& recording, const Format& format, const Video& video,
                                           const std::string& name, const Rows* times);

/// The Unix time (ns) in a sample of timed metadata, within a day of `near_ns`: Apple's keyed items with a signed
/// 64-bit number, the bare number, or decimal digits.
std::optional<int64_t> unix_time_in(const std::vector<unsigned char>& sample, int64_t near_ns);

/// For each frame, the row of a table with possibly more or fewer rows: the shift at which the rows match the video's
/// own times best. ODO_E_DATA if none matches within a third of a frame.
Result<std::vector<size_t>> match_rows(const std::vector<int64_t>& video_ns, const std::vector<int64_t>& rows_ns);

}  // namespace odograph::phone
