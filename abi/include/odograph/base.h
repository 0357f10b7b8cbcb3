/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: basic types, conventions and rules.
 *
 * Live input, recordings, replay, plugins and bindings use the same messages. Every input sample and every output event
 * is a struct that starts with an `odo_header`.
 *
 * Rules for every struct
 *  - It starts with `uint32_t struct_size`. For an input, this is the number of bytes that the writer filled. For an
 *    output, it is the capacity on entry and the number of bytes written on return.
 *  - New fields are appended at the end. Test ODO_HAS(pointer, field) before reading a field that is newer than version
 *    1.0 (messages.h lists the sizes of 1.0). A struct smaller than in version 1.0 is rejected. Of a larger one, the
 *    part beyond the known fields is forwarded unread.
 *  - No pointer is ever appended to a message, so that a host can forward messages of unknown type. `odo_loan` is the
 *    only access to borrowed memory.
 *  - A value is valid if its bit in `header.flags` is set. NaN never marks a missing value. Each covariance, standard
 *    deviation, quality and integrity has a bit or is always valid, as its comment states.
 *  - Lists (modes, reasons, states, formats) may gain numbers that an older reader does not have. docs/abi.md states
 *    how each list treats an unknown number.
 *  - Fields are fixed-width integers, float, double and pointers. Pointers occupy 8 bytes on every target
 *    (ODO_POINTER), and padding is explicit and zero, so that 32-bit and 64-bit targets share one layout. layout.h
 *    checks every offset.
 *
 * Conventions
 *  - SI units and radians. Times are int64_t nanoseconds of the sensor clock: any epoch, one clock for all sensors. All
 *    times are IMU time, but those of pushed frames, to which the host adds the camera's time_offset_ns.
 *  - Frames: n is local North-East-Down; b is the body, the axes of the IMU; c is the
 *    camera, x right, y down, z forward. R_n_c rotates vectors from c to n; p_n_c is the position of the origin of c in
 *    n. The north of n is true (geographic) north once it is observed, and arbitrary before: see ODO_POSE_NORTH and
 *    ODO_ATTITUDE_TRUE_NORTH. Satellite positions and velocities, and headings of fixes (yaw_rad), refer to true north
 *    at any time.
 *  - Quaternions are Hamilton, stored w, x, y, z, of either sign; q_n_b rotates vectors from b to n. Matrices are
 *    row-major.
 *  - Rotation errors are left perturbations in the target frame: R_true = Exp(theta) R, theta ~ N(0, P); for q_n_b,
 *    theta is expressed in n. Covariances are symmetric and positive semidefinite, standard deviations positive.
 */
#ifndef ODOGRAPH_BASE_H
#define ODOGRAPH_BASE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Odograph's ABI is little-endian: recordings and saved state could not be exchanged with this target"
#endif

/* Calling convention of every function of the ABI, explicit because Windows compilers can default to another one. */
#if defined(_WIN32)
#define ODO_CALL __cdecl
#else
#define ODO_CALL
#endif

/* Declare a pointer or a function pointer as a member of 8 bytes on every target. On 32-bit targets the upper four
 * bytes have no meaning. */
#if UINTPTR_MAX == UINT64_MAX
#define ODO_POINTER(type, name) type name
#define ODO_FUNCTION(result, name, arguments) result(ODO_CALL *name) arguments
#elif UINTPTR_MAX == UINT32_MAX
#if defined(__GNUC__)
#define ODO_ANONYMOUS_UNION __extension__ union
#else
#define ODO_ANONYMOUS_UNION union
#endif
#define ODO_POINTER(type, name)                                                                                        \
  ODO_ANONYMOUS_UNION {                                                                                                \
    type name;                                                                                                         \
    uint64_t name##_bits;                                                                                              \
  }
#define ODO_FUNCTION(result, name, arguments)                                                                          \
  ODO_ANONYMOUS_UNION {                                                                                                \
    result(ODO_CALL *name) arguments;                                                                                  \
    uint64_t name##_bits;                                                                                              \
  }
#else
#error "Odograph's ABI needs pointers of 32 or 64 bits"
#endif

/* ODO_EXPORT marks the entry function of a plugin. ODO_API marks the functions of the library. Define ODO_STATIC if
 * plugins or the library are linked statically. */
#if defined(ODO_STATIC)
#define ODO_EXPORT
#define ODO_API
#elif defined(_WIN32)
#define ODO_EXPORT __declspec(dllexport)
#if defined(ODO_BUILDING_LIBRARY)
#define ODO_API __declspec(dllexport)
#else
#define ODO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define ODO_EXPORT __attribute__((visibility("default")))
#define ODO_API ODO_EXPORT
#else
#define ODO_EXPORT
#define ODO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ABI version of these headers. An incompatible change raises the major version and renames the entry symbol; an
 * addition raises the minor version. */
#define ODO_ABI_MAJOR 1u
#define ODO_ABI_MINOR 1u

/* True if the struct at `ptr` contains `field`, according to its size, which is its first member. */
#define ODO_HAS(ptr, field)                                                                                            \
  ((uint64_t)((const char *)&(ptr)->field - (const char *)(ptr)) + sizeof((ptr)->field) <=                             \
   (uint64_t) * (const uint32_t *)(const void *)(ptr))

/* ---- status codes -------------------------------------------------------------------------------------------------
 * Zero is success, negative values are errors. The range of a code is its effect, also if a later version adds it:
 * -1 to -999: the input is discarded, the state unchanged; -1000 to -1999: a plugin instance needs reset or load, a
 * session can only be destroyed; -2000 and below: the whole plugin library is quarantined. */
#define ODO_OK 0
#define ODO_NOT_READY 1         /* no output yet, no error; state unchanged */
#define ODO_END 2               /* there is no more */
#define ODO_PARTIAL 3           /* done in part, the rest was refused */
#define ODO_E_ARGUMENT (-1)     /* the call violates the contract */
#define ODO_E_DISCARD (-2)      /* unusable input */
#define ODO_E_EXHAUSTED (-3)    /* a quota or buffer is full */
#define ODO_E_UNSUPPORTED (-4)  /* not supported by the called side */
#define ODO_E_STRUCT_SIZE (-5)  /* a struct is smaller than in version 1.0 */
#define ODO_E_VERSION (-6)      /* no common ABI version; nothing was created */
#define ODO_E_STATE (-7)        /* not allowed in this state */
#define ODO_E_CONFIG (-8)       /* invalid configuration; the instance stays unconfigured */
#define ODO_E_NOT_FOUND (-9)    /* no such file, plugin, key or time */
#define ODO_E_DATA (-10)        /* a file or blob is damaged */
#define ODO_E_IO (-11)          /* a file could not be created, read or written */
#define ODO_E_MEMORY (-1001)    /* out of memory */
#define ODO_E_ERROR (-1002)     /* internal failure */
#define ODO_E_FATAL (-2001)     /* the library must not be called again */

/* A UTF-8 string, neither terminated nor owned. Frozen at 16 bytes; embedded by value in other structs. */
typedef struct odo_string {
  ODO_POINTER(const char *, data); /* may be null when size is 0 */
  uint64_t size;                   /* bytes */
} odo_string;

/* ---- messages ---------------------------------------------------------------------------------------------------- */

/* Ranges of type numbers: 0 is none, 0x1 to 0xFFF are inputs, 0x1000 to 0x1FFF are events, 0x2000 to 0x7FFFFFFF are
 * reserved (apps, plugins and recordings must not use them), and 0x80000000 and above are vendor messages. A host
 * orders inputs and vendor messages of unknown type by time, records them and delivers them to the plugins that declare
 * them. In every range the bit ODO_BORROWED marks messages with borrowed memory; these are inputs only: emit returns
 * ODO_E_UNSUPPORTED. */
#define ODO_BORROWED 0x800u
#define ODO_TYPE_IMU 0x1u
#define ODO_TYPE_MAGNETOMETER 0x2u
#define ODO_TYPE_BAROMETER 0x3u
#define ODO_TYPE_GNSS 0x4u
#define ODO_TYPE_CALIBRATION 0x5u
#define ODO_TYPE_IMU_NOISE 0x6u
#define ODO_TYPE_WAYPOINT 0x7u
#define ODO_TYPE_EARTH_FIELD 0x8u
#define ODO_TYPE_PLATFORM_POSE 0x9u
#define ODO_TYPE_RANGE 0xAu
#define ODO_TYPE_SYSTEM_STEP 0xBu
#define ODO_TYPE_FRAME 0x801u
#define ODO_TYPE_ATTITUDE 0x1001u
#define ODO_TYPE_STEP 0x1002u
#define ODO_TYPE_MOTION_MODE 0x1003u
#define ODO_TYPE_VO_MOTION 0x1004u
#define ODO_TYPE_SCALE 0x1005u
#define ODO_TYPE_FIX 0x1006u
#define ODO_TYPE_POSE 0x1007u
#define ODO_TYPE_STATE 0x1008u
#define ODO_TYPE_CORRECTION 0x1009u
#define ODO_TYPE_REPORT 0x100Au
#define ODO_TYPE_REFINED 0x100Bu
#define ODO_TYPE_RELATIVE_POSE 0x100Cu
#define ODO_TYPE_POINTS 0x100Du
#define ODO_TYPE_SURFACE 0x100Eu
#define ODO_TYPE_KEY_FRAME 0x100Fu
#define ODO_TYPE_MAP_POSE 0x1010u

/* Type number of a vendor message. `vendor` (below 2^19) is assigned in docs/abi.md; the vendor chooses `number` (below
 * 4096). The message starts with an odo_header, contains no pointer and has at most ODO_LARGEST_MESSAGE bytes; it is
 * copied, recorded and replayed. With number & ODO_VENDOR_EVENT it is an event, which plugins emit and apps do not
 * push; without, it is an input, which apps push and plugins do not emit (ODO_E_ARGUMENT). With number & ODO_BORROWED
 * it starts with an odo_borrowed instead, and must be an input. Vendor 0 is for experiments. */
#define ODO_VENDOR_EVENT 0x400u
#define ODO_TYPE_VENDOR(vendor, number)                                                                                \
  (0x80000000u | ((uint32_t)(vendor) & 0x7FFFFu) << 12 | ((uint32_t)(number) & 0xFFFu))
#define ODO_IS_VENDOR(type) (((uint32_t)(type) >> 31) == 1)
#define ODO_IS_EVENT(type)                                                                                             \
  (((uint32_t)(type) >> 12) == 1 || (ODO_IS_VENDOR(type) && ((uint32_t)(type) & ODO_VENDOR_EVENT) != 0))
#define ODO_IS_RESERVED(type) ((uint32_t)(type) == 0 || ((uint32_t)(type) >= 0x2000u && (uint32_t)(type) <= 0x7FFFFFFFu))
#define ODO_IS_BORROWED(type) (((uint32_t)(type) & ODO_BORROWED) != 0)
#define ODO_LARGEST_MESSAGE 65536u

/* Bits of header.flags: 0 to 23 are specific to the type. Only the host sets 24 to 27; it clears all four on every
 * message that it receives. 28 to 31 are common to all types (29 and 30 are unused). Writers set bits that their
 * version does not define to 0. */
#define ODO_FLAG_QUALITY 0x80000000u     /* header.quality is valid */
/* On an input: it describes a sensor, an antenna, a map. The host keeps the newest of each type and source, and
 * delivers it again, before anything else, to a plugin that was reset or restarted. odo_calibration, odo_imu_noise and
 * odo_earth_field are such descriptions without the flag. */
#define ODO_FLAG_DESCRIPTION 0x10000000u
#define ODO_FLAG_HOST_MASK 0x0F000000u
#define ODO_FLAG_ACCEPTED 0x01000000u  /* on a published fix, scale, relative pose or map pose: the host used it */
#define ODO_FLAG_NAVIGATION 0x02000000u /* on a motion: q_n_c0 is valid; on a key frame: its pose is */

/* First member of every message. Frozen at 32 bytes; a message grows at its end. */
typedef struct odo_header {
  uint32_t struct_size; /* size of the whole message in its writer's version, bytes */
  uint32_t type;        /* ODO_TYPE_* */
  int64_t t_ns;         /* time of validity, within +-2^62; for a frame, the middle of the exposure of the middle row */
  uint32_t source;      /* input: number of the sensor, the same for frames and calibration of one camera; event: number
                         * of the plugin instance, set by the host */
  uint32_t flags;       /* validity bits */
  float quality;        /* 0 (worst) to 1 (best); valid with ODO_FLAG_QUALITY */
  uint32_t reserved;    /* 0 */
} odo_header;

/* Borrowed memory of a message: pixels, a buffer of the operating system, a texture. Its creator owns it; it is valid
 * during the call. To use it longer, call retain (ODO_E_EXHAUSTED if too many are retained) and later release, once for
 * each retain, and keep a copy of the struct (odo_copy). The functions read only `owner`, so that a host can retain
 * messages of unknown type. Frozen at 40 bytes. */
typedef struct odo_loan {
  ODO_POINTER(void *, owner);                    /* passed to the functions below; opaque otherwise */
  ODO_FUNCTION(int32_t, retain, (void *owner));  /* [any] null: cannot be retained */
  ODO_FUNCTION(void, release, (void *owner));    /* [any] */
  /* [any] Returns the platform object (ODO_NATIVE_*), borrowed likewise, or null if there is none. May be null. */
  ODO_FUNCTION(const void *, native, (void *owner, const char *id, uint64_t id_size));
  uint64_t reserved; /* 0 */
} odo_loan;

/* Ids for `native`, and the type that it returns for each. The content is complete when the message is pushed: the app
 * has waited for the camera's fence. A reader, on a GPU too, has finished before the call returns or before it calls
 * release. "odo.bytes/1" is reserved for a plain copy of borrowed memory. */
#define ODO_NATIVE_HARDWARE_BUFFER "android.hardware_buffer/1" /* AHardwareBuffer * */
#define ODO_NATIVE_PIXEL_BUFFER "apple.pixel_buffer/1"         /* CVPixelBufferRef */

/* First members of every message whose type has the bit ODO_BORROWED. Frozen at 72 bytes. */
typedef struct odo_borrowed {
  odo_header header;
  odo_loan loan;
} odo_borrowed;

struct odo_host;   /* plugin.h */
struct odo_plugin;
/* [any] Entry function of a plugin. Fills at most out->struct_size bytes of *out and returns ODO_OK, or sets
 * out->refusal and returns ODO_E_VERSION or another status. It is called once for each session or tool that uses the
 * plugin, possibly from several threads at once, so it must be fast, free of side effects, and fill the same table
 * every time. Everything that the table points to must stay valid while the library is loaded, that is, until the
 * process ends. */
typedef int32_t (ODO_CALL *odo_plugin_entry)(const struct odo_host *host, struct odo_plugin *out);

#ifdef __cplusplus
}
#endif
#endif
