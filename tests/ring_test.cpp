// SPDX-License-Identifier: Apache-2.0
#include <deque>

#include <doctest/doctest.h>

#include "plugins/shared/ring.hpp"
#include "sdk/host/estimator/timed_positions.hpp"

TEST_SUITE_BEGIN("ring");

namespace {

/// As a queue does that is cut.
template <class Ring>
void check_newest() {
  Ring ring;
  std::deque<int> queue;
  CHECK(ring.empty());
  for (int i = 0; i < 23; ++i) {
    if (i == 13) ring.clear(), queue.clear();
    ring.push(i);
    queue.push_front(i);
    if (queue.size() > 5) queue.pop_back();
    REQUIRE(ring.size() == queue.size());
    for (size_t k = 0; k < queue.size(); ++k) CHECK(ring.back(k) == queue[k]);
  }
}

}  // namespace

TEST_CASE("a ring keeps the newest values, the host's and the plugins'") {
  check_newest<odograph::Ring<int, 5>>();
  check_newest<odograph::plugin::Ring<int, 5>>();
}

TEST_CASE("positions between those kept are linear, outside there are none but for a moment after the newest") {
  odograph::inertial::TimedPositions positions;
  CHECK(!positions.at(0, 100));
  const auto p = [](int64_t t_ns) { return Eigen::Vector3d(1e-3 * static_cast<double>(t_ns), 2, -1); };
  for (int64_t t = 0; t <= 3000; t += 10) positions.add(t, p(t));
  CHECK(*positions.at(3000) == p(3000));
  CHECK(*positions.at(2000) == p(2000));
  CHECK((*positions.at(2994) - p(2994)).norm() < 1e-12);
  CHECK(!positions.at(3001));
  CHECK(*positions.at(3099, 100) == p(3000));
  CHECK(!positions.at(3100, 100));
  CHECK(positions.at(450));  // 256 are kept, from 450 on
  CHECK(!positions.at(449));
}
