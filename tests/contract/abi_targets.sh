#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks one layout on every target by compiling all public headers for it; big-endian targets are rejected.
#   abi_targets.sh PROJECT
# C with clang and no C library. The C++ wrapper with clang and this machine's libstdc++, whose headers need a word size of
# their own for each target; for Windows with MinGW's own, which also links it. What has no compiler here is skipped.
set -eu
include=$1/abi/include skipped=0
command -v clang >/dev/null || { echo "SKIPPED: no clang"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$include" && ls odograph/*.h | sed 's/.*/#include <&>/') > "$work/all.c"
python3 "$1/abi/generate.py" --probe > "$work/probe.c"
(cd "$include" && ls odograph/*.h odograph/*.hpp | sed 's/.*/#include <&>/') > "$work/all.cpp"
cat >> "$work/all.cpp" <<'END'
struct Example {
  double gain = 1.0;
  static constexpr odo::Description description{"scale/example", "1.0.0", "An example.", ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<Example>> parameters() {
    return {odo::real("gain", "m", 0.1, 10.0, &Example::gain, "Metres per unit.")};
  }
  void on(const odo_vo_motion& motion, odo::Output& output) { output.emit(odo::make<odo_scale>(motion.header.t_ns)); }
};
ODO_PLUGIN(Example)
END
mkdir -p "$work/system/gnu" "$work/system/bits"
for stubs in 32 soft hard lp64 64; do : > "$work/system/gnu/stubs-$stubs.h"; done
echo '#define __WORDSIZE (__SIZEOF_LONG__ * 8)
#define __WORDSIZE_TIME64_COMPAT32 0' > "$work/system/bits/wordsize.h"
library=$(echo '#include <bits/c++config.h>' | c++ -x c++ -M - | tr ' ' '\n' | sed -n 's|/bits/c++config.h$||p')

fail() { echo "$1:"; head -20 "$work/messages"; exit 1; }
c() { clang --target="$1" -ffreestanding -std=c99 -Wall -Wextra -Wpadded -Wno-unused-parameter -Wno-unused-variable -Werror -fsyntax-only -I"$include" "$2" 2> "$work/messages"; }
cpp() {
  clang++ --target="$1" -std=c++17 -fexceptions -Wall -Wextra -Wno-missing-braces -Werror -fsyntax-only -nostdinc++ -isystem "$work/system" \
    -isystem "${library%/*/c++/*}/c++/${library##*/}" -isystem "$library" -isystem "${library%/c++/*}" -isystem /usr/include -I"$include" "$work/all.cpp" 2> "$work/messages"
}
mingw() {
  "$1" -std=c++17 -Wall -Wextra -Wno-missing-braces -Werror -shared -I"$include" "$work/all.cpp" -o "$work/plugin.dll" 2> "$work/messages" || fail "$1"
  entry=$(python3 "$2/abi/generate.py" --symbols | grep -v @@)
  "${1%g++*}objdump" -p "$work/plugin.dll" | grep -q "$entry" || { echo "$1: the DLL does not export $entry"; exit 1; }
}

for target in x86_64-linux-gnu i386-linux-gnu armv7-linux-gnueabihf aarch64-linux-gnu riscv64-linux-gnu wasm32-unknown-unknown; do
  for file in all probe; do c $target "$work/$file.c" || fail "$target, C"; done
  cpp $target || fail "$target, C++"
  echo "$target: C and C++, one layout"
done
for target in aarch64-linux-android armv7-linux-androideabi x86_64-pc-windows-msvc i386-pc-windows-msvc arm64-apple-ios; do
  c $target "$work/all.c" || fail "$target, C"
  echo "$target: C, one layout"
done
for compiler in x86_64-w64-mingw32-g++ i686-w64-mingw32-g++; do
  if command -v $compiler >/dev/null; then
    mingw $compiler "$1"
    echo "${compiler%-g++}: C++, one layout, the entry is exported"
  else
    echo "SKIPPED: no $compiler"
    skipped=77
  fi
done
for target in s390x-linux-gnu aarch64_be-linux-gnu; do
  if c $target "$work/all.c"; then echo "$target: compiled, though it is big-endian"; exit 1; fi
  grep -q "little-endian" "$work/messages" || fail "$target: refused for another reason"
  echo "$target: refused"
done
exit $skipped
