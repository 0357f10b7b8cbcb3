#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Compares the ABI as read by libabigail from a compiled program (abi/generate.py --probe) with
# abi/golden/binary_v1.abi.
#   abi_binary.sh PROJECT [--write]
# The program compiles only where the compiler agrees with the description on every constant, field type and prototype.
set -eu
golden=$1/abi/golden/binary_v1.abi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$1/abi/generate.py" --probe > "$work/probe.c"
include=$(cd "$1/abi/include" && pwd)
(cd "$work" && ${CC:-cc} -g -std=c99 -w -Werror=incompatible-pointer-types -shared -fPIC -I"$include" probe.c -o probe.so)
command -v abidiff >/dev/null || { echo "SKIPPED: no abidiff; the compiler agrees with the description"; exit 77; }
if [ "${2:-}" = --write ]; then
  abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-parameter-names --type-id-style hash "$work/probe.so" > "$golden"
  exit
fi
abidiff "$golden" "$work/probe.so" || { echo "the binary interface differs from $golden"; exit 1; }
echo "$(grep -c '<elf-symbol' "$golden") functions and types are as in ${golden##*/}"
