#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The layout on other targets, by compiling for them with clang: one layout on those of 64 bits, refused by #error on the
# others. No C library of the target is needed: the two standard headers are clang's own.
set -eu
clang=$(command -v clang || command -v clang-19 || command -v clang-16 || command -v clang-14 || true)
if [ -z "$clang" ]; then
  echo "SKIPPED: no clang here"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for header in layout messages recording attitude step_estimator vo_frontend scale_source absolute_fixer; do
  echo "#include <odograph/$header.h>" >> "$work/all.c"
done
echo 'int odo_unused;' >> "$work/all.c"
compile() { "$clang" --target="$1" -ffreestanding -std=c99 -Wall -Wextra -Wpadded -Werror -fsyntax-only -I"$2" "$work/all.c" 2> "$work/said"; }
for target in x86_64-linux-gnu aarch64-linux-android x86_64-pc-windows-msvc arm64-apple-ios riscv64-linux-gnu; do
  compile $target "$1" || { echo "$target:"; cat "$work/said"; exit 1; }
  echo "$target: the layout"
done
for target in i386-linux-gnu armv7-linux-androideabi i386-pc-windows-msvc; do
  if compile $target "$1"; then echo "$target: compiled, though pointers are small there"; exit 1; fi
  grep -q "64-bit targets" "$work/said" || { echo "$target: refused for another reason:"; cat "$work/said"; exit 1; }
  echo "$target: refused"
done
