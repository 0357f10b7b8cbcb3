/* SPDX-License-Identifier: Apache-2.0
 *
 * Extension of a plugin that knows the skylines of a city model (odo_plugin.get_interface): tools have it build a
 * database of them and ask what is in one. A skyline is eq. (2) of Gakne & O'Keefe 2018 in 720 directions from north to
 * the east, each in the middle of its half degree. Failures are reported in words through the report service.
 */
#ifndef ODOGRAPH_SKYLINES_H
#define ODOGRAPH_SKYLINES_H

#include <odograph/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_EXTENSION_SKYLINES "odo.skylines/1"
#define ODO_SKYLINE_DIRECTIONS 720u

/* What a database is. */
typedef struct odo_skyline_database {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  uint64_t places;
  uint64_t bytes;   /* of the file */
  double origin[3]; /* easting, northing and height of n's origin in the model's reference system, m */
  double spacing_m; /* between places; 0 where they have none */
} odo_skyline_database;

/* Called now and then while a database is built, on the caller's thread; 0 stops it. */
typedef int32_t(ODO_CALL* odo_skyline_progress)(void* context, uint64_t done, uint64_t all);

typedef struct odo_skylines {
  uint32_t struct_size;
  uint32_t reserved;        /* 0 */
  ODO_POINTER(void*, user); /* for the functions below */
  /* [control] Writes a database of the instance's model at `count` places (north, east, down of its n each, m), which
   * lie `spacing_m` apart. ODO_E_STATE without a model, ODO_E_DATA where it cannot be written, ODO_E_DISCARD where
   * `progress` (may be null) stopped it. */
  ODO_FUNCTION(int32_t, build,
               (void* user, const odo_string* file, const double* places_n, uint64_t count, double spacing_m,
                odo_skyline_progress progress, void* context));
  /* [control] Opens a database for what follows. ODO_E_DATA where it is none or damaged. */
  ODO_FUNCTION(int32_t, open, (void* user, const odo_string* file, odo_skyline_database* what));
  /* [control] The number of the place nearest to a point of the database's n. ODO_E_STATE before open. */
  ODO_FUNCTION(int32_t, nearest, (void* user, double north_m, double east_m, uint64_t* place));
  /* [control] A place (north, east, down in the database's n) and its skyline, 720 numbers each; any but `p_n` may be
   * null. ODO_E_DATA where the file is damaged there, ODO_E_NOT_FOUND where there is no such place. */
  ODO_FUNCTION(int32_t, skyline,
               (void* user, uint64_t place, double* p_n, float* elevation_rad, float* height_m, float* distance_m));
  /* [control] The skyline of the instance's model from a point of its own n: 720 elevations, rad, 0 where nothing is,
   * and which object of the model each is of (-1 nothing, -2 ground). ODO_E_STATE without a model. */
  ODO_FUNCTION(int32_t, look, (void* user, const double* p_n, float* elevation_rad, int32_t* object));
  /* [control] The ground of the model at a point of its n, m down: 1 in `terrain` where the model has terrain there, 0
   * where it is what lies between the lowest corners of the buildings. ODO_E_NOT_FOUND where there is neither near. */
  ODO_FUNCTION(int32_t, ground, (void* user, double north_m, double east_m, double* down_m, int32_t* terrain));
  /* [control] An edge of the model in its n, m, and whose it is (as above), by its number from 0. ODO_E_NOT_FOUND
   * beyond the last. */
  ODO_FUNCTION(int32_t, edge, (void* user, uint64_t number, double* from_n, double* to_n, int32_t* object));
  /* [any] Since 1.1. Correlation of the binary images of two skylines, 720 elevations each, rad: eq. (3), 1 where they
   * are equal. */
  ODO_FUNCTION(int32_t, correlate, (void* user, const float* seen_rad, const float* place_rad, double* correlation));
} odo_skylines;

#ifdef __cplusplus
}
#endif
#endif
