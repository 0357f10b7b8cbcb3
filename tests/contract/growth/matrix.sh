#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The growth matrix: app, library, plugin and recording of this version and of a later one with larger structs, in all
# sixteen combinations. A new field arrives whenever both ends support it, whatever lies between.
set -eu
old_host=$1 new_host=$2 folder=$3 manifest=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for age in old new; do
  mkdir "$work/$age"
  cp "$folder/growth_plugin_$age.so" "$work/$age/growth.so"
  "$manifest" "$work/$age/growth.so"
  eval host=\$${age}_host
  "$folder/growth_app_$age" "$host" write "$work/$age.odo"
done
cells=0
for app in old new; do for host in old new; do for plugin in old new; do for recording in old new; do
  eval library=\$${host}_host
  found=$("$folder/growth_app_$app" "$library" replay "$work/$recording.odo" "$work/$plugin")
  field=0 answer=0 count=0
  [ $plugin = new ] && field=-1
  [ $plugin = new ] && [ $recording = new ] && field=2.5
  # A later library's own larger struct has the field too: with the plugin's value, or zero.
  [ $plugin = new ] && [ $app = new ] && answer=7 count=300
  expected="worst 0, processed 606, faults 0, unknown 0, attitudes 300, field $field, vendor 2432, answer $answer in $count, pose 0"
  if [ "$found" != "$expected" ]; then
    echo "app $app, library $host, plugin $plugin, recording $recording:"
    echo "  found    $found"
    echo "  expected $expected"
    exit 1
  fi
  cells=$((cells + 1))
done; done; done; done
echo "$cells combinations hold"
