#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The site is built without warnings and dead links; the gallery matches the manifests.
set -eu
source=$1 build=$2
for program in doxygen linkchecker mkdocs; do
  command -v $program > /dev/null || { echo "SKIPPED: no $program"; exit 77; }
done
"$source/packaging/gallery" "$build/lib/odograph/plugins" --check
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"  # linkchecker reads as nobody
"$source/packaging/documents" "$work/site" > "$work/said" 2>&1 || { cat "$work/said"; exit 1; }
grep "links in" "$work/said"
