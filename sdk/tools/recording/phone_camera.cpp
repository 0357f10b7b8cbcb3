// SPDX-License-Identifier: Apache-2.0
//
// Frames of a phone recording: their times, lens and mount.
#include "sdk/tools/recording/phone_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/frame_clock.hpp"
#include "sdk/tools/recording/picture_header.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

/// Focal length over the picture's longer side, for the main cameras of phones in video mode. A 26 mm equivalent lens
/// has 0.75 (34.6 mm picture width at 4:3); stabilisation and readout crop about a tenth: 0.78 to 0.85. ARKit's own
/// matrices of iPhone 8 to 15 have 0.82 to 0.84 (strayrobots, ADVIO).
constexpr double kFocalOfApple = 0.83, kFocalOfOthers = 0.79;

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// A wide picture is in sensor orientation: its right is the phone's bottom. A tall picture has been rotated to be
/// upright when the phone is.
void guess_mount(odo_calibration& c) {
  const bool as_read = c.width >= c.height;
  const double r = std::sqrt(0.5);
  const double q[2][4] = {{0, 1, 0, 0}, {0, r, -r, 0}};
  std::copy_n(q[as_read ? 1 : 0], 4, c.q_b_c);
  c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
}

/// Scales a lens calibrated for another picture size, if the aspect ratio is the same.
Result<bool> fit_to_size(odo_calibration& c, uint32_t width, uint32_t height, const std::string& from) {
  if (c.width == width && c.height == height) return true;
  if (c.width == 0 || c.height == 0) {
    c.width = width, c.height = height;
    return true;
  }
  const double sx = width / double(c.width), sy = height / double(c.height);
  if (std::abs(sx / sy - 1) > 0.02)
    return Failure{ODO_E_DATA, from + ": a lens of " + std::to_string(c.width) + "x" + std::to_string(c.height) +
                                   ", pictures of " + std::to_string(width) + "x" + std::to_string(height)};
  c.fx *= sx, c.fy *= sy;
  c.cx = (c.cx + 0.5) * sx - 0.5, c.cy = (c.cy + 0.5) * sy - 0.5;
  c.width = width, c.height = height;
  return true;
}

/// A frame with the focal length, exposure and readout of its row.
odo_frame frame_of(int64_t t_ns, const Row* row, const odo_calibration& c, bool by_lens) {
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
  if (!row) return frame;
  const auto& v = row->v;
  if (by_lens && v[0] > 0.2 * c.width) {
    frame.header.flags |= ODO_FRAME_INTRINSICS;
    frame.fx = v[0], frame.fy = v[1] > 0 ? v[1] : v[0];
    frame.cx = v[2] > 0 ? v[2] : c.cx, frame.cy = v[3] > 0 ? v[3] : c.cy;
  }
  if (v[4] > 1 && v[4] < 1e9) {
    frame.header.flags |= ODO_FRAME_EXPOSURE;
    frame.exposure_ns = std::llround(v[4]);
  }
  if (v[5] > 1e5 && v[5] < 1e8 && c.height > 1) {  // 0.1 to 100 ms for the whole picture
    frame.header.flags |= ODO_FRAME_LINE_TIME;
    frame.line_time_ns = std::llround(v[5] / c.height);
  }
  return frame;
}

Result<bool> add_video(Recording& recording, const Format& format, const Files& files, const Rows* times,
                       const CameraFacts& facts, const std::string& name) {
  const auto video = Video::open(*files.path(name), files.keep);
  if (!video) return video.failure();
  const auto calibration = calibration_of(facts, times, (*video)->width(), (*video)->height(), recording);
  if (!calibration) return calibration.failure();
  recording.add(calibration->header);
  const auto clock = frame_clock(recording, format, **video, name, times);
  if (!clock) return clock.failure();
  const bool by_lens = facts.frames_have_lens || !facts.has_lens;
  for (size_t i = 0; i < clock->size(); ++i) {
    const auto& [t_ns, row] = (*clock)[i];
    if (!t_ns) continue;
    const Row* values = times && row < times->rows.size() ? &times->rows[row] : nullptr;
    recording.add(frame_of(*t_ns, values, *calibration, by_lens).header, PictureRef{.offset = i, .store = *video});
  }
  return true;
}

/// The number in a picture's name: Unix time in ms, or its index.
std::optional<int64_t> number_in(const fs::path& file) {
  const std::string stem = file.stem().string();
  const size_t end = stem.find_first_not_of("0123456789");
  if (stem.empty() || end == 0 || stem.size() > 18) return std::nullopt;
  return std::atoll(stem.substr(0, end).c_str());
}

Result<bool> add_pictures(Recording& recording, const Format& format, const Files& files, const Rows* times,
                          const CameraFacts& facts, std::vector<std::string> names) {
  std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    const auto x = number_in(a), y = number_in(b);
    return x && y ? *x < *y : a < b;
  });
  if (times && times->rows.size() != names.size())
    return Failure{ODO_E_DATA, times->file.string() + ": " + std::to_string(times->rows.size()) + " times for " +
                                   std::to_string(names.size()) + " pictures; expected one for each"};
  Result<PictureSize> size = Failure{};
  for (size_t i = 0; i < names.size() && !size; ++i) size = picture_size(*files.path(names[i]));
  if (!size) return size.failure();
  const auto calibration = calibration_of(facts, times, size->width, size->height, recording);
  if (!calibration) return calibration.failure();
  recording.add(calibration->header);
  const bool by_name = !times && format.frame_times == FrameTimes::metadata_track;
  if (!times && !by_name)
    return Failure{ODO_E_DATA, files.folder.string() +
                                   ": pictures and no times: a times.csv with one time in ns a "
                                   "picture is missing"};
  for (size_t i = 0; i < names.size(); ++i) {
    const auto number = number_in(names[i]);
    if (by_name && (!number || *number < 1'000'000'000'000)) continue;
    const int64_t t_ns = by_name ? *number * 1'000'000 : times->rows[i].t_ns;
    recording.add(frame_of(t_ns, by_name ? nullptr : &times->rows[i], *calibration, false).header,
                  {files.path(names[i])});
  }
  if (by_name) recording.warnings.push_back("frames have whole milliseconds, from the pictures' names");
  return true;
}

}  // namespace

Result<odo_calibration> calibration_of(CameraFacts facts, const Rows* times, uint32_t width, uint32_t height,
                                       Recording& recording) {
  odo_calibration c = facts.calibration;
  if (!facts.has_lens) {
    c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    c.model = ODO_CAMERA_PINHOLE;
    if (facts.has_mount) {
      std::copy_n(facts.calibration.q_b_c, 4, c.q_b_c), std::copy_n(facts.calibration.p_b_c, 3, c.p_b_c);
      c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
    }
    c.width = width, c.height = height, c.cx = 0.5 * (width - 1), c.cy = 0.5 * (height - 1);
    const double focal = times && !times->rows.empty() ? times->rows.front().v[0] : std::nan("");
    if (times && !times->table->columns.empty() && focal > 0.2 * width) {
      c.fx = focal;
      const auto& v = times->rows.front().v;
      c.fy = v[1] > 0 ? v[1] : focal;
      if (v[2] > 0 && v[3] > 0) c.cx = v[2], c.cy = v[3];
    } else {
      recording.guessed.lens = true;
      c.fx = c.fy = (facts.apple ? kFocalOfApple : kFocalOfOthers) * std::max(width, height);
      recording.warnings.push_back(
          "no lens in the recording: guessed a focal length of " + number_text(c.fx) + " px, " +
          number_text(2 * 57.29578 * std::atan(0.5 * std::max(width, height) / c.fx)) +
          " degrees over the longer side (" + (facts.device.empty() ? "a phone's main camera" : facts.device) +
          "); the metric scale depends on it: 'odograph calibrate' makes a camera.yaml");
    }
  } else if (const auto fitted = fit_to_size(c, width, height, facts.lens_from); !fitted) {
    return fitted.failure();
  }
  if (!facts.has_mount) {
    guess_mount(c);
    recording.guessed.mount = true;
    recording.warnings.push_back(std::string("mount of the camera guessed by the picture's shape: ") +
                                 (c.width >= c.height ? "wide, so its right is the phone's bottom"
                                                      : "tall, so it stands upright when the phone does"));
  }
  if (const std::string fault = message_fault(c.header); !fault.empty())
    return Failure{ODO_E_DATA, facts.lens_from + ": " + fault};
  return c;
}

Result<bool> add_camera(Recording& recording, const Format& format, const Files& files, const Rows* times,
                        CameraFacts facts) {
  const auto videos = *format.video ? files.find_all(format.video) : std::vector<std::string>();
  const auto pictures = *format.pictures ? files.find_all(format.pictures) : std::vector<std::string>();
  if (videos.size() > 1)
    recording.warnings.push_back(std::to_string(videos.size()) + " videos: " + videos.front() + " is read");
  if (!videos.empty()) return add_video(recording, format, files, times, facts, videos.front());
  if (!pictures.empty()) return add_pictures(recording, format, files, times, facts, pictures);
  if (*format.switch_on_video)
    recording.warnings.push_back("no video and no pictures: the track is from steps and inertia only; in " +
                                 std::string(format.name) + ": " + format.switch_on_video);
  return true;
}

}  // namespace odograph::phone
