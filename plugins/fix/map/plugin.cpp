// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "plugins/fix/map/place_session.hpp"
#include "plugins/fix/map/places_extension.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace {

using namespace odograph::place_map;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Recognises places: of this session (loops), and of the maps of earlier ones.
class Map {
 public:
  double interval = PlaceSession::Parameters().interval_s, delay = PlaceSession::Parameters().delay_s,
         apart = PlaceSession::Parameters().apart_s, map_sigma = 0.03, map_yaw_sigma = 0.01, largest = 60;

  static constexpr odo::Description description{"fix/map", "1.0.0",
                                                "Map of landmarks that recognises places: loops, and maps of earlier "
                                                "sessions",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_KEY_FRAME, ODO_TYPE_MAP_POSE};
  static std::vector<odo::Parameter<Map>> parameters() {
    return {odo::real("interval", "s", 0.1, 60, &Map::interval, "between two pictures that are looked up"),
            odo::real("delay", "s", 0.1, 10, &Map::delay, "from a picture to its result, on a thread of its own"),
            odo::real("apart", "s", 5, 3600, &Map::apart, "smallest time between a picture and what it recognises"),
            odo::real("map_sigma", "m", 0.001, 10, &Map::map_sigma,
                      "standard deviation of a loaded map itself; that of a flat walked once"),
            odo::real("map_yaw_sigma", "rad", 0.0001, 0.5, &Map::map_yaw_sigma, "the same of its heading"),
            odo::real("largest", "", 1, 250, &Map::largest, "size of a saved map in MB; beyond it, it is thinned")};
  }

  void configured(odo::Output& host) {
    static constexpr std::string_view id = ODO_SERVICE_RUN;
    const auto* run = static_cast<const odo_run_service*>(
        host.host()->get_service ? host.host()->get_service(host.host(), id.data(), id.size()) : nullptr);
    is_live_ = run && run->is_live;
    output_ = host;
    extension_.emplace(host);
    reset();
  }
  void reset() {
    PlaceSession::Parameters p;
    p.interval_s = interval, p.delay_s = delay, p.apart_s = apart;
    session_ = std::make_unique<PlaceSession>(PlaceMapParameters(), p, is_live_);
    landmarks_.clear(), landmarks_ns_ = INT64_MIN;
    pose_ = {}, pose_.header.t_ns = INT64_MIN;
    camera_ = {};
    for (Waiting& waiting : waiting_) waiting.t_ns = INT64_MIN;
  }

  void on(const odo_calibration& c, odo::Output&) {
    camera_.take(c);
    T_b_c_ = {odograph::rear_camera_mount(), Vector3d::Zero()};
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) T_b_c_ = {odograph::quaternion(c.q_b_c), Vector3d(c.p_b_c)};
  }

  void on(const odo_points& points, odo::Output&) {
    constexpr uint32_t kYoungest = 3;  // frames; two rays fit any wrong match
    landmarks_.clear();
    landmarks_ns_ = points.header.t_ns, epoch_ = points.scale_group;
    for (uint32_t i = 0; i < points.count; ++i) {
      const odo_point* point = ODO_POINTS_AT(&points, i);
      if (!point) break;
      if ((point->flags & (ODO_POINT_UNCERTAIN | ODO_POINT_LOST)) != 0 || point->age < kYoungest) continue;
      const float* c = point->covariance;
      Eigen::Matrix3f covariance;
      covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
      landmarks_.push_back({point->id, Eigen::Vector3f(point->p_c).cast<double>(), covariance.cast<double>(),
                            Eigen::Vector2f(point->pixel).cast<double>()});
    }
  }

  void on(const odo_pose& pose, odo::Output& output) {
    constexpr uint32_t needed = ODO_POSE_ORIENTATION | ODO_POSE_CAMERA;
    if ((pose.header.flags & needed) != needed || (pose.header.flags & ODO_POSE_EXTRAPOLATED) != 0) return;
    pose_ = pose;
    for (const Waiting& waiting : waiting_)
      if (waiting.t_ns == pose.header.t_ns) return see(waiting, output);
  }

  void on(const odo_correction& correction, odo::Output&) {
    session_->correct({odograph::quaternion(correction.q_n), Vector3d(correction.p_n)});
  }

  /// A recognised place has moved it.
  void on(const odo_key_frame& frame, odo::Output& output) {
    if (frame.header.source != output.instance() || (frame.header.flags & ODO_FLAG_NAVIGATION) == 0) return;
    const Rigid T_n_b{odograph::quaternion(frame.q_n_b), Vector3d(frame.p_n_b)};
    session_->move(frame.header.t_ns, T_n_b * T_b_c_);
  }

  /// The pose of a frame precedes it, or follows within some frames where the front-end waits for inertial samples.
  void on(const odo_frame& frame, odo::Output& output) {
    Waiting& waiting = waiting_[next_++ % waiting_.size()];
    waiting.t_ns = frame.header.t_ns, waiting.camera = frame.header.source;
    waiting.lens = camera_.lens_of(frame);
    odograph::grey_of(frame, converted_).copyTo(waiting.grey);
    if (pose_.header.t_ns == waiting.t_ns) see(waiting, output);
    for (const Found& found : session_->take(waiting.t_ns)) emit(found, output);
  }

  std::vector<uint8_t> save_map() const {
    const PlaceSession::Saved saved = session_->save(static_cast<size_t>(largest * 1e6));
    if (!saved.has_own)
      output_.report(ODO_SEVERITY_WARNING, "map_not_recognised",
                     "the loaded map was not recognised in this session: it is saved as it was, without what this "
                     "session has seen and without its new anchors");
    if (saved.left_out > 0)
      output_.report(ODO_SEVERITY_WARNING, "maps_left_out",
                     "loaded maps that were not recognised in this session are not in the saved one: keep their files");
    return saved.id == 0 ? std::vector<uint8_t>() : with_id(saved.id, saved.bytes);
  }

  void load_map(const uint8_t* data, size_t size) {
    const std::span<const uint8_t> bytes(data, size);
    const uint64_t id = id_of(bytes);
    if (const auto why = session_->load(id, bytes.subspan(8))) throw odo::Error(ODO_E_DATA, *why);
  }

  const void* extension(std::string_view id) const {
    return id == ODO_EXTENSION_PLACES && extension_ ? extension_->table() : nullptr;
  }

 private:
  /// A frame that waits for its pose.
  struct Waiting {
    int64_t t_ns = INT64_MIN;
    uint32_t camera = 0;
    odograph::CameraModel lens;
    cv::Mat grey;
  };

  void see(const Waiting& frame, odo::Output& output) {
    Sight sight;
    const Rigid T_n_c{odograph::quaternion(pose_.q_n), Vector3d(pose_.p_n)};
    sight.picture.t_ns = frame.t_ns;
    sight.picture.grey = frame.grey;
    sight.picture.lens = frame.lens;
    sight.picture.down_c = T_n_c.q.conjugate() * Vector3d::UnitZ();
    sight.picture.tilt_sigma_rad = std::sqrt(std::max(pose_.covariance[0], pose_.covariance[7]));
    sight.T_n_c = T_n_c;
    constexpr uint32_t placed = ODO_POSE_POSITION | ODO_POSE_METRIC;
    sight.is_placed = (pose_.header.flags & placed) == placed;
    const bool metric = sight.is_placed && pose_.scale > 0 && pose_.scale_sigma > 0;
    sight.is_metric = metric;
    const double scale_sigma = metric ? pose_.scale_sigma / pose_.scale : 1;
    if (metric && pose_.state == ODO_TRACKING && landmarks_ns_ == frame.t_ns) {
      sight.scale_sigma = scale_sigma, sight.epoch = epoch_;
      sight.landmarks = landmarks_;
      for (Landmark& landmark : sight.landmarks)
        landmark.p_c *= pose_.scale, landmark.covariance *= pose_.scale * pose_.scale;
    }
    const auto count = static_cast<uint32_t>(sight.landmarks.size());
    if (!session_->see(std::move(sight))) return;
    auto key_frame = odo::make<odo_key_frame>(frame.t_ns);
    key_frame.id = ++key_frames_, key_frame.camera = frame.camera, key_frame.landmarks = count;
    output.emit(key_frame);
  }

  void emit(const Found& found, odo::Output& output) const {
    // From cameras to bodies: of the key frame and the picture, or of the picture alone.
    const Rigid outer = found.map == 0 ? T_b_c_ : Rigid();
    const Rigid T_x_b = outer * found.T_x_c * T_b_c_.inverse();
    const Vector3d lever = T_x_b.p - (outer * found.T_x_c).p;
    Eigen::Matrix<double, 6, 6> by = Eigen::Matrix<double, 6, 6>::Zero();
    by.topLeftCorner<3, 3>() = by.bottomRightCorner<3, 3>() = outer.q.toRotationMatrix();
    by.bottomLeftCorner<3, 3>() = -odograph::skew(lever) * outer.q.toRotationMatrix();
    const Eigen::Matrix<double, 6, 6> covariance = by * found.covariance * by.transpose();
    if (found.map == 0) {
      auto loop = odo::make<odo_relative_pose>(found.t_ns);
      loop.header.flags = ODO_RELATIVE_POSE_TRANSLATION | ODO_RELATIVE_POSE_ROTATION;
      loop.t_from_ns = found.key_frame_ns;
      put(T_x_b, covariance, loop.q_b0_b1, loop.p_b0_b1, loop.covariance);
      output.emit(loop);
      return;
    }
    auto place = odo::make<odo_map_pose>(found.t_ns);
    place.map = found.map, place.map_sigma_m = map_sigma, place.map_sigma_rad = map_yaw_sigma;
    put(T_x_b, covariance, place.q_m_b, place.p_m_b, place.covariance);
    output.emit(place);
  }

  static void put(const Rigid& T, const Eigen::Matrix<double, 6, 6>& covariance, double* q, double* p, double* c) {
    odograph::put_quaternion(T.q, q);
    Vector3d::Map(p) = T.p;
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> out(c);
    out = 0.5 * (covariance + covariance.transpose());
  }

  bool is_live_ = false;
  odo::Output output_;  // for reports
  std::unique_ptr<PlaceSession> session_;
  std::optional<PlacesExtension> extension_;
  odograph::CalibratedCamera camera_;
  Rigid T_b_c_;
  std::vector<Landmark> landmarks_;  // of the newest frame, in units of the front-end
  int64_t landmarks_ns_ = INT64_MIN;
  uint32_t epoch_ = 0;
  std::array<Waiting, 4> waiting_;
  size_t next_ = 0;
  odo_pose pose_{};
  uint64_t key_frames_ = 0;
  cv::Mat converted_;
};

}  // namespace

ODO_PLUGIN(Map)
