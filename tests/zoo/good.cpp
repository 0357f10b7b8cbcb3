// SPDX-License-Identifier: Apache-2.0
//
// A good plugin of each kind, which must pass every case.
#include "tests/zoo/animal.hpp"

using namespace zoo;

#if defined(ZOO_good_attitude)
TABLE(attitude) {}
GOOD_ENTRY
#elif defined(ZOO_good_steps)
TABLE(steps) {}
GOOD_ENTRY
#elif defined(ZOO_good_odometry)
TABLE(odometry) {}
GOOD_ENTRY
#elif defined(ZOO_good_scale)
TABLE(scale) {}
GOOD_ENTRY
#elif defined(ZOO_good_fixer)
TABLE(fixer) {}
GOOD_ENTRY
#else
#error "no animal of this name"
#endif
