/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <camera/NdkCameraDevice.h>
extern "C" {
struct ACameraManager;
struct ACameraIdList {
  int numCameras;
  const char** cameraIds;
};
ACameraManager* ACameraManager_create();
void ACameraManager_delete(ACameraManager* manager);
camera_status_t ACameraManager_getCameraIdList(ACameraManager* manager, ACameraIdList** list);
void ACameraManager_deleteCameraIdList(ACameraIdList* list);
camera_status_t ACameraManager_getCameraCharacteristics(ACameraManager* manager, const char* id,
                                                        ACameraMetadata** characteristics);
camera_status_t ACameraManager_openCamera(ACameraManager* manager, const char* id,
                                          ACameraDevice_StateCallbacks* callbacks, ACameraDevice** device);
}
