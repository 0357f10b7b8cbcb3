#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Every file has a licence, by reuse.
set -eu
cd "$1"
command -v reuse > /dev/null || { echo "SKIPPED: no reuse"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
reuse lint > "$work/said" 2>&1 || { cat "$work/said"; exit 1; }
if grep ERROR "$work/said"; then exit 1; fi
