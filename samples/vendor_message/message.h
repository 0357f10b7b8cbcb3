/* SPDX-License-Identifier: Apache-2.0
 *
 * A vendor's message types, common to the app and its plugin. Vendor 0 is for experiments; docs/abi.md assigns others.
 */
#ifndef EXAMPLE_MESSAGE_H
#define EXAMPLE_MESSAGE_H

#include <odograph/base.h>

#define EXAMPLE_TYPE_WIFI_SCAN ODO_TYPE_VENDOR(0, 1)
#define EXAMPLE_TYPE_ZONE ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2)

/* From the app: the access points found by a scan. No pointers, so that it can be recorded and replayed. */
typedef struct example_wifi_scan {
  odo_header header; /* t_ns: of the scan, on the clock of the sensors */
  uint32_t count;    /* of access points */
  uint32_t reserved; /* 0 */
  struct {
    uint64_t bssid;
    double rssi_dbm;
  } access_points[32];
} example_wifi_scan;

/* From the plugin: the zone that the phone is in. */
typedef struct example_zone {
  odo_header header; /* t_ns: of the scan; quality: 1 if no other zone is possible */
  uint64_t zone;
} example_zone;

#endif
