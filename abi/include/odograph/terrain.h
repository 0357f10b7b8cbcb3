/* SPDX-License-Identifier: Apache-2.0
 *
 * Extension of a plugin with a terrain model (odo_plugin.get_interface). The host uses it to place anchors above
 * terrain.
 */
#ifndef ODOGRAPH_TERRAIN_H
#define ODOGRAPH_TERRAIN_H

#include <odograph/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_EXTENSION_TERRAIN "odo.terrain/1"

typedef struct odo_terrain {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  ODO_POINTER(void *, user);        /* passed to height */
  /* [process] Returns the down coordinate of the ground in n at a horizontal position, and its standard deviation, m.
   * Of several surfaces above one another (a bridge), selects the one nearest to `near_down_m`. ODO_E_NOT_FOUND outside
   * the model. */
  ODO_FUNCTION(int32_t, height, (void *user, double north_m, double east_m, double near_down_m, double *down_m, double *sigma_m));
} odo_terrain;

#ifdef __cplusplus
}
#endif
#endif
