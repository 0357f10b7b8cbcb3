#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Each header compiles alone: .h as C99 by gcc and clang, .h and .hpp as C++17.
set -eu
include=$1 skipped=0
for compiler in gcc clang; do
  command -v $compiler >/dev/null || { echo "SKIPPED: no $compiler"; skipped=77; continue; }
  for header in "$include"/odograph/*.h; do
    echo "#include \"$header\"" | $compiler -x c -std=c99 -pedantic-errors -Wall -Wextra -Werror -I"$include" -fsyntax-only -
  done
done
for compiler in g++ clang++; do
  command -v $compiler >/dev/null || { echo "SKIPPED: no $compiler"; skipped=77; continue; }
  for header in "$include"/odograph/*.h "$include"/odograph/*.hpp; do
    echo "#include \"$header\"" | $compiler -x c++ -std=c++17 -pedantic-errors -Wall -Wextra -Werror -I"$include" -fsyntax-only -
  done
done
if grep -hE '^ *# *include *<' "$include"/odograph/*.h | grep -vE '<(stddef|stdint)\.h>|<odograph/'; then
  echo "a header of abi/ includes something else than <stddef.h> and <stdint.h>"; exit 1
fi
exit $skipped
