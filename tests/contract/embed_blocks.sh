#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The C blocks of README.md and docs/embed.md are compiled as C99 and run.
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed -n '/^```c$/,/^```$/p' "$source/README.md" "$source/docs/embed.md" | grep -v '^```' > "$work/blocks.h"
[ -s "$work/blocks.h" ]
gcc -std=c99 -pedantic-errors -Wall -Wextra -Werror -I"$source/abi/include" -DBLOCKS="\"$work/blocks.h\"" \
  "$source/tests/contract/embed_blocks.c" -o "$work/blocks" -L"$build/lib" -lodograph -lm -Wl,-rpath,"$build/lib"
"$work/blocks" "$build/lib/odograph/plugins"
