/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 4: recordings (*.odo), to be written while an app runs and replayed later.
 *
 * A recording holds messages as their writer knew them, older or newer than this library, vendors' own too. Pictures are
 * kept as the app encoded them (PNG or JPEG, as `odograph` reads them): this library decodes none.
 */
#ifndef ODOGRAPH_RECORDING_H
#define ODOGRAPH_RECORDING_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct odo_recording odo_recording;
typedef struct odo_recorder odo_recorder;

/* [any] Opens a recording and looks for its messages; what is damaged is left out (odo_recording_loss). On failure *recording is
 * null and `error`, which may be null, says why: ODO_E_NOT_FOUND, ODO_E_DATA, ODO_E_VERSION. */
ODO_API int32_t ODO_CALL odo_recording_open(const odo_string *path, odo_recording **recording, odo_error *error);

/* [any, one thread at a time] The next message in the order of time; valid until the next call. Of a frame the planes are
 * null and *picture is its picture, encoded; otherwise *picture is null. `picture` and `picture_size` may be null.
 * ODO_NOT_READY at the end. */
ODO_API int32_t ODO_CALL odo_recording_next(odo_recording *recording, const odo_header **message, const void **picture,
                                            uint64_t *picture_size);

/* [any] What the recording lacks of what was written, in words: ODO_OK and an empty message when nothing, ODO_E_DATA when
 * records are damaged or it was cut off. */
ODO_API int32_t ODO_CALL odo_recording_loss(odo_recording *recording, odo_error *loss);

/* [any] Null is allowed. */
ODO_API void ODO_CALL odo_recording_close(odo_recording *recording);

/* [any] Creates a recording. A file of that name stays until the new one is closed; until then that lies beside it as
 * NAME.part. Where there is none, it is written in its place at once. ODO_E_STATE: another recorder or run is writing it,
 * in this process or in another (POSIX systems). */
ODO_API int32_t ODO_CALL odo_recorder_create(const odo_string *path, odo_recorder **recorder, odo_error *error);

/* [any, one thread at a time] Appends a message of any type as it is, of a frame the encoded picture too (none: the frame
 * is left out of a replay). After a crash everything up to the last whole message can be read.
 * ODO_E_STRUCT_SIZE, ODO_E_ARGUMENT (a reserved type: ODO_IS_RESERVED), ODO_E_UNSUPPORTED (a borrowed message that is no frame),
 * ODO_E_DISCARD (a number that odo_session_push refuses too: no number, or beyond all that it can mean), ODO_E_DATA when the
 * disk is full. */
ODO_API int32_t ODO_CALL odo_recorder_write(odo_recorder *recorder, const odo_header *message, const void *picture,
                                            uint64_t picture_size);

/* [any] Sets the mark that tells a closed recording from one that was cut off. ODO_E_DATA when something did not reach
 * the file: what did is left where it lies. Null is allowed. */
ODO_API int32_t ODO_CALL odo_recorder_close(odo_recorder *recorder);

#ifdef __cplusplus
}
#endif
#endif
