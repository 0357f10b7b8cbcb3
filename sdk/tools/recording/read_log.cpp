// SPDX-License-Identifier: Apache-2.0
//
// A recording from a ROS 1 bag or an MCAP file: one topic per sensor, the camera's lens and mount, pictures on demand.
#include <algorithm>
#include <map>
#include <set>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/frame_loan.hpp"
#include "sdk/tools/recording/log_messages.hpp"
#include "sdk/tools/recording/phone_camera.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr size_t kMaxNamed = 12;  // topics listed in a message
constexpr int kMaxDepth = 100;    // of the transform tree

/// The pictures of a log, by number.
class LoggedPictures : public PictureStore {
 public:
  std::shared_ptr<MessageLog> log;
  LogTopic topic;
  std::vector<LogPlace> places;

  Result<LoggedMessage::Picture> picture(uint64_t number) {
    if (number >= places.size()) return Failure{ODO_E_DATA, log->path().string() + ": no such picture"};
    const auto bytes = log->at(places[number]);
    if (!bytes) return bytes.failure();
    auto message = decode_logged(topic, *bytes, true);
    if (!message || !message->picture)
      return Failure{ODO_E_DATA, log->path().string() + ": a picture of " + topic.name + " is damaged"};
    return std::move(*message->picture);
  }
  Result<odo_frame> load(uint64_t number, const odo_frame& frame) override {
    const auto found = picture(number);
    if (!found) return found.failure();
    return borrow_image(image_of(*found), frame, log->path().string() + ": " + topic.name);
  }
  std::vector<unsigned char> encoded(uint64_t number) override {
    auto found = picture(number);
    return found && found->encoding.empty() ? std::move(found->bytes) : std::vector<unsigned char>();
  }
};

/// The messages of one topic.
struct Topic {
  LogTopic topic;
  uint32_t type = 0;  // of its messages; ODO_TYPE_FRAME: pictures
  std::string frame;  // coordinate frame
  std::vector<StoredMessage> messages;
  std::vector<std::pair<int64_t, LogPlace>> pictures;
  size_t gyro = 0, accel = 0, damaged = 0;
  std::string unknown_encoding, lens_fault;
  size_t size() const { return messages.size() + pictures.size(); }
};

class LogReading {
 public:
  explicit LogReading(const fs::path& path) { recording_.path = path; }

  Result<Recording> run() {
    const auto log = MessageLog::read(recording_.path, [this](const auto&... message) { return take(message...); });
    if (!log) return log.failure();
    recording_.format = (*log)->format();
    if (!(*log)->flaw().empty()) warn((*log)->flaw());
    if (const auto done = add_inertial(); !done) return done.failure();
    for (const uint32_t type : {ODO_TYPE_MAGNETOMETER, ODO_TYPE_BAROMETER, ODO_TYPE_GNSS})
      if (const Topic* most = busiest(type))
        for (const StoredMessage& m : most->messages) recording_.add(m.header());
    if (const auto done = add_camera(*log); !done) return done.failure();
    if (recording_.messages.empty()) return wrong("no topic in it that is read; it has " + list_of_topics(false));
    warn_of_skipped();
    recording_.sort();
    return std::move(recording_);
  }

 private:
  Failure wrong(const std::string& text) const { return {ODO_E_DATA, recording_.path.string() + ": " + text}; }
  void warn(const std::string& text) { recording_.warnings.push_back(text); }

  Result<bool> take(const LogTopic& topic, int64_t logged_ns, LogPlace place, Bytes bytes) {
    Topic& t = topics_[topic.name];
    t.topic = topic;
    if (!unsupported_reason(topic).empty()) return true;
    auto message = decode_logged(topic, bytes, false);
    if (!message) {
      ++t.damaged;
      return true;
    }
    for (auto& transform : message->transforms) parents_.try_emplace(transform.child, transform);
    if (!message->frame.empty()) t.frame = message->frame;
    const int64_t t_ns = message->t_ns != 0 ? message->t_ns : logged_ns;
    if (message->picture) {
      t.type = ODO_TYPE_FRAME;
      if (!is_supported_encoding(message->picture->encoding)) t.unknown_encoding = message->picture->encoding;
      t.pictures.emplace_back(t_ns, place);
      return true;
    }
    if (!message->lens_fault.empty()) {
      t.type = ODO_TYPE_CALIBRATION, t.lens_fault = message->lens_fault;
      return true;
    }
    odo_header& header = message->message.header();
    if (header.type == 0) return true;
    header.t_ns = t_ns;
    t.type = header.type;
    if (t.type == ODO_TYPE_IMU)
      t.gyro += (header.flags & ODO_IMU_GYRO) != 0, t.accel += (header.flags & ODO_IMU_ACCEL) != 0;
    if (t.type == ODO_TYPE_CALIBRATION && !t.messages.empty()) return true;  // it is repeated with every picture
    t.messages.emplace_back();
    t.messages.back().assign(header);
    return true;
  }

  /// The topic of a type with the most messages.
  template <class Count>
  Topic* most(uint32_t type, Count count) {
    Topic* best = nullptr;
    for (auto& [name, t] : topics_)
      if (t.type == type && count(t) > 0 && (!best || count(t) > count(*best))) best = &t;
    if (best) used_.insert(best->topic.name);
    return best;
  }
  Topic* busiest(uint32_t type) {
    return most(type, [](const Topic& t) { return t.size(); });
  }

  /// Both sensors from one topic, or from separate topics.
  Result<bool> add_inertial() {
    Topic* gyro = most(ODO_TYPE_IMU, [](const Topic& t) { return t.gyro; });
    if (!gyro) return true;
    Topic* accel = gyro->accel > 0 ? gyro : most(ODO_TYPE_IMU, [](const Topic& t) { return t.accel; });
    imu_frame_ = gyro->frame;
    for (const StoredMessage& m : gyro->messages) recording_.add(m.header());
    if (accel && accel != gyro)
      for (const StoredMessage& m : accel->messages) recording_.add(m.header());
    if (!accel) warn(gyro->topic.name + ": no accelerations in it");
    return true;
  }

  Result<bool> add_camera(const std::shared_ptr<MessageLog>& log) {
    Topic* camera = busiest(ODO_TYPE_FRAME);
    if (!camera) {
      warn("no pictures: the track is from steps and inertia only");
      return true;
    }
    if (!camera->unknown_encoding.empty())
      return wrong(camera->topic.name + ": pictures encoded as '" + camera->unknown_encoding.substr(0, 40) +
                   "'; expected mono8, rgb8, bgr8, rgba8, bgra8, bayer_*8, yuv422, JPEG or PNG");
    const auto store = std::make_shared<LoggedPictures>();
    store->log = log, store->topic = camera->topic;
    std::stable_sort(camera->pictures.begin(), camera->pictures.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [t_ns, place] : camera->pictures) store->places.push_back(place);
    Result<odo_frame> first = Failure{ODO_E_DATA, ""};
    for (size_t i = 0; i < store->places.size() && !first; ++i)
      first = store->load(i, make_message<odo_frame>(ODO_TYPE_FRAME, 0));
    if (!first) return first.failure();
    first->loan.release(first->loan.owner);
    auto lens = lens_of(*camera, first->width, first->height);
    if (!lens) return lens.failure();
    int64_t begin_ns = camera->pictures.front().first;
    for (const RecordedMessage& m : recording_.messages) begin_ns = std::min(begin_ns, m.message.header().t_ns);
    lens->header.t_ns = begin_ns;
    recording_.add(lens->header);
    for (size_t i = 0; i < store->places.size(); ++i)
      recording_.add(make_message<odo_frame>(ODO_TYPE_FRAME, camera->pictures[i].first).header,
                     PictureRef{.offset = i, .store = store});
    return true;
  }

  /// Lens from camera.yaml or Kalibr's camchain beside the file, from the CameraInfo with the most similar name and
  /// transforms, or guessed.
  Result<odo_calibration> lens_of(const Topic& camera, uint32_t width, uint32_t height) {
    const auto files = phone::files_of(recording_.path.parent_path().empty() ? "." : recording_.path.parent_path(), {});
    auto facts = phone::camera_facts(files, recording_.warnings);
    if (!facts) return facts.failure();
    if (!facts->has_lens) {
      const auto shared = [&](const std::string& name) {
        const auto& own = camera.topic.name;
        return std::mismatch(own.begin(), own.end(), name.begin(), name.end()).first - own.begin();
      };
      const Topic* nearest = nullptr;
      for (const auto& [name, t] : topics_)
        if (t.type == ODO_TYPE_CALIBRATION && (!nearest || shared(name) > shared(nearest->topic.name))) nearest = &t;
      if (nearest && !nearest->lens_fault.empty()) return wrong(nearest->topic.name + ": " + nearest->lens_fault);
      if (nearest) {
        facts->calibration = copy_as<odo_calibration>(nearest->messages.front().header());
        facts->has_lens = true, facts->lens_from = recording_.path.string() + ": " + nearest->topic.name;
        used_.insert(nearest->topic.name);
      }
    }
    if (!facts->has_mount) set_mount(camera.frame, *facts);
    return phone::calibration_of(*facts, nullptr, width, height, recording_);
  }

  void set_mount(const std::string& camera_frame, phone::CameraFacts& facts) const {
    const auto to_root = [&](std::string frame) {
      std::pair<std::string, Eigen::Isometry3d> at{frame, Eigen::Isometry3d::Identity()};
      for (int depth = 0; depth < kMaxDepth; ++depth) {
        const auto found = parents_.find(at.first);
        if (found == parents_.end()) break;
        const auto& [parent, child, q, p] = found->second;
        at = {parent, Eigen::Translation3d(p) * q * at.second};
      }
      return at;
    };
    if (camera_frame.empty() || imu_frame_.empty() || (parents_.empty() && camera_frame != imu_frame_)) return;
    const auto [camera_root, T_r_c] = to_root(camera_frame);
    const auto [imu_root, T_r_b] = to_root(imu_frame_);
    if (camera_root != imu_root || camera_frame == imu_frame_)
      return;  // the same frame for both sensors carries no information
    const Eigen::Isometry3d T_b_c = T_r_b.inverse() * T_r_c;
    put_quaternion(Eigen::Quaterniond(T_b_c.linear()).normalized(), facts.calibration.q_b_c);
    Eigen::Vector3d::Map(facts.calibration.p_b_c) = T_b_c.translation();
    facts.calibration.header.flags |= ODO_CALIBRATION_EXTRINSICS;
    facts.has_mount = true;
  }

  std::string list_of_topics(bool only_unused) const {
    std::string out;
    size_t named = 0, more = 0;
    for (const auto& [name, t] : topics_) {
      if (only_unused && (used_.contains(name) || t.type == ODO_TYPE_CALIBRATION ||
                          t.topic.type == "tf2_msgs/TFMessage" || t.topic.type == "foxglove.FrameTransform"))
        continue;
      if (++named > kMaxNamed) {
        ++more;
        continue;
      }
      const std::string why = unsupported_reason(t.topic);
      out += (out.empty() ? "" : ", ") + name + " (" + t.topic.type + (why.empty() ? "" : ", " + why) + ")";
    }
    if (more > 0) out += " and " + std::to_string(more) + " more";
    return out.empty() ? "no topic" : out;
  }

  void warn_of_skipped() {
    for (const auto& [name, t] : topics_)
      if (t.damaged > 0) warn(name + ": " + std::to_string(t.damaged) + " messages are damaged and skipped");
    if (const std::string left = list_of_topics(true); left != "no topic") warn("skipped: " + left);
  }

  Recording recording_;
  std::map<std::string, Topic> topics_;
  std::map<std::string, LoggedMessage::Transform> parents_;  // by child frame
  std::set<std::string> used_;
  std::string imu_frame_;
};

}  // namespace

Result<Recording> read_log(const fs::path& file) { return LogReading(file).run(); }

}  // namespace odograph
