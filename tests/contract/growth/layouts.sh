#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Writes and reads every message with the headers of this version and of a later one with larger structs, natively and
# with WebAssembly's layout (32-bit pointers) if node is installed. All must read the same numbers.
#   layouts.sh PROJECT
set -eu
here=$(cd "$(dirname "$0")" && pwd) project=$1
for tool in clang wasm-ld node; do command -v $tool >/dev/null || { echo "SKIPPED: no $tool"; exit 77; }; done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$project/abi/generate.py" --grow "$work/new"
mkdir "$work/old" && cp -r "$project/abi/include/odograph" "$work/old/"
for age in old new; do
  python3 "$project/abi/generate.py" --exchange "$work/$age" > "$work/$age.c"
  cc -std=c99 -O1 -Wall -Werror -I"$work/$age" -DMAIN "$work/$age.c" "$here/exchange.c" -o "$work/$age.native"
  clang --target=wasm32 -std=c99 -O1 -ffreestanding -nostdlib -I"$work/$age" "$work/$age.c" -Wl,--no-entry -Wl,--export=odo_read \
    -Wl,--export=odo_write -Wl,--export=odo_types -Wl,--export=__heap_base -o "$work/$age.wasm"
done
"$work/old.native" write "$work/reference"
node "$here/exchange.js" "$work"
