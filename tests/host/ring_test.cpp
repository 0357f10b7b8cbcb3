// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <deque>
#include <vector>

#include <doctest/doctest.h>

#include "sdk/host/localizer/timed_positions.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/sample_intervals.hpp"
#include "sdk/math/time.hpp"

TEST_SUITE_BEGIN("ring");

namespace {

/// Like a queue of limited length.
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

TEST_CASE("a ring keeps the newest values") { check_newest<odograph::Ring<int, 5>>(); }

TEST_CASE("the intervals between samples cover a span once, in order, and gaps and missing ends are reported") {
  struct Sample {
    int64_t t_ns;
  };
  odograph::Ring<Sample, 8> ring;
  struct Part {
    int64_t before, after, t0, t1;
    bool operator==(const Part&) const = default;
  };
  std::vector<Part> parts;
  const auto visit = [&](const Sample& a, const Sample& b, int64_t t0, int64_t t1) {
    parts.push_back({a.t_ns, b.t_ns, t0, t1});
  };
  const auto whole = [&](int64_t from_ns, int64_t to_ns) {
    parts.clear();
    return odograph::for_each_interval(ring, from_ns, to_ns, 15, visit);
  };
  CHECK(!whole(0, 10));
  for (const int64_t t_ns : {100, 110, 120, 150, 160}) ring.push({t_ns});
  CHECK(odograph::count_after(ring, 120) == 2);
  CHECK(odograph::count_after(ring, 99) == 5);
  CHECK(odograph::count_after(ring, 160) == 0);
  CHECK(whole(103, 118));
  CHECK(parts == std::vector<Part>{{100, 110, 103, 110}, {110, 120, 110, 118}});
  CHECK(whole(110, 120));
  CHECK(parts == std::vector<Part>{{110, 120, 110, 120}});
  CHECK(whole(85, 100));  // extrapolated before the oldest and after the newest sample
  CHECK(parts == std::vector<Part>{{100, 100, 85, 100}});
  CHECK(whole(155, 175));
  CHECK(parts == std::vector<Part>{{150, 160, 155, 160}, {160, 160, 160, 175}});
  CHECK(whole(165, 170));
  CHECK(parts == std::vector<Part>{{160, 160, 165, 170}});
  CHECK((!whole(84, 100) && parts.empty()));
  CHECK((!whole(150, 176) && parts.empty()));
  CHECK(!whole(115, 155));  // 120 to 150
  CHECK(parts.size() == 3);
  CHECK(whole(125, 140));  // within that gap, but no longer than a gap may be
  CHECK((whole(130, 130) && parts.empty()));
}

TEST_CASE("pressure and height are inverse to each other and follow the standard atmosphere") {
  const double table[][2] = {{0, 101325}, {1000, 89874.6}, {5000, 54019.9}, {11000, 22632.1}};  // m, Pa (ISO 2533)
  for (const auto& [height_m, pressure_pa] : table) {
    CHECK(odograph::pressure_at_pa(height_m) == doctest::Approx(pressure_pa).epsilon(1e-5));
    CHECK(std::abs(odograph::pressure_height_m(odograph::pressure_at_pa(height_m)) - height_m) < 1e-9);
  }
}

TEST_CASE("nanoseconds are rounded to nearest, and seconds are the inverse") {
  CHECK(odograph::nanoseconds(1.001) == 1'001'000'000);  // truncation would give one less
  CHECK(odograph::nanoseconds(-1.5e-9) == -2);
  CHECK(odograph::seconds(3 * odograph::kSecond_ns + 5 * odograph::kMillisecond_ns) == doctest::Approx(3.005));
}

TEST_CASE("stored positions are interpolated linearly, and extrapolated only for a moment after the newest") {
  odograph::TimedPositions positions;
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
