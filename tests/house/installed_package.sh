#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Outside the source tree, against the installed package: the C99 sample through CMake and through pkg-config, and the
# plugin sample with its static C++ runtime.
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cp -r "$source/samples" "$work/samples"
export CMAKE_GENERATOR=Ninja
PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name odograph.pc)")
# Called by its name from another folder, the program finds its plugins.
(cd "$work" && env -u ODOGRAPH_PLUGIN_PATH PATH="$work/prefix/bin:$PATH" odograph plugins | grep -q "^vo/odograph")
ODOGRAPH_PLUGIN_PATH=$(PKG_CONFIG_PATH=$PKG_CONFIG_PATH pkg-config --variable=plugindir odograph)
export PKG_CONFIG_PATH ODOGRAPH_PLUGIN_PATH

cmake -S "$work/samples/embed_c" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/cmake" >/dev/null
"$work/cmake/embed_c" "$work/samples/configs/phone_walk.yaml" | tail -1

libdir=$(pkg-config --variable=libdir odograph)
gcc -std=c99 -pedantic-errors -Wall -Wextra -Werror "$work/samples/embed_c/main.c" -o "$work/embed_pc" $(pkg-config --cflags --libs odograph) -lm -Wl,-rpath,"$libdir"
"$work/embed_pc" "$work/samples/configs/phone_walk.yaml" | tail -1

cmake -S "$work/samples/live_c" -B "$work/live" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/live" >/dev/null
"$work/live/live" "$work/samples/configs/phone_walk.yaml" "$work/live.odo" | tail -1

cmake -S "$work/samples/plugin_example" -B "$work/plugin" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/plugin" >/dev/null
"$work/prefix/bin/odograph" plugin manifest "$work/plugin/constant_speed.so"
cp "$work/plugin/constant_speed.odoplugin.json" "$work/by_command_line.json"
"$(pkg-config --variable=manifest odograph)" "$work/plugin/constant_speed.so"
cmp "$work/by_command_line.json" "$work/plugin/constant_speed.odoplugin.json"
"$work/prefix/bin/odograph" plugin check "$work/plugin/constant_speed.so"
[ "$(nm -D --defined-only "$work/plugin/constant_speed.so" | awk '{print $NF}')" = odo_plugin_entry_v1 ]

cmake -S "$work/samples/plugins_c" -B "$work/plugins_c" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/plugins_c" >/dev/null
for plugin in fix_range vo_platform_pose; do
  "$work/prefix/bin/odograph" plugin check "$work/plugins_c/$plugin.so" > "$work/said" || { grep FAIL "$work/said"; exit 1; }
done
cmake -S "$work/samples/vendor_message" -B "$work/vendor" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/vendor" >/dev/null
"$work/vendor/vendor_message" "$work/samples/vendor_message/pipeline.yaml" "$work/vendor"

# A new plugin of each kind in both languages builds, passes the check and runs; the rest of its pipeline gives the
# displacement if it does not.
"$work/prefix/bin/odograph" sim "$work/samples/scenarios/walk_short.yaml" --first 8 -o "$work/short.odo" >/dev/null
for kind in attitude step_estimator vo_frontend scale_source absolute_fixer surface_finder; do
  for language in "" --c; do
    name=fresh_$kind${language#--}
    "$work/prefix/bin/odograph" plugin new $kind trial/$name "$work/$name" $language >/dev/null
    cmake -S "$work/$name" -B "$work/$name/build" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
    cmake --build "$work/$name/build" >/dev/null
    "$work/prefix/bin/odograph" plugin check "$work/$name/build/$name.so" > "$work/$name/said" || { grep FAIL "$work/$name/said"; exit 1; }
    "$work/prefix/bin/odograph" config check "$work/$name/pipeline.yaml" >/dev/null
    [ "$kind" = scale_source ] && continue  # no steps beside it: the displacement is that of its single speed
    "$work/prefix/bin/odograph" run -c "$work/$name/pipeline.yaml" -i "$work/short.odo" -o "$work/$name/out" --json >/dev/null || [ $? = 1 ]
    python3 -c "import json, sys; m = json.load(open(sys.argv[1]))['distance_m']; sys.exit(not 4 < m < 16 and f'{m} m of 8 m')" "$work/$name/out/summary.json"
    [ "$kind" != surface_finder ] || grep -q '"kind": "floor"' "$work/$name/out/surfaces.json"
  done
done
# As a repository: the commands of its CI, and the report; a failing plugin is reported in red.
(cd "$work" && "$work/prefix/bin/odograph" plugin new absolute_fixer acme/fix_it --repository > /dev/null)
if command -v openssl >/dev/null; then # signed too
  openssl genpkey -algorithm ed25519 -out "$work/key.pem"
  export ODOGRAPH_KEY="$work/key.pem"
fi
(cd "$work/fix_it" && PATH="$work/prefix/bin:$PATH" sh ci/check -DCMAKE_PREFIX_PATH="$work/prefix" > said) || { cat "$work/fix_it/said"; exit 1; }
[ -z "${ODOGRAPH_KEY:-}" ] || grep -q 'signers: \[{ids: acme/fix_it, key: [0-9a-f]*}\]' "$work/fix_it/said"
grep -q '^# acme/fix_it 0.1.0 conforms to odo.absolute_fixer/' "$work/fix_it/build/conformance.md"
grep -q ' cases passed' "$work/fix_it/build/conformance.svg"
python3 -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1]); m.parse(sys.argv[2])' "$work/fix_it/build/conformance.svg" "$work/fix_it/build/check.xml"
"$work/prefix/bin/odograph" plugins --plugins "$work/plugin" example/constant_speed
