// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// What is to be shown, from the command line.
struct Options {
  /// Something that is put before the camera at a time, at a place in its axes, m.
  struct Drop {
    double at_s;
    std::string name;
    double p[3];
  };
  /// A place on the Earth: degrees, and metres above the ground, the ellipsoid or the geoid.
  struct Place {
    std::string name;
    double latitude_deg, longitude_deg, height_m;
  };
  struct Picture {
    double at_s;
    std::string file;
  };
  std::string config, recording, video;
  int camera = -1;         ///< number of a V4L2 camera, instead of a recording
  double for_s = 1e9;      ///< of the recording, or of the camera
  double height_m = 1.45;  ///< of the phone above the ground
  int factor = 2;          ///< the picture's size over the camera's
  std::vector<Drop> drops;
  std::vector<Place> places;
  std::vector<Picture> pictures;
};

/// False after a message where something is wrong with them.
bool read_options(int argc, char** argv, Options& options);
