/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stdint.h>
extern "C" {
typedef enum { AMEDIA_OK = 0 } media_status_t;
enum { AIMAGE_FORMAT_YUV_420_888 = 0x23 };
struct AImage;
void AImage_delete(AImage* image);
media_status_t AImage_getTimestamp(const AImage* image, int64_t* timestamp_ns);
media_status_t AImage_getPlanePixelStride(const AImage* image, int plane, int32_t* stride);
media_status_t AImage_getPlaneRowStride(const AImage* image, int plane, int32_t* stride);
media_status_t AImage_getPlaneData(const AImage* image, int plane, uint8_t** data, int* size);
}
