#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# An app with linked plugins, alone in a folder, gives the same poses as with shared libraries, byte for byte.
set -eu
app=$1 whole=$2 library=$3 plugins=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset ODOGRAPH_PLUGIN_PATH
mkdir "$work/app" "$work/whole"
cp "$app" "$work/app/run" && cp "$library" "$work/app/libodograph.so.1"
cp "$whole" "$work/whole/run"
export LD_LIBRARY_PATH="$work/app${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
for kind in app whole; do
  cd "$work/$kind"
  ./run > inside.txt
  ./run "$plugins" > libraries.txt
  cmp inside.txt libraries.txt
  [ "$(wc -l < inside.txt)" -gt 30 ]
  if ./run "$work" 2> said.txt; then echo "FAILED: $kind finds plugins that are neither registered nor in a folder"; exit 1; fi
  grep -q "no plugin 'attitude/vqf'" said.txt
done
cmp "$work/app/inside.txt" "$work/whole/inside.txt"
echo "$(wc -l < "$work/whole/inside.txt") poses, the same bytes; the program with all inside has $(stat -c %s "$whole") bytes"
