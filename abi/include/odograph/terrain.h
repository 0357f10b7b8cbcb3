/* SPDX-License-Identifier: Apache-2.0
 *
 * Extension of a plugin that knows the ground's height (odo_plugin.get_interface): the host asks it where an anchor above
 * terrain stands.
 */
#ifndef ODOGRAPH_TERRAIN_H
#define ODOGRAPH_TERRAIN_H

#include <odograph/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_EXTENSION_TERRAIN "odo.terrain/draft3"

typedef struct odo_terrain {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  ODO_POINTER(void *, user);        /* for height alone */
  /* [process] Where the ground is at a place of n: downwards from n's origin, m, and its standard deviation. Of several
   * surfaces over one another (a bridge) the one nearest to `near_down_m`. ODO_E_NOT_FOUND where it knows no ground. */
  ODO_FUNCTION(int32_t, height, (void *user, double north_m, double east_m, double near_down_m, double *down_m, double *sigma_m));
} odo_terrain;

#ifdef __cplusplus
}
#endif
#endif
