/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#define NS_ASSUME_NONNULL_BEGIN _Pragma("clang assume_nonnull begin")
#define NS_ASSUME_NONNULL_END _Pragma("clang assume_nonnull end")
#define YES __objc_yes
#define NO __objc_no
#define nil ((id)0)
#define NS_SWIFT_NAME(name) __attribute__((swift_name(#name)))
typedef bool BOOL;
typedef long NSInteger;
typedef unsigned long NSUInteger;
typedef const struct __CFString* CFStringRef;
typedef const void* CFTypeRef;
typedef struct dispatch_queue_s* dispatch_queue_t;
dispatch_queue_t dispatch_queue_create(const char* label, void* attributes);
void dispatch_sync(dispatch_queue_t queue, void (^block)(void));
@protocol NSObject
@end
@protocol NSCopying
@end
__attribute__((objc_root_class))
@interface NSObject<NSObject>
+ (instancetype)new;
- (instancetype)init;
- (void)dealloc;
@end
@interface NSString : NSObject <NSCopying>
@property(readonly) const char* UTF8String;
+ (instancetype)stringWithUTF8String:(const char*)text;
@end
@interface NSNumber : NSObject
@property(readonly) double doubleValue;
+ (NSNumber*)numberWithUnsignedInt:(unsigned)value;
+ (NSNumber*)numberWithInt:(int)value;
@end
@interface NSDictionary : NSObject
+ (instancetype)dictionaryWithObjects:(const id[])objects forKeys:(const id<NSCopying>[])keys count:(NSUInteger)count;
@end
@interface NSArray<Type> : NSObject
@end
@interface NSMutableArray<Type> : NSArray <Type>
- (void)addObject:(Type)object;
@end
@interface NSData : NSObject
@property(readonly) NSUInteger length;
@property(readonly) const void* bytes;
@end
extern NSString* const NSLocalizedDescriptionKey;
@interface NSError : NSObject
+ (instancetype)errorWithDomain:(NSString*)domain code:(NSInteger)code userInfo:(NSDictionary*)info;
@end
@interface NSOperationQueue : NSObject
@property NSInteger maxConcurrentOperationCount;
- (void)waitUntilAllOperationsAreFinished;
@end
