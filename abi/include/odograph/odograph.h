/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 2: the functions for apps.
 *
 * A session is one pipeline. Order of calls: odo_session_create, odo_session_set_callback (optional), odo_session_push
 * for each sample, odo_session_flush, odo_session_destroy. A tag in [brackets] states the threads of each function:
 *   [any]      any thread, several at once
 *   [control]  one thread at a time for each session, not within a callback; odo_session_create: any thread
 * There may be several sessions at a time; they share nothing but the loaded plugin libraries.
 */
#ifndef ODOGRAPH_ODOGRAPH_H
#define ODOGRAPH_ODOGRAPH_H

#include <odograph/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct odo_session odo_session;

/* Reason of a failure. struct_size: capacity in, bytes written out. The message is UTF-8 and terminated. */
typedef struct odo_error {
  uint32_t struct_size;
  int32_t status;
  char message[2040];
} odo_error;

#define ODO_RUN_LIVE 0u   /* samples are processed on a thread of the session */
#define ODO_RUN_REPLAY 1u /* samples are processed within push, on the thread of the caller: deterministic. Samples that
                           * other threads push meanwhile are processed on the same thread */

/* Enables crash notes. The first session of a process with this flag installs handlers for SIGSEGV, SIGBUS, SIGILL,
 * SIGFPE and SIGABRT, unless a handler is already installed. If the signal occurs in a call of a plugin, they write the
 * plugin and the call to standard error; then the signal takes its previous effect. An exit() in a call of a plugin
 * ends the process with status 4. Do not use it in processes whose runtime uses these signals (ART, .NET, Mono).
 * Without the flag, no signal handler is installed. */
#define ODO_SESSION_CRASH_NOTES 1u

typedef struct odo_session_options {
  uint32_t struct_size;
  uint32_t run;            /* ODO_RUN_* */
  odo_string config_path;  /* path of a YAML file; set exactly one of config_path and config_text */
  odo_string config_text;  /* YAML text; relative names in it are searched in asset_path alone */
  odo_string plugin_path;  /* directories that are searched first for plugins, separated by ':' (';' on Windows) */
  uint64_t seed;           /* seed of the random numbers for plugins */
  odo_string asset_path;   /* directories to search for files that the config names and that are not beside it,
                            * separated as those of plugin_path */
  uint32_t flags;          /* ODO_SESSION_* */
  uint32_t reserved;       /* 0 */
  ODO_POINTER(void *, user); /* passed to get_service */
  /* [any] May be null. Services that the app provides to plugins: returns the table for an id of the app
   * ("acme.java_vm/1") or for ODO_SERVICE_CONTENTS, otherwise null. Tables must stay valid as long as the session.
   * Plugins that are isolated in a process do not receive them. */
  ODO_FUNCTION(const void *, get_service, (void *user, const char *id, uint64_t id_size));
} odo_session_options;

/* Statistics of a session since its creation. struct_size: capacity in, bytes written out. */
typedef struct odo_statistics {
  uint32_t struct_size;
  uint32_t reserved;         /* 0 */
  uint64_t pushed;           /* messages pushed, including rejected ones */
  uint64_t processed;        /* messages passed to the pipeline */
  uint64_t frames;
  uint64_t steps;
  uint64_t fixes_accepted;
  uint64_t fixes_rejected;
  uint64_t late;             /* dropped: arrived after its time had been processed */
  uint64_t duplicate;        /* dropped: same sensor and time as an earlier one */
  uint64_t invalid;          /* dropped: not finite, out of range or of wrong size */
  uint64_t overflow;         /* dropped: the queue was full */
  uint64_t gaps;             /* pauses of the IMU or the camera longer than the configured max_gap */
  uint64_t plugin_faults;    /* errors returned and invalid events emitted by plugins */
  double tracking_s;         /* sensor time in each state */
  double degraded_s;
  double lost_s;
  double distance_m;
  uint64_t wild;             /* dropped: outside the range of any such sensor, or a spike relative to its neighbours */
  uint64_t events_dropped;   /* dropped events, beyond the limit for one sample */
  uint64_t unknown;          /* samples of a type that neither the library nor any loaded plugin supports */
  double scale_sigma;        /* relative standard deviation of the scale of the current scale group; 0: unknown */
  double scale_by_inertia;   /* share of its information from inertial data, in front-end or host, 0 to 1 */
  double scale_by_steps;     /* share of its information from steps, 0 to 1 */
} odo_statistics;

/* [control] Reads the config, loads and starts the plugins. On failure *session is null and `error`, which may be null,
 * has the reason: file:line:column of an error in the config, path and reason of a plugin that does not load.
 * Returns ODO_E_CONFIG, ODO_E_NOT_FOUND, ODO_E_VERSION, ODO_E_ARGUMENT or another status. */
ODO_API int32_t ODO_CALL odo_session_create(const odo_session_options *options, odo_session **session, odo_error *error);

/* [control] Stops the thread of the session, destroys the plugin instances and releases retained frames. Samples that
 * wait are dropped (odo_session_flush processes them). A plugin in a process of its own is ended at once, the running
 * call of one in this process is waited for: odo_current_plugin_call names it. No other call of the session may be
 * running. Null is allowed. */
ODO_API void ODO_CALL odo_session_destroy(odo_session *session);

/* [any] Adds an input of samples.h or a vendor message, with struct_size and type set. The struct is copied, and the
 * bits of ODO_FLAG_HOST_MASK are cleared. The pixels of a frame are not copied if it has retain and release and no
 * plugin is isolated in a process; otherwise they are copied once. Any other borrowed message must have retain and
 * release (ODO_E_UNSUPPORTED) and is not delivered to isolated plugins. Samples of different sensors may arrive in any
 * order within the configured wait (time_ordering.max_wait). Samples of IMU, magnetometer, barometer, camera and
 * platform poses are rejected if they are later than that or duplicates; all other messages are delivered even if late.
 * An inertial sample that jumps relative to its predecessor waits for the next one and is dropped if the next one does
 * not confirm it. No lock is held while retain or release is called: they may push. Returns ODO_E_ARGUMENT (type of an
 * event or reserved type), ODO_E_DISCARD (not finite, outside the range of any sensor, late), ODO_E_EXHAUSTED (queue
 * full, too many frames retained), ODO_E_UNSUPPORTED, ODO_E_STRUCT_SIZE, ODO_E_STATE (the session is being destroyed).
 * If an error is returned, nothing of the message was used. */
ODO_API int32_t ODO_CALL odo_session_push(odo_session *session, const odo_header *sample);

/* [any] Pushes an odo_imu with both sensors: arrays of 3, rad/s and m/s^2, in b. */
ODO_API int32_t ODO_CALL odo_session_push_imu(odo_session *session, int64_t t_ns, const double *gyro_b, const double *accel_b);

/* [control] Processes all pushed samples without waiting for slower sensors, on the thread of the session (live) or of
 * the caller (replay). Returns when done. ODO_E_STATE within a callback. */
ODO_API int32_t ODO_CALL odo_session_flush(odo_session *session);

#define ODO_TIME_LATEST INT64_MIN
/* [any] Returns the pose at a time of the sensor clock, or at the newest sample, in today's n: with each correction
 * (odo_correction) the stored poses move. Between two poses it is interpolated.
 * After the last pose it is propagated with the inertial samples pushed since, and beyond the newest sample with their
 * last values (intended for 100 ms, at most 0.5 s); ODO_POSE_EXTRAPOLATED is then set. While the position is unknown
 * (camera off for more than 0.5 s, state lost), only the orientation is valid: check the flags. Takes microseconds and
 * never waits for the pipeline. pose->header.struct_size: capacity in, bytes written out. ODO_NOT_READY before the
 * first pose or attitude, ODO_E_NOT_FOUND for a time outside the stored poses and the extrapolation,
 * ODO_E_STRUCT_SIZE. */
ODO_API int32_t ODO_CALL odo_session_get_pose(odo_session *session, int64_t t_ns, odo_pose *pose);

/* The two worlds for rendering, each with its pose of the phone. */
#define ODO_WORLD_CORRECTED 0u /* odo_session_get_pose: best estimate; jumps at corrections */
#define ODO_WORLD_SMOOTH 1u    /* odo_session_get_smooth_pose: content never jumps relative to the image */

#define ODO_OF_PIPELINE 0u /* what the pipeline tracks: the camera or the body, as ODO_POSE_CAMERA states; it may change
                            * from the body to the camera when a front-end begins */
#define ODO_OF_BODY 1u
#define ODO_OF_CAMERA 2u
/* [any] Like odo_session_get_pose, for the camera or the body (`of`: ODO_OF_*) in a world (ODO_WORLD_*). The conversion
 * uses the extrinsics of the pipeline's camera (ODO_CALIBRATION_EXTRINSICS of its newest calibration); ODO_NOT_READY if
 * it is needed and they are unknown. ODO_E_ARGUMENT for any other `of` or world. */
ODO_API int32_t ODO_CALL odo_session_get_pose_of(odo_session *session, uint32_t of, uint32_t world, int64_t t_ns,
                                                 odo_pose *pose);

/* [any] Like odo_session_get_pose, but corrections (see odo_correction) are blended in: beyond the true motion at most
 * at 0.5 m/s and 10 degrees/s within 0.5 m and 10 degrees of it; a larger difference first decays with a time constant
 * of 1 s. Use it to render without jumps; positions in n refer to odo_session_get_pose. */
ODO_API int32_t ODO_CALL odo_session_get_smooth_pose(odo_session *session, int64_t t_ns, odo_pose *pose);

/* Receives an event, which is valid during the call; cast it by event->type. Called on the thread of the session (live)
 * or within push or flush (replay). No lock is held: it may call [any] functions. Samples that it pushes are processed
 * after it returns. */
typedef void (ODO_CALL *odo_callback)(void *user, const odo_header *event);

#define ODO_ALL_EVENTS UINT32_MAX
/* [control, or within a callback] Replaces it. `types` are the wanted events (ODO_TYPE_*, vendor types too) and are copied; a type
 * that this library never emits is no error. With the count ODO_ALL_EVENTS, which selects all, types is ignored. With
 * count 0 or a null function, no more calls follow; after the return none is running, except the one that called this
 * function. */
ODO_API int32_t ODO_CALL odo_session_set_callback(odo_session *session, const uint32_t *types, uint32_t count,
                                                  odo_callback callback, void *user);

/* [any] Registers a plugin that is linked into the program. Sessions created later find it by its id, before plugins in
 * directories. It needs no manifest and cannot be isolated in a process. Registering an entry again has no effect.
 * Returns ODO_E_ARGUMENT (null), ODO_E_VERSION, ODO_E_CONFIG (another registered plugin has its id) or the status of
 * the entry; `error`, which may be null, has the reason. */
ODO_API int32_t ODO_CALL odo_register_plugin(odo_plugin_entry entry, odo_error *error);

/* [any] For signal handlers of the app: names the plugin call that is running on this thread ("acme/vo in process"), or
 * if there is none, on another thread. Async-signal-safe. Writes at most `capacity` bytes, unterminated, and returns
 * their number; 0: no such call. */
ODO_API uint64_t ODO_CALL odo_current_plugin_call(char *text, uint64_t capacity);

/* [any] Returns the statistics. Never waits for the pipeline. */
ODO_API int32_t ODO_CALL odo_session_get_statistics(odo_session *session, odo_statistics *statistics);

/* [any] Writes the latest error or warning of a push or a plugin since the last call; error->status is ODO_OK if there
 * is none. Returns ODO_OK if it was written. */
ODO_API int32_t ODO_CALL odo_session_last_error(odo_session *session, odo_error *error);

/* [any] Convert between n (local NED) and WGS 84, exactly (GeographicLib::LocalCartesian) if the north of n is true
 * north (ODO_POSE_NORTH); otherwise rotated about the origin by the same angle as n. p_n is an array of 3, m;
 * geodetic is latitude and longitude, rad, and ellipsoidal height, m. ODO_NOT_READY while the origin of n is unknown
 * (neither navigation.origin nor a GNSS fix). This concerns only n: with navigation.origin the functions work
 * immediately, but the position of the phone in n is arbitrary until a navigation.start or a position fix
 * (ODO_REASON_NO_FIX of geodetic anchors). ODO_E_ARGUMENT: not finite, invalid latitude or longitude, or farther than
 * 2e7 m. */
ODO_API int32_t ODO_CALL odo_session_to_geodetic(odo_session *session, const double *p_n, double *geodetic);
ODO_API int32_t ODO_CALL odo_session_from_geodetic(odo_session *session, const double *geodetic, double *p_n);

/* [control] Saves anchors and parameters that plugins have estimated (such as the user's step length) as a blob for
 * odo_session_load. Returns the number of bytes required, and writes them if `capacity` suffices; data may be null with
 * capacity 0. A negative value is a status. */
ODO_API int64_t ODO_CALL odo_session_save(odo_session *session, void *data, uint64_t capacity);
/* [control] Restores saved state, once, before the first sample. Its parts are identified by plugin id; those of
 * plugins that the config does not contain are ignored. Saved anchors are added to those that there are, with new ids.
 * ODO_PARTIAL if a plugin rejects its part (the others are restored), ODO_E_DATA if the blob is damaged (nothing
 * changes). */
ODO_API int32_t ODO_CALL odo_session_load(odo_session *session, const void *data, uint64_t size);

/* [any] Returns the version of the library, "major.minor.patch", terminated; never null. */
ODO_API const char *ODO_CALL odo_version(void);

/* [any] Returns the ABI version of the library: major << 16 | minor. */
ODO_API uint32_t ODO_CALL odo_abi_version(void);

/* [any] Return the text of a status code, a state (ODO_TRACKING ...), a reason or a motion mode; never null. */
ODO_API const char *ODO_CALL odo_status_text(int32_t status);
ODO_API const char *ODO_CALL odo_state_text(uint32_t state);
ODO_API const char *ODO_CALL odo_reason_text(uint32_t reason);
ODO_API const char *ODO_CALL odo_mode_text(uint32_t mode);

#ifdef __cplusplus
}
#endif
#endif
