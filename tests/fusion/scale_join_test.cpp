// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/scale_group_numbers.hpp"
#include "sdk/host/core/scale_join.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("scale_join");

namespace {

odo_scale scale(double scale, double relative_sigma, uint32_t flags = 0) {
  auto s = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  s.header.flags = flags;
  s.scale = scale, s.sigma = relative_sigma * scale;
  s.scale_group = 7, s.valid_from_ns = 0, s.valid_to_ns = 1000;
  return s;
}

odo_vo_motion motion(int64_t t_ns, uint32_t group = 7) {
  auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
  m.scale_group = group;
  return m;
}

}  // namespace

TEST_CASE("two scales of one motion are averaged in the logarithm, weighted by their inverse variances") {
  ScaleJoin join(2);
  join.begin(motion(100), false);
  const odo_scale a = scale(2.0, 0.05), b = scale(2.4, 0.20);
  CHECK(join.answer(0, a) == ScaleUse::used);
  CHECK(join.answer(1, b) == ScaleUse::used);
  const odo_scale* both = join.joined();
  REQUIRE(both);
  // Sixteen times the weight for a quarter of the error.
  CHECK(both->scale == doctest::Approx(std::exp((16 * std::log(2.0) + std::log(2.4)) / 17)).epsilon(1e-12));
  CHECK(both->sigma / both->scale == doctest::Approx(1 / std::sqrt(400.0 + 25.0)).epsilon(1e-12));
  join.reset();
  CHECK(join.note(0, scale(2.0, 0.05)) == ScaleUse::used);  // no motion waits: any scale may be of a later one
  join.reset();
  join.begin(motion(100), false);
  CHECK_FALSE(join.joined());
}

TEST_CASE("a horizontal scale and one of all three components are not mixed, and their common validity is reported") {
  ScaleJoin join(3);
  join.begin(motion(100), false);
  odo_scale a = scale(2.0, 0.1, ODO_SCALE_HORIZONTAL | ODO_SCALE_STEADY), c = scale(2.2, 0.1, ODO_SCALE_HORIZONTAL);
  a.valid_from_ns = 50, c.valid_to_ns = 500;
  join.answer(0, a), join.answer(1, scale(9.0, 0.001)), join.answer(2, c);
  const odo_scale* both = join.joined();
  REQUIRE(both);
  CHECK(both->scale == doctest::Approx(std::sqrt(2.0 * 2.2)));
  CHECK((both->header.flags & ODO_SCALE_HORIZONTAL) != 0);
  CHECK((both->header.flags & ODO_SCALE_STEADY) == 0);
  CHECK(both->valid_from_ns == 50);
  CHECK(both->valid_to_ns == 500);
}

TEST_CASE("a scale does not outlive the front-end of its group, nor its reset") {
  ScaleGroupNumbers groups;
  ScaleJoin join(1);
  const auto begins = [&](uint32_t instance, uint32_t resets, uint32_t group) {
    join.begin(motion(100, groups.number(instance, resets, group)), false);
    return join.group();
  };
  CHECK(begins(2, 0, 7) == 7);  // the first front-end's own numbers remain
  CHECK(join.answer(0, scale(2.0, 0.05)) == ScaleUse::used);
  CHECK(begins(2, 0, 7) == 7);
  CHECK(join.joined());
  CHECK(begins(2, 1, 7) == 15);  // reset
  CHECK_FALSE(join.joined());
  CHECK(begins(2, 1, 0) == 8);
  CHECK_FALSE(join.joined());
  CHECK(begins(3, 0, 7) == 23);  // another takes over
  CHECK_FALSE(join.joined());
  CHECK(begins(2, 1, 7) == 31);  // and hands back
  CHECK_FALSE(join.joined());
}
