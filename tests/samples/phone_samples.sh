#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Compiles samples/android (C++ for arm64, Kotlin) and the Objective-C of samples/ios against our own declarations
# (phone_platforms).
#   phone_samples.sh PROJECT
set -eu
here=$1/tests/samples/phone_platforms skipped=0
android=$1/samples/android/app/src/main/cpp
if command -v aarch64-linux-gnu-g++ >/dev/null; then
  for file in camera sensors tracker_jni; do
    aarch64-linux-gnu-g++ -std=c++20 -D__ANDROID_API__=28 -DODO_STATIC -Wall -Wextra -Wno-missing-field-initializers -Werror -fsyntax-only -I"$here/android" -I"$1/abi/include" "$android/$file.cpp"
  done
  echo "samples/android: compiles for arm64 Linux"
else
  echo "SKIPPED: no aarch64-linux-gnu-g++"
  skipped=77
fi
if command -v kotlinc >/dev/null; then
  classes=$(mktemp -d)
  trap 'rm -rf "$classes"' EXIT
  kotlinc -nowarn "$here/android/java" "$1/samples/android/app/src/main/kotlin" -d "$classes"
  echo "samples/android: the Kotlin compiles"
else
  echo "SKIPPED: no kotlinc"
  skipped=77
fi
clang --target=arm64-apple-ios16 -x objective-c -fobjc-arc -fblocks -Wall -Wextra -Wno-unused-parameter -Werror -fsyntax-only -nostdlibinc -F"$here/apple" \
  -I"$here/apple" -I"$1/abi/include" -I"$1/samples/ios/Sources/OdographPhone/include" "$1/samples/ios/Sources/OdographPhone/OdographTracker.m"
echo "samples/ios: compiles for arm64-apple-ios"
exit $skipped
