/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <media/NdkImage.h>
extern "C" {
struct ANativeWindow;
struct AImageReader;
struct AImageReader_ImageListener {
  void* context;
  void (*onImageAvailable)(void* context, AImageReader* reader);
};
media_status_t AImageReader_new(int32_t width, int32_t height, int32_t format, int32_t images, AImageReader** reader);
void AImageReader_delete(AImageReader* reader);
media_status_t AImageReader_getWindow(AImageReader* reader, ANativeWindow** window);
media_status_t AImageReader_acquireNextImage(AImageReader* reader, AImage** image);
media_status_t AImageReader_setImageListener(AImageReader* reader, AImageReader_ImageListener* listener);
}
