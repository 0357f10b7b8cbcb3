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

/// Pictures that are no files of their own: the frames of a video, the messages of a bag.
class PictureStore {
 public:
  virtual ~PictureStore() = default;
  /// Fills in pixels, size, format and loan of a frame; the caller releases it once. [any]
  virtual Result<odo_frame> load(uint64_t number, const odo_frame& frame) = 0;
  /// The picture as PNG or JPEG where it is stored as one; empty otherwise. [any]
  virtual std::vector<unsigned char> encoded(uint64_t) { return {}; }
};

/// Where a camera frame's picture is: a file of its own, a part of one, or a number in a store.
struct PictureRef {
  std::shared_ptr<const std::filesystem::path> file;  // null: none, or a store's
  uint64_t offset = 0;                                // in the file; in a store the picture's number
  uint32_t size = 0;                                  // 0: the whole file
  // Other light than was recorded: grey levels g become gain 255 (g / 255)^gamma. Of a gain of 0, when something stood
  // before the camera, the size alone counts.
  uint16_t gamma_percent = 100, gain_percent = 100;
  std::shared_ptr<PictureStore> store{};

  bool relit() const { return gamma_percent != 100 || gain_percent != 100; }
};

/// One message of a recording; a frame has its picture apart.
struct RecordedMessage {
  StoredMessage message;
  PictureRef picture;
};

/// What a simulator knows of the body b at an IMU sample.
struct TrueState {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< from b to n
  Eigen::Vector3d p, v;                                   ///< in n, m and m/s
  Eigen::Vector3d gyro_bias, accel_bias;                  ///< in b, rad/s and m/s^2
  uint32_t mode = 0;                                      ///< ODO_MODE_*
};

/// Where the sky began around the camera, as a simulator knows it: of every direction from north to the east the
/// elevation (rad) and the distance (m; 0: nothing there) of the highest edge.
struct TrueSkyline {
  int64_t t_ns = 0;
  std::vector<float> elevation_rad, distance_m;
};

/// A known object in a frame, as a simulator knows it.
struct TrueSighting {
  int64_t t_ns = 0;  ///< of the frame, true
  uint32_t tag = 0;
  float visible = 0;       ///< part of it that nothing hides
  double corners_px[8]{};  ///< x, y: lower left, lower right, upper right, upper left as one reads it
};

/// How far somebody had walked at a time, as a wheel measured it.
struct TrueDistance {
  int64_t t_ns = 0;
  double walked_m = 0;
};

/// On which floor he was at a time.
struct TrueFloor {
  int64_t t_ns = 0;
  int floor = 0;
};

/// What a recording lacks of what it should hold.
struct RecordingLoss {
  RecordLoss file;          ///< of an Odograph recording
  uint64_t pictures = 0;    ///< that are missing or damaged, as far as they have been looked at; each costs its frame
  uint64_t wild_times = 0;  ///< messages further from the clock's zero than kFarthestTime_ns, left out
  uint64_t impossible = 0;  ///< messages that message_fault() refuses, left out; the host would not take them either
  std::string first_impossible;
  bool any() const { return file.any() || pictures > 0 || wild_times > 0 || impossible > 0; }
};

/// How recordings are read.
struct ReadOptions {
  /// A picture's name may lead out of the recording's folder. Off: nobody's recording gets to name our files.
  bool pictures_outside = false;
  /// What a simulator knows of the body is read too, which takes 144 bytes for each IMU sample.
  bool true_states = true;
  /// Events that an app recorded are messages too; without it they are left out, since a replay makes them anew.
  bool events = false;
};

/// A recording in memory, except for its pictures. Messages are in order of time.
struct Recording {
  std::string format;  // "EuRoC/ASL", ...
  std::filesystem::path path;
  std::vector<RecordedMessage> messages;
  Trajectory truth;  // of the camera where there is one, otherwise of the body; may be empty
  /// The phone's own orientation where its recording has one: q from b to n (magnetic north). No input, a comparison.
  std::vector<StampedPose> phone_attitudes;
  std::vector<odo_step> true_steps;
  std::vector<TrueDistance> true_distances;
  std::vector<TrueFloor> true_floors;
  std::vector<TrueState> true_states;
  std::vector<TrueSkyline> true_skylines;
  std::vector<TrueSighting> true_sightings;
  RecordingLoss loss;
  std::vector<std::string> warnings;  ///< what it lacks, and what had to be guessed
  /// What the reader had to guess of the camera: what a calibration against the gyroscope may replace.
  struct Guesses {
    bool lens = false, mount = false, times = false;
    bool any() const { return lens || mount || times; }
  } guessed;
  std::shared_ptr<const void> keep{};  ///< the folder that it was unpacked into, for as long as its pictures

  bool has(uint32_t type) const;
  std::vector<Waypoint> waypoints() const;  ///< in order of time
  /// A message with a wild time is counted and left out.
  void add(const odo_header& message, PictureRef picture = {});
  /// Puts the messages into order; equal times keep the order in which they were added.
  void sort();
};

/// When its frames were taken, on the IMU's clock as the first calibration with a time offset has it.
std::vector<int64_t> frame_times_ns(const Recording& recording);

/// Finds out by looking what it is, and reads it: an Odograph recording (*.odo), EuRoC/ASL, TUM RGB-D, KITTI odometry,
/// ADVIO, an Indoor Location Competition trace (*.txt), a folder of numbered images with a camera.yaml, what
/// read_walk() reads, a ROS 1 bag, MCAP, or what a phone's app has written (docs/phone_recordings.md), as a folder or a
/// zip of it.
/// Failures name file and line (ODO_E_DATA), or say what was looked for (ODO_E_NOT_FOUND).
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
/// A walk of a published data set without a camera, known by its first line: RIDI (*.csv, a row each sample with the
/// truth), IPIN competitions (*.txt, GetSensorData), Oxford step counter (*_accelerometer.csv beside
/// *_stepcounter.csv), Malmo trundle wheel (*.csv). Nothing where it is none of these.
std::optional<Result<Recording>> read_walk(const std::filesystem::path& file);

/// Writes camera, IMU and (of a simulation) the true states as an EuRoC/ASL folder, with `camchain-imucam.yaml` and
/// `imu.yaml` in Kalibr's form beside `mav0`. Pictures become PNG; time stamps stay the camera's own (Kalibr's file
/// says the offset). Other sensors have no place in that format and are left out; the result says which. A folder that
/// holds a recording already is refused (ODO_E_ARGUMENT): the files of two would mix.
struct EurocWritten {
  size_t messages = 0, true_states = 0;
  uint64_t pictures_lost = 0;
  std::string left_out;  ///< "120 magnetometer, 12 gnss", or empty
};
Result<EurocWritten> write_euroc(const Recording& recording, const std::filesystem::path& folder,
                                 const std::function<void(size_t, size_t)>& progress);

/// Loads a frame's picture and fills in pixels, size and format. The result carries retain and release, so nobody has
/// to copy it; the caller releases it once.
Result<odo_frame> load_frame(const RecordedMessage& message);
/// A picture that lies somewhere as PNG or JPEG, byte for byte; empty where it does not, or is to be another.
std::vector<unsigned char> encoded_picture(const PictureRef& picture);

}  // namespace odograph
