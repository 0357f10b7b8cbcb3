// SPDX-License-Identifier: Apache-2.0
#include <deque>

#include <GL/glu.h>

#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

/// Output of GLU's tessellator, vertex by vertex.
struct Cut {
  std::deque<std::array<double, 3>> points;  // GLU requires stable addresses
  std::vector<const double*> corners;
};

void take_vertex(void* vertex, void* cut) {
  static_cast<Cut*>(cut)->corners.push_back(static_cast<const double*>(vertex));
}
void take_edge(GLboolean, void*) {}  // its presence makes GLU emit only separate triangles
void meet_vertex(double at[3], void**, float*, void** out, void* cut) {
  auto& points = static_cast<Cut*>(cut)->points;
  points.push_back({at[0], at[1], at[2]});
  *out = points.back().data();
}

using Callback = void (*)();

}  // namespace

Vector3d newell_normal(const std::vector<Vector3d>& ring) {
  Vector3d n = Vector3d::Zero();
  for (size_t i = 0; i < ring.size(); ++i) n += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
  return n;
}

std::vector<std::array<Vector3d, 3>> triangulate(const std::vector<std::vector<Vector3d>>& rings) {
  if (rings.empty() || rings[0].size() < 3) return {};
  const Vector3d normal = newell_normal(rings[0]);
  if (!(normal.norm() >= 1e-9)) return {};  // rejects NaN, too, on which GLU crashes
  if (rings.size() == 1 && rings[0].size() == 3) return {{rings[0][0], rings[0][1], rings[0][2]}};
  Cut cut;
  GLUtesselator* tesselator = gluNewTess();
  gluTessNormal(tesselator, normal.x(), normal.y(), normal.z());
  gluTessProperty(tesselator, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_ODD);
  gluTessCallback(tesselator, GLU_TESS_VERTEX_DATA, reinterpret_cast<Callback>(take_vertex));
  gluTessCallback(tesselator, GLU_TESS_EDGE_FLAG_DATA, reinterpret_cast<Callback>(take_edge));
  gluTessCallback(tesselator, GLU_TESS_COMBINE_DATA, reinterpret_cast<Callback>(meet_vertex));
  gluTessBeginPolygon(tesselator, &cut);
  for (const auto& ring : rings) {
    gluTessBeginContour(tesselator);
    for (const Vector3d& p : ring) {
      cut.points.push_back({p.x(), p.y(), p.z()});
      gluTessVertex(tesselator, cut.points.back().data(), cut.points.back().data());
    }
    gluTessEndContour(tesselator);
  }
  gluTessEndPolygon(tesselator);
  gluDeleteTess(tesselator);
  std::vector<std::array<Vector3d, 3>> triangles;
  for (size_t i = 0; i + 2 < cut.corners.size(); i += 3)
    triangles.push_back(
        {Vector3d::Map(cut.corners[i]), Vector3d::Map(cut.corners[i + 1]), Vector3d::Map(cut.corners[i + 2])});
  return triangles;
}

}  // namespace odograph
