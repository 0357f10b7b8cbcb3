#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The dependency rule: who may include whom.
set -eu
cd "$1"
fail() { echo "$1"; exit 1; }
grep -rnE '#include "(sdk|tests)/' plugins --include='*.[ch]pp' && fail "a plugin includes the host"
grep -rlE '#include <odograph/' plugins --include='*.[ch]pp' | grep -vE '/(plugin\.cpp|step_plugin\.hpp|attitude_plugin\.hpp|horizontal_scale\.hpp|database_extension\.hpp|frame_view\.hpp)$' && fail "an algorithm file includes the ABI"
grep -rnE '#include "(sdk|plugins|tests)/' samples && fail "a sample includes more than what is installed"
grep -rnE '#include "plugins/' sdk && fail "the host includes a plugin"
grep -rnE '#include <opencv2|embree|CLI/|nlohmann' sdk/base sdk/config sdk/core sdk/plugin_host && fail "the host core uses a heavy library"
grep -rnE 'std::(cout|cerr|exit|getenv)|printf *\(|[^a-z_]getenv *\(' sdk/base sdk/config sdk/core plugins --include='*.[ch]pp' | grep -v snprintf && fail "a library writes to the terminal or ends the program"
exit 0
