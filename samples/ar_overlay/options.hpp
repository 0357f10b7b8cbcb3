// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// The command line's options.
struct Options {
  /// An object placed in front of the camera at a time, at a position in its axes, m.
  struct Drop {
    double at_s;
    std::string name;
    double p[3];
    bool touched;  ///< by a touch: p are column and row of the picture's pixel
  };
  /// A geodetic position: degrees, and metres above the ground, the ellipsoid or the geoid.
  struct Place {
    std::string name;
    double latitude_deg, longitude_deg, height_m;
  };
  struct Picture {
    double at_s;
    std::string file;
  };
  std::string config, recording, video, map;
  int camera = -1;         ///< number of a V4L2 camera, instead of a recording
  double for_s = 1e9;      ///< of the recording, or of the camera
  double height_m = 1.45;  ///< of the phone above the ground
  int factor = 2;          ///< enlargement of the picture
  std::vector<Drop> drops;
  std::vector<Place> places;
  std::vector<Picture> pictures;
};

/// False, after a message, if they are invalid.
bool read_options(int argc, char** argv, Options& options);
