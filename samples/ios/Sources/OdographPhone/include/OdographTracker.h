/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph on an iPhone's back camera, motion sensors and barometer.
 */
#import <Foundation/Foundation.h>
#include <stdbool.h>

NS_ASSUME_NONNULL_BEGIN

typedef struct OdographPose {
  double north, east, down; /* m where metric */
  bool metric;
  unsigned state; /* odo_state_text */
  double distance;
} OdographPose;

@interface OdographTracker : NSObject
/* A pipeline's YAML. Nil and an error with file, line and reason when it is refused. */
- (nullable instancetype)initWithConfig:(NSString*)config error:(NSError* _Nullable* _Nullable)error;
/* The app may use the camera (AVCaptureDevice requestAccess), and says why in its Info.plist. */
- (BOOL)start:(NSError* _Nullable* _Nullable)error;
- (void)stop;
/* The newest one; NO before the first. From any thread. */
- (BOOL)getPose:(OdographPose*)pose;
- (NSString*)textOfState:(unsigned)state;
@end

NS_ASSUME_NONNULL_END
