// SPDX-License-Identifier: Apache-2.0
//
// Reason why an anchor is not placed, and whether it is in front of the camera.
#include <doctest/doctest.h>

#include <odograph/anchor.h>

#include "tests/support/session_app.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("anchor_state");

namespace {

const std::string kInertial = "coupling: {type: localizer}\n",
                  kPlace = "start: {position: [0 m, 0 m, 0 m], heading: 0 rad}",
                  kOrigin = "origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}";

std::string navigation(const std::string& keys) { return "navigation: {" + keys + "}\n"; }

odo_anchor_place in_view(double z_m) {
  odo_anchor_place out{};
  out.struct_size = sizeof out;
  out.kind = ODO_ANCHOR_VIEW, out.t_ns = ODO_TIME_LATEST, out.p[2] = z_m;
  return out;
}

odo_anchor_place on_earth() {
  odo_anchor_place out{};
  out.struct_size = sizeof out;
  out.kind = ODO_ANCHOR_GEODETIC, out.height_above = ODO_HEIGHT_ELLIPSOID;
  out.latitude_rad = 0.8, out.longitude_rad = 0.1, out.height_m = 302;
  return out;
}

uint64_t make(const App& app, const odo_anchor_place& at) {
  uint64_t id = 0;
  REQUIRE(odo_anchor_create(app.session, &at, &id) == ODO_OK);
  return id;
}

odo_anchor get(const App& app, uint64_t id) {
  odo_anchor anchor{};
  anchor.struct_size = sizeof anchor;
  REQUIRE(odo_anchor_get(app.session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor) == ODO_OK);
  return anchor;
}

}  // namespace

TEST_CASE("n's origin and the phone's position in n are independent, and an anchor's reason names the missing one") {
  const double geodetic[3] = {0.8, 0.1, 300};
  double p_n[3];
  App origin(kWalk + kInertial + navigation(kOrigin)), start(kWalk + kInertial + navigation(kPlace)),
      both(kWalk + kInertial + navigation(kOrigin + ", " + kPlace));
  CHECK(odo_session_from_geodetic(origin.session, geodetic, p_n) == ODO_OK);  // conversion needs no position
  CHECK(odo_session_from_geodetic(start.session, geodetic, p_n) == ODO_NOT_READY);
  for (App* app : {&origin, &start, &both}) make(*app, on_earth()), app->walk(0, 500);
  CHECK(get(origin, 1).reason == ODO_REASON_NO_FIX);
  CHECK(get(start, 1).reason == ODO_REASON_NO_ORIGIN);
  CHECK(std::string(odo_reason_text(ODO_REASON_NO_ORIGIN)) == "no origin on the Earth yet");
  CHECK(get(both, 1).state == ODO_TRACKING);
}

TEST_CASE("an anchor is in front only on the side that the phone's camera faces") {
  App app(kWalk + kInertial + navigation(kPlace));
  app.walk(0, 500);
  // Without a camera the pose is the body's, whose z axis points out of the screen.
  const uint64_t faced = make(app, in_view(-3)), behind = make(app, in_view(3));
  CHECK(get(app, faced).flags == (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE | ODO_ANCHOR_IN_FRONT));
  CHECK(get(app, behind).flags == (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE));
}

TEST_CASE("a geodetic anchor made before the first sample has the correct position in both worlds, for any heading") {
  for (const char* heading : {"0 rad", "3.1 rad"}) {
    App app(kWalk + kInertial +
            navigation(kOrigin + ", start: {position: [0 m, 0 m, 0 m], heading: " + std::string(heading) + "}"));
    odo_anchor_place place = on_earth();
    place.latitude_rad += 20 / 6.4e6;  // 20 m to the north
    const uint64_t id = make(app, place);
    int placed = 0;
    for (int i = 0; i < 2000; i += 10) {
      app.walk(i, i + 10);
      odo_anchor worlds[2]{};
      for (odo_anchor& world : worlds) world.struct_size = sizeof world;
      odo_anchor_get(app.session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &worlds[0]);
      odo_anchor_get(app.session, id, ODO_WORLD_SMOOTH, ODO_TIME_LATEST, &worlds[1]);
      if (worlds[0].state != ODO_TRACKING) continue;
      ++placed;
      for (int k = 0; k < 3; ++k) CHECK(std::abs(worlds[0].p_n[k] - worlds[1].p_n[k]) < 0.1);
      CHECK(std::abs(worlds[0].p_n[0] - 20) < 0.1);
    }
    CHECK(placed > 100);
  }
}

TEST_SUITE_END();
