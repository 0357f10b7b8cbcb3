#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# headset.sh SOURCE BUILD: libodograph_vit.so exports exactly the 21 functions, and a consumer gets the command line's
# poses.
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
count=$(nm -D --defined-only "$build/lib/libodograph_vit.so" | grep -c ' T vit_')
others=$(nm -D --defined-only "$build/lib/libodograph_vit.so" | grep -cv ' T vit_' || true)
[ "$count" = 21 ] && [ "$others" = 0 ] || { echo "FAILED: it exports $count functions of 21, and $others symbols beside them"; exit 1; }
"$build/bin/odograph" sim "$source/samples/scenarios/walk_short.yaml" --first 12 -o "$work/walk.odo" >/dev/null
exec "$build/bin/odograph-headset" "$build/lib/libodograph_vit.so" "$source/samples/configs/walk.yaml" "$work/walk.odo"
