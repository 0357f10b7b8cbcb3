#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# repeat.sh and odograph-batches on two short rendered walks.
set -eu
odograph=$1 source=$2 batches=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/short.yaml" <<'YAML'
odograph_scenario: 1
walker: {stand: 1.5 s}
route:
  points: [[0, 0, 0], [5, 0, 0]]
camera: {width: 320, height: 240, focal: 240 px}
YAML
for seed in 1 2; do "$odograph" sim "$work/short.yaml" -o "$work/$seed.odo" --seed $seed >/dev/null; done
"$source/tests/host/repeat.sh" "$odograph" "$source/samples/configs/walk.yaml" 2 "$work/1.odo" "$work/2.odo"
"$batches" "$source/samples/configs/walk.yaml" "$work/1.odo" "$work/2.odo"
