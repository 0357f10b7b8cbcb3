#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The site is built without warnings and dead links.
set -eu
source=$1
for program in doxygen linkchecker mkdocs; do
  command -v $program > /dev/null || { echo "SKIPPED: no $program"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"  # linkchecker reads as nobody
"$source/packaging/documents" "$work/site" > "$work/said" 2>&1 || { cat "$work/said"; exit 1; }
grep "links in" "$work/said"
