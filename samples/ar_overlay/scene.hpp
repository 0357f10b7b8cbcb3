// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <odograph/anchor.h>
#include <odograph/scene.h>

#include "canvas.hpp"
#include "options.hpp"

/// The virtual objects: the anchors of the options, the path walked, and a grid on the ground. Objects fixed to the
/// world are anchors of the session; the grid follows the phone.
class Scene {
 public:
  Scene(odo_session* session, const Options& options) : session_(session), options_(options) {}

  /// Call once per picture, after pushing it; `seconds` since the start of the recording.
  void put_up(int64_t t_ns, double seconds);
  void draw(Canvas& canvas, int64_t t_ns) const;

 private:
  uint64_t touch(const std::string& name, double column, double row, int64_t t_ns) const;
  uint64_t anchor(uint32_t kind, const std::string& name, const Point& p, int64_t t_ns) const;
  void draw_grid(Canvas& canvas, const odo_pose& pose, double ground_down) const;
  std::vector<Point> path_points(int64_t t_ns) const;
  void draw_path(Canvas& canvas, const odo_pose& pose, const std::vector<Point>& points) const;
  void draw_map(Canvas& canvas, const odo_pose& pose, const std::vector<Point>& path, int64_t t_ns) const;
  void draw_anchors(Canvas& canvas, const odo_pose& pose, double ground_down, int64_t t_ns) const;
  void draw_state(Canvas& canvas, const odo_pose& pose, bool known) const;

  odo_session* session_;
  const Options& options_;
  struct Shown {
    uint64_t id;
    std::string name;
    int colour;
  };
  std::vector<Shown> shown_;
  std::vector<uint64_t> path_;  // an anchor on the ground every kPath_m
  Point last_path_;
  double ground_down_ = 0;
  bool placed_ = false, started_ = false;
};
