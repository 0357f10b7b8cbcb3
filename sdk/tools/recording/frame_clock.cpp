// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/frame_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace odograph::phone {
namespace {

constexpr int64_t kDay_ns = 86'400'000'000'000;
/// Tolerance between a frame's time in the video and that of its metadata: both tracks have time scales of 1/600 s or
/// finer.
constexpr int64_t kSameMoment_ns = 4'000'000;
/// Maximum difference in frames between a table and the video at the start: encoders drop their first ones.
constexpr int kMaxShift = 30;

int64_t big_endian(const unsigned char* bytes) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return static_cast<int64_t>(value);
}

int64_t median_of(std::vector<int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

int64_t interval_of(const std::vector<int64_t>& times_ns) {
  std::vector<int64_t> intervals;
  for (size_t i = 1; i < times_ns.size(); ++i) intervals.push_back(times_ns[i] - times_ns[i - 1]);
  return intervals.empty() ? 33'333'333 : median_of(intervals);
}

int64_t first_inertial_ns(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_IMU) return m.message.header().t_ns;
  return 0;
}

/// For each frame, the time that the metadata states for the same video time.
std::vector<FrameTime> by_metadata(const Video& video, int64_t near_ns) {
  std::vector<std::pair<int64_t, int64_t>> track;  // video time, Unix time
  for (const Video::Metadata& sample : video.metadata())
    if (const auto t = unix_time_in(sample.bytes, near_ns)) track.emplace_back(sample.t_ns, *t);
  std::sort(track.begin(), track.end());
  std::vector<FrameTime> times;
  for (const int64_t moment : video.times_ns()) {
    const auto after = std::lower_bound(track.begin(), track.end(), std::pair(moment, INT64_MIN));
    FrameTime time;
    int64_t best = kSameMoment_ns;
    const auto consider = [&](auto place) {
      if (std::abs(place->first - moment) > best) return;
      best = std::abs(place->first - moment);
      time.t_ns = place->second;
    };
    if (after != track.end()) consider(after);
    if (after != track.begin()) consider(after - 1);
    times.push_back(time);
  }
  return times;
}

/// "Camera/1770510090666.mp4": start time of the recording, before that of the camera.
std::optional<int64_t> unix_time_in_name(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  if (stem.size() != 13 || stem.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return std::atoll(stem.c_str()) * 1'000'000;
}

Result<std::vector<FrameTime>> by_name(Recording& recording, const Video& video, const std::string& name) {
  const auto start = unix_time_in_name(name);
  if (!start)
    return Failure{ODO_E_DATA, recording.path.string() + ": " + name +
                                   " has no track with its frames' times, and its name is not a time in milliseconds: "
                                   "the times of its frames are unknown"};
  recording.warnings.push_back(
      name +
      " has no track with its frames' times (older versions of the app): taken from its name, which is 0.1 to "
      "0.7 s early; 'odograph calibrate --imu' finds the offset, update the app for the next recording");
  recording.guessed.times = true;
  std::vector<FrameTime> times;
  for (const int64_t t : video.times_ns()) times.push_back({*start + t - video.times_ns().front(), SIZE_MAX});
  return times;
}

Result<std::vector<FrameTime>> by_table(Recording& recording, const Video& video, const std::string& name,
                                        const Rows& table) {
  std::vector<int64_t> rows_ns;
  for (const Row& row : table.rows) rows_ns.push_back(row.t_ns);
  const auto matched = match_rows(video.times_ns(), rows_ns);
  if (!matched) return Failure{ODO_E_DATA, table.file.string() + ": " + matched.failure().text};
  std::vector<FrameTime> times;
  size_t without = 0;
  for (const size_t row : *matched) {
    times.push_back({row < rows_ns.size() ? std::optional(rows_ns[row]) : std::nullopt, row});
    without += row >= rows_ns.size() ? 1 : 0;
  }
  if (rows_ns.size() != matched->size())
    recording.warnings.push_back(name + " has " + std::to_string(matched->size()) + " frames, " +
                                 table.file.filename().string() + " " + std::to_string(rows_ns.size()) +
                                 " rows: matched by their intervals" +
                                 (without > 0 ? ", " + std::to_string(without) + " frames skipped" : ""));
  return times;
}

}  // namespace

std::optional<int64_t> unix_time_in(const std::vector<unsigned char>& sample, int64_t near_ns) {
  const auto plausible = [&](int64_t t) { return std::abs(t - near_ns) < kDay_ns; };
  // Apple's timed metadata: items with a 32-bit size, a 32-bit key and the value (QuickTime File Format, "mebx").
  for (size_t at = 0; at + 8 <= sample.size();) {
    const auto size = static_cast<size_t>(static_cast<uint64_t>(big_endian(sample.data() + at)) >> 32);
    if (size < 8 || size > sample.size() - at) break;
    if (size == 16 && plausible(big_endian(sample.data() + at + 8))) return big_endian(sample.data() + at + 8);
    if (size > 16) {
      const std::vector<unsigned char> value(sample.begin() + static_cast<std::ptrdiff_t>(at + 8),
                                             sample.begin() + static_cast<std::ptrdiff_t>(at + size));
      if (const auto t = unix_time_in(value, near_ns)) return t;
    }
    at += size;
  }
  if (sample.size() == 8 && plausible(big_endian(sample.data()))) return big_endian(sample.data());
  const std::string digits(sample.begin(), sample.end());
  if (digits.size() >= 19 && digits.size() <= 40 && digits.find_first_not_of("0123456789") >= 19) {
    const int64_t t = std::atoll(digits.substr(0, 19).c_str());
    if (plausible(t)) return t;
  }
  return std::nullopt;
}

Result<std::vector<size_t>> match_rows(const std::vector<int64_t>& video_ns, const std::vector<int64_t>& rows_ns) {
  if (video_ns.empty() || rows_ns.size() < 2)
    return Failure{ODO_E_DATA, std::to_string(rows_ns.size()) + " rows for " + std::to_string(video_ns.size()) +
                                   " frames; expected one for each"};
  if (rows_ns.size() * 2 < video_ns.size())
    return Failure{ODO_E_DATA, std::to_string(rows_ns.size()) + " rows for the video's " +
                                   std::to_string(video_ns.size()) + " frames; is it cut off?"};
  const int64_t interval = interval_of(rows_ns);
  int best_shift = 0;
  double best = 1e18;
  size_t best_count = 0;
  for (int shift = -kMaxShift; shift <= kMaxShift; ++shift) {
    std::vector<int64_t> offsets;
    for (size_t i = 0; i < video_ns.size(); ++i) {
      const auto row = static_cast<int64_t>(i) + shift;
      if (row >= 0 && row < static_cast<int64_t>(rows_ns.size()))
        offsets.push_back(rows_ns[static_cast<size_t>(row)] - video_ns[i]);
    }
    if (offsets.size() < 2 || offsets.size() * 2 < std::min(video_ns.size(), rows_ns.size())) continue;
    const int64_t middle = median_of(offsets);
    double sum = 0;
    for (const int64_t offset : offsets)
      sum += std::min<double>(std::abs(double(offset - middle)), 2.0 * double(interval));
    // Ties (uniform intervals) resolve to the smallest shift.
    const double cost = sum / double(offsets.size()) + 1e3 * std::abs(shift);
    if (cost < best) best = cost, best_shift = shift, best_count = offsets.size();
  }
  if (best_count == 0 || best > double(interval) / 3)
    return Failure{ODO_E_DATA, std::to_string(rows_ns.size()) + " rows do not follow the video's " +
                                   std::to_string(video_ns.size()) + " frames; are they of the same recording?"};
  std::vector<size_t> rows;
  for (size_t i = 0; i < video_ns.size(); ++i) {
    const auto row = static_cast<int64_t>(i) + best_shift;
    rows.push_back(row >= 0 && row < static_cast<int64_t>(rows_ns.size()) ? static_cast<size_t>(row) : SIZE_MAX);
  }
  return rows;
}

Result<std::vector<FrameTime>> frame_clock(Recording& recording, const Format& format, const Video& video,
                                           const std::string& name, const Rows* times) {
  if (times && !times->rows.empty()) return by_table(recording, video, name, *times);
  if (format.frame_times == FrameTimes::table)
    return Failure{ODO_E_DATA, recording.path.string() + ": " + name +
                                   " and no times of its frames: a table with one time a frame is missing"};
  auto clock = by_metadata(video, first_inertial_ns(recording));
  const auto without =
      static_cast<size_t>(std::count_if(clock.begin(), clock.end(), [](const FrameTime& t) { return !t.t_ns; }));
  if (without == clock.size()) return by_name(recording, video, name);
  if (without > 0)
    recording.warnings.push_back(std::to_string(without) + " of " + std::to_string(clock.size()) + " frames of " +
                                 name + " have no time in its metadata track and are skipped");
  return clock;
}

}  // namespace odograph::phone
