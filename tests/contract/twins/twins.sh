#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Two plugins with the same class name in one program: loaded as by the host, with default visibility; and linked, with
# link-time optimisation and unused sections removed. No host: their entries are called.
#   twins.sh INCLUDE
set -eu
here=$(cd "$(dirname "$0")" && pwd) include=$1 skipped=0 held=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for compiler in g++ clang++; do
  command -v $compiler >/dev/null || { echo "SKIPPED: no $compiler"; skipped=77; continue; }
  c=clang
  [ $compiler = clang++ ] || c=gcc
  for twin in 1 2; do
    $compiler -std=c++17 -O0 -fPIC -shared -fvisibility=default -DTWIN=$twin -I"$include" "$here/plugin.cpp" -o "$work/twin$twin.so"
    $compiler -std=c++17 -O2 -flto -ffunction-sections -fdata-sections -DODO_STATIC -DTWIN=$twin -DODO_PLUGIN_ENTRY=twin_entry_$twin \
      -I"$include" -c "$here/plugin.cpp" -o "$work/twin$twin.o"
  done
  $c -std=c99 -D_POSIX_C_SOURCE=200809L -I"$include" "$here/app.c" -o "$work/loads" -ldl
  $c -std=c99 -O2 -flto -DODO_STATIC -I"$include" -c "$here/app.c" -o "$work/app.o"
  $compiler -O2 -flto $([ $compiler = g++ ] || echo -fuse-ld=lld) -Wl,--gc-sections "$work/app.o" "$work/twin1.o" "$work/twin2.o" -o "$work/linked"
  "$work/loads" "$work/twin1.so" "$work/twin2.so" || { echo "$compiler, loaded"; exit 1; }
  "$work/linked" || { echo "$compiler, linked in"; exit 1; }
  held=$((held + 2))
done
echo "$held programs with two plugins of one class name"
exit $skipped
