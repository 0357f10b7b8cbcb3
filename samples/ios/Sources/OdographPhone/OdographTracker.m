/* SPDX-License-Identifier: Apache-2.0 */
#import "OdographTracker.h"

#import <AVFoundation/AVFoundation.h>
#import <CoreMotion/CoreMotion.h>

#include <math.h>

#include <odograph/anchor.h>
#include <odograph/odograph.h>
#include <odograph/scene.h>

#include "conversions.h"

static const double kReadoutS = 0.010; /* of a picture; no API reports it, the front-end refines it */

int32_t ODO_CALL odo_plugin_entry_attitude_vqf(const struct odo_host *host, struct odo_plugin *out);
int32_t ODO_CALL odo_plugin_entry_step_odograph(const struct odo_host *host, struct odo_plugin *out);
int32_t ODO_CALL odo_plugin_entry_vo_odograph(const struct odo_host *host, struct odo_plugin *out);
int32_t ODO_CALL odo_plugin_entry_surface_planes(const struct odo_host *host, struct odo_plugin *out);

static NSError *failure(NSString *text) {
  return [NSError errorWithDomain:@"Odograph" code:1 userInfo:@{NSLocalizedDescriptionKey : text}];
}

/* The session holds a picture until it has released it as often as it retained it. */
static int32_t retain_picture(void *owner) {
  CVPixelBufferLockBaseAddress((CVPixelBufferRef)owner, kCVPixelBufferLock_ReadOnly);
  CVPixelBufferRetain((CVPixelBufferRef)owner);
  return ODO_OK;
}

static void release_picture(void *owner) {
  CVPixelBufferUnlockBaseAddress((CVPixelBufferRef)owner, kCVPixelBufferLock_ReadOnly);
  CVPixelBufferRelease((CVPixelBufferRef)owner);
}

static const void *native_picture(void *owner, const char *id, uint64_t size) {
  return size == strlen(ODO_NATIVE_PIXEL_BUFFER) && memcmp(id, ODO_NATIVE_PIXEL_BUFFER, size) == 0 ? owner : NULL;
}

@implementation OdographRaycastResult {
 @public
  odo_hit hit;
}

- (double)distance {
  return hit.distance_m;
}

- (double)sigma {
  return hit.sigma_m;
}

- (NSString *)target {
  if (hit.what == ODO_HIT_POINT) return @"point";
  if (hit.surface == 0) return @"assumed floor";
  if (hit.surface_kind == ODO_SURFACE_FLOOR) return @"floor";
  return hit.surface_kind == ODO_SURFACE_VERTICAL ? @"wall" : @"surface";
}

@end

@interface OdographTracker () <AVCaptureVideoDataOutputSampleBufferDelegate>
@end

@implementation OdographTracker {
  odo_session *_session;
  CMMotionManager *_motion;
  CMAltimeter *_altimeter;
  AVCaptureSession *_capture;
  AVCaptureDevice *_camera;
  NSOperationQueue *_queue;
  dispatch_queue_t _pictures;
  BOOL _described;
  odo_calibration _lens;
  _Atomic int64_t _newest_ns; /* time of the newest picture, 0 before the first: then _lens is not read */
}

- (nullable instancetype)initWithConfig:(NSString *)config error:(NSError **)error {
  const odo_plugin_entry entries[] = {odo_plugin_entry_attitude_vqf, odo_plugin_entry_step_odograph,
                                      odo_plugin_entry_vo_odograph, odo_plugin_entry_surface_planes};
  odo_session_options options;
  odo_error reason;
  int32_t status = ODO_OK;
  if (!(self = [super init])) return nil;
  memset(&options, 0, sizeof options);
  memset(&reason, 0, sizeof reason);
  options.struct_size = sizeof options;
  reason.struct_size = sizeof reason;
  options.run = ODO_RUN_LIVE;
  options.config_text.data = config.UTF8String;
  options.config_text.size = strlen(config.UTF8String);
  for (size_t i = 0; i < sizeof entries / sizeof *entries && status == ODO_OK; ++i) status = odo_register_plugin(entries[i], &reason);
  if (status == ODO_OK) status = odo_session_create(&options, &_session, &reason);
  if (status != ODO_OK) {
    if (error) *error = failure([NSString stringWithUTF8String:reason.message]);
    return nil;
  }
  _motion = [CMMotionManager new];
  _altimeter = [CMAltimeter new];
  _queue = [NSOperationQueue new];
  _queue.maxConcurrentOperationCount = 1;
  _pictures = dispatch_queue_create("org.odograph.pictures", NULL);
  return self;
}

- (void)dealloc {
  [self stop];
  odo_session_destroy(_session);
}

- (AVCaptureSession *)captureSession {
  return _capture;
}

- (BOOL)start:(NSError **)error {
  NSString *wrong = [self startCamera];
  if (wrong) {
    if (error) *error = failure(wrong);
    return NO;
  }
  [self startMotion];
  return YES;
}

- (void)stop {
  [_motion stopAccelerometerUpdates];
  [_motion stopGyroUpdates];
  [_altimeter stopRelativeAltitudeUpdates];
  [_capture stopRunning];
  [_queue waitUntilAllOperationsAreFinished];
  dispatch_sync(_pictures, ^{});
}

- (void)startMotion {
  odo_session *session = _session;
  _motion.accelerometerUpdateInterval = _motion.gyroUpdateInterval = 0.01;
  [_motion startAccelerometerUpdatesToQueue:_queue
                                withHandler:^(CMAccelerometerData *data, NSError *error) {
                                  odo_imu imu;
                                  if (!data) return;
                                  phone_accelerometer(&imu, data.timestamp, data.acceleration.x, data.acceleration.y, data.acceleration.z);
                                  odo_session_push(session, &imu.header);
                                }];
  [_motion startGyroUpdatesToQueue:_queue
                       withHandler:^(CMGyroData *data, NSError *error) {
                         odo_imu imu;
                         if (!data) return;
                         phone_gyroscope(&imu, data.timestamp, data.rotationRate.x, data.rotationRate.y, data.rotationRate.z);
                         odo_session_push(session, &imu.header);
                       }];
  if (![CMAltimeter isRelativeAltitudeAvailable]) return;
  [_altimeter startRelativeAltitudeUpdatesToQueue:_queue
                                      withHandler:^(CMAltitudeData *data, NSError *error) {
                                        odo_barometer barometer;
                                        if (!data) return;
                                        phone_barometer(&barometer, data.timestamp, data.pressure.doubleValue);
                                        odo_session_push(session, &barometer.header);
                                      }];
}

/* Rear wide camera, 640 x 480, in sensor orientation, without stabilisation, focus at infinity. Returns an error text. */
- (NSString *)startCamera {
  AVCaptureVideoDataOutput *output = [AVCaptureVideoDataOutput new];
  AVCaptureDeviceInput *input;
  AVCaptureConnection *connection;
  _camera = [AVCaptureDevice defaultDeviceWithDeviceType:AVCaptureDeviceTypeBuiltInWideAngleCamera
                                               mediaType:AVMediaTypeVideo
                                                position:AVCaptureDevicePositionBack];
  input = _camera ? [AVCaptureDeviceInput deviceInputWithDevice:_camera error:NULL] : nil;
  if (!input) return @"no back camera, or no permission to use it";
  _capture = [AVCaptureSession new];
  _capture.sessionPreset = AVCaptureSessionPreset640x480;
  output.videoSettings = @{(NSString *)kCVPixelBufferPixelFormatTypeKey : @(kCVPixelFormatType_420YpCbCr8BiPlanarFullRange)};
  output.alwaysDiscardsLateVideoFrames = YES;
  [output setSampleBufferDelegate:self queue:_pictures];
  if (![_capture canAddInput:input] || ![_capture canAddOutput:output]) return @"the camera does not support this picture format";
  [_capture addInput:input];
  [_capture addOutput:output];
  connection = [output connectionWithMediaType:AVMediaTypeVideo];
  connection.preferredVideoStabilizationMode = AVCaptureVideoStabilizationModeOff;
  if (connection.isCameraIntrinsicMatrixDeliverySupported) connection.cameraIntrinsicMatrixDeliveryEnabled = YES;
  if ([_camera isLockingFocusWithCustomLensPositionSupported] && [_camera lockForConfiguration:NULL]) {
    [_camera setFocusModeLockedWithLensPosition:1.0f completionHandler:nil];
    [_camera unlockForConfiguration];
  }
  _described = NO;
  [_capture startRunning];
  return nil;
}

- (void)captureOutput:(AVCaptureOutput *)output didOutputSampleBuffer:(CMSampleBufferRef)sample fromConnection:(AVCaptureConnection *)connection {
  CVPixelBufferRef pixels = CMSampleBufferGetImageBuffer(sample);
  /* From the session's clock to that of Core Motion. That it is the start of the exposure is an assumption. */
  const CMTime start = CMSyncConvertTime(CMSampleBufferGetPresentationTimeStamp(sample), _capture.synchronizationClock, CMClockGetHostTimeClock());
  const double exposure_s = CMTimeGetSeconds(_camera.exposureDuration);
  NSData *matrix = (__bridge NSData *)CMGetAttachment(sample, kCMSampleBufferAttachmentKey_CameraIntrinsicMatrix, NULL);
  odo_frame frame;
  if (!pixels) return;
  retain_picture(pixels);
  phone_begin(&frame.header, sizeof frame, ODO_TYPE_FRAME, phone_ns(CMTimeGetSeconds(start) + (exposure_s + kReadoutS) / 2), ODO_FRAME_EXPOSURE);
  frame.exposure_ns = phone_ns(exposure_s);
  frame.format = ODO_FORMAT_NV12;
  frame.width = (uint32_t)CVPixelBufferGetWidth(pixels);
  frame.height = (uint32_t)CVPixelBufferGetHeight(pixels);
  for (size_t i = 0; i < 2; ++i) {
    frame.planes[i].data = CVPixelBufferGetBaseAddressOfPlane(pixels, i);
    frame.planes[i].row_stride = (int64_t)CVPixelBufferGetBytesPerRowOfPlane(pixels, i);
    frame.planes[i].pixel_stride = i == 0 ? 1 : 2;
  }
  frame.loan.owner = pixels;
  frame.loan.retain = retain_picture;
  frame.loan.release = release_picture;
  frame.loan.native = native_picture;
  if (matrix.length >= 12 * sizeof(float)) phone_intrinsics(&frame, (const float *)matrix.bytes);
  if (!_described) {
    phone_calibration(&_lens, &frame, kReadoutS);
    odo_session_push(_session, &_lens.header);
    _described = YES;
  }
  odo_session_push(_session, &frame.header);
  _newest_ns = frame.header.t_ns;
  release_picture(pixels);
}

- (BOOL)getPose:(OdographPose *)out {
  odo_pose pose;
  odo_statistics statistics;
  memset(&pose, 0, sizeof pose);
  memset(&statistics, 0, sizeof statistics);
  pose.header.struct_size = sizeof pose;
  statistics.struct_size = sizeof statistics;
  if (odo_session_get_smooth_pose(_session, ODO_TIME_LATEST, &pose) != ODO_OK) return NO;
  odo_session_get_statistics(_session, &statistics);
  out->north = pose.p_n[0], out->east = pose.p_n[1], out->down = pose.p_n[2];
  out->metric = (pose.header.flags & ODO_POSE_METRIC) != 0;
  out->state = pose.state;
  out->distance = statistics.distance_m;
  return YES;
}

- (NSArray<OdographRaycastResult *> *)raycastFromPoint:(CGPoint)point {
  NSMutableArray<OdographRaycastResult *> *results = [NSMutableArray new];
  odo_hit hits[8];
  odo_ray ray;
  uint32_t count = 0;
  memset(&ray, 0, sizeof ray);
  ray.struct_size = sizeof ray, hits->struct_size = sizeof *hits;
  ray.kind = ODO_RAY_PIXEL;
  ray.t_ns = _newest_ns;
  if (ray.t_ns == 0) return results;
  ray.pixel[0] = point.x * _lens.width - 0.5, ray.pixel[1] = point.y * _lens.height - 0.5;
  if (odo_session_hit_test(_session, &ray, hits, 8, &count) != ODO_OK) return results;
  for (uint32_t i = 0; i < count; ++i) {
    OdographRaycastResult *result = [OdographRaycastResult new];
    result->hit = hits[i];
    [results addObject:result];
  }
  return results;
}

- (uint64_t)addAnchorAtResult:(OdographRaycastResult *)result {
  odo_anchor_place place;
  uint64_t anchor = 0;
  memset(&place, 0, sizeof place);
  place.struct_size = sizeof place;
  place.kind = ODO_ANCHOR_HIT;
  place.t_ns = result->hit.t_ns;
  place.surface = result->hit.surface;
  place.sigma_m = result->hit.sigma_m;
  memcpy(place.q, result->hit.q_n, sizeof place.q);
  memcpy(place.p, result->hit.p_n, sizeof place.p);
  odo_anchor_create(_session, &place, &anchor);
  return anchor;
}

- (BOOL)getAnchor:(uint64_t)anchor point:(CGPoint *)point distance:(double *)distance {
  odo_anchor found;
  const double *p = found.p_view;
  const int64_t newest_ns = _newest_ns;
  memset(&found, 0, sizeof found);
  found.struct_size = sizeof found;
  if (newest_ns == 0 || odo_anchor_get(_session, anchor, ODO_WORLD_CORRECTED, newest_ns, &found) != ODO_OK) return NO;
  if (!(found.flags & ODO_ANCHOR_IN_FRONT)) return NO;
  point->x = (_lens.fx * p[0] / p[2] + _lens.cx + 0.5) / _lens.width;
  point->y = (_lens.fy * p[1] / p[2] + _lens.cy + 0.5) / _lens.height;
  *distance = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  return YES;
}

- (NSString *)textOfState:(unsigned)state {
  return [NSString stringWithUTF8String:odo_state_text(state)];
}

@end
