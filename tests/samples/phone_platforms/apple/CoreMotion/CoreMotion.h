/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#import <Foundation/Foundation.h>
typedef struct {
  double x, y, z;
} CMAcceleration;
typedef struct {
  double x, y, z;
} CMRotationRate;
@interface CMLogItem : NSObject
@property(readonly) double timestamp;
@end
@interface CMAccelerometerData : CMLogItem
@property(readonly) CMAcceleration acceleration;
@end
@interface CMGyroData : CMLogItem
@property(readonly) CMRotationRate rotationRate;
@end
@interface CMAltitudeData : CMLogItem
@property(readonly) NSNumber* pressure;
@end
@interface CMMotionManager : NSObject
@property double accelerometerUpdateInterval, gyroUpdateInterval;
- (void)startAccelerometerUpdatesToQueue:(NSOperationQueue*)queue
                             withHandler:(void (^)(CMAccelerometerData* data, NSError* error))handler;
- (void)startGyroUpdatesToQueue:(NSOperationQueue*)queue
                    withHandler:(void (^)(CMGyroData* data, NSError* error))handler;
- (void)stopAccelerometerUpdates;
- (void)stopGyroUpdates;
@end
@interface CMAltimeter : NSObject
+ (BOOL)isRelativeAltitudeAvailable;
- (void)startRelativeAltitudeUpdatesToQueue:(NSOperationQueue*)queue
                                withHandler:(void (^)(CMAltitudeData* data, NSError* error))handler;
- (void)stopRelativeAltitudeUpdates;
@end
