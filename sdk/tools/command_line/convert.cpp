// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/spec.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/recording/odo_file.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct ConvertArguments {
  std::string input, output, origin;
  int jpeg_quality = 0;
  ReadOptions reading;
};

/// Writes all that there is. Pictures that cannot be read cost their frames; they are counted in `lost`.
Result<bool> to_recording(const Recording& recording, const fs::path& output, int jpeg_quality, uint64_t& lost) {
  auto writer = OdoWriter::create(output, jpeg_quality);
  if (!writer) return writer.failure();
  Progress progress("convert");
  size_t done = 0;
  for (const RecordedMessage& m : recording.messages) {
    progress.show(++done, recording.messages.size());
    if (m.message.header().type != ODO_TYPE_FRAME) {
      if (const auto written = (*writer)->write(m.message.header()); !written) return written.failure();
      continue;
    }
    const auto frame = load_frame(m);
    if (!frame) {
      if (lost++ == 0) std::fprintf(stderr, "%s\n", printable(frame.failure().text).c_str());
      continue;
    }
    const auto written = (*writer)->write(frame->header);
    frame->loan.release(frame->loan.owner);
    if (!written) return written.failure();
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

Result<Trajectory> read_track(const fs::path& input) {
  std::error_code error;
  if (fs::is_directory(input, error) && fs::exists(input / "trajectory.tum", error))
    return read_tum(input / "trajectory.tum");
  if (input.extension() == ".csv") return read_euroc_truth(input);
  auto kitti = read_kitti_poses(input, {});
  return kitti ? std::move(kitti) : read_tum(input);
}

void say_pictures(uint64_t lost) {
  if (lost > 0) std::fprintf(stderr, "%zu pictures cannot be read; their frames are left out\n", size_t(lost));
}

int convert_to_recording(const ConvertArguments& a) {
  const auto recording = open_recording(a.input, a.reading);
  if (!recording) return complain(recording.failure());
  RecordingLoss loss = recording->loss;
  if (const auto done = to_recording(*recording, a.output, a.jpeg_quality, loss.pictures); !done)
    return complain(done.failure());
  say_pictures(loss.pictures);
  std::printf("%s: %s, %zu messages, %zu true poses\n", a.output.c_str(), recording->format.c_str(),
              recording->messages.size() - static_cast<size_t>(loss.pictures), recording->truth.size());
  return status_over(loss, kDone);
}

int convert_to_euroc(const ConvertArguments& a) {
  const auto recording = open_recording(a.input, a.reading);
  if (!recording) return complain(recording.failure());
  RecordingLoss loss = recording->loss;
  Result<EurocWritten> done = Failure{};
  {
    Progress progress("convert");
    done = write_euroc(*recording, a.output, [&](size_t i, size_t n) { progress.show(i, n); });
  }
  if (!done) return complain(done.failure());
  loss.pictures = done->pictures_lost;
  say_pictures(loss.pictures);
  if (!done->left_out.empty())
    std::fprintf(stderr, "left out, because EuRoC/ASL has no place for it: %s\n", done->left_out.c_str());
  std::printf("%s: EuRoC/ASL, %zu messages, %zu true states\n", a.output.c_str(), done->messages, done->true_states);
  return status_over(loss, kDone);
}

int convert(const ConvertArguments& a) {
  const fs::path input = a.input, output = a.output;
  if (output.extension() == ".odo") return convert_to_recording(a);
  if (output.extension().empty()) return convert_to_euroc(a);
  int status = kDone;
  auto track = read_track(input);
  if (!track) {
    const auto recording = open_recording(input);
    if (!recording || recording->truth.empty()) return complain(track.failure());
    track = recording->truth;
    status = status_over(recording->loss, kDone);
  }
  auto geodesy = std::make_shared<Geodesy>();
  ToGeodetic to_geodetic;
  if (!a.origin.empty()) {
    const auto parts = split(a.origin, ',');
    if (parts.size() != 3)
      return complain({ODO_E_ARGUMENT, "--origin: expected LATITUDE,LONGITUDE,HEIGHT in degrees and metres"});
    std::array<double, 3> origin{};
    for (size_t i = 0; i < 3; ++i) {
      const auto number = parse_quantity(parts[i], "");
      if (!number) return complain({ODO_E_ARGUMENT, "--origin: '" + parts[i] + "'; expected a number"});
      origin[i] = *number * (i < 2 ? EIGEN_PI / 180 : 1.0);
    }
    geodesy->set_origin(origin);
    to_geodetic = [geodesy](const Eigen::Vector3d& p) { return geodesy->to_geodetic({p.x(), p.y(), p.z()}); };
  }
  const auto written = write_trajectory(output, *track, to_geodetic);
  if (!written) return complain(written.failure());
  std::printf("%s: %zu poses\n", a.output.c_str(), track->size());
  return status;
}

}  // namespace

void add_convert(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "convert",
      "Convert a recording to *.odo or an EuRoC/ASL folder, or a track to TUM, KITTI, CSV, GPX, KML, GeoJSON");
  auto a = std::make_shared<ConvertArguments>();
  command->add_option("input", a->input, "recording, track, or folder of a run")->required();
  command
      ->add_option("output", a->output,
                   "its ending says the format: .odo .tum .kitti .csv .gpx .kml .geojson; none: EuRoC/ASL folder")
      ->required();
  command->add_option("--origin", a->origin,
                      "of the track's frame, for GPX, KML and GeoJSON: LATITUDE,LONGITUDE,HEIGHT (degrees, metres)");
  command->add_option("--jpeg", a->jpeg_quality, "store pictures as JPEG of this quality; 0 = PNG, lossless")
      ->capture_default_str()
      ->check(CLI::Range(0, 100));
  command->add_flag("--pictures-outside", a->reading.pictures_outside,
                    "pictures may lie outside of the recording's folder");
  command->callback([a, &status] { status = convert(*a); });
}

}  // namespace odograph
