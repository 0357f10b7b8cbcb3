// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/recording.hpp"

#include "sdk/tools/recording/read_phone.hpp"
#include "sdk/tools/recording/archive.hpp"
#include "sdk/tools/recording/message_log.hpp"

#include <algorithm>

namespace odograph {
namespace fs = std::filesystem;

bool Recording::has(uint32_t type) const {
  return std::any_of(messages.begin(), messages.end(),
                     [type](const auto& m) { return m.message.header().type == type; });
}

std::vector<Waypoint> Recording::waypoints() const {
  std::vector<Waypoint> all;
  for (const auto& m : messages)
    if (m.message.header().type == ODO_TYPE_WAYPOINT)
      all.push_back({m.message.header().t_ns, Eigen::Vector3d(as<odo_waypoint>(m.message.header()).p_n)});
  return all;
}

void Recording::add(const odo_header& message, PictureRef picture) {
  if (!is_plausible_time(message.t_ns)) {
    ++loss.times_out_of_range;
    return;
  }
  StoredMessage stored;
  if (!stored.assign(message)) return;
  if (const std::string fault = recorded_fault(stored.header()); !fault.empty()) {
    if (loss.impossible++ == 0)
      loss.first_impossible = message_name(message.type) + " at " + std::to_string(message.t_ns) + " ns: " + fault;
    return;
  }
  messages.push_back({std::move(stored), std::move(picture)});
}

void Recording::sort() {
  const auto earlier = [](const auto& a, const auto& b) { return a.message.header().t_ns < b.message.header().t_ns; };
  if (!std::is_sorted(messages.begin(), messages.end(), earlier))  // sorting doubles the memory
    std::stable_sort(messages.begin(), messages.end(), earlier);
}

namespace {

/// The bag or MCAP file of a folder, as stored by ROS 2; empty if there is none.
Result<fs::path> log_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> logs;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path kind = entry.path().extension();
    if (kind == ".db3" && fs::exists(folder / "metadata.yaml", error))
      return Failure{ODO_E_DATA, folder.string() +
                                     ": a ROS 2 bag in SQLite, which is not read; 'ros2 bag convert' makes MCAP of it"};
    if (kind == ".mcap" || kind == ".bag") logs.push_back(entry.path());
  }
  if (logs.size() > 1)
    return Failure{ODO_E_DATA,
                   folder.string() + ": " + std::to_string(logs.size()) + " bags or MCAP files; name one of them"};
  return logs.empty() ? fs::path() : logs.front();
}

Result<Recording> read_folder(const fs::path& path, const ReadOptions& options, std::shared_ptr<const void> keep) {
  std::error_code error;
  if (fs::exists(path / "mav0", error) || fs::exists(path / "imu0", error)) return read_euroc(path, options);
  if (fs::exists(path / "image_0", error)) return read_kitti(path);
  if (fs::exists(path / "iphone", error)) return read_advio(path);
  if (fs::exists(path / "rgb.txt", error)) return read_tum_rgbd(path, options);
  if (const auto log = log_in(path); log && !log->empty())
    return read_log(*log);
  else if (!log)
    return log.failure();
  if (looks_like_phone_recording(path)) return read_phone(path, std::move(keep));
  if (fs::exists(path / "camera.yaml", error)) return read_image_folder(path);
  return Failure{ODO_E_DATA, path.string() +
                                 ": no recording in this folder; looked for mav0/ (EuRoC/ASL), image_0/ (KITTI), "
                                 "iphone/ (ADVIO), rgb.txt (TUM RGB-D), camera.yaml (images), and the files of phones' "
                                 "apps (docs/phone_recordings.md)"};
}

/// An archive of a recording's files, or of one folder that contains them.
Result<Recording> read_archive(const fs::path& path, const ReadOptions& options) {
  const auto folder = unpack(path);
  if (!folder) return folder.failure();
  fs::path inside = (*folder)->path();
  std::error_code error;
  for (int depth = 0; depth < 3; ++depth) {
    std::vector<fs::path> folders;
    bool has_files = false;
    for (const auto& entry : fs::directory_iterator(inside, error)) {
      const std::string name = entry.path().filename().string();
      if (name == "__MACOSX" || name.starts_with(".")) continue;
      if (entry.is_directory(error))
        folders.push_back(entry.path());
      else
        has_files = true;
    }
    if (has_files || folders.size() != 1 || folders.front().filename() == "mav0") break;
    inside = folders.front();
  }
  auto recording = read_folder(inside, options, *folder);
  const std::string shown = path.string() + ':', own = inside.string();
  const auto renamed = [&](std::string text) {
    for (size_t at = 0; (at = text.find(own, at)) != std::string::npos; at += shown.size())
      text.replace(at, own.size() + (text[at + own.size()] == ':' ? 1 : 0), shown);
    return text;
  };
  if (!recording) return Failure{recording.failure().status, renamed(recording.failure().text)};
  recording->path = path;
  for (std::string& warning : recording->warnings) warning = renamed(warning);
  recording->keep = *folder;
  return recording;
}

Result<Recording> read_whatever(const fs::path& path, const ReadOptions& options) {
  std::error_code error;
  if (!fs::exists(path, error)) return Failure{ODO_E_NOT_FOUND, path.string() + ": no such file or folder"};
  if (fs::is_directory(path, error)) return read_folder(path, options, {});
  if (!fs::is_regular_file(path, error))
    return Failure{ODO_E_DATA, path.string() + ": neither a file nor a folder; a pipe or a device is no recording"};
  if (RecordReader::has_signature(path)) return read_odo(path, options);
  if (MessageLog::has_signature(path)) return read_log(path);
  if (looks_like_archive(path)) return read_archive(path, options);
  if (looks_like_gnss_log(path)) return read_gnss_log(path);
  if (const auto walk = read_walk(path)) return *walk;
  if (path.extension() == ".txt") return read_indoor_location(path);
  return Failure{ODO_E_DATA, path.string() +
                                 ": not a recording; expected an Odograph recording (.odo), a phone app's export "
                                 "(.zip), a ROS bag (.bag), MCAP (.mcap), GnssLogger's text, an Indoor Location "
                                 "Competition or IPIN trace (.txt), or a "
                                 "walk of RIDI, Oxford's step counter or the trundle wheel (.csv)"};
}

/// The first picture outside the recording's folder, through a link; missing ones are handled later.
std::optional<fs::path> picture_outside(const Recording& recording, const fs::path& path) {
  std::error_code error;
  const fs::path root = fs::canonical(path, error);
  for (const RecordedMessage& m : recording.messages) {
    if (!m.picture.file) continue;
    const fs::path real = fs::canonical(*m.picture.file, error);
    if (!error && std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first != root.end())
      return *m.picture.file;
  }
  return std::nullopt;
}

}  // namespace

std::vector<int64_t> frame_times_ns(const Recording& recording) {
  std::vector<int64_t> frames;
  int64_t offset_ns = 0;
  for (const RecordedMessage& m : recording.messages) {
    const odo_header& header = m.message.header();
    if (header.type == ODO_TYPE_FRAME) frames.push_back(header.t_ns);
    if (header.type == ODO_TYPE_CALIBRATION && (header.flags & ODO_CALIBRATION_TIME_OFFSET) && offset_ns == 0)
      offset_ns = as<odo_calibration>(header).time_offset_ns;
  }
  for (int64_t& t_ns : frames) t_ns += offset_ns;
  return frames;
}

Result<Recording> read_recording(const fs::path& path, const ReadOptions& options) {
  auto recording = read_whatever(path, options);
  std::error_code error;
  if (recording && !options.pictures_outside && fs::is_directory(path, error))
    if (const auto outside = picture_outside(*recording, path))
      return Failure{ODO_E_DATA,
                     outside->string() + ": a link leads out of the recording's folder; --pictures-outside allows it"};
  if (recording && recording->loss.times_out_of_range > 0)
    recording->warnings.push_back(std::to_string(recording->loss.times_out_of_range) +
                                  " messages have times beyond +-2^62 ns and were skipped");
  if (recording && recording->loss.impossible > 0)
    recording->warnings.push_back(std::to_string(recording->loss.impossible) +
                                  " messages are impossible and were skipped; the first, " +
                                  recording->loss.first_impossible);
  if (recording && recording->messages.empty()) return Failure{ODO_E_DATA, path.string() + ": no usable message in it"};
  return recording;
}

}  // namespace odograph
