/* SPDX-License-Identifier: Apache-2.0
 *
 * Extension of a plugin that makes maps of places (odo_plugin.get_interface): tools read, join and thin its maps. Each
 * is in a frame of its own, z down. Failures are reported in words through the report service.
 */
#ifndef ODOGRAPH_PLACES_H
#define ODOGRAPH_PLACES_H

#include <odograph/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_EXTENSION_PLACES "odo.places/1"

/* A key frame of the map. */
typedef struct odo_place_view {
  uint32_t struct_size;
  uint32_t landmarks;
  uint32_t epoch; /* frames of one are of one session, tracked without interruption */
  uint32_t reserved;
  double q_m_c[4], p_m_c[3]; /* of the camera */
} odo_place_view;

/* Where another map lies in the map. */
typedef struct odo_place_joint {
  uint32_t struct_size;
  uint32_t asked;            /* key frames of both */
  uint32_t recognised;       /* of them, in the other map */
  uint32_t agreeing;         /* of them, on this place */
  double q_m_o[4], p_m_o[3]; /* from the other map to the map: a turn about the vertical and a shift */
  double sigma_m;            /* of a place of the other map, in each axis */
} odo_place_joint;

typedef struct odo_places {
  uint32_t struct_size;
  uint32_t reserved;        /* 0 */
  ODO_POINTER(void*, user); /* for the functions below */
  /* [control] Reads a map (odo_plugin.save_map) for what follows. ODO_E_DATA where it is none or damaged. */
  ODO_FUNCTION(int32_t, open, (void* user, const uint8_t* data, uint64_t size, uint64_t* views));
  /* [control] A key frame by its number from 0, and its landmarks' places in the map, three numbers each; `p_m` may be
   * null. ODO_E_NOT_FOUND beyond the last. */
  ODO_FUNCTION(int32_t, view, (void* user, uint64_t number, odo_place_view* view, double* p_m));
  /* [control] Adds another map of the same place; the frame remains. ODO_E_NOT_FOUND, and nothing changed, where too
   * few of its key frames are recognised or they do not agree. */
  ODO_FUNCTION(int32_t, join, (void* user, const uint8_t* data, uint64_t size, odo_place_joint* joint));
  /* [control] Removes key frames beside others until the map has at most that many bytes when saved, or a
   * single key frame. */
  ODO_FUNCTION(int32_t, thin, (void* user, uint64_t bytes));
  /* [control] Writes the map if `capacity` suffices; returns its bytes. */
  ODO_FUNCTION(int64_t, save, (void* user, uint8_t* data, uint64_t capacity));
} odo_places;

#ifdef __cplusplus
}
#endif
#endif
