#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `plugin check --recording` from the command line, on a recording of the simulator.
set -u
odograph=$1 plugins=$2 source=$3
. "$source/tests/support/expect.sh"
"$odograph" sim "$source/tests/data/tiny_walk.yaml" -o tiny.odo >/dev/null || exit 1
expect 0 'emits events: attitude ' "$odograph" plugin check "$plugins/attitude_vqf.so" --only recording --recording tiny.odo
expect 0 'frame ' "$odograph" plugin check "$plugins/vo_five_point.so" --only recording --recording tiny.odo --format json
expect 3 'no such file' "$odograph" plugin check "$plugins/attitude_vqf.so" --recording missing.odo
exit $failed
