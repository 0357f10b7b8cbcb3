#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Nothing visible but the contract: odo_* of one version in the library, the entry in each plugin; and nothing undefined.
# With a second argument ON the library is one file to ship: it needs the C library alone and has at most 4 MB.
set -eu
lib=$1/lib
node=ODOGRAPH_DRAFT_2
symbols() { nm -D --defined-only --with-symbol-versions "$1" | awk '$2 != "A" {print $NF}'; }
others=$(symbols "$lib/libodograph.so" | grep -v "^odo_[a-z_]*@@$node\$" || true)
[ -z "$others" ] || { echo "libodograph.so also exports: $others"; exit 1; }
[ "$(symbols "$lib/libodograph.so" | wc -l)" -ge 25 ]
for plugin in "$lib"/odograph/plugins/*.so; do
  found=$(symbols "$plugin")
  [ "$found" = odo_plugin_entry_draft2 ] || { echo "$plugin exports: $found"; exit 1; }
done
needed=$(readelf -d "$lib/libodograph.so" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | grep -v '^lib[cm]\.so\|^ld-linux' | tr '\n' ' ' || true)
size=$(stat -L -c %s "$lib/libodograph.so")
if [ "${2:-}" = ON ]; then
  [ -z "$needed" ] || { echo "libodograph.so needs $needed"; exit 1; }
  [ "$size" -le 4194304 ] || { echo "libodograph.so has $size bytes"; exit 1; }
fi
echo "$(symbols "$lib/libodograph.so" | wc -l) functions, all $node; the library has $size bytes and needs the C library${needed:+ and $needed}"
