/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#import <Foundation/Foundation.h>
typedef struct {
  int64_t value;
  int32_t timescale;
  uint32_t flags;
  int64_t epoch;
} CMTime;
typedef struct opaqueCMSampleBuffer* CMSampleBufferRef;
typedef struct OpaqueCMClock* CMClockRef;
typedef struct __CVBuffer* CVPixelBufferRef;
enum { kCVPixelBufferLock_ReadOnly = 1, kCVPixelFormatType_420YpCbCr8BiPlanarFullRange = 0x34323066 };
extern const CFStringRef kCVPixelBufferPixelFormatTypeKey, kCMSampleBufferAttachmentKey_CameraIntrinsicMatrix;
double CMTimeGetSeconds(CMTime time);
CMClockRef CMClockGetHostTimeClock(void);
CMTime CMSyncConvertTime(CMTime time, CMClockRef from, CMClockRef to);
CMTime CMSampleBufferGetPresentationTimeStamp(CMSampleBufferRef sample);
CVPixelBufferRef CMSampleBufferGetImageBuffer(CMSampleBufferRef sample);
CFTypeRef CMGetAttachment(const void* target, CFStringRef key, uint32_t* mode);
int32_t CVPixelBufferLockBaseAddress(CVPixelBufferRef pixels, uint64_t flags);
int32_t CVPixelBufferUnlockBaseAddress(CVPixelBufferRef pixels, uint64_t flags);
CVPixelBufferRef CVPixelBufferRetain(CVPixelBufferRef pixels);
void CVPixelBufferRelease(CVPixelBufferRef pixels);
size_t CVPixelBufferGetWidth(CVPixelBufferRef pixels);
size_t CVPixelBufferGetHeight(CVPixelBufferRef pixels);
void* CVPixelBufferGetBaseAddressOfPlane(CVPixelBufferRef pixels, size_t plane);
size_t CVPixelBufferGetBytesPerRowOfPlane(CVPixelBufferRef pixels, size_t plane);
extern NSString *const AVMediaTypeVideo, *const AVCaptureDeviceTypeBuiltInWideAngleCamera,
                                             *const AVCaptureSessionPreset640x480;
typedef enum { AVCaptureDevicePositionBack = 1 } AVCaptureDevicePosition;
typedef enum { AVCaptureVideoStabilizationModeOff = 0 } AVCaptureVideoStabilizationMode;
@interface AVCaptureDevice : NSObject
@property(readonly) CMTime exposureDuration;
@property(readonly, getter=isLockingFocusWithCustomLensPositionSupported)
    BOOL lockingFocusWithCustomLensPositionSupported;
+ (AVCaptureDevice*)defaultDeviceWithDeviceType:(NSString*)type
                                      mediaType:(NSString*)media
                                       position:(AVCaptureDevicePosition)position;
- (BOOL)lockForConfiguration:(NSError**)error;
- (void)unlockForConfiguration;
- (void)setFocusModeLockedWithLensPosition:(float)position completionHandler:(void (^)(CMTime time))handler;
@end
@interface AVCaptureInput : NSObject
@end
@interface AVCaptureDeviceInput : AVCaptureInput
+ (instancetype)deviceInputWithDevice:(AVCaptureDevice*)device error:(NSError**)error;
@end
@interface AVCaptureConnection : NSObject
@property AVCaptureVideoStabilizationMode preferredVideoStabilizationMode;
@property(readonly, getter=isCameraIntrinsicMatrixDeliverySupported) BOOL cameraIntrinsicMatrixDeliverySupported;
@property(getter=isCameraIntrinsicMatrixDeliveryEnabled) BOOL cameraIntrinsicMatrixDeliveryEnabled;
@end
@interface AVCaptureOutput : NSObject
- (AVCaptureConnection*)connectionWithMediaType:(NSString*)type;
@end
@protocol AVCaptureVideoDataOutputSampleBufferDelegate <NSObject>
@optional
- (void)captureOutput:(AVCaptureOutput*)output
    didOutputSampleBuffer:(CMSampleBufferRef)sample
           fromConnection:(AVCaptureConnection*)connection;
@end
@interface AVCaptureVideoDataOutput : AVCaptureOutput
@property(copy) NSDictionary* videoSettings;
@property BOOL alwaysDiscardsLateVideoFrames;
- (void)setSampleBufferDelegate:(id<AVCaptureVideoDataOutputSampleBufferDelegate>)delegate
                          queue:(dispatch_queue_t)queue;
@end
@interface AVCaptureSession : NSObject
@property(copy) NSString* sessionPreset;
@property(readonly) CMClockRef synchronizationClock;
- (BOOL)canAddInput:(AVCaptureInput*)input;
- (BOOL)canAddOutput:(AVCaptureOutput*)output;
- (void)addInput:(AVCaptureInput*)input;
- (void)addOutput:(AVCaptureOutput*)output;
- (void)startRunning;
- (void)stopRunning;
@end
