#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# An archived release against this tree, and this tree against the archive:
#   archive.sh ARCHIVE BUILD
# ARCHIVE is a file of abi/archive (packaging/archive), BUILD this tree's build. Each line of the output is a promise of docs/abi.md that holds.
set -eu
archive=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/old"
tar -C "$work/old" -xJf "$archive"
old=$work/old tests=$(dirname "$0")
library=$build/lib/libodograph.so.1 archived=$old/lib/libodograph.so.1
held=0
holds() { # TEXT COMMAND ...
  text=$1
  shift
  if "$@" > "$work/log" 2>&1; then
    held=$((held + 1))
    echo "holds: $text$(tail -1 "$work/log" | grep -E 'passed|hold' | sed 's/^/: /')"
  else
    echo "FAILS: $text"
    grep -A4 '^fail' "$work/log" || tail -40 "$work/log"
    exit 1
  fi
}

# Archived apps, plugins and files with today's library.
with_app() { LD_LIBRARY_PATH=${1%/*} ODOGRAPH_PLUGIN_PATH=$old/plugins "$old/apps/embed_c" "$old/app.yaml" > "$work/app" && grep '^step' "$work/app"; }
holds "an app in C" with_app "$library"
holds "the archived suite of the host's conformance" "$old/apps/odograph-host-conformance" "$library"
for plugin in "$old"/plugins/*.so; do
  holds "plugin ${plugin##*/}" "$build/bin/odograph" plugin check "$plugin"
done
for config in "$old"/configs/*.yaml; do
  holds "config ${config##*/}" "$build/bin/odograph" config check --no-load "$config"
done
loads() { cp "$old/every.state" "$work/state" && "$old/growth/growth_app_old" "$1" replay "$old/every.odo" "$(cat "$old/every.yaml")" "$old/every" "$work/state" old old old; }
holds "a recording and a saved state" loads "$library"

# Today's apps and plugins with the archived library.
holds "today's suite of the host's conformance with the archived library" "$build/bin/odograph-host-conformance" "$archived"
cp "$build"/tests/growth/*_old* "$work/"
mkdir "$work/new" && cp "$work/growth_plugin_old.so" "$work/new/every.so" && cp "$old/every/every.odoplugin.json" "$work/new/"
today() { "$work/growth_app_old" "$archived" write "$work/new.odo" && "$work/growth_app_old" "$archived" replay "$work/new.odo" "$(cat "$old/every.yaml")" "$1" "$work/none" old old old; }
"$build/bin/odograph-manifest" "$work/new/every.so"
holds "today's app and plugin with the archived library" today "$work/new"

# The archived library does not know the kind of today's surface finder, and says so.
unknown_kind() {
  "$work/growth_app_old" "$archived" replay "$work/new.odo" "$(cat "$old/every.yaml")
surface_finder: {plugin: test/every}" "$work/new" "$work/none" old old old
  grep -q "surface_finder" "$work/log"
}
holds "the archived library names 'surface_finder' as unknown" unknown_kind

# All combinations of archived binaries with those of a later minor version, in which every struct has one more field.
if [ -e "$build/tests/growth/growth_app_new" ]; then
  mkdir "$work/growth"
  cp "$old"/growth/*_old* "$build"/tests/growth/*_new* "$work/growth/"
  holds "archive and a later minor version" env ODO_GROWTH_ARCHIVE=1 "$tests/growth/matrix.sh" "$archived" "$build/lib/libodograph-grown.so" \
    "$old/lib/odograph-plugin-host" "$build/bin/odograph-grown-plugin-host" "$work/growth" "$build/bin/odograph-manifest"
fi
echo "$held promises hold"
