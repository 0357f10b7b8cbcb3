#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The library exports the functions of the headers, each from its version node, and nothing else; each plugin its entry.
#   exports.sh BUILD PROJECT [ON]
# With ON the library is a single file to ship: it depends on the C library and libgcc only and has at most 4 MB.
set -eu
lib=$1/lib
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
symbols() { nm -D --defined-only --with-symbol-versions "$1" | awk '$2 != "A" {print $NF}' | LC_ALL=C sort; }
python3 "$2/abi/generate.py" --symbols > "$work/all"
grep @@ "$work/all" | LC_ALL=C sort > "$work/described"
entry=$(grep -v @@ "$work/all")
symbols "$lib/libodograph.so" > "$work/exported"
diff "$work/described" "$work/exported" || { echo "< described, > exported by libodograph.so"; exit 1; }
for plugin in "$lib"/odograph/plugins/*.so; do
  found=$(symbols "$plugin")
  [ "$found" = "$entry" ] || { echo "$plugin exports '$found' instead of $entry"; exit 1; }
done
needed=$(readelf -d "$lib/libodograph.so" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | grep -v '^lib[cm]\.so\|^libgcc_s\.so\|^ld-linux' | tr '\n' ' ' || true)
size=$(stat -L -c %s "$lib/libodograph.so")
if [ "${3:-}" = ON ]; then
  [ -z "$needed" ] || { echo "libodograph.so needs $needed"; exit 1; }
  [ "$size" -le 4194304 ] || { echo "libodograph.so has $size bytes"; exit 1; }
fi
echo "$(wc -l < "$work/exported") functions, all described; the library has $size bytes and needs the C library and libgcc${needed:+ and $needed}"
