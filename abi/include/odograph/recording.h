/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 4: recordings (*.odo), written by an app and replayed later.
 *
 * A recording contains messages in the version of their writer, which may be older or newer than this library,
 * including vendor messages. Pictures are stored as the app encoded them (`odograph` reads PNG and JPEG); this library
 * does not decode them.
 */
#ifndef ODOGRAPH_RECORDING_H
#define ODOGRAPH_RECORDING_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct odo_recording odo_recording;
typedef struct odo_recorder odo_recorder;

/* [any] Opens a recording and indexes its messages, without damaged ones (odo_recording_loss). On failure *recording is
 * null and `error`, which may be null, has the reason: ODO_E_NOT_FOUND, ODO_E_IO, ODO_E_DATA, ODO_E_VERSION. */
ODO_API int32_t ODO_CALL odo_recording_open(const odo_string *path, odo_recording **recording, odo_error *error);

/* [any, one thread at a time] Returns the next message in time order, valid until the next call. For a frame, the
 * planes are null and *picture is the encoded picture; otherwise *picture is null. `picture` and `picture_size` may be
 * null. ODO_END at the end; ODO_E_DATA for a record that cannot be read: call again for the next one. */
ODO_API int32_t ODO_CALL odo_recording_next(odo_recording *recording, const odo_header **message, const void **picture,
                                            uint64_t *picture_size);

/* [any] Describes the missing data in *loss: the status ODO_OK and an empty message if the recording is complete,
 * ODO_E_DATA if records are damaged or the file is truncated. Returns ODO_OK if it was written. */
ODO_API int32_t ODO_CALL odo_recording_loss(odo_recording *recording, odo_error *loss);

/* [any] Closes a recording. Null is allowed. */
ODO_API void ODO_CALL odo_recording_close(odo_recording *recording);

/* [any] Creates a recording. If a file of that name exists, the recording is written to NAME.part and replaces it when
 * closed; otherwise it is written to NAME directly. ODO_E_IO: it cannot be created. ODO_E_STATE: another recorder or
 * run writes it, in this process or in another (POSIX systems). */
ODO_API int32_t ODO_CALL odo_recorder_create(const odo_string *path, odo_recorder **recorder, odo_error *error);

#define ODO_LARGEST_PICTURE 67108864u /* bytes of an encoded picture */
/* [any, one thread at a time] Appends a message of any type, and for a frame the encoded picture of at most
 * ODO_LARGEST_PICTURE bytes; a replay skips frames without one. A message is stored unchanged, a frame without pixels
 * and mask. After a crash of the process, everything up to the last complete message can be read. Returns
 * ODO_E_STRUCT_SIZE, ODO_E_ARGUMENT (reserved type: ODO_IS_RESERVED; a picture that is too large), ODO_E_UNSUPPORTED
 * (borrowed message other than a frame), ODO_E_DISCARD (a value that odo_session_push also rejects: not finite or out
 * of range), ODO_E_IO (the disk is full). */
ODO_API int32_t ODO_CALL odo_recorder_write(odo_recorder *recorder, const odo_header *message, const void *picture,
                                            uint64_t picture_size);

/* [any] Closes the recording and marks it as complete. ODO_E_IO if not all data reached the file; the
 * partial file is not removed. Null is allowed. */
ODO_API int32_t ODO_CALL odo_recorder_close(odo_recorder *recorder);

#ifdef __cplusplus
}
#endif
#endif
