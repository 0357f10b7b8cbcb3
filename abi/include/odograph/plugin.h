/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 3: what a plugin implements.
 *
 * A plugin is a shared library that exports one symbol, ODO_PLUGIN_ENTRY, and beside it lies NAME.odoplugin.json,
 * which `odograph plugin manifest` writes. It sees only these headers; C++ authors use plugin.hpp.
 *
 * Life of an instance:   create -> configure -> activate -> process ... [reset | save | load] -> destroy
 * Threads: [control] and [process] calls to one instance never overlap and are ordered; instances are independent.
 *   [control]  any thread of the host, not during process
 *   [process]  the pipeline's thread, instance active
 *   [any]      any thread, at any time between create and destroy
 * No exception, longjmp or signal may leave a function of the plugin.
 */
#ifndef ODOGRAPH_PLUGIN_H
#define ODOGRAPH_PLUGIN_H

#include <odograph/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what the host offers ----------------------------------------------------------------------------------------- */
typedef struct odo_host {
  uint32_t struct_size;
  uint32_t abi_major_min; /* the ABI majors the host speaks, inclusive */
  uint32_t abi_major_max;
  uint32_t abi_minor;     /* of abi_major_max */
  odo_string version;     /* of the host, for the log */
  /* [any] A table of the service, or null where the host has none: plugins cope. Tables live as long as the host. */
  const void *(ODO_CALL *get_service)(const struct odo_host *host, const char *id, uint64_t id_size);
} odo_host;

#define ODO_SERVICE_REPORT "odo.report/1"
/* Text for people. `key` groups equal reports ("no_magnetometer"): the host passes on one a second of each. */
typedef struct odo_report_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] */
  void (ODO_CALL *report)(const odo_host *host, uint32_t instance, uint32_t severity, const odo_string *key,
                 const odo_string *text);
} odo_report_service;

#define ODO_SERVICE_RANDOM "odo.random/1"
/* Random numbers that are a function of the run's seed, the instance and the stream alone. */
typedef struct odo_random_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] Seed for a generator of the plugin's own. */
  uint64_t (ODO_CALL *seed)(const odo_host *host, uint32_t instance, uint64_t stream);
} odo_random_service;

#define ODO_SERVICE_ASSETS "odo.assets/1"
/* Files that a config names, relative to the config. */
typedef struct odo_asset_service {
  uint32_t struct_size;
  uint32_t reserved;
  /* [control] Bytes of the path, which is absolute and not terminated, or ODO_E_NOT_FOUND. Writes at most `capacity`. */
  int64_t (ODO_CALL *resolve)(const odo_host *host, const odo_string *name, char *path, uint64_t capacity);
} odo_asset_service;

/* ---- parameters --------------------------------------------------------------------------------------------------- */
#define ODO_PARAMETER_BOOL UINT32_C(1)
#define ODO_PARAMETER_INT UINT32_C(2)
#define ODO_PARAMETER_REAL UINT32_C(3)
#define ODO_PARAMETER_STRING UINT32_C(4)
#define ODO_PARAMETER_CHOICE UINT32_C(5) /* a string, one of `choices` */
#define ODO_PARAMETER_REALS UINT32_C(6)  /* exactly `count` numbers */

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
  const double *reals;  /* REAL, REALS */
  uint64_t count;       /* of reals */
  int64_t integer;      /* INT; BOOL as 0 or 1 */
} odo_value;

/* ---- data in and out ---------------------------------------------------------------------------------------------- */
/* Messages in the order of their time, as the host let them through: at least of version 1.0's size, with numbers that
 * are finite and within what a sensor can measure. A plugin must survive others, but need not answer to them. Each
 * message carries its own size, so a batch needs no stride and merges any types. How the input is cut into batches never
 * changes the output. */
typedef struct odo_batch {
  uint32_t struct_size;
  uint32_t count;
  const odo_header *const *messages;
} odo_batch;

/* Where events go. Valid from activate to destroy. */
typedef struct odo_sink {
  uint32_t struct_size;
  uint32_t instance; /* this instance's number, for the report service */
  /* [process] The event is copied. ODO_E_ARGUMENT (a type that neither this kind emits nor the table declares, or a value
   * that is not finite: a report names the field), ODO_E_STRUCT_SIZE, ODO_E_EXHAUSTED (more than 256 events in one call).
   * ODO_E_UNSUPPORTED: an event that this host is too old for; nothing is wrong. */
  int32_t (ODO_CALL *emit)(const struct odo_sink *sink, const odo_header *event);
} odo_sink;

/* ---- the plugin's table ------------------------------------------------------------------------------------------- */
typedef struct odo_instance odo_instance; /* the plugin's own */

typedef struct odo_plugin {
  uint32_t struct_size;   /* in: what the host's struct holds. out: how much of it the plugin filled */
  uint32_t abi_major;     /* the version the plugin uses */
  uint32_t abi_minor;
  uint32_t interface_count;
  const odo_string *interfaces; /* kinds it serves: ODO_INTERFACE_* */
  odo_string id;          /* "group/name", as configs name it */
  odo_string version;     /* "major.minor.patch" */
  odo_string summary;     /* one sentence */
  odo_string refusal;     /* why the entry did not return ODO_OK */
  const odo_parameter *parameters;
  uint32_t parameter_count;
  uint32_t parameter_stride; /* sizeof(odo_parameter) as the plugin knew it */
  /* [control] Makes an instance that serves `interface_id`. `number` is its number in reports. */
  int32_t (ODO_CALL *create)(const odo_host *host, uint32_t number, const odo_string *interface_id, odo_instance **instance);
  /* [control] All parameters, checked; called once before activate. ODO_E_CONFIG refuses, after a report. */
  int32_t (ODO_CALL *configure)(odo_instance *instance, const odo_value *values, uint32_t count, uint32_t stride);
  /* [control] From here on the instance may emit. `sink` outlives it. */
  int32_t (ODO_CALL *activate)(odo_instance *instance, const odo_sink *sink);
  /* [process] */
  int32_t (ODO_CALL *process)(odo_instance *instance, const odo_batch *batch);
  /* [control] */
  void (ODO_CALL *destroy)(odo_instance *instance);
  /* What follows is optional: a table may end here or leave any of it null. */
  /* [control] Back to the state after activate; cameras and noise are told anew. Without it the host makes a new instance. */
  int32_t (ODO_CALL *reset)(odo_instance *instance);
  /* [control] What should survive a restart (a walker's personal parameters, ...). Returns the bytes needed; writes them
   * if `capacity` suffices. 0: nothing to save. */
  int64_t (ODO_CALL *save)(odo_instance *instance, void *data, uint64_t capacity);
  /* [control] ODO_E_DATA when the blob is not this plugin's or damaged: the state is as it was. */
  int32_t (ODO_CALL *load)(odo_instance *instance, const void *data, uint64_t size);
  /* [any] An extension's table, or null. */
  const void *(ODO_CALL *get_interface)(odo_instance *instance, const char *id, uint64_t id_size);
  /* Message types beyond those of its kinds: what it wants to be given and what it may emit. A vendor's messages, the
   * frames that a scale source looks at, the attitudes that an odometry gives by the way. */
  const uint32_t *inputs;
  const uint32_t *outputs;
  uint32_t input_count;
  uint32_t output_count;
} odo_plugin;

/* The one exported symbol. Fills *out up to out->struct_size bytes and returns ODO_OK, or sets out->refusal and returns
 * ODO_E_VERSION or another status. Called once after loading; it must be quick and have no side effects. [control] */
/* Whether a host speaks the ABI of these headers: an entry that is asked by another answers ODO_E_VERSION. */
#define ODO_HOST_FITS(host)                                                                                            \
  ((host)->abi_major_min <= ODO_ABI_MAJOR && ((host)->abi_major_max - ODO_ABI_MAJOR) >> 31 == 0 &&                     \
   (ODO_ABI_MAJOR != 0 || (host)->abi_minor == ODO_ABI_MINOR))
typedef int32_t (ODO_CALL *odo_plugin_entry)(const odo_host *host, odo_plugin *out);
#define ODO_PLUGIN_ENTRY odo_plugin_entry_draft2 /* the freeze makes it odo_plugin_entry_v1 */
#define ODO_PLUGIN_ENTRY_SYMBOL "odo_plugin_entry_draft2"
ODO_EXPORT int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host *host, odo_plugin *out);

#ifdef __cplusplus
}
#endif
#endif
