/* SPDX-License-Identifier: Apache-2.0
 *
 * An app that sends a message of its own type to its own plugin, and receives an event of its own type from it.
 *
 *   vendor_message pipeline.yaml FOLDER_OF_THE_PLUGIN
 */
#include <stdio.h>
#include <string.h>

#include <odograph/odograph.h>

#include "message.h"

static void on_event(void* user, const odo_header* event) {
  example_zone* newest = (example_zone*)user;
  if (event->type != EXAMPLE_TYPE_ZONE || event->struct_size < sizeof *newest) return;
  memcpy(newest, event, sizeof *newest);
  printf("zone %llu, quality %.2f\n", (unsigned long long)newest->zone, (double)newest->header.quality);
}

int main(int argc, char** argv) {
  const uint32_t wanted = EXAMPLE_TYPE_ZONE;
  odo_session_options options;
  odo_session* session = NULL;
  odo_error error;
  example_wifi_scan scan;
  example_zone zone;

  if (argc != 3) return fprintf(stderr, "usage: %s pipeline.yaml FOLDER_OF_THE_PLUGIN\n", argv[0]), 2;
  memset(&options, 0, sizeof options);
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY; /* an app on a phone uses ODO_RUN_LIVE */
  options.config_path.data = argv[1], options.config_path.size = strlen(argv[1]);
  options.plugin_path.data = argv[2], options.plugin_path.size = strlen(argv[2]);
  memset(&error, 0, sizeof error);
  error.struct_size = sizeof error;
  if (odo_session_create(&options, &session, &error) != ODO_OK) return fprintf(stderr, "%s\n", error.message), 2;
  memset(&zone, 0, sizeof zone);
  odo_session_set_callback(session, &wanted, 1, on_event, &zone);

  memset(&scan, 0, sizeof scan);
  scan.header.struct_size = sizeof scan;
  scan.header.type = EXAMPLE_TYPE_WIFI_SCAN;
  scan.header.t_ns = 1000000000;
  scan.count = 3;
  scan.access_points[0].bssid = 11, scan.access_points[0].rssi_dbm = -71;
  scan.access_points[1].bssid = 12, scan.access_points[1].rssi_dbm = -48;
  scan.access_points[2].bssid = 13, scan.access_points[2].rssi_dbm = -58;
  if (odo_session_push(session, &scan.header) != ODO_OK) return fprintf(stderr, "the scan was rejected\n"), 1;
  odo_session_flush(session);
  odo_session_destroy(session);
  return zone.zone == 12 ? 0 : 1;
}
