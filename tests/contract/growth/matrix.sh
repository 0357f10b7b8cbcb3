#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The growth matrix over every message, service and output, saved states, recordings and manifests: app, library,
# plugin and recording of this version and of a later one, the plugin in process and isolated; and states of each
# library and plugin loaded by each. A later manifest has keys that are unknown to this version. With the archive of a
# version that has no surface finders, that kind is left out.
#   matrix.sh OLD_LIBRARY NEW_LIBRARY OLD_PLUGIN_HOST NEW_PLUGIN_HOST FOLDER ODOGRAPH_MANIFEST
set -eu
old_library=$1 new_library=$2 old_host=$3 new_host=$4 folder=$5 manifest=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for age in old new; do
  mkdir "$work/$age"
  cp "$folder/growth_plugin_$age.so" "$work/$age/every.so"
  "$manifest" "$work/$age/every.so"
  eval library=\$${age}_library
  "$folder/growth_app_$age" "$library" write "$work/$age.odo"
done
sed -i 's/^{/{"later": {"key": 1},/; s/"name": "answer"/"later": [1], "name": "answer"/' "$work/new/every.odoplugin.json"
cells=0 held=0
cell() { # app library plugin recording isolation state [more of the config]
  eval file=\$${2}_library host=\$${2}_host
  config="odograph: 1
plugins: {isolation: $5, host: $host}
attitude:
  plugin: test/every
  parameters: {answer: 42}
${7:-}"
  found=$("$folder/growth_app_$1" "$file" replay "$work/$4.odo" "$config" "$work/$3" "$6" $2 $3 $4) || {
    echo "app $1, library $2, plugin $3, recording $4, isolation $5, state ${6##*/}:"
    echo "$found"
    exit 1
  }
  cells=$((cells + 1)) held=$((held + $(echo "$found" | tail -1)))
}
for isolation in none process; do
  for app in old new; do for library in old new; do for plugin in old new; do for recording in old new; do
    cell $app $library $plugin $recording $isolation "$work/state.$isolation.$app.$library.$plugin.$recording"
  done; done; done; done
  [ "${ODO_GROWTH_ARCHIVE:-}" ] || for library in old new; do for plugin in old new; do
    cell old $library $plugin old $isolation "$work/state.kind.$isolation.$library.$plugin" "coupling: {type: localizer}
vo_frontend: {plugin: test/every, parameters: {answer: 42}}
surface_finder: {plugin: test/every, parameters: {answer: 42}}
"
  done; done
  for writer in old.old old.new new.old new.new; do for library in old new; do for plugin in old new; do
    cell old $library $plugin old $isolation "$work/state.$isolation.old.$writer.old"
  done; done; done
done
echo "$held combinations hold in $cells runs"
