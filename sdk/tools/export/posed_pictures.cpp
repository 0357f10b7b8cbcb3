// SPDX-License-Identifier: Apache-2.0
//
// Pictures with poses, for 3-D reconstruction with COLMAP (colmap.github.io/format.html) and nerfstudio
// (docs.nerf.studio, "data conventions").
#include <fstream>
#include <iomanip>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/export/exported_run.hpp"
#include "sdk/tools/page/page_pictures.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr double kLargestTrackGap_s = 0.2;  // of the track around a picture

struct PosedPicture {
  std::string name;  // within images/
  StampedPose pose;  // of the camera, in n
};

class PosedPictures {
 public:
  PosedPictures(const ExportedRun& run, fs::path folder, double every_s)
      : run_(run), folder_(std::move(folder)), every_s_(every_s) {}

  Result<bool> write(const ExportProgress& progress) {
    const odo_calibration* lens = camera_of(run_.recording);
    if (!lens) return wrong("it has no camera");
    if (run_.track.empty()) return wrong("it has no poses; run it first, and convert the run's folder");
    lens_ = *lens;
    std::error_code error;
    if (fs::exists(folder_, error) && !fs::is_empty(folder_, error))
      return Failure{ODO_E_ARGUMENT, folder_.string() + ": has files in it already; expected another folder"};
    if (fs::create_directories(folder_, error); error)
      return Failure{ODO_E_IO, folder_.string() + ": cannot be created"};
    const auto frames = frames_of(run_.recording, lens);
    int64_t next_ns = INT64_MIN;
    for (size_t i = 0; i < frames.size(); ++i) {
      if (progress) progress(i + 1, frames.size());
      const int64_t t_ns = frames[i]->message.header().t_ns + lens_.time_offset_ns;
      if (t_ns < next_ns) continue;
      const auto pose = pose_at(run_.track, t_ns, kLargestTrackGap_s);
      if (!pose) {
        ++exported.without_pose;
        continue;
      }
      if (const auto done = write_picture(*frames[i], i, *pose); !done) return done.failure();
      next_ns = t_ns + nanoseconds(every_s_);
    }
    if (pictures.empty()) return wrong("no picture at whose time there is a pose");
    exported.pictures = exported.poses = pictures.size();
    return true;
  }

  const odo_calibration& lens() const { return lens_; }
  std::vector<PosedPicture> pictures;
  Exported exported;

 private:
  Failure wrong(const std::string& text) const { return {ODO_E_DATA, run_.recording.path.string() + ": " + text}; }

  Result<bool> write_picture(const RecordedMessage& message, size_t number, const StampedPose& pose) {
    const auto bytes = picture_as_file(message);
    if (!bytes) return bytes.failure();
    if (bytes->empty()) {
      ++exported.pictures_lost;
      return true;
    }
    const std::string name = text("%06zu.%s", number, bytes->front() == 0xFF ? "jpg" : "png");
    std::ofstream out(folder_ / name, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
    if (!out.flush()) return Failure{ODO_E_IO, folder_.string() + ": writing failed; is the disk full?"};
    pictures.push_back({name, pose});
    return true;
  }

  const ExportedRun& run_;
  fs::path folder_;
  double every_s_;
  odo_calibration lens_{};
};

/// Lens in COLMAP's convention: the first pixel's corner is 0.
void write_camera(std::ostream& out, const odo_calibration& c) {
  const bool fisheye = c.model == ODO_CAMERA_KANNALA_BRANDT, many = c.distortion_count > 4;
  out << "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 "
      << (fisheye ? "OPENCV_FISHEYE"
          : many  ? "FULL_OPENCV"
                  : "OPENCV")
      << ' ' << c.width << ' ' << c.height << ' ' << c.fx << ' ' << c.fy << ' ' << c.cx + 0.5 << ' ' << c.cy + 0.5;
  for (size_t i = 0; i < (many && !fisheye ? 8 : 4); ++i)
    out << ' ' << (i < c.distortion_count ? c.distortion[i] : 0.0);
  out << '\n';
}

/// World-to-camera poses, each followed by an empty line for the missing points.
void write_images(std::ostream& out, const std::vector<PosedPicture>& pictures) {
  out << "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[]\n";
  for (size_t i = 0; i < pictures.size(); ++i) {
    const Eigen::Quaterniond q = pictures[i].pose.q.conjugate();
    const Eigen::Vector3d t = -(q * pictures[i].pose.p);
    out << i + 1 << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << t.x() << ' ' << t.y() << ' '
        << t.z() << " 1 " << pictures[i].name << "\n\n";
  }
}

}  // namespace

Result<Exported> write_colmap(const ExportedRun& run, const fs::path& folder, double every_s,
                              const ExportProgress& progress) {
  PosedPictures posed(run, folder / "images", every_s);
  if (const auto done = posed.write(progress); !done) return done.failure();
  std::error_code error;
  fs::create_directories(folder / "sparse", error);
  std::ofstream cameras(folder / "sparse/cameras.txt"), images(folder / "sparse/images.txt"),
      points(folder / "sparse/points3D.txt");
  cameras << std::setprecision(17), images << std::setprecision(17);
  write_camera(cameras, posed.lens());
  write_images(images, posed.pictures);
  points << "# no points: 'colmap point_triangulator' makes them\n";
  if (!cameras.flush() || !images.flush() || !points.flush())
    return Failure{ODO_E_IO, folder.string() + ": writing failed; is the disk full?"};
  return posed.exported;
}

Result<Exported> write_transforms(const ExportedRun& run, const fs::path& file, double every_s,
                                  const ExportProgress& progress) {
  PosedPictures posed(run, file.parent_path() / "images", every_s);
  if (const odo_calibration* lens = camera_of(run.recording); lens && lens->distortion_count > 5)
    return Failure{ODO_E_UNSUPPORTED, run.recording.path.string() +
                                          ": a lens with a rational distortion (k4 to k6), which "
                                          "transforms.json cannot hold; COLMAP's can"};
  if (const auto done = posed.write(progress); !done) return done.failure();
  const odo_calibration& c = posed.lens();
  const bool fisheye = c.model == ODO_CAMERA_KANNALA_BRANDT;
  nlohmann::ordered_json out = {{"camera_model", fisheye ? "OPENCV_FISHEYE" : "OPENCV"},
                                {"w", c.width},
                                {"h", c.height},
                                {"fl_x", c.fx},
                                {"fl_y", c.fy},
                                {"cx", c.cx + 0.5},
                                {"cy", c.cy + 0.5}};
  const char* pinhole[] = {"k1", "k2", "p1", "p2", "k3"};
  const char* radial[] = {"k1", "k2", "k3", "k4"};
  for (uint32_t i = 0; i < std::min(c.distortion_count, fisheye ? 4u : 5u); ++i)
    out[fisheye ? radial[i] : pinhole[i]] = c.distortion[i];
  Eigen::Matrix3d R_e_n, R_c_g;  // east, north, up; camera axes as in OpenGL: y up, z backwards
  R_e_n << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  R_c_g << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  out["frames"] = nlohmann::ordered_json::array();
  for (const PosedPicture& picture : posed.pictures) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = R_e_n * picture.pose.q.toRotationMatrix() * R_c_g;
    T.topRightCorner<3, 1>() = R_e_n * picture.pose.p;
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (int i = 0; i < 4; ++i) rows.push_back({T(i, 0), T(i, 1), T(i, 2), T(i, 3)});
    out["frames"].push_back({{"file_path", "images/" + picture.name}, {"transform_matrix", rows}});
  }
  if (const auto written = write_whole_file(file, out.dump(1) + "\n"); !written) return written.failure();
  return posed.exported;
}

}  // namespace odograph
