// SPDX-License-Identifier: Apache-2.0
//
// The back camera by the NDK's Camera2: the session borrows the pictures without a copy.
#ifndef PHONE_CAMERA_HPP
#define PHONE_CAMERA_HPP

#include <atomic>
#include <map>
#include <mutex>
#include <string>

#include <camera/NdkCameraManager.h>
#include <media/NdkImageReader.h>

#include <odograph/odograph.h>
#include <odograph/scene.h>

#include "conversions.hpp"

namespace phone {

class Camera {
 public:
  explicit Camera(odo_session* session) : session_(session) {}
  /// Call after odo_session_destroy, which returns the pictures that the session holds.
  ~Camera();
  Camera(const Camera&) = delete;

  /// Opens the back camera; the app needs the permission CAMERA. Returns an error text, empty on success.
  std::string start();
  /// No picture is pushed after it returns.
  void pause();
  /// A ray through the newest picture: columns and rows from 0 to 1 of it, in sensor orientation; t_ns 0 before the
  /// first. [any]
  odo_ray ray(double column, double row) const;

 private:
  /// The capture result of a frame. It arrives separately from its picture, with the same timestamp.
  struct Result {
    int64_t exposure_ns = 0, skew_ns = 0;
    bool has_intrinsics = false;
    float intrinsics[5] = {};
  };
  std::string find_back_camera();
  std::string open_reader();
  std::string open_session();
  void on_picture();
  void on_result(const ACameraMetadata* result);
  void push(AImage* image, int64_t start_ns, const Result& result);
  int64_t to_sensor_clock(int64_t t_ns) const;

  odo_session* session_;
  std::string id_;
  CameraFacts facts_;
  bool realtime_ = true, described_ = false;
  ACameraManager* manager_ = nullptr;
  ACameraDevice* device_ = nullptr;
  AImageReader* reader_ = nullptr;
  ACaptureSessionOutputContainer* outputs_ = nullptr;
  ACaptureSessionOutput* output_ = nullptr;
  ACameraCaptureSession* capture_ = nullptr;
  ACaptureRequest* request_ = nullptr;
  ACameraOutputTarget* target_ = nullptr;
  std::mutex mutex_;
  std::map<int64_t, Result> results_;
  std::map<int64_t, AImage*> pictures_;
  std::atomic<int64_t> newest_ns_{0};
};

}  // namespace phone

#endif
