// SPDX-License-Identifier: Apache-2.0
//
// A good plugin of each kind, which must pass every case.
#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

#if defined(FAULTY_good_attitude)
TABLE(attitude) {}
#elif defined(FAULTY_good_steps)
TABLE(steps) {}
#elif defined(FAULTY_good_odometry)
TABLE(odometry) {}
#elif defined(FAULTY_good_scale)
TABLE(scale) {}
#elif defined(FAULTY_good_fixer)
TABLE(fixer) {}
#else
#error "no plugin of this name"
#endif
