// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sdk/host/messages/messages.hpp"
#include "sdk/host/messages/record_file.hpp"
#include "sdk/tools/recording/stored_message.hpp"
#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

/// Source of pictures without files of their own: the frames of a video, the messages of a bag.
class PictureStore {
 public:
  virtual ~PictureStore() = default;
  /// Sets pixels, size, format and loan of a frame; the caller releases it once. [any]
  virtual Result<odo_frame> load(uint64_t number, const odo_frame& frame) = 0;
  /// The picture as PNG or JPEG if stored as such; empty otherwise. [any]
  virtual std::vector<unsigned char> encoded(uint64_t) { return {}; }
};

/// Location of a frame's picture: a file, a part of a file, or a number in a store.
struct PictureRef {
  std::shared_ptr<const std::filesystem::path> file;  // null: none, or a store's
  uint64_t offset = 0;                                // in the file; for a store, the picture's number
  uint32_t size = 0;                                  // 0: the whole file
  // Simulated lighting: grey levels g become gain 255 (g / 255)^gamma. A gain of 0 (covered camera) keeps only the
  // size.
  uint16_t gamma_percent = 100, gain_percent = 100;
  std::shared_ptr<PictureStore> store{};

  bool relit() const { return gamma_percent != 100 || gain_percent != 100; }
};

/// One message of a recording; a frame's picture is stored separately.
struct RecordedMessage {
  StoredMessage message;
  PictureRef picture;
};

/// True state of the body b at an IMU sample, from a simulator.
struct TrueState {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< from b to n
  Eigen::Vector3d p, v;                                   ///< in n, m and m/s
  Eigen::Vector3d gyro_bias, accel_bias;                  ///< in b, rad/s and m/s^2
  uint32_t mode = 0;                                      ///< ODO_MODE_*
};

/// True skyline around the camera, from a simulator: for each direction from north to east, the elevation (rad) and
/// distance (m; 0: nothing) of the highest edge.
struct TrueSkyline {
  int64_t t_ns = 0;
  std::vector<float> elevation_rad, distance_m;
};

/// A known object in a frame, from a simulator.
struct TrueSighting {
  int64_t t_ns = 0;  ///< of the frame, true
  uint32_t tag = 0;
  float visible = 0;       ///< visible fraction
  double corners_px[8]{};  ///< x, y: lower left, lower right, upper right, upper left in reading orientation
};

/// Distance walked until a time, measured by a wheel.
struct TrueDistance {
  int64_t t_ns = 0;
  double walked_m = 0;
};

/// True floor at a time.
struct TrueFloor {
  int64_t t_ns = 0;
  int floor = 0;
};

/// Losses of a recording.
struct RecordingLoss {
  RecordLoss file;                  ///< of an Odograph recording
  uint64_t pictures = 0;            ///< missing or damaged, among those loaded; each costs its frame
  uint64_t times_out_of_range = 0;  ///< messages further from the clock's zero than kFarthestTime_ns, skipped
  uint64_t impossible = 0;          ///< messages that message_fault() refuses, skipped; the host would refuse them too
  std::string first_impossible;
  bool any() const { return file.any() || pictures > 0 || times_out_of_range > 0 || impossible > 0; }
};

/// Options for reading recordings.
struct ReadOptions {
  /// Allow picture names that lead out of the recording's folder. Off by default: an untrusted recording must not name
  /// local files.
  bool pictures_outside = false;
  /// Read the simulator's true states, 144 bytes per IMU sample.
  bool true_states = true;
  /// Keep events recorded by an app as messages; otherwise they are skipped, because a replay generates them.
  bool events = false;
};

/// A recording in memory, without its pictures. Messages are in time order.
struct Recording {
  std::string format;  // "EuRoC/ASL", ...
  std::filesystem::path path;
  std::vector<RecordedMessage> messages;
  StampedPoses truth;  // of the camera if there is one, otherwise of the body; may be empty
  /// The phone's own orientation, if recorded: q from b to n (magnetic north). For comparison only, not an input.
  std::vector<StampedPose> phone_attitudes;
  std::vector<odo_step> true_steps;
  std::vector<TrueDistance> true_distances;
  std::vector<TrueFloor> true_floors;
  std::vector<TrueState> true_states;
  std::vector<TrueSkyline> true_skylines;
  std::vector<TrueSighting> true_sightings;
  RecordingLoss loss;
  std::vector<std::string> warnings;  ///< missing data and assumptions
  /// Camera parameters that the reader guessed, which a calibration against the gyroscope may replace.
  struct Guesses {
    bool lens = false, mount = false, times = false;
    bool any() const { return lens || mount || times; }
  } guessed;
  std::shared_ptr<const void> keep{};  ///< the folder that it was unpacked into, needed by its pictures

  bool has(uint32_t type) const;
  std::vector<Waypoint> waypoints() const;  ///< in time order
  /// A message with an out-of-range time is counted and skipped.
  void add(const odo_header& message, PictureRef picture = {});
  /// Sorts the messages by time, stably.
  void sort();
};

/// Frame times on the IMU's clock, with the offset of the first calibration that has one.
std::vector<int64_t> frame_times_ns(const Recording& recording);

/// Detects the format by content and reads it: an Odograph recording (*.odo), EuRoC/ASL, TUM RGB-D, KITTI odometry,
/// ADVIO, an Indoor Location Competition trace (*.txt), a folder of numbered images with a camera.yaml, the formats of
/// read_walk(), a ROS 1 bag, MCAP, or a phone app's recording (docs/phone_recordings.md), as a folder or a zip of it.
/// Failures state file and line (ODO_E_DATA), or what was looked for (ODO_E_NOT_FOUND).
Result<Recording> read_recording(const std::filesystem::path& path, const ReadOptions& options = {});

Result<Recording> read_odo(const std::filesystem::path& file, const ReadOptions& options = {});
Result<Recording> read_euroc(const std::filesystem::path& folder, const ReadOptions& options = {});
Result<Recording> read_tum_rgbd(const std::filesystem::path& folder, const ReadOptions& options = {});
Result<Recording> read_kitti(const std::filesystem::path& folder);
Result<Recording> read_advio(const std::filesystem::path& folder);
Result<Recording> read_indoor_location(const std::filesystem::path& file);
/// A ROS 1 bag, or MCAP with sensor_msgs or Foxglove's schemas.
Result<Recording> read_log(const std::filesystem::path& file);
Result<Recording> read_image_folder(const std::filesystem::path& folder);
/// A walk of a published data set without a camera, recognised by its first line: RIDI (*.csv, one row per sample with
/// the truth), IPIN competitions (*.txt, GetSensorData), Oxford step counter (*_accelerometer.csv beside
/// *_stepcounter.csv), Malmo trundle wheel (*.csv). Nothing if it is none of these.
std::optional<Result<Recording>> read_walk(const std::filesystem::path& file);

/// Writes camera, IMU and, from a simulation, the true states as an EuRoC/ASL folder, with `camchain-imucam.yaml` and
/// `imu.yaml` in Kalibr's form beside `mav0`. Pictures become PNG; time stamps stay on the camera's clock (Kalibr's
/// file states the offset). Other sensors cannot be represented and are skipped; the result lists them. A folder that
/// already holds a recording is refused (ODO_E_ARGUMENT), because the files would mix.
struct EurocWritten {
  size_t messages = 0, true_states = 0;
  uint64_t pictures_lost = 0;
  std::string left_out;  ///< "120 magnetometer, 12 gnss", or empty
};
Result<EurocWritten> write_euroc(const Recording& recording, const std::filesystem::path& folder,
                                 const std::function<void(size_t, size_t)>& progress);

/// Loads a frame's picture and sets pixels, size and format. The result has retain and release, so that no copy is
/// needed; the caller releases it once.
Result<odo_frame> load_frame(const RecordedMessage& message);
/// The bytes of a picture stored as PNG or JPEG; empty if it is not, or must be modified.
std::vector<unsigned char> encoded_picture(const PictureRef& picture);

}  // namespace odograph
