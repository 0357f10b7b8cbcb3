#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Nothing visible but the contract: odo_* in the library, the entry in each plugin; and nothing undefined.
set -eu
lib=$1/lib
others=$(nm -D --defined-only "$lib/libodograph.so" | awk '{print $NF}' | grep -v '^odo_' || true)
[ -z "$others" ] || { echo "libodograph.so also exports: $others"; exit 1; }
[ "$(nm -D --defined-only "$lib/libodograph.so" | grep -c ' odo_')" -ge 15 ]
for plugin in "$lib"/odograph/plugins/*.so; do
  symbols=$(nm -D --defined-only "$plugin" | awk '{print $NF}')
  [ "$symbols" = odo_plugin_entry_v1 ] || { echo "$plugin exports: $symbols"; exit 1; }
done
