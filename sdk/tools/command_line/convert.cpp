// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <optional>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/spec.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/export/exported_run.hpp"
#include "sdk/tools/recording/kalibr.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/recording/run_track.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct ConvertArguments {
  std::string input, output, origin, recording;
  std::optional<int> jpeg_quality;
  bool pgm = false;
  double every_s = 0;
  ReadOptions reading;
};

/// Writes a frame with its picture, unchanged or recoded. A picture that cannot be decoded, encoded or stored is
/// a failure with ODO_E_DATA.
Result<bool> write_frame(OdoWriter& writer, const RecordedMessage& m, bool pack) {
  const auto frame = load_frame(m);  // decode even if copied unchanged, to detect damage now
  if (!frame) return frame.failure();
  auto bytes = pack ? std::vector<unsigned char>() : encoded_picture(m.picture);
  const auto written = bytes.empty() ? writer.write(frame->header) : writer.write_encoded_frame(*frame, bytes);
  frame->loan.release(frame->loan.owner);
  return written;
}

/// Writes the whole recording. Frames whose pictures are unreadable are skipped and counted in `lost`. Without a
/// quality (OdoWriter's), pictures are copied unchanged; those of a video become PNG.
Result<bool> to_recording(const Recording& recording, const fs::path& output, std::optional<int> jpeg_quality,
                          uint64_t& lost) {
  auto writer = OdoWriter::create(output, jpeg_quality.value_or(0));
  if (!writer) return writer.failure();
  Progress progress("convert");
  size_t done = 0;
  for (const RecordedMessage& m : recording.messages) {
    progress.show(++done, recording.messages.size());
    if (m.message.header().type != ODO_TYPE_FRAME) {
      if (const auto written = (*writer)->write(m.message.header()); !written) return written.failure();
      continue;
    }
    const auto written = write_frame(**writer, m, jpeg_quality.has_value());
    if (written) continue;
    if (written.failure().status != ODO_E_DATA) return written.failure();
    if (lost++ == 0) std::fprintf(stderr, "%s\n", printable(written.failure().text).c_str());
  }
  for (const odo_step& step : recording.true_steps)
    if (const auto written = (*writer)->write_true_step(step); !written) return written.failure();
  for (const StampedPose& pose : recording.truth)
    if (const auto written = (*writer)->write_truth(pose); !written) return written.failure();
  for (const TrueState& state : recording.true_states)
    if (const auto written = (*writer)->write_true_state(state); !written) return written.failure();
  for (const TrueSkyline& skyline : recording.true_skylines)
    if (const auto written = (*writer)->write_true_skyline(skyline); !written) return written.failure();
  for (const TrueSighting& sighting : recording.true_sightings)
    if (const auto written = (*writer)->write_true_sighting(sighting); !written) return written.failure();
  return (*writer)->finish();
}

Result<StampedPoses> read_track(const fs::path& input) {
  std::error_code error;
  if (fs::is_directory(input, error) && fs::exists(input / "trajectory.tum", error))
    return read_tum(track_of_run(input));
  return read_poses(input);
}

void print_lost_pictures(uint64_t lost) {
  if (lost > 0) std::fprintf(stderr, "%zu pictures cannot be read; their frames are skipped\n", size_t(lost));
}

int convert_to_recording(const ConvertArguments& a) {
  const auto recording = open_recording(a.input, a.reading);
  if (!recording) return print_failure(recording.failure());
  RecordingLoss loss = recording->loss;
  if (const auto done = to_recording(*recording, a.output, a.pgm ? std::optional(-1) : a.jpeg_quality, loss.pictures);
      !done)
    return print_failure(done.failure());
  print_lost_pictures(loss.pictures);
  std::printf("%s: %s, %zu messages, %zu true poses\n", a.output.c_str(), recording->format.c_str(),
              recording->messages.size() - static_cast<size_t>(loss.pictures), recording->truth.size());
  return exit_status(loss, kDone);
}

int convert_to_euroc(const ConvertArguments& a) {
  const auto recording = open_recording(a.input, a.reading);
  if (!recording) return print_failure(recording.failure());
  RecordingLoss loss = recording->loss;
  Result<EurocWritten> done = Failure{};
  {
    Progress progress("convert");
    done = write_euroc(*recording, a.output, [&](size_t i, size_t n) { progress.show(i, n); });
  }
  if (!done) return print_failure(done.failure());
  loss.pictures = done->pictures_lost;
  print_lost_pictures(loss.pictures);
  if (!done->left_out.empty())
    std::fprintf(stderr, "skipped, because EuRoC/ASL cannot represent it: %s\n", done->left_out.c_str());
  std::printf("%s: EuRoC/ASL, %zu messages, %zu true states\n", a.output.c_str(), done->messages, done->true_states);
  return exit_status(loss, kDone);
}

/// Origin of a track's frame: as given, or from the run's summary.json.
Result<Origin> origin_of(const ConvertArguments& a) {
  std::error_code error;
  const fs::path input = a.input;
  if (a.origin.empty())
    return origin_in_summary((fs::is_directory(input, error) ? input : input.parent_path()) / "summary.json");
  std::array<double, 3> origin{};
  const auto parts = split(a.origin, ',');
  if (parts.size() != 3)
    return Failure{ODO_E_ARGUMENT, "--origin: expected LATITUDE,LONGITUDE,HEIGHT in degrees and metres"};
  for (size_t i = 0; i < 3; ++i) {
    const auto number = parse_quantity(parts[i], "");
    if (!number) return Failure{ODO_E_ARGUMENT, "--origin: '" + parts[i] + "'; expected a number"};
    origin[i] = *number * (i < 2 ? EIGEN_PI / 180 : 1.0);
  }
  return Origin(origin);
}

/// MCAP, COLMAP, transforms.json: poses with their sensor data.
int convert_with_pictures(const ConvertArguments& a) {
  auto run = read_exported_run(a.input, a.recording, a.reading);
  if (!run) return print_failure(run.failure());
  for (const std::string& warning : run->recording.warnings) std::fprintf(stderr, "%s\n", printable(warning).c_str());
  const fs::path output = a.output;
  if (const auto origin = origin_of(a); !origin)
    return print_failure(origin.failure());
  else
    run->origin = *origin;
  Result<Exported> done = Failure{};
  {
    Progress bar("convert");
    const auto progress = [&](size_t i, size_t n) { bar.show(i, n); };
    done = output.extension() == ".mcap"     ? write_foxglove(*run, output, progress)
           : output.extension() == ".colmap" ? write_colmap(*run, output, a.every_s, progress)
                                             : write_transforms(*run, output, a.every_s, progress);
  }
  if (!done) return print_failure(done.failure());
  RecordingLoss loss = run->recording.loss;
  loss.pictures = done->pictures_lost;
  print_lost_pictures(loss.pictures);
  if (done->without_pose > 0)
    std::fprintf(stderr, "%zu pictures have no pose at their time and are skipped\n", done->without_pose);
  std::printf("%s: %zu poses, %zu pictures\n", a.output.c_str(), done->poses, done->pictures);
  return exit_status(loss, kDone);
}

/// Converts Kalibr's camchain to camera.yaml.
int convert_camera(const ConvertArguments& a) {
  const auto camera = read_camchain(a.input);
  if (!camera) return print_failure(camera.failure());
  if (const auto written = write_whole_file(a.output, camera_yaml(*camera)); !written)
    return print_failure(written.failure());
  std::printf("%s: camera of %u x %u\n", a.output.c_str(), camera->width, camera->height);
  return kDone;
}

int convert(const ConvertArguments& a) {
  const fs::path input = a.input, output = a.output;
  if (output.extension() == ".odo") return convert_to_recording(a);
  if (output.extension() == ".yaml") return convert_camera(a);
  if (output.extension() == ".mcap" || output.extension() == ".colmap" || output.filename() == "transforms.json")
    return convert_with_pictures(a);
  if (output.extension().empty()) return convert_to_euroc(a);
  int status = kDone;
  auto track = read_track(input);
  if (!track) {
    std::error_code error;
    const auto recording = open_recording(input);
    if (!recording || recording->truth.empty())
      return print_failure(!fs::is_directory(input, error) ? track.failure()
                           : recording
                               ? Failure{ODO_E_DATA, a.input + ": no truth in it; convert a run's folder"}
                               : Failure{ODO_E_DATA, a.input + ": not the folder of a run (no trajectory.tum in it)"});
    track = recording->truth;
    status = exit_status(recording->loss, kDone);
  }
  const auto origin = origin_of(a);
  if (!origin) return print_failure(origin.failure());
  ToGeodetic to_geodetic;
  if (*origin) {
    const auto geodesy = std::make_shared<Geodesy>();
    geodesy->set_origin(**origin);
    to_geodetic = [geodesy](const Eigen::Vector3d& p) { return geodesy->to_geodetic({p.x(), p.y(), p.z()}); };
  }
  const auto written = write_trajectory(output, *track, to_geodetic);
  if (!written) return print_failure(written.failure());
  std::printf("%s: %zu poses\n", a.output.c_str(), track->size());
  const bool on_map = to_geodetic && (output.extension() == ".gpx" || output.extension() == ".kml");
  if (on_map && !track->empty() && !is_unix_time(track->front().t_ns))
    std::fprintf(stderr, "%s: without times: the recording's clock is not Unix time\n", a.output.c_str());
  return status;
}

}  // namespace

void add_convert(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "convert",
      "Convert a recording to *.odo or an EuRoC/ASL folder, a track to TUM, KITTI, CSV, GPX, KML or "
      "GeoJSON, a run with its pictures to MCAP, COLMAP or transforms.json, or Kalibr's camchain to camera.yaml");
  auto a = std::make_shared<ConvertArguments>();
  command->add_option("input", a->input, "recording, track, or folder of a run")->required();
  command
      ->add_option(
          "output", a->output,
          "its extension selects the format: .odo, .tum, .kitti, .csv, .gpx, .kml, .geojson, .mcap, .colmap (a "
          "folder), transforms.json (with images/ beside it), .yaml (from Kalibr's camchain); none: EuRoC/ASL folder")
      ->required();
  command->add_option("--origin", a->origin,
                      "origin of the track's frame, for GPX, KML and GeoJSON: LATITUDE,LONGITUDE,HEIGHT (degrees, "
                      "metres); default: from the run's summary.json");
  command->add_option("--recording", a->recording,
                      "recording of a run's track, if it is no longer at the path in summary.json");
  command->add_option("--every", a->every_s, "COLMAP and transforms.json: time between pictures, s; 0: all")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--jpeg", a->jpeg_quality,
                   "re-encode pictures as JPEG of this quality; 0: as PNG, lossless; default: copy them unchanged "
                   "(frames of a video become PNG)")
      ->check(CLI::Range(0, 100));
  command->add_flag("--pgm", a->pgm, "re-encode pictures as grey PGM, which needs no library to read (samples/walk)")
      ->excludes("--jpeg");
  command->add_flag("--pictures-outside", a->reading.pictures_outside,
                    "read pictures outside of the recording's folder too");
  command->callback([a, &status] { status = convert(*a); });
}

}  // namespace odograph
