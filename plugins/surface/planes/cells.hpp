// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace odograph::planes {

/// Landmarks on a plane and beside it, in square cells. Keeps its memory.
class Cells {
 public:
  using Index = Eigen::Vector2i;
  struct Landmark {
    Index cell;
    size_t number;
    bool on;
  };
  struct Cell {
    Index at;
    size_t first, last, on;  ///< its landmarks, and how many of them are on the plane
    bool reached;
  };
  /// Of the cells of a connected patch.
  struct Count {
    size_t beside = 0, cells = 0;
  };

  static Index index_of(const Eigen::Vector2d& p, double side) {
    return (p / side).array().floor().matrix().cast<int>();
  }
  void clear() { landmarks_.clear(), cells_.clear(); }
  void add(const Index& cell, size_t number, bool on) { landmarks_.push_back({cell, number, on}); }
  /// After all were added: the cells, in order.
  std::vector<Cell>& sort();
  Cell* find(const Index& at);
  /// Appends the numbers of the landmarks on the plane in all cells that are connected with one, by sides or corners.
  Count connect(Cell& from, std::vector<size_t>& on);

 private:
  std::vector<Landmark> landmarks_;
  std::vector<Cell> cells_;
  std::vector<Cell*> edge_;
};

}  // namespace odograph::planes
