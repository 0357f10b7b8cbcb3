/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <camera/NdkCameraMetadata.h>
extern "C" {
struct ANativeWindow;
struct ACameraDevice;
struct ACaptureRequest;
struct ACameraOutputTarget;
struct ACaptureSessionOutput;
struct ACaptureSessionOutputContainer;
struct ACameraCaptureSession;
struct ACameraCaptureFailure;
typedef enum { TEMPLATE_RECORD = 3 } ACameraDevice_request_template;
struct ACameraDevice_StateCallbacks {
  void* context;
  void (*onDisconnected)(void* context, ACameraDevice* device);
  void (*onError)(void* context, ACameraDevice* device, int error);
};
struct ACameraCaptureSession_stateCallbacks {
  void* context;
  void (*onClosed)(void* context, ACameraCaptureSession* session);
  void (*onReady)(void* context, ACameraCaptureSession* session);
  void (*onActive)(void* context, ACameraCaptureSession* session);
};
typedef void (*ACameraCaptureSession_captureCallback_result)(void* context, ACameraCaptureSession* session,
                                                             ACaptureRequest* request, const ACameraMetadata* result);
struct ACameraCaptureSession_captureCallbacks {
  void* context;
  void (*onCaptureStarted)(void* context, ACameraCaptureSession* session, const ACaptureRequest* request,
                           int64_t timestamp);
  ACameraCaptureSession_captureCallback_result onCaptureProgressed;
  ACameraCaptureSession_captureCallback_result onCaptureCompleted;
  void (*onCaptureFailed)(void* context, ACameraCaptureSession* session, ACaptureRequest* request,
                          ACameraCaptureFailure* failure);
};
camera_status_t ACameraDevice_close(ACameraDevice* device);
camera_status_t ACameraDevice_createCaptureRequest(const ACameraDevice* device, ACameraDevice_request_template name,
                                                   ACaptureRequest** request);
camera_status_t ACameraDevice_createCaptureSession(ACameraDevice* device, const ACaptureSessionOutputContainer* outputs,
                                                   const ACameraCaptureSession_stateCallbacks* callbacks,
                                                   ACameraCaptureSession** session);
camera_status_t ACaptureSessionOutputContainer_create(ACaptureSessionOutputContainer** container);
void ACaptureSessionOutputContainer_free(ACaptureSessionOutputContainer* container);
camera_status_t ACaptureSessionOutputContainer_add(ACaptureSessionOutputContainer* container,
                                                   const ACaptureSessionOutput* output);
camera_status_t ACaptureSessionOutput_create(ANativeWindow* window, ACaptureSessionOutput** output);
void ACaptureSessionOutput_free(ACaptureSessionOutput* output);
camera_status_t ACameraOutputTarget_create(ANativeWindow* window, ACameraOutputTarget** output);
void ACameraOutputTarget_free(ACameraOutputTarget* output);
camera_status_t ACaptureRequest_addTarget(ACaptureRequest* request, const ACameraOutputTarget* output);
camera_status_t ACaptureRequest_setEntry_u8(ACaptureRequest* request, uint32_t tag, uint32_t count,
                                            const uint8_t* data);
camera_status_t ACaptureRequest_setEntry_i32(ACaptureRequest* request, uint32_t tag, uint32_t count,
                                             const int32_t* data);
camera_status_t ACaptureRequest_setEntry_float(ACaptureRequest* request, uint32_t tag, uint32_t count,
                                               const float* data);
void ACaptureRequest_free(ACaptureRequest* request);
camera_status_t ACameraCaptureSession_setRepeatingRequest(ACameraCaptureSession* session,
                                                          ACameraCaptureSession_captureCallbacks* callbacks, int count,
                                                          ACaptureRequest** requests, int* sequence_id);
void ACameraCaptureSession_close(ACameraCaptureSession* session);
}
