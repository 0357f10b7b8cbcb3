/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 3: the interface that a plugin implements.
 *
 * A plugin is either a shared library that exports the symbol ODO_PLUGIN_ENTRY, with its manifest NAME.odoplugin.json
 * (written by `odograph plugin manifest`) beside it, or code linked into the app, which registers its entry with
 * odo_register_plugin. It needs only these headers; plugin.hpp is a C++ wrapper.
 *
 * Order of calls to an instance: create, configure, activate, process ... [reset | save | load], destroy. Threads:
 * [control] and [process] calls to one instance are ordered and never overlap, but may come from different threads. An
 * instance must not depend on the thread that created it (in Rust it is Send). Instances are independent of each other
 * and may be called concurrently.
 *   [control]  any thread of the host, not during process
 *   [process]  the thread of the pipeline, while the instance is active
 *   [any]      any thread, at any time between create and destroy
 * No exception, longjmp or signal may leave a function of the plugin. Each call must restore the floating-point
 * environment of the host (rounding mode, traps) before it returns.
 */
#ifndef ODOGRAPH_PLUGIN_H
#define ODOGRAPH_PLUGIN_H

#include <odograph/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- services of the host ---------------------------------------------------------------------------------------- */

/* Host of one session. One that is passed to create is valid until the last of its instances is destroyed; one that is
 * passed to the entry, during that call only. */
typedef struct odo_host {
  uint32_t struct_size;
  uint32_t abi_major_min; /* range of supported major ABI versions, inclusive */
  uint32_t abi_major_max;
  uint32_t abi_minor;     /* minor version of the major whose entry was called */
  odo_string version;     /* version of the host, for logs */
  /* [any] Returns the table of a service, or null if it is not available; a plugin must work without it. Tables are
   * valid as long as the host. The host provides the ids that start with "odo."; it passes all others to the app
   * (odo_session_options.get_service). */
  ODO_FUNCTION(const void *, get_service, (const struct odo_host *host, const char *id, uint64_t id_size));
} odo_host;

#define ODO_SERVICE_REPORT "odo.report/1"
/* Reports for the user or the log. `key` identifies the kind of report ("no_magnetometer"): the host publishes at most
 * one per second of each. */
typedef struct odo_report_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] */
  ODO_FUNCTION(void, report, (const odo_host *host, uint32_t instance, uint32_t severity, const odo_string *key, const odo_string *text));
} odo_report_service;

#define ODO_SERVICE_RANDOM "odo.random/1"
/* Reproducible random seeds: a function of the seed of the run, the instance and the stream only. */
typedef struct odo_random_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] Returns a seed for the plugin's random number generator. */
  ODO_FUNCTION(uint64_t, seed, (const odo_host *host, uint32_t instance, uint64_t stream));
} odo_random_service;

#define ODO_SERVICE_ASSETS "odo.assets/1"
/* Resolves names of files in a config, which are relative to the config. If assets have no paths (inside an APK, in a
 * browser), use odo.contents/1. */
typedef struct odo_asset_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [control] Writes at most `capacity` bytes of the path, which is absolute and not terminated. Returns its size in
   * bytes, or ODO_E_NOT_FOUND. */
  ODO_FUNCTION(int64_t, resolve, (const odo_host *host, const odo_string *name, char *path, uint64_t capacity));
} odo_asset_service;

#define ODO_SERVICE_CONTENTS "odo.contents/1"
typedef struct odo_asset odo_asset; /* opaque, defined by the provider */
/* Contents of files that a config names. The service of the host reads files; the app may provide its own
 * (odo_session_options.get_service). */
typedef struct odo_content_service {
  uint32_t struct_size;
  uint32_t reserved;
  ODO_POINTER(void *, user); /* passed to open */
  /* [any] Opens an asset and writes its size in bytes. Returns ODO_OK or ODO_E_NOT_FOUND. */
  ODO_FUNCTION(int32_t, open, (void *user, const odo_string *name, odo_asset **asset, uint64_t *size));
  /* [any, one thread at a time for each asset] Copies up to `size` bytes from `offset`. Returns their number, 0 at the
   * end, or a negative status. */
  ODO_FUNCTION(int64_t, read, (odo_asset *asset, uint64_t offset, void *data, uint64_t size));
  /* [any] */
  ODO_FUNCTION(void, close, (odo_asset *asset));
} odo_content_service;

#define ODO_SERVICE_WAKE "odo.wake/1"
/* For plugins with another source of data (a radio, a worker thread): requests a call of process. */
typedef struct odo_wake_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] The host calls process of this instance with an empty batch soon, at the latest with the next sample. One
   * call may serve several requests. Events emitted in it depend on real time: a replay does not reproduce them. */
  ODO_FUNCTION(void, wake, (const odo_host *host, uint32_t instance));
} odo_wake_service;

#define ODO_SERVICE_RUN "odo.run/1"
/* What kind of run it is, since 1.1. */
typedef struct odo_run_service {
  uint32_t struct_size;
  uint32_t is_live; /* 1: samples arrive in real time: do not wait for a worker thread. 0: a replay, which must give the
                     * same output each time: wait for it */
} odo_run_service;

/* ---- parameters -------------------------------------------------------------------------------------------------- */

#define ODO_PARAMETER_BOOL 1u
#define ODO_PARAMETER_INT 2u
#define ODO_PARAMETER_REAL 3u
#define ODO_PARAMETER_STRING 4u
#define ODO_PARAMETER_CHOICE 5u /* a string, one of `choices` */
#define ODO_PARAMETER_REALS 6u  /* exactly `count` numbers */

/* One row of a plugin's parameter table, used for validation, `odograph plugins ID`, the manifest and the schema. A
 * host ignores a row of a type that it does not know: the key is an error in a config, and the plugin keeps its
 * default. */
typedef struct odo_parameter {
  uint32_t struct_size;
  uint32_t type;          /* ODO_PARAMETER_* */
  odo_string name;        /* [a-z0-9_] */
  odo_string unit;        /* SI: "m", "rad", "m/s^2", "m^(3/4)*s^(1/2)" (products, quotients, powers), px; "": none */
  odo_string help;        /* one sentence with the source of the number */
  odo_string default_text; /* in YAML syntax, in `unit`; a number needs one */
  odo_string choices;     /* separated by '|' */
  double min;             /* inclusive and finite, numbers only; min = max = 0: no bounds */
  double max;
  uint32_t count;         /* number of values of ODO_PARAMETER_REALS, 1 to 64 */
  uint32_t reserved;      /* 0 */
} odo_parameter;

/* A parameter value from the config, validated against the table. */
typedef struct odo_value {
  uint32_t struct_size;
  uint32_t type;        /* ODO_PARAMETER_* */
  odo_string name;
  odo_string text;      /* STRING, CHOICE */
  ODO_POINTER(const double *, reals);  /* REAL, REALS */
  uint64_t count;       /* number of reals */
  int64_t integer;      /* INT; BOOL as 0 or 1 */
} odo_value;

/* ---- data in and out --------------------------------------------------------------------------------------------- */

/* Messages in time order; at equal times descriptions (ODO_FLAG_DESCRIPTION) first, then by type, source and order of
 * push. An odo_attitude comes before the odo_imu of its time. Inertial, magnetometer and barometer samples, frames and
 * platform poses never follow newer ones of the same sensor; all others may be late. Messages have at least 1.0's size.
 * In the fields that its version has, the host has checked that numbers are finite and within the range of a sensor;
 * check the fields of later versions and of vendors' messages yourself. A plugin must survive other messages, and
 * returns ODO_OK for a type that it does not know. Types and sizes of the messages may differ. The partition of the
 * input into batches must not change the output. A batch may be empty (odo.wake/1). */
typedef struct odo_batch {
  uint32_t struct_size;
  uint32_t count;
  ODO_POINTER(const odo_header *const *, messages);
} odo_batch;

/* Receives the events of an instance. The pointer is valid from activate to destroy. */
typedef struct odo_sink {
  uint32_t struct_size;
  uint32_t instance; /* number of this instance, for the report service */
  /* [process] Copies an event to the host and clears the bits of ODO_FLAG_HOST_MASK. Returns ODO_E_STATE outside
   * process of this instance and on other threads; ODO_E_ARGUMENT for a type that neither the kind emits nor the table
   * declares, for an input, pose, state, correction or report, and for a field that is out of range (a report names
   * it) or a time more than a second after the newest message; ODO_E_STRUCT_SIZE; ODO_E_EXHAUSTED for more than 256
   * events for each message of the batch (256 for an empty one); ODO_E_UNSUPPORTED, which is no fault, for an event
   * that is newer than the host and not among `outputs`. One that is among them is forwarded unread. */
  ODO_FUNCTION(int32_t, emit, (const struct odo_sink *sink, const odo_header *event));
} odo_sink;

/* ---- table of the plugin ----------------------------------------------------------------------------------------- */

typedef struct odo_instance odo_instance; /* opaque, defined by the plugin */
#define ODO_LARGEST_STATE 16777216u       /* bytes of saved state of one instance; more is reported, not saved */
#define ODO_LARGEST_PIECE 1048576u        /* bytes of a map that cross at once */
#define ODO_LARGEST_MAP 268435456u        /* bytes of the map of one instance */

/* Bits of odo_plugin.flags. A host ignores bits that it does not know. */
#define ODO_PLUGIN_SEVERAL_CAMERAS 1u /* the front-end receives frames of all cameras, not only of the main one */
#define ODO_PLUGIN_NATIVE_FRAMES 2u   /* the plugin accepts frames whose pixels are available from loan.native only */
#define ODO_PLUGIN_INPUTS_WHOLE 4u    /* since 1.1: it reads the types in `inputs` alone, not all of its kind */

typedef struct odo_plugin {
  uint32_t struct_size;   /* in: capacity; out: number of bytes that the plugin filled */
  uint32_t abi_major;     /* ABI version that the plugin was built for */
  uint32_t abi_minor;
  uint32_t interface_count;
  ODO_POINTER(const odo_string *, interfaces); /* kinds that it implements: ODO_INTERFACE_* */
  odo_string id;          /* "group/name", each of [a-z0-9_-], at most 63 bytes; groups "odo" and "host" are reserved */
  odo_string version;     /* "major.minor.patch" */
  odo_string summary;     /* one sentence */
  odo_string refusal;     /* reason if the entry does not return ODO_OK */
  ODO_POINTER(const odo_parameter *, parameters);
  uint32_t parameter_count;
  uint32_t parameter_stride; /* sizeof(odo_parameter) in the headers of the plugin */
  uint32_t flags;            /* ODO_PLUGIN_* */
  uint32_t reserved;         /* 0 */
  /* [control] Creates an instance of the kind `interface_id`. `number` identifies it in reports. */
  ODO_FUNCTION(int32_t, create, (const odo_host *host, uint32_t number, const odo_string *interface_id, odo_instance **instance));
  /* [control] Sets all parameters, validated and in the units of the table; called once, before activate. The values
   * and their pointers are valid only during the call. To reject them, report the reason and return ODO_E_CONFIG. */
  ODO_FUNCTION(int32_t, configure, (odo_instance *instance, const odo_value *values, uint32_t count, uint32_t stride));
  /* [control] After this call, process may be called. `sink` outlives the instance. */
  ODO_FUNCTION(int32_t, activate, (odo_instance *instance, const odo_sink *sink));
  /* [process] Processes every message of the batch, even if earlier ones are discarded, up to one that leaves the
   * instance in need of reset; emitted events remain valid. Returns the lowest status. */
  ODO_FUNCTION(int32_t, process, (odo_instance *instance, const odo_batch *batch));
  /* [control] Destroys the instance, which must release everything that it has retained. */
  ODO_FUNCTION(void, destroy, (odo_instance *instance));
  /* The remaining members are optional and may be null. */
  /* [control] Returns to the state after activate and discards everything else, loaded state too; the host sends
   * descriptions again (ODO_FLAG_DESCRIPTION). If it is null, the host creates a new instance. */
  ODO_FUNCTION(int32_t, reset, (odo_instance *instance));
  /* [control] Saves state that should survive a restart (such as personal parameters of the user), at most
   * ODO_LARGEST_STATE bytes. Returns the number of bytes required, and writes them if `capacity` suffices. 0: nothing
   * to save. The host stores the state under the id of the plugin. */
  ODO_FUNCTION(int64_t, save, (odo_instance *instance, void *data, uint64_t capacity));
  /* [control] Restores saved state, after activate. ODO_E_DATA if the blob is damaged or from another plugin; the state
   * is then unchanged. */
  ODO_FUNCTION(int32_t, load, (odo_instance *instance, const void *data, uint64_t size));
  /* [control] Returns the table of an extension, or null. It is valid until the next reset or destroy; the host asks
   * again afterwards. Not called in isolated plugins. */
  ODO_FUNCTION(const void *, get_interface, (odo_instance *instance, const char *id, uint64_t id_size));
  /* Types of messages that the plugin receives and may emit in addition to those of its kinds: vendor messages, frames
   * for a scale source, attitudes from an odometry. */
  ODO_POINTER(const uint32_t *, inputs);
  ODO_POINTER(const uint32_t *, outputs);
  uint32_t input_count;
  uint32_t output_count;
  /* Since 1.1, optional: the map of a plugin that recognises places (odo_map_save), in pieces of at most
   * ODO_LARGEST_PIECE bytes. */
  /* [control] Writes up to `capacity` bytes of the map from `offset` on. Returns their number, 0 at the end. The pieces
   * from an offset of 0 on belong together. */
  ODO_FUNCTION(int64_t, save_map, (odo_instance *instance, uint64_t offset, void *data, uint64_t capacity));
  /* [control] Takes a map in pieces, in order; the one of size 0 ends it. ODO_E_DATA: damaged, or of another plugin or a
   * later format; nothing has changed then. */
  ODO_FUNCTION(int32_t, load_map, (odo_instance *instance, uint64_t offset, const void *data, uint64_t size));
} odo_plugin;

/* True if the host supports the ABI of these headers. Otherwise the entry must return ODO_E_VERSION. */
#define ODO_HOST_FITS(host)                                                                                            \
  ((host)->abi_major_min <= ODO_ABI_MAJOR && (host)->abi_major_max >= ODO_ABI_MAJOR)

/* Name of the entry function (odo_plugin_entry, base.h). A plugin that is linked into an app defines ODO_PLUGIN_ENTRY
 * as a unique name before it includes this header. */
#define ODO_PLUGIN_ENTRY_SYMBOL "odo_plugin_entry_v1"
#if !defined(ODO_PLUGIN_ENTRY)
#define ODO_PLUGIN_ENTRY odo_plugin_entry_v1
#endif
ODO_EXPORT int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host *host, odo_plugin *out);

#ifdef __cplusplus
}
#endif
#endif
