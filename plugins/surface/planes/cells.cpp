// SPDX-License-Identifier: Apache-2.0
#include "plugins/surface/planes/cells.hpp"

#include <algorithm>
#include <tuple>

namespace odograph::planes {

std::vector<Cells::Cell>& Cells::sort() {
  const auto key = [](const Landmark& i) { return std::tuple(i.cell.x(), i.cell.y(), i.number); };
  std::sort(landmarks_.begin(), landmarks_.end(),
            [&](const Landmark& a, const Landmark& b) { return key(a) < key(b); });
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    if (cells_.empty() || cells_.back().at != landmarks_[i].cell)
      cells_.push_back({landmarks_[i].cell, i, i, 0, false});
    cells_.back().last = i + 1, cells_.back().on += landmarks_[i].on ? 1 : 0;
  }
  return cells_;
}

Cells::Cell* Cells::find(const Index& at) {
  const auto key = [](const Index& i) { return std::pair(i.x(), i.y()); };
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), at,
                                      [&](const Cell& cell, const Index& i) { return key(cell.at) < key(i); });
  return found != cells_.end() && found->at == at ? &*found : nullptr;
}

Cells::Count Cells::connect(Cell& from, std::vector<size_t>& on) {
  Count count;
  edge_.assign(1, &from);
  from.reached = true;
  while (!edge_.empty()) {
    const Cell& cell = *edge_.back();
    edge_.pop_back();
    for (size_t i = cell.first; i < cell.last; ++i)
      if (landmarks_[i].on) on.push_back(landmarks_[i].number);
    count.beside += cell.last - cell.first - cell.on, ++count.cells;
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        Cell* next = find(cell.at + Index(dx, dy));
        if (!next || next->reached || next->on == 0) continue;
        next->reached = true;
        edge_.push_back(next);
      }
  }
  return count;
}

}  // namespace odograph::planes
