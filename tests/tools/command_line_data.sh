#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The command line on real recordings. ODOGRAPH_DATA and ODOGRAPH_REQUIRE_DATA in the environment take precedence.
set -u
odograph=$1 source=$2 data=${ODOGRAPH_DATA-$3} required=${ODOGRAPH_REQUIRE_DATA-$4}
for name in phone_walks tsukuba_90; do
  [ -d "$data/$name" ] && continue
  [ "$required" = ON ] && { echo "FAILED: no real recordings at $data/$name, and ODOGRAPH_REQUIRE_DATA is on"; exit 1; }
  echo "SKIPPED: no real recordings at $data/$name"
  exit 77
done
. "$source/tests/support/expect.sh"
configs=$source/samples/configs
walk=$(ls "$data"/phone_walks/*.txt | head -1)
expect 0 "steps" "$odograph" run -c "$configs/phone_walk.yaml" -i "$walk" -o w
expect 0 "distance error" "$odograph" eval --ref "$walk" --est w
expect 0 "written to" "$odograph" run -c "$configs/monocular.yaml" -i "$data/tsukuba_90" -o t
expect 0 "of the path" "$odograph" eval --ref "$data/tsukuba_90" --est t --align sim3
exit $failed
