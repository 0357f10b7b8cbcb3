// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <ostream>

namespace odograph {

/// The head of a PLY file of points, whose rows follow as text.
inline void write_ply_head(std::ostream& out, const char* comment, size_t points,
                           std::initializer_list<const char*> properties) {
  out << "ply\nformat ascii 1.0\ncomment " << comment << "\nelement vertex " << points << '\n';
  for (const char* property : properties) out << "property " << property << '\n';
  out << "end_header\n";
}

}  // namespace odograph
