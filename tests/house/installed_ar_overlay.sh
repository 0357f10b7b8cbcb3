#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the augmented reality sample against the installed package and runs it over a few metres of a street: a video
# and a picture.
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cp -r "$source/samples" "$work/samples"
export CMAKE_GENERATOR=Ninja
if ! cmake -S "$work/samples/ar_overlay" -B "$work/ar" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >"$work/ar.log" 2>&1; then
  grep -q OPENCV "$work/ar.log" || { cat "$work/ar.log"; exit 1; }
  echo "SKIPPED: samples/ar_overlay needs libopencv-videoio-dev"
  exit 77
fi
cmake --build "$work/ar" >/dev/null
"$work/prefix/bin/odograph" sim "$work/samples/scenarios/street_short.yaml" --first 6 -o "$work/walk.odo" >/dev/null
"$work/ar/ar_overlay" "$work/samples/configs/walk.yaml" "$work/walk.odo" -o "$work/walk.mp4" --drop "4:Bakery:1,-0.5,6" --picture "5:$work/walk.png"
[ -s "$work/walk.mp4" ] && [ -s "$work/walk.png" ]
