#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# web.sh ODOGRAPH SOURCE FOLDER [PICTURES]: @odograph/web and its page, as packaging/targets wasm has built them into FOLDER, against the command line.
# With ODOGRAPH_REQUIRE_WEB=ON what is missing for that is a failure.
set -u
odograph=$1 source=$2 built=$3 pictures=${4:-}
missing=77
[ "${ODOGRAPH_REQUIRE_WEB:-OFF}" != ON ] || missing=1
[ -e "$built/web/odograph/odograph.wasm" ] || { echo "SKIPPED: no $built/web: packaging/targets wasm builds it"; exit $missing; }
NODE_PATH=${NODE_PATH:-${ODOGRAPH_TARGETS:-$HOME/.cache/odograph-targets}/npm/node_modules} # packaging/dependencies test
export NODE_PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0 skipped=0
run() { # what a script says, whatever comes of it
  "$@"
  case $? in 0) ;; 77) skipped=$((skipped + 1)) ;; *) failed=1 ;; esac
}
"$odograph" sim "$source/samples/scenarios/street_short.yaml" --seed 1 -o "$work/walk.odo" || exit 1
"$odograph" run -c "$source/samples/configs/walk.yaml" -i "$work/walk.odo" -o "$work/run" || exit 1
run node "$source/tests/web/page.js" "$built/web" "$work/walk.odo" "$work/run/trajectory.tum" $pictures
# Pictures that node can read to the digit: PNG, by way of a folder that has them.
"$odograph" convert "$work/walk.odo" "$work/euroc" >/dev/null && "$odograph" convert "$work/euroc" "$work/png.odo" >/dev/null &&
  "$odograph" run -c "$source/samples/configs/walk.yaml" -i "$work/png.odo" -o "$work/png" >/dev/null || exit 1
run node "$source/tests/web/node.mjs" "$built/npm" "$work/png.odo" "$work/png/trajectory.tum" "$source/samples/configs/walk.yaml"
# The types, by what a user writes.
mkdir -p "$work/types/node_modules/@odograph"
cp "$source/tests/web/types.ts" "$work/types"
cp -r "$built/npm" "$work/types/node_modules/@odograph/web"
tsc=$(node -p "require.resolve('typescript/bin/tsc')" 2>/dev/null) &&
  { node "$tsc" --noEmit --strict --target es2022 --module nodenext --moduleResolution nodenext --lib es2022,dom "$work/types/types.ts" || failed=1; } || skipped=$((skipped + 1))
[ $failed = 0 ] || exit 1
[ $skipped = 0 ] || exit $missing
