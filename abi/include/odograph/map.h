/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 7: maps of places that were seen, since 1.1. A plugin such as fix/map makes one while the session
 * runs; saved and loaded in a later session it recognises the place, and the anchors that were there are there again.
 * A map holds descriptors and positions of landmarks and no pictures.
 *
 * Equivalents in ARCore and ARKit: ARWorldMap, getCurrentWorldMap = odo_map_save; initialWorldMap = odo_map_load.
 */
#ifndef ODOGRAPH_MAP_H
#define ODOGRAPH_MAP_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

/* [control] Writes the maps of all plugins of the session, with the local anchors that are placed; while a loaded map is
 * not recognised, that map alone (report map_not_recognised). Allowed while samples arrive. Returns the number of bytes
 * required, and writes them if `capacity` suffices; data may be null with capacity 0. 0: there is nothing to save. The
 * number may grow between two calls. A negative value is a status: ODO_E_STATE from within a callback. */
ODO_API int64_t ODO_CALL odo_map_save(odo_session *session, void *data, uint64_t capacity);

/* [control] Adds a saved map to those of the session. Allowed while samples arrive. Its anchors appear at once, with new
 * ids and the names that they had (odo_anchor_list), and are ODO_LOST (ODO_REASON_NO_FIX) until the place is recognised
 * (odo_map_pose). An anchor whose name the session has already is left out. ODO_E_DATA: damaged, of a later format, or
 * of plugins that the session does not have; nothing has changed then, but for the maps of other plugins that precede
 * a damaged one, and a report says why. */
ODO_API int32_t ODO_CALL odo_map_load(odo_session *session, const void *data, uint64_t size);

#ifdef __cplusplus
}
#endif
#endif
