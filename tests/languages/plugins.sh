#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# plugins.sh SOURCE BUILD [LANGUAGE [KIND...]]: a new plugin of each kind in Rust and in Python, as written by
# `odograph plugin new`, outside the tree and against the installed package, builds, passes the check and runs. A
# language without its tools is reported and skipped.
set -eu
source=$1 build=$2 languages=${3:-rust python}
kinds=${*:4}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
program=$work/prefix/bin/odograph
export CMAKE_GENERATOR=Ninja CARGO_TARGET_DIR=$work/target CARGO_HOME=$work/cargo_home PATH=/usr/bin:$PATH # Debian's, if there is another one
unset PYTHONPATH ODOGRAPH_PLUGIN_PATH
"$program" sim "$source/samples/scenarios/walk_short.yaml" --first 8 -o "$work/short.odo" >/dev/null
done=0

quietly() { "$@" >"$work/said" 2>&1 || { echo "FAILED: $*"; grep -E "FAIL|error|Error" "$work/said" | head -20 || tail -20 "$work/said"; exit 1; }; }

for language in $languages; do
  case $language in
    rust) command -v cargo >/dev/null || { echo "SKIPPED: Rust: no cargo"; continue; } ;;
    python) python3 -c 'import numpy' 2>/dev/null || { echo "SKIPPED: Python: no numpy"; continue; } ;;
  esac
  for kind in ${kinds:-attitude step_estimator vo_frontend scale_source absolute_fixer surface_finder}; do
    name=${language}_$kind folder=$work/${language}_$kind
    if [ "$language" = rust ]; then # as in the vendor's CI
      quietly "$program" plugin new "$kind" "trial/$name" "$folder" --language rust --repository
      (cd "$folder" && PATH=$work/prefix/bin:$PATH quietly sh ci/check)
      grep -q "^# trial/$name 0.1.0 conforms to odo.$kind/" "$folder/build/conformance.md"
    else
      quietly "$program" plugin new "$kind" "trial/$name" "$folder" --language "$language"
      quietly cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$work/prefix"
      quietly cmake --build "$folder/build"
      quietly "$program" plugin check "$folder/build/$name.so" --only events # each case starts an interpreter, so only the events are checked
    fi
    quietly "$program" config check "$folder/pipeline.yaml"
    quietly "$program" plugins "trial/$name" --plugins "$folder/build" # as its README has it
    grep -q gain "$work/said"
    if [ "$kind" != scale_source ]; then # no steps beside it: the displacement is that of its single speed
      "$program" run -c "$folder/pipeline.yaml" -i "$work/short.odo" -o "$folder/out" --json >/dev/null || [ $? = 1 ]
      python3 -c "import json, sys; m = json.load(open(sys.argv[1]))['distance_m']; sys.exit(not 4 < m < 16 and f'$name: {m} m of 8 m')" "$folder/out/summary.json"
      [ "$kind" != surface_finder ] || grep -q '"kind": "floor"' "$folder/out/surfaces.json"
    fi
    if [ "$name" = python_scale_source ]; then # a parameter that was changed without a build
      sed 's/"gain", /"pace", /; s/self\.gain/self.pace/' "$folder/$name.py" >"$work/changed.py"
      cp "$folder/$name.py" "$work/kept.py" && cp "$work/changed.py" "$folder/$name.py"
      "$program" plugin check "$folder/build/$name.so" --only life.starts >"$work/said" && { echo "FAILED: a changed table is not noticed"; exit 1; }
      grep -q "build it again" "$work/said" || { echo "FAILED: a changed table is not named"; cat "$work/said"; exit 1; }
      cp "$work/kept.py" "$folder/$name.py"
    fi
    echo "$language: $kind builds, passes the check and runs"
    done=$((done + 1))
  done
done
[ $done -gt 0 ] || exit 77
