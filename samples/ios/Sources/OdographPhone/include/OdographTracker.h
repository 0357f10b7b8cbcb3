/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph with an iPhone's back camera, motion sensors and barometer.
 */
#import <Foundation/Foundation.h>
#include <stdbool.h>

NS_ASSUME_NONNULL_BEGIN

typedef struct OdographPose {
  double north, east, down; /* m if metric */
  bool metric;
  unsigned state; /* odo_state_text */
  double distance;
} OdographPose;

@interface OdographTracker : NSObject
/* A pipeline's YAML. If it is rejected: nil, and an error with file, line and reason. */
- (nullable instancetype)initWithConfig:(NSString*)config error:(NSError* _Nullable* _Nullable)error;
/* The app needs camera permission (AVCaptureDevice requestAccess) and its reason in Info.plist. */
- (BOOL)start:(NSError* _Nullable* _Nullable)error;
- (void)stop;
/* The newest pose; NO before the first. Thread-safe. */
- (BOOL)getPose:(OdographPose*)pose;
- (NSString*)textOfState:(unsigned)state;
@end

NS_ASSUME_NONNULL_END
