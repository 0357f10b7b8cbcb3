#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# For a Mac with Xcode: builds Odograph with four plugins and all dependencies as one static library, for phones and
# the simulator.
# make_xcframework.sh ODOGRAPH PREFIX_PHONE PREFIX_SIMULATOR
# The prefixes contain the dependencies listed in README.md, built for each of the two.
set -eu
odograph=$1
here=$(cd "$(dirname "$0")" && pwd)
build=$here/.build/odograph
plugins="odograph_attitude_vqf_static odograph_step_odograph_static odograph_vo_odograph_static odograph_surface_planes_static"

# one SDK ARCHITECTURES PREFIX
one() {
  cmake -S "$odograph" -B "$build/$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=iOS -DCMAKE_OSX_SYSROOT="$1" \
    -DCMAKE_OSX_ARCHITECTURES="$2" -DCMAKE_OSX_DEPLOYMENT_TARGET=16.0 -DCMAKE_FIND_ROOT_PATH="$3" \
    -DODOGRAPH_TESTS=OFF -DODOGRAPH_TOOLS=OFF -DODOGRAPH_STATIC_DEPENDENCIES=OFF
  cmake --build "$build/$1" --target odograph_core $plugins
  libtool -static -o "$build/$1/libodograph_all.a" $(find "$build/$1" -name '*.a' ! -name libodograph_all.a) $(find "$3" -name '*.a')
}
one iphoneos arm64 "$2"
one iphonesimulator "arm64;x86_64" "$3"

headers=$build/headers
rm -rf "$headers" "$here/Odograph.xcframework"
mkdir -p "$headers"
cp -R "$odograph/abi/include/odograph" "$headers/"
rm -f "$headers"/odograph/*.hpp
printf 'module Odograph {\n  umbrella "odograph"\n  export *\n}\n' > "$headers/module.modulemap"
xcodebuild -create-xcframework -library "$build/iphoneos/libodograph_all.a" -headers "$headers" \
  -library "$build/iphonesimulator/libodograph_all.a" -headers "$headers" -output "$here/Odograph.xcframework"
