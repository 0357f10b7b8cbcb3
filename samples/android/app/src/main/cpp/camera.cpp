// SPDX-License-Identifier: Apache-2.0
#include "camera.hpp"

#include <ctime>

#include <camera/NdkCameraDevice.h>
#include <camera/NdkCameraMetadata.h>
#include <media/NdkImage.h>

namespace phone {
namespace {

constexpr int kWidth = 640, kHeight = 480;  // supported by every Camera2 phone
constexpr int kBuffers = 8;

bool read(const ACameraMetadata* metadata, uint32_t tag, uint32_t count, ACameraMetadata_const_entry* entry) {
  return ACameraMetadata_getConstEntry(metadata, tag, entry) == ACAMERA_OK && entry->count >= count;
}

bool read_floats(const ACameraMetadata* metadata, uint32_t tag, uint32_t count, float* values) {
  ACameraMetadata_const_entry entry = {};
  if (!read(metadata, tag, count, &entry)) return false;
  std::memcpy(values, entry.data.f, count * sizeof *values);
  return true;
}

int64_t read_time(const ACameraMetadata* metadata, uint32_t tag) {
  ACameraMetadata_const_entry entry = {};
  return read(metadata, tag, 1, &entry) ? entry.data.i64[0] : 0;
}

CameraFacts facts_of(const ACameraMetadata* camera) {
  CameraFacts facts;
  ACameraMetadata_const_entry entry = {};
  if (read(camera, ACAMERA_SENSOR_INFO_PRE_CORRECTION_ACTIVE_ARRAY_SIZE, 4, &entry) ||
      read(camera, ACAMERA_SENSOR_INFO_ACTIVE_ARRAY_SIZE, 4, &entry))
    facts.array_width = entry.data.i32[2], facts.array_height = entry.data.i32[3];  // left, top, width, height
  if (read(camera, ACAMERA_SENSOR_ORIENTATION, 1, &entry)) facts.orientation_deg = entry.data.i32[0];
  facts.has_intrinsics = read_floats(camera, ACAMERA_LENS_INTRINSIC_CALIBRATION, 5, facts.intrinsics);
  facts.has_distortion = read_floats(camera, ACAMERA_LENS_DISTORTION, 5, facts.distortion);
  facts.has_rotation = read_floats(camera, ACAMERA_LENS_POSE_ROTATION, 4, facts.rotation);
  facts.has_translation = read(camera, ACAMERA_LENS_POSE_REFERENCE, 1, &entry) &&
                          entry.data.u8[0] == ACAMERA_LENS_POSE_REFERENCE_GYROSCOPE &&
                          read_floats(camera, ACAMERA_LENS_POSE_TRANSLATION, 3, facts.translation);
  float size[2] = {};
  read_floats(camera, ACAMERA_LENS_INFO_AVAILABLE_FOCAL_LENGTHS, 1, &facts.focal_mm);
  if (read_floats(camera, ACAMERA_SENSOR_INFO_PHYSICAL_SIZE, 2, size)) facts.sensor_width_mm = size[0];
  return facts;
}

/// A picture that the session may hold; the last release returns it to the camera.
struct Picture {
  AImage* image;
  std::atomic<int> holds{1};
};

int32_t retain(void* owner) {
  ++static_cast<Picture*>(owner)->holds;
  return ODO_OK;
}

void release(void* owner) {
  auto* picture = static_cast<Picture*>(owner);
  if (--picture->holds > 0) return;
  AImage_delete(picture->image);
  delete picture;
}

bool set_planes(AImage* image, odo_frame& frame) {
  for (int i = 0; i < 3; ++i) {
    uint8_t* data = nullptr;
    int size = 0;
    int32_t row = 0, pixel = 0;
    if (AImage_getPlaneData(image, i, &data, &size) != AMEDIA_OK ||
        AImage_getPlaneRowStride(image, i, &row) != AMEDIA_OK ||
        AImage_getPlanePixelStride(image, i, &pixel) != AMEDIA_OK)
      return false;
    frame.planes[i].data = data;
    frame.planes[i].row_stride = row;
    frame.planes[i].pixel_stride = static_cast<uint32_t>(pixel);
  }
  return true;
}

}  // namespace

std::string Camera::find_back_camera() {
  ACameraIdList* list = nullptr;
  if (ACameraManager_getCameraIdList(manager_, &list) != ACAMERA_OK) return "cannot list the cameras";
  for (int i = 0; i < list->numCameras && id_.empty(); ++i) {
    ACameraMetadata* camera = nullptr;
    ACameraMetadata_const_entry entry = {};
    if (ACameraManager_getCameraCharacteristics(manager_, list->cameraIds[i], &camera) != ACAMERA_OK) continue;
    if (read(camera, ACAMERA_LENS_FACING, 1, &entry) && entry.data.u8[0] == ACAMERA_LENS_FACING_BACK) {
      id_ = list->cameraIds[i];
      facts_ = facts_of(camera);
      realtime_ = read(camera, ACAMERA_SENSOR_INFO_TIMESTAMP_SOURCE, 1, &entry) &&
                  entry.data.u8[0] == ACAMERA_SENSOR_INFO_TIMESTAMP_SOURCE_REALTIME;
    }
    ACameraMetadata_free(camera);
  }
  ACameraManager_deleteCameraIdList(list);
  if (id_.empty()) return "no back camera";
  return facts_.array_width > 0 && facts_.array_height > 0 ? "" : "the camera does not report the size of its sensor";
}

std::string Camera::open_reader() {
  AImageReader_ImageListener listener = {this,
                                         [](void* self, AImageReader*) { static_cast<Camera*>(self)->on_picture(); }};
  ANativeWindow* window = nullptr;
  if (AImageReader_new(kWidth, kHeight, AIMAGE_FORMAT_YUV_420_888, kBuffers, &reader_) != AMEDIA_OK ||
      AImageReader_setImageListener(reader_, &listener) != AMEDIA_OK ||
      AImageReader_getWindow(reader_, &window) != AMEDIA_OK)
    return "cannot create an image reader";
  const bool made = ACaptureSessionOutputContainer_create(&outputs_) == ACAMERA_OK &&
                    ACaptureSessionOutput_create(window, &output_) == ACAMERA_OK &&
                    ACaptureSessionOutputContainer_add(outputs_, output_) == ACAMERA_OK &&
                    ACameraOutputTarget_create(window, &target_) == ACAMERA_OK;
  return made ? "" : "cannot create a camera output";
}

std::string Camera::open_session() {
  static ACameraCaptureSession_stateCallbacks states = {};
  states.onClosed = states.onReady = states.onActive = [](void*, ACameraCaptureSession*) {};
  if (ACameraDevice_createCaptureRequest(device_, TEMPLATE_RECORD, &request_) != ACAMERA_OK ||
      ACaptureRequest_addTarget(request_, target_) != ACAMERA_OK ||
      ACameraDevice_createCaptureSession(device_, outputs_, &states, &capture_) != ACAMERA_OK)
    return "cannot create a capture session";
  // Nothing may shift the picture: focus at infinity, no optical or digital stabilisation, no lens correction. Phones
  // without one of them ignore it.
  const uint8_t off = 0;
  const float far_away = 0;
  const int32_t rate[2] = {30, 30};
  for (const uint32_t tag :
       {ACAMERA_CONTROL_AF_MODE, ACAMERA_CONTROL_VIDEO_STABILIZATION_MODE, ACAMERA_LENS_OPTICAL_STABILIZATION_MODE})
    ACaptureRequest_setEntry_u8(request_, tag, 1, &off);
#if defined(__ANDROID_API__) && __ANDROID_API__ >= 28
  ACaptureRequest_setEntry_u8(request_, ACAMERA_DISTORTION_CORRECTION_MODE, 1, &off);
#endif
  ACaptureRequest_setEntry_float(request_, ACAMERA_LENS_FOCUS_DISTANCE, 1, &far_away);
  ACaptureRequest_setEntry_i32(request_, ACAMERA_CONTROL_AE_TARGET_FPS_RANGE, 2, rate);
  ACameraCaptureSession_captureCallbacks callbacks = {};
  callbacks.context = this;
  callbacks.onCaptureCompleted = [](void* self, ACameraCaptureSession*, ACaptureRequest*,
                                    const ACameraMetadata* result) { static_cast<Camera*>(self)->on_result(result); };
  const bool runs =
      ACameraCaptureSession_setRepeatingRequest(capture_, &callbacks, 1, &request_, nullptr) == ACAMERA_OK;
  return runs ? "" : "the camera does not start";
}

std::string Camera::start() {
  manager_ = ACameraManager_create();
  std::string wrong = find_back_camera();
  if (!wrong.empty()) return wrong;
  static ACameraDevice_StateCallbacks states = {};
  states.onDisconnected = [](void*, ACameraDevice*) {};
  states.onError = [](void*, ACameraDevice*, int) {};
  if (ACameraManager_openCamera(manager_, id_.c_str(), &states, &device_) != ACAMERA_OK)
    return "the camera cannot be opened";
  wrong = open_reader();
  return wrong.empty() ? open_session() : wrong;
}

void Camera::pause() {
  if (capture_) ACameraCaptureSession_close(capture_);
  if (device_) ACameraDevice_close(device_);
  if (reader_) AImageReader_setImageListener(reader_, nullptr);
  for (const auto& waiting : pictures_) AImage_delete(waiting.second);
  pictures_.clear();
  capture_ = nullptr, device_ = nullptr;
}

Camera::~Camera() {
  pause();
  if (request_) ACaptureRequest_free(request_);
  if (target_) ACameraOutputTarget_free(target_);
  if (output_) ACaptureSessionOutput_free(output_);
  if (outputs_) ACaptureSessionOutputContainer_free(outputs_);
  if (reader_) AImageReader_delete(reader_);
  if (manager_) ACameraManager_delete(manager_);
}

void Camera::on_picture() {
  AImage* image = nullptr;
  int64_t start_ns = 0;
  if (AImageReader_acquireNextImage(reader_, &image) != AMEDIA_OK || !image) return;
  if (AImage_getTimestamp(image, &start_ns) != AMEDIA_OK) return AImage_delete(image);
  Result result;
  {
    const std::lock_guard lock(mutex_);
    const auto found = results_.find(start_ns);
    if (found == results_.end()) {  // its result usually comes later; a picture without one is dropped with the next
      for (auto old = pictures_.begin(); pictures_.size() >= 2; old = pictures_.erase(old)) AImage_delete(old->second);
      pictures_.emplace(start_ns, image);
      return;
    }
    result = found->second;
    results_.erase(results_.begin(), std::next(found));
  }
  push(image, start_ns, result);
}

void Camera::on_result(const ACameraMetadata* metadata) {
  const int64_t start_ns = read_time(metadata, ACAMERA_SENSOR_TIMESTAMP);
  Result result;
  result.exposure_ns = read_time(metadata, ACAMERA_SENSOR_EXPOSURE_TIME);
  result.skew_ns = read_time(metadata, ACAMERA_SENSOR_ROLLING_SHUTTER_SKEW);
  result.has_intrinsics = read_floats(metadata, ACAMERA_LENS_INTRINSIC_CALIBRATION, 5, result.intrinsics);
  AImage* image = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto found = pictures_.find(start_ns);
    if (found == pictures_.end()) {
      while (results_.size() >= kBuffers) results_.erase(results_.begin());
      results_.emplace(start_ns, result);
      return;
    }
    image = found->second;
    pictures_.erase(found);
  }
  push(image, start_ns, result);
}

/// The clock of ASensorEvent. A camera with timestamp source UNKNOWN mostly uses CLOCK_MONOTONIC, which stops in sleep;
/// a remaining offset belongs in the calibration's time_offset_ns.
int64_t Camera::to_sensor_clock(int64_t t_ns) const {
  if (realtime_) return t_ns;
  timespec boot = {}, monotonic = {};
  clock_gettime(CLOCK_BOOTTIME, &boot);
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return t_ns + (boot.tv_sec - monotonic.tv_sec) * int64_t{1000000000} + (boot.tv_nsec - monotonic.tv_nsec);
}

void Camera::push(AImage* image, int64_t start_ns, const Result& result) {
  auto* picture = new Picture{image};
  const Crop crop = crop_of(facts_, kWidth, kHeight);
  const int64_t t_ns = to_sensor_clock(middle_of_frame(start_ns, result.exposure_ns, result.skew_ns));
  if (!described_) {
    const odo_calibration calibration = calibration_of(facts_, t_ns, kWidth, kHeight);
    odo_session_push(session_, &calibration.header);
    described_ = true;
  }
  auto frame = message<odo_frame>(ODO_TYPE_FRAME, t_ns, 0);
  frame.format = ODO_FORMAT_YUV420;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.loan.owner = picture;
  frame.loan.retain = retain;
  frame.loan.release = release;
  if (result.exposure_ns > 0) frame.exposure_ns = result.exposure_ns, frame.header.flags |= ODO_FRAME_EXPOSURE;
  if (result.skew_ns > 0) {
    frame.line_time_ns = line_time(result.skew_ns, facts_, crop, kHeight);
    frame.header.flags |= ODO_FRAME_LINE_TIME;
  }
  if (result.has_intrinsics) {
    scale_intrinsics(result.intrinsics, crop, &frame.fx, &frame.fy, &frame.cx, &frame.cy);
    frame.header.flags |= ODO_FRAME_INTRINSICS;
  }
  if (set_planes(image, frame)) odo_session_push(session_, &frame.header);
  newest_ns_ = t_ns;
  release(picture);
}

odo_ray Camera::ray(double column, double row) const {
  odo_ray ray = {};
  ray.struct_size = sizeof ray;
  ray.kind = ODO_RAY_PIXEL;
  ray.t_ns = newest_ns_;
  ray.pixel[0] = column * kWidth - 0.5, ray.pixel[1] = row * kHeight - 0.5;
  return ray;
}

}  // namespace phone
