/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 3: what a plugin implements.
 *
 * A plugin is a shared library that exports one symbol, ODO_PLUGIN_ENTRY, with NAME.odoplugin.json beside it, which
 * `odograph plugin manifest` writes; or code linked into the app, whose entry the app registers (odo_register_plugin). It
 * sees these headers alone; C++ authors use plugin.hpp.
 *
 * Life of an instance:   create -> configure -> activate -> process ... [reset | save | load] -> destroy
 * Threads: [control] and [process] calls to one instance never overlap and are ordered, but may come from different threads:
 * an instance must not depend on the thread it was created on (in Rust it is Send). Instances are independent of each other
 * and are called concurrently.
 *   [control]  any thread of the host, not during process
 *   [process]  the pipeline's thread, instance active
 *   [any]      any thread, at any time between create and destroy
 * No exception, longjmp or signal may leave a function of the plugin. The host's floating-point environment (rounding mode,
 * traps) must be as it was when a call returns.
 */
#ifndef ODOGRAPH_PLUGIN_H
#define ODOGRAPH_PLUGIN_H

#include <odograph/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what the host offers ----------------------------------------------------------------------------------------- */
/* One session's host. Valid from the entry's or create's call until the last of its instances is destroyed. */
typedef struct odo_host {
  uint32_t struct_size;
  uint32_t abi_major_min; /* the ABI majors the host supports, inclusive */
  uint32_t abi_major_max;
  uint32_t abi_minor;     /* of abi_major_max */
  odo_string version;     /* of the host, for the log */
  /* [any] A table of the service, or null where there is none: plugins cope. Tables live as long as the host. Ids that begin
   * with "odo." are the host's; all others are handed to the app (odo_session_options.get_service). */
  ODO_FUNCTION(const void *, get_service, (const struct odo_host *host, const char *id, uint64_t id_size));
} odo_host;

#define ODO_SERVICE_REPORT "odo.report/1"
/* Text for people. `key` groups equal reports ("no_magnetometer"): the host passes on one a second of each. */
typedef struct odo_report_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] */
  ODO_FUNCTION(void, report, (const odo_host *host, uint32_t instance, uint32_t severity, const odo_string *key, const odo_string *text));
} odo_report_service;

#define ODO_SERVICE_RANDOM "odo.random/1"
/* Random numbers that are a function of the run's seed, the instance and the stream alone. */
typedef struct odo_random_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] Seed for a generator of the plugin's own. */
  ODO_FUNCTION(uint64_t, seed, (const odo_host *host, uint32_t instance, uint64_t stream));
} odo_random_service;

#define ODO_SERVICE_ASSETS "odo.assets/1"
/* Paths of files that a config names, relative to the config. Where assets have no paths (inside an APK, in a browser) use
 * odo.assets/2. */
typedef struct odo_asset_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [control] Bytes of the path, which is absolute and not terminated, or ODO_E_NOT_FOUND. Writes at most `capacity`. */
  ODO_FUNCTION(int64_t, resolve, (const odo_host *host, const odo_string *name, char *path, uint64_t capacity));
} odo_asset_service;

#define ODO_SERVICE_ASSETS_2 "odo.assets/2"
typedef struct odo_asset odo_asset; /* the provider's own */
/* Contents of files that a config names. The app may provide this service itself (odo_session_options.get_service); the
 * host's reads files. */
typedef struct odo_asset_service_2 {
  uint32_t struct_size;
  uint32_t reserved;
  ODO_POINTER(void *, user); /* for open alone */
  /* [control] Opens an asset and writes its size in bytes. ODO_E_NOT_FOUND. */
  ODO_FUNCTION(int32_t, open, (void *user, const odo_string *name, odo_asset **asset, uint64_t *size));
  /* [any, one thread at a time for each asset] Copies up to `size` bytes from `offset`; returns how many, 0 at the end, below
   * 0 a status. */
  ODO_FUNCTION(int64_t, read, (odo_asset *asset, uint64_t offset, void *data, uint64_t size));
  /* [any] */
  ODO_FUNCTION(void, close, (odo_asset *asset));
} odo_asset_service_2;

#define ODO_SERVICE_WAKE "odo.wake/1"
/* For a plugin with an input of its own (a radio, a worker thread): asks to be called. */
typedef struct odo_wake_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] Soon, at the latest with the next sample, the host calls process of this instance with a batch of no messages; several
   * requests may be answered by one call. What then is emitted depends on real time: a replay does not repeat it. */
  ODO_FUNCTION(void, wake, (const odo_host *host, uint32_t instance));
} odo_wake_service;

/* ---- parameters --------------------------------------------------------------------------------------------------- */
#define ODO_PARAMETER_BOOL 1u
#define ODO_PARAMETER_INT 2u
#define ODO_PARAMETER_REAL 3u
#define ODO_PARAMETER_STRING 4u
#define ODO_PARAMETER_CHOICE 5u /* a string, one of `choices` */
#define ODO_PARAMETER_REALS 6u  /* exactly `count` numbers */

/* One line of a plugin's parameter table: it feeds validation, `odograph plugins ID`, the manifest and the schema. */
typedef struct odo_parameter {
  uint32_t struct_size;
  uint32_t type;          /* ODO_PARAMETER_* */
  odo_string name;        /* lower_case */
  odo_string unit;        /* SI: "m", "rad", "m/s^2", "m^(3/4)*s^(1/2)" (products, quotients, powers), px; "" for a number */
  odo_string help;        /* one sentence with the source of the number */
  odo_string default_text; /* as one would write it in YAML, in `unit` */
  odo_string choices;     /* separated by '|' */
  double min;             /* inclusive, numbers only */
  double max;
  uint32_t count;         /* of ODO_PARAMETER_REALS */
  uint32_t reserved;      /* 0 */
} odo_parameter;

/* A value out of the config, already checked against the table. */
typedef struct odo_value {
  uint32_t struct_size;
  uint32_t type;        /* ODO_PARAMETER_* */
  odo_string name;
  odo_string text;      /* STRING, CHOICE */
  ODO_POINTER(const double *, reals);  /* REAL, REALS */
  uint64_t count;       /* of reals */
  int64_t integer;      /* INT; BOOL as 0 or 1 */
} odo_value;

/* ---- data in and out ---------------------------------------------------------------------------------------------- */
/* Messages in the order of their time; GNSS, waypoints, ranges, steps of the system, descriptions of sensors and vendors'
 * messages that came too late for that follow newer ones. The host has checked them: at least of version 1.0's size, with
 * numbers that are finite and within what a sensor can measure. A plugin must survive others, but need not process them. Each message has its own size,
 * so that a batch needs no stride and mixes types. How the input is cut into batches never changes the output. A batch may
 * be empty (odo.wake/1). */
typedef struct odo_batch {
  uint32_t struct_size;
  uint32_t count;
  ODO_POINTER(const odo_header *const *, messages);
} odo_batch;

/* Where events go. The pointer is valid from activate to destroy; emit works within process of this instance alone. */
typedef struct odo_sink {
  uint32_t struct_size;
  uint32_t instance; /* this instance's number, for the report service */
  /* [process] The event is copied; bits of ODO_FLAG_HOST_MASK are cleared. ODO_E_STATE outside process and on other threads. ODO_E_ARGUMENT (a type
   * that neither this kind emits nor the table declares, an input, a pose, state, correction or report, or a field that is out of its range: a report names it),
   * ODO_E_STRUCT_SIZE, ODO_E_EXHAUSTED (more than 256 events in one call). ODO_E_UNSUPPORTED: an event that this host is too old
   * for; nothing is wrong. */
  ODO_FUNCTION(int32_t, emit, (const struct odo_sink *sink, const odo_header *event));
} odo_sink;

/* ---- the plugin's table ------------------------------------------------------------------------------------------- */
typedef struct odo_instance odo_instance; /* the plugin's own */
#define ODO_LARGEST_STATE 16777216u       /* bytes of saved state of one instance; more is not kept, and reported */

/* Bits of odo_plugin.flags. */
#define ODO_PLUGIN_SEVERAL_CAMERAS 1u /* a front-end that is given frames of all cameras instead of the first one's */
#define ODO_PLUGIN_NATIVE_FRAMES 2u   /* is given frames whose pixels only loan.native has */

typedef struct odo_plugin {
  uint32_t struct_size;   /* in: capacity. out: how much of it the plugin filled */
  uint32_t abi_major;     /* the version the plugin uses */
  uint32_t abi_minor;
  uint32_t interface_count;
  ODO_POINTER(const odo_string *, interfaces); /* kinds it serves: ODO_INTERFACE_* */
  odo_string id;          /* "group/name", as configs name it */
  odo_string version;     /* "major.minor.patch" */
  odo_string summary;     /* one sentence */
  odo_string refusal;     /* why the entry did not return ODO_OK */
  ODO_POINTER(const odo_parameter *, parameters);
  uint32_t parameter_count;
  uint32_t parameter_stride; /* sizeof(odo_parameter) as the plugin knew it */
  uint32_t flags;            /* ODO_PLUGIN_* */
  uint32_t reserved;         /* 0 */
  /* [control] Makes an instance that serves `interface_id`. `number` is its number in reports. */
  ODO_FUNCTION(int32_t, create, (const odo_host *host, uint32_t number, const odo_string *interface_id, odo_instance **instance));
  /* [control] All parameters, checked, numbers in the table's units; called once before activate. The rows and what they point to
   * are valid for the call alone. ODO_E_CONFIG refuses, after a report. */
  ODO_FUNCTION(int32_t, configure, (odo_instance *instance, const odo_value *values, uint32_t count, uint32_t stride));
  /* [control] From here on process may be called. `sink` outlives the instance. */
  ODO_FUNCTION(int32_t, activate, (odo_instance *instance, const odo_sink *sink));
  /* [process] Each message of the batch is processed whatever became of those before it; events that were emitted stand. Returns
   * the lowest status of all. */
  ODO_FUNCTION(int32_t, process, (odo_instance *instance, const odo_batch *batch));
  /* [control] Ends the instance, which releases all that it has retained first. */
  ODO_FUNCTION(void, destroy, (odo_instance *instance));
  /* What follows is optional: any of it may be null. */
  /* [control] Back to the state after activate, what was loaded included; calibrations and noise come again. Without it the host
   * makes a new instance. */
  ODO_FUNCTION(int32_t, reset, (odo_instance *instance));
  /* [control] What should survive a restart (a walker's personal parameters, ...), at most ODO_LARGEST_STATE bytes. Returns the
   * bytes needed; writes them if `capacity` suffices. 0: nothing to save. The host keeps it by the plugin's id. */
  ODO_FUNCTION(int64_t, save, (odo_instance *instance, void *data, uint64_t capacity));
  /* [control] After activate. ODO_E_DATA when the blob is not this plugin's or damaged: the state is as it was. */
  ODO_FUNCTION(int32_t, load, (odo_instance *instance, const void *data, uint64_t size));
  /* [any] An extension's table, or null. */
  ODO_FUNCTION(const void *, get_interface, (odo_instance *instance, const char *id, uint64_t id_size));
  /* Message types beyond those of its kinds: what it wants to be given and what it may emit. A vendor's messages, the
   * frames that a scale source looks at, the attitudes that an odometry gives by the way. */
  ODO_POINTER(const uint32_t *, inputs);
  ODO_POINTER(const uint32_t *, outputs);
  uint32_t input_count;
  uint32_t output_count;
} odo_plugin;

/* Whether a host supports the ABI of these headers; an entry that is called by another returns ODO_E_VERSION. */
#define ODO_HOST_FITS(host)                                                                                            \
  ((host)->abi_major_min <= ODO_ABI_MAJOR && ((host)->abi_major_max - ODO_ABI_MAJOR) >> 31 == 0 &&                     \
   (ODO_ABI_MAJOR != 0 || (host)->abi_minor == ODO_ABI_MINOR))

/* The name of the entry (odo_plugin_entry, base.h). A plugin that is linked into an app defines ODO_PLUGIN_ENTRY to a name of its own before it includes
 * this header. */
#define ODO_PLUGIN_ENTRY_SYMBOL "odo_plugin_entry_draft3" /* the freeze makes it odo_plugin_entry_v1 */
#if !defined(ODO_PLUGIN_ENTRY)
#define ODO_PLUGIN_ENTRY odo_plugin_entry_draft3
#endif
ODO_EXPORT int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host *host, odo_plugin *out);

#ifdef __cplusplus
}
#endif
#endif
