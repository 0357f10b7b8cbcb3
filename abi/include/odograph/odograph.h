/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 2: what an app calls.
 *
 * A session is one pipeline. Its life: odo_session_create -> odo_session_set_callback (if wanted) -> push ... ->
 * odo_session_flush -> odo_session_destroy. Tags in [brackets] say on which thread a function may be called:
 *   [any]      from any thread, also several at once
 *   [control]  from one thread at a time, not from within a callback
 */
#ifndef ODOGRAPH_ODOGRAPH_H
#define ODOGRAPH_ODOGRAPH_H

#include <odograph/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct odo_session odo_session;

/* Why something failed, in words. struct_size: capacity in, bytes written out; message is UTF-8 and terminated. */
typedef struct odo_error {
  uint32_t struct_size;
  int32_t status;
  char message[2040];
} odo_error;

#define ODO_RUN_LIVE 0u   /* samples are processed on a thread of the session's own */
#define ODO_RUN_REPLAY 1u /* samples are processed within push, on the caller's thread: deterministic. While
                                    * one thread processes, what others push is processed by it */

/* Asks for crash notes: the first session of a process with this flag sets handlers for SIGSEGV, SIGBUS, SIGILL, SIGFPE and
 * SIGABRT where no other has been set. Within a plugin's call they write plugin and call to standard error, then the signal
 * has its former effect; an exit() within a plugin's call ends the process with status 4. Not for processes with a runtime
 * that uses these signals (ART, .NET, Mono). Without it no signal handler is ever set. */
#define ODO_SESSION_CRASH_NOTES 1u

typedef struct odo_session_options {
  uint32_t struct_size;
  uint32_t run;            /* ODO_RUN_* */
  odo_string config_path;  /* a YAML file ... */
  odo_string config_text;  /* ... or its text; exactly one of the two */
  odo_string plugin_path;  /* directories to look for plugins in before all others, separated by ':' (';' on Windows) */
  uint64_t seed;           /* of the random numbers handed to plugins */
  odo_string asset_path;   /* directories to look in for files that the config names and that are not beside it */
  uint32_t flags;          /* ODO_SESSION_* */
  uint32_t reserved;       /* 0 */
  ODO_POINTER(void *, user); /* for get_service alone */
  /* [any] May be null. Services of the app for plugins: a table for an id of its own ("acme.java_vm/1"), or for
   * ODO_SERVICE_ASSETS_2; null for others. Tables live as long as the session. Plugins that are isolated in a process are
   * not given them. */
  ODO_FUNCTION(const void *, get_service, (void *user, const char *id, uint64_t id_size));
} odo_session_options;

/* What a session has done so far. Counters count from creation. struct_size: capacity in, bytes written out. */
typedef struct odo_statistics {
  uint32_t struct_size;
  uint32_t reserved;         /* 0 */
  uint64_t pushed;           /* messages taken in */
  uint64_t processed;        /* messages handed to the pipeline */
  uint64_t frames;
  uint64_t steps;
  uint64_t fixes_accepted;
  uint64_t fixes_rejected;
  uint64_t late;             /* dropped: came after its time had been processed */
  uint64_t duplicate;        /* dropped: same sensor, same time */
  uint64_t invalid;          /* dropped: not finite, out of range or wrong size */
  uint64_t overflow;         /* dropped: the queue was full */
  uint64_t gaps;             /* pauses of a sensor longer than it ever should */
  uint64_t plugin_faults;    /* errors returned by plugins, bad events emitted */
  double tracking_s;         /* sensor time spent in each state */
  double degraded_s;
  double lost_s;
  double distance_m;
  uint64_t wild;             /* dropped: outside the sensor's range, or a spike against its neighbours */
  uint64_t events_dropped;   /* of samples that gave more events than the pipeline takes of one */
  uint64_t unknown;          /* samples of a type that neither the library nor any of its plugins knows */
  double scale_sigma;        /* relative standard deviation of the present scale group's scale; 0: unknown */
  double scale_by_inertia;   /* share of its information, 0 to 1, by inertia, in the front-end or in the host, */
  double scale_by_steps;     /* and by steps */
} odo_statistics;

/* [control] Compiles the config, loads and starts the plugins. On failure *session is null and `error`, which may be
 * null, says why: a bad config with file:line:column, a plugin with its path and reason.
 * ODO_E_CONFIG, ODO_E_NOT_FOUND, ODO_E_VERSION, ODO_E_ARGUMENT ... */
ODO_API int32_t ODO_CALL odo_session_create(const odo_session_options *options, odo_session **session, odo_error *error);

/* [control] Stops the session's thread, destroys the plugins' instances, releases held frames. Null is allowed. */
ODO_API void ODO_CALL odo_session_destroy(odo_session *session);

/* [any] Hands in an input of samples.h or a vendor's message, with struct_size and type set. The struct is copied; bits of
 * ODO_FLAG_HOST_MASK are cleared. A frame's pixels are not copied if it has retain and release (otherwise, and where any
 * plugin is isolated in a process, they are copied once); another borrowed message must have them (ODO_E_UNSUPPORTED), and
 * is not given to isolated plugins.
 * Samples of different sensors may come in any order within the configured wait (time_ordering.max_wait). Those of IMU,
 * magnetometer, barometer, camera and platform poses that come later than that, or twice, are refused; all others are
 * passed on late rather than lost. An inertial sample that jumps away from the one before waits for the next one, and is
 * dropped if that does not confirm it.
 * No lock is held while a frame's retain or release is called: they may push.
 * ODO_E_ARGUMENT (an event's or a reserved type), ODO_E_DISCARD (not finite, outside any sensor's range, late),
 * ODO_E_EXHAUSTED (queue full, too many frames retained), ODO_E_UNSUPPORTED, ODO_E_STRUCT_SIZE. */
ODO_API int32_t ODO_CALL odo_session_push(odo_session *session, const odo_header *sample);

/* [any] Shorthand for the commonest sample. Arrays of 3, rad/s and m/s^2. */
ODO_API int32_t ODO_CALL odo_session_push_imu(odo_session *session, int64_t t_ns, const double *gyro_b, const double *accel_b);

/* [control] Processes all that has been pushed, without waiting for slower sensors: on the session's thread when live,
 * on the caller's in replay. Returns when done. ODO_E_STATE from within a callback. */
ODO_API int32_t ODO_CALL odo_session_flush(odo_session *session);

#define ODO_TIME_LATEST INT64_MIN
/* [any] The pose at a time of the sensor clock, or at the newest sample. Between two poses it is interpolated; after the
 * last one it is carried on with the inertial samples that have been pushed meanwhile, and ahead of the newest sample
 * (100 ms are intended, 0.5 s allowed) with their last values; it is flagged ODO_POSE_EXTRAPOLATED then. While the position
 * is not known (camera off for more than 0.5 s, state lost) there is the orientation alone: look at the flags. Takes
 * microseconds and never waits for the pipeline.
 * pose->header.struct_size: capacity in, bytes written out. ODO_NOT_READY before the first pose or attitude, ODO_E_NOT_FOUND outside,
 * ODO_E_STRUCT_SIZE. */
ODO_API int32_t ODO_CALL odo_session_get_pose(odo_session *session, int64_t t_ns, odo_pose *pose);

#define ODO_OF_PIPELINE 0u /* of what the config has: the camera, or the body where there is none */
#define ODO_OF_BODY 1u
#define ODO_OF_CAMERA 2u
/* [any] As odo_session_get_pose, of what the caller asks for: ODO_OF_*. Between camera and body it uses the mount of the
 * pipeline's camera (ODO_CALIBRATION_EXTRINSICS of its newest calibration), without one zero. `smooth`: not 0 for the smooth
 * pose. ODO_E_ARGUMENT for another ODO_OF_*. */
ODO_API int32_t ODO_CALL odo_session_get_pose_of(odo_session *session, uint32_t of, uint32_t smooth, int64_t t_ns,
                                                 odo_pose *pose);

/* [any] The same pose, but corrections (see odo_correction) are blended in: never faster than 0.5 m/s and 10 degrees/s
 * beyond the true motion. For what is drawn and must not jump; places in n belong to odo_session_get_pose. */
ODO_API int32_t ODO_CALL odo_session_get_smooth_pose(odo_session *session, int64_t t_ns, odo_pose *pose);

/* Called with an event that is valid for the duration of the call; cast by event->type. On the session's thread when
 * live, within push or flush in replay. No lock is held: it may call [any] functions; what it pushes is processed after
 * it has returned. */
typedef void (ODO_CALL *odo_callback)(void *user, const odo_header *event);

#define ODO_ALL_EVENTS UINT32_MAX
/* [control] Replaces the callback. `types` are the events that are wanted (ODO_TYPE_*, vendors' too), copied; one that this library never gives is no error. With the
 * count ODO_ALL_EVENTS and null types it is called for all. No types or a null function end the calls, and none is running after the return (but the one that it was called from). */
ODO_API int32_t ODO_CALL odo_session_set_callback(odo_session *session, const uint32_t *types, uint32_t count,
                                                  odo_callback callback, void *user);

/* [any] Registers a plugin that is linked into the program; sessions created later find it by its id, like one that lies in a
 * folder, and before those. It needs no manifest and cannot be isolated in a process. Registering an entry again changes
 * nothing. ODO_E_ARGUMENT (null), ODO_E_VERSION, ODO_E_CONFIG (another registered plugin has its id) or what the entry returned;
 * `error`, which may be null, has the reason. */
ODO_API int32_t ODO_CALL odo_register_plugin(odo_plugin_entry entry, odo_error *error);

/* [any] For a signal handler of the app's own: which plugin's call this thread is in ("acme/vo in process"), or another
 * thread where this one is in none. Async-signal-safe. Writes at most `capacity` bytes, unterminated, and returns how many;
 * 0: none. */
ODO_API uint64_t ODO_CALL odo_current_plugin_call(char *text, uint64_t capacity);

/* [any] Accumulated counters. Never waits for the pipeline. */
ODO_API int32_t ODO_CALL odo_session_get_statistics(odo_session *session, odo_statistics *statistics);

/* [any] The last error or warning that a push or a plugin caused since the last call; ODO_OK when none. */
ODO_API int32_t ODO_CALL odo_session_last_error(odo_session *session, odo_error *error);

/* [any] Local NED to WGS 84 and back, exact (GeographicLib::LocalCartesian). p_n and geodetic are arrays of 3; geodetic
 * is latitude and longitude in rad, ellipsoidal height in m. ODO_NOT_READY while n's origin is not known (neither
 * navigation.origin nor a GNSS fix). That is about n alone: with navigation.origin they work at once, while the phone's
 * place in n is arbitrary until a navigation.start or a position fix (ODO_REASON_NO_FIX of geodetic anchors).
 * ODO_E_ARGUMENT: no number, no such latitude or longitude, or farther than 2e7 m. */
ODO_API int32_t ODO_CALL odo_session_to_geodetic(odo_session *session, const double *p_n, double *geodetic);
ODO_API int32_t ODO_CALL odo_session_from_geodetic(odo_session *session, const double *geodetic, double *p_n);

/* [control] What the plugins have estimated and should outlive the session (a walker's step length ...), as a blob for
 * odo_session_load. Returns the bytes needed, and writes them if `capacity` suffices; data may be null with capacity 0. */
ODO_API int64_t ODO_CALL odo_session_save(odo_session *session, void *data, uint64_t capacity);
/* [control] Before the first sample as a rule. Parts are by plugin id; those of plugins that this config does not have are ignored.
 * ODO_E_DATA when the blob is damaged (nothing changed) or a plugin does not take its part (the others have theirs). */
ODO_API int32_t ODO_CALL odo_session_load(odo_session *session, const void *data, uint64_t size);

/* [any] "major.minor.patch" of the library, terminated, never null. */
ODO_API const char *ODO_CALL odo_version(void);

/* [any] ABI of the library: major << 16 | minor. */
ODO_API uint32_t ODO_CALL odo_abi_version(void);

/* [any] A status code, a state (ODO_TRACKING ...), a reason or a motion mode in words; never null. */
ODO_API const char *ODO_CALL odo_status_text(int32_t status);
ODO_API const char *ODO_CALL odo_state_text(uint32_t state);
ODO_API const char *ODO_CALL odo_reason_text(uint32_t reason);
ODO_API const char *ODO_CALL odo_mode_text(uint32_t mode);

#ifdef __cplusplus
}
#endif
#endif
