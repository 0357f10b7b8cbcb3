// SPDX-License-Identifier: Apache-2.0
//
// A plugin whose input and output are messages defined by its vendor: the zone is that of the strongest access point.
// As a fixer it could also emit an odo_fix.
#include <algorithm>
#include <cmath>

#include <odograph/plugin.hpp>

#include "message.h"

template <>
struct odo::type_of<example_wifi_scan> : std::integral_constant<uint32_t, EXAMPLE_TYPE_WIFI_SCAN> {};
template <>
struct odo::type_of<example_zone> : std::integral_constant<uint32_t, EXAMPLE_TYPE_ZONE> {};

struct ZoneByWifi {
  double clear_db = 20.0;

  static constexpr odo::Description description{"example/zone_by_wifi", "1.0.0",
                                                "The zone of the strongest access point", ODO_INTERFACE_ABSOLUTE_FIXER};
  static constexpr uint32_t extra_inputs[] = {EXAMPLE_TYPE_WIFI_SCAN};
  static constexpr uint32_t extra_outputs[] = {EXAMPLE_TYPE_ZONE};
  using VendorMessages = odo::Messages<example_wifi_scan>;  // input of on()

  static std::vector<odo::Parameter<ZoneByWifi>> parameters() {
    return {odo::real("clear_db", "", 0.1, 100.0, &ZoneByWifi::clear_db,
                      "dB above the second strongest at which the quality is 1: two walls attenuate by about 20.")};
  }

  // The host checks the size of a vendor's message but not its fields.
  void on(const example_wifi_scan& scan, odo::Output& output) {
    const uint32_t count = std::min<uint32_t>(scan.count, 32);
    uint32_t loudest = count;
    double second_dbm = -200;
    for (uint32_t i = 0; i < count; ++i) {
      const double dbm = scan.access_points[i].rssi_dbm;
      if (!(dbm > -200 && dbm < 50)) continue;  // NaN too
      if (loudest < count && dbm <= scan.access_points[loudest].rssi_dbm) {
        second_dbm = std::max(second_dbm, dbm);
      } else {
        if (loudest < count) second_dbm = scan.access_points[loudest].rssi_dbm;
        loudest = i;
      }
    }
    if (loudest == count) return;
    auto zone = odo::make<example_zone>(scan.header.t_ns);
    zone.zone = scan.access_points[loudest].bssid;
    zone.header.flags = ODO_FLAG_QUALITY;
    zone.header.quality =
        static_cast<float>(std::min(1.0, (scan.access_points[loudest].rssi_dbm - second_dbm) / clear_db));
    output.emit(zone);
  }
};

ODO_PLUGIN(ZoneByWifi)
