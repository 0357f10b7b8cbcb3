#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# languages.sh SOURCE BUILD: samples/walk in each language, against the command line's poses. A language without its
# tools is reported and skipped; if all are, the status is 77.
set -u
source=$1 build=$2 bindings=$2/bindings
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
walk=$source/samples/walk here=$source/tests/languages
config=$source/samples/configs/walk.yaml map=$source/tests/fuzz/seeds/map/two_views
export ODOGRAPH_PLUGIN_PATH=$work/plugins:$build/lib/odograph/plugins LD_LIBRARY_PATH=$build/lib
failed=0 done=0

# say LANGUAGE COMMAND...: runs the command; shows its output if it fails.
say() {
  local language=$1
  shift
  "$@" >"$work/said" 2>&1 && return
  echo "FAILED: $language: $*"
  tail -20 "$work/said"
  failed=1
  return 1
}
missing() { # reports a language's missing commands
  local tool
  for tool in "${@:2}"; do
    command -v "$tool" >/dev/null || { echo "SKIPPED: $1: no $tool"; return 0; }
  done
  return 1
}
# compare LANGUAGE COMMAND...: compares the output of the sample
compare() {
  local language=$1
  shift
  "$@" "$config" "$work/walk.odo" >"$work/$language.txt" 2>"$work/said" || { echo "FAILED: $language: $*"; tail -20 "$work/said"; failed=1; return 1; }
  python3 "$here/compare.py" "$language" "$work/reference.txt" "$work/$language.txt" "$work/live.txt" || { failed=1; return 1; }
  done=$((done + 1))
}

# A library of another major version: all functions, which return 0, as the ABI's version does. ABI 0.0.
mkdir "$work/other"
python3 "$source/abi/generate.py" --probe >"$work/other.c"
say library cc -shared -fPIC -O1 -w -I"$source/abi/include" -Wl,-soname,libodograph.so.1 -Wl,--version-script="$source/sdk/host/odograph.map" "$work/other.c" -o "$work/other/libodograph.so.1" || exit 1
ln -s libodograph.so.1 "$work/other/libodograph.so"
# refuses LANGUAGE COMMAND...: with that library the sample ends with an error that names both versions
refuses() {
  local language=$1
  shift
  LD_LIBRARY_PATH=$work/other "$@" "$config" "$work/walk.odo" >"$work/said" 2>&1
  grep -q 'has ABI 0\.0, this [a-z]* 1\.' "$work/said" || { echo "FAILED: $language accepts a library of another major version"; tail -5 "$work/said"; failed=1; }
}

say recording "$build/bin/odograph" sim "$source/samples/scenarios/walk_short.yaml" --first 8 -o "$work/jpeg.odo" || exit 1
say recording "$build/bin/odograph" convert --pgm "$work/jpeg.odo" "$work/walk.odo" || exit 1
say run "$build/bin/odograph" run -c "$config" -i "$work/walk.odo" -o "$work/run" || exit 1
"$build/bin/odograph-reference" "$config" "$work/walk.odo" "$work/run" >"$work/reference.txt" || exit 1

# The counter of allocations, and a front-end that records the addresses of pixels.
mkdir "$work/plugins"
say counter cc -shared -fPIC -O1 -o "$work/count.so" "$here/allocations.c"
say counter c++ -std=c++17 -shared -fPIC -fvisibility=hidden -I"$source/abi/include" -o "$work/plugins/pixels.so" "$here/pixels.cpp" &&
  say counter "$build/bin/odograph" plugin manifest "$work/plugins/pixels.so"

cpp() {
  say C++ c++ -std=c++17 -Wall -Wextra -Wpedantic -Wshadow -Werror -O1 -I"$source/abi/include" "$walk/walk.cpp" -L"$build/lib" -lodograph -o "$work/walk_cpp" &&
    compare C++ "$work/walk_cpp"
}

python() {
  local python
  for python in python3 /usr/bin/python3; do "$python" -c 'import numpy' 2>/dev/null && break; done
  "$python" -c 'import numpy' 2>/dev/null || { echo "SKIPPED: Python: no numpy"; return; }
  # The wheel as installed.
  cp -r "$bindings/python" "$work/python"
  if "$python" -c 'import build, setuptools, wheel' 2>/dev/null; then
    (cd "$work/python" && say Python "$python" -m build --wheel --no-isolation && "$python" -m zipfile -e dist/odograph-*.whl "$work/site") || return
    [ -e "$work/site/odograph/py.typed" ] || { echo "FAILED: Python: no py.typed in the wheel"; failed=1; }
  else
    echo "SKIPPED: Python's wheel: no build"
    cp -r "$work/python" "$work/site"
  fi
  PYTHONPATH=$work/site compare Python "$python" "$walk/walk.py" || return
  PYTHONPATH=$work/site refuses Python "$python" "$walk/walk.py"
  PYTHONPATH=$work/site LD_PRELOAD=$work/count.so "$python" "$here/no_copy.py" || { echo "FAILED: Python copies, keeps or allocates for a frame"; failed=1; }
  PATH=$build/bin:$PATH PYTHONPATH=$work/site say Python "$python" "$here/python_package.py" "$config" "$work/walk.odo" "$work" "$map"
  PATH=$build/bin:$PATH PYTHONPATH=$work/site say Python "$python" "$walk/evaluate.py" "$config" "$work/walk.odo" "$work/sample.tum"
  "$python" -c 'import matplotlib' 2>/dev/null && MPLBACKEND=Agg PYTHONPATH=$work/site say Python "$python" "$walk/plot.py" "$source/samples/configs/phone_walk.yaml" "$work/walk.odo" "$work/walk.png"
  missing "Python's types" mypy || say Python mypy --strict --no-warn-return-any --ignore-missing-imports --no-error-summary "$work/site/odograph"
}

csharp() {
  missing 'C#' mcs mono && return
  say 'C#' mcs -unsafe -warnaserror -out:"$work/Walk.exe" "$bindings"/csharp/*.cs "$walk/Walk.cs" && compare 'C#' mono "$work/Walk.exe" && refuses 'C#' mono "$work/Walk.exe"
  say 'C#' mcs -unsafe -warnaserror -out:"$work/NoCopy.exe" "$bindings"/csharp/*.cs "$here/NoCopy.cs" || return
  say 'C#' mcs -unsafe -warnaserror -out:"$work/Callbacks.exe" "$bindings"/csharp/*.cs "$here/Callbacks.cs" && say 'C#' mono "$work/Callbacks.exe" "$map"
  LD_PRELOAD=$work/count.so mono "$work/NoCopy.exe" || { echo "FAILED: C# copies, keeps or allocates for a frame"; failed=1; }
  say Unity mcs -unsafe -out:"$work/Unity.exe" "$bindings"/csharp/*.cs "$source/samples/unity/OdographProvider.cs" "$here/unity.cs" && say Unity mono "$work/Unity.exe" "$work/walk.odo"
}

rust() {
  local PATH=/usr/bin:$PATH # Debian's, if there is another one
  missing Rust cargo && return
  export ODOGRAPH_LIB_DIR=$build/lib CARGO_TARGET_DIR=$work/cargo CARGO_HOME=$work/cargo_home
  cp -r "$bindings/rust" "$work/rust"
  mkdir -p "$work/walk_rust/src" && cp "$walk/walk.rs" "$work/walk_rust/src/main.rs"
  printf '[package]\nname = "walk"\nversion = "0.1.0"\nedition = "2021"\n\n[dependencies]\nodograph = {path = "%s"}\n' "$work/rust" >"$work/walk_rust/Cargo.toml"
  (cd "$work/walk_rust" && say Rust cargo build --offline) && compare Rust "$work/cargo/debug/walk" && refuses Rust "$work/cargo/debug/walk"
  # bindgen's reading of the headers as an oracle.
  missing "Rust's layout" bindgen && return
  say Rust bindgen "$source/abi/include/odograph/layout.h" -o "$work/bindgen.rs" --no-layout-tests -- -I"$source/abi/include" || return
  { echo '#[allow(warnings)] mod theirs { include!("bindgen.rs"); }'
    echo '#[allow(warnings)] #[path = "rust/src/abi.rs"] mod ours;'
    sed -n 's/^pub struct \(odo_[a-z_0-9]*\) {$/const _: () = assert!(std::mem::size_of::<ours::\1>() == std::mem::size_of::<theirs::\1>());/p' "$work/rust/src/abi.rs"
    echo 'fn main() {}'; } >"$work/layout.rs"
  say Rust rustc --edition 2021 --emit metadata -o "$work/layout.rmeta" "$work/layout.rs"
}

java() {
  missing Java javac && return
  local home
  home=$(dirname "$(dirname "$(readlink -f "$(command -v javac)")")")
  say Java cc -std=c99 -shared -fPIC -Wall -Wextra -Werror -I"$home/include" -I"$home/include/linux" -I"$source/abi/include" "$bindings"/java/*.c \
    -L"$build/lib" -lodograph -o "$work/libodograph_jni.so" || return
  say Java javac -Xlint:all -Werror --release 11 -d "$work/java" "$bindings"/java/org/odograph/*.java "$walk/Walk.java" "$here/Callbacks.java" || return
  compare Java "$home/bin/java" -Xcheck:jni -Djava.library.path="$work" -cp "$work/java" Walk
  refuses Java "$home/bin/java" -Djava.library.path="$work" -cp "$work/java" Walk
  say Java "$home/bin/java" -Xcheck:jni -Djava.library.path="$work" -cp "$work/java" Callbacks "$map"
  missing Kotlin kotlinc && return
  say Kotlin kotlinc -cp "$work/java" -d "$work/kotlin.jar" -include-runtime "$walk/Walk.kt" &&
    compare Kotlin "$home/bin/java" -Djava.library.path="$work" -cp "$work/java:$work/kotlin.jar" WalkKt
}

javascript() {
  missing JavaScript node && return
  local koffi npm=${ODOGRAPH_TARGETS:-$HOME/.cache/odograph-targets}/npm/node_modules # installed by packaging/dependencies test
  koffi=$(NODE_PATH="${NODE_PATH:+$NODE_PATH:}$npm" node -p "require('path').dirname(require.resolve('koffi'))" 2>/dev/null) ||
    { echo "SKIPPED: JavaScript: no npm package koffi (packaging/dependencies test)"; return; }
  mkdir -p "$work/node/node_modules/@odograph"
  cp -r "$bindings/javascript" "$work/node/node_modules/@odograph/node"
  ln -s "$koffi" "$work/node/node_modules/koffi"
  ln -s "$(dirname "$koffi")/@koromix" "$work/node/node_modules/@koromix" # koffi's compiled part
  cp "$walk/walk.mjs" "$work/node/"
  compare JavaScript node --preserve-symlinks "$work/node/walk.mjs"
  cp "$here/callbacks.mjs" "$work/node/" && say JavaScript node --preserve-symlinks "$work/node/callbacks.mjs" "$map"
  refuses JavaScript node --preserve-symlinks "$work/node/walk.mjs"
}

swift() { # the headers as Swift imports them
  missing "Swift's headers" clang && return
  local target
  for target in x86_64-linux-gnu arm64-apple-ios16 arm64-apple-macos13; do
    say Swift clang --target=$target -ffreestanding -fmodules -fmodules-cache-path="$work/modules" -fsyntax-only -Wall -Wextra -Wno-missing-field-initializers -Werror \
      -fmodule-map-file="$bindings/swift/Sources/COdograph/module.modulemap" -I"$source/abi/include" -x objective-c "$here/module.m" || return
  done
  echo "Swift: the module's headers compile; its own sources were not compiled"
}

say documents python3 "$here/snippets.py" "$source"
for language in ${3:-cpp python csharp rust java javascript swift}; do $language; done
[ $failed = 0 ] || exit 1
[ $done -gt 0 ] || exit 77
