/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph with an iPhone's back camera, motion sensors and barometer.
 */
#import <CoreGraphics/CoreGraphics.h>
#import <Foundation/Foundation.h>
#include <stdbool.h>

@class AVCaptureSession;

NS_ASSUME_NONNULL_BEGIN

typedef struct OdographPose {
  double north, east, down; /* m if metric */
  bool metric;
  unsigned state; /* odo_state_text */
  double distance;
} OdographPose;

/* As ARRaycastResult: where a ray met a surface, a landmark or the floor. */
@interface OdographRaycastResult : NSObject
@property(readonly) NSString* target;       /* "floor", "wall", ... */
@property(readonly) double distance, sigma; /* from the camera, and its standard deviation, m */
@end

@interface OdographTracker : NSObject
@property(readonly, nullable) AVCaptureSession* captureSession; /* for an AVCaptureVideoPreviewLayer */
/* A pipeline's YAML. If it is rejected: nil, and an error with file, line and reason. */
- (nullable instancetype)initWithConfig:(NSString*)config error:(NSError* _Nullable* _Nullable)error;
/* The app needs camera permission (AVCaptureDevice requestAccess) and its reason in Info.plist. */
- (BOOL)start:(NSError* _Nullable* _Nullable)error;
- (void)stop;
/* The newest pose; NO before the first. Thread-safe. */
- (BOOL)getPose:(OdographPose*)pose;
- (NSString*)textOfState:(unsigned)state;

/* Of the newest picture, [main thread]. Points are those of AVCaptureVideoPreviewLayer's captureDevicePointConverted:
 * 0 to 1 in the picture, in sensor orientation. */

/* What lies behind a point, nearest first; empty if nothing is known there. */
- (NSArray<OdographRaycastResult*>*)raycastFromPoint:(CGPoint)point NS_SWIFT_NAME(raycast(from:));
/* An anchor there, which stays fixed to the surface: its id, 0 while the position is unknown. */
- (uint64_t)addAnchorAtResult:(OdographRaycastResult*)result NS_SWIFT_NAME(addAnchor(at:));
/* Where to draw it, and how far away it is, m; NO if it is behind the camera or not placed. */
- (BOOL)getAnchor:(uint64_t)anchor point:(CGPoint*)point distance:(double*)distance;
@end

NS_ASSUME_NONNULL_END
