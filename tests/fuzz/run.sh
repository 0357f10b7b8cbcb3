#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the fuzzers and runs each for a given time, by default an hour; `session` under ThreadSanitizer too.
#   tests/fuzz/run.sh [SECONDS [TARGET...]]
# Findings are stored in build-fuzz/TARGET/ as crash-*, timeout-*, oom-*; the corpus beside them is kept small. Fails
# if there are findings.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-3600}
[ $# -gt 0 ] && shift
targets=${*:-archive city config folder manifest map map_section messages recording records session skylines state table terrain video}
export ASAN_OPTIONS=malloc_context_size=2:quarantine_size_mb=32
export TSAN_OPTIONS=suppressions=$PWD/tests/support/tsan.supp

run() {  # PRESET TARGET
  cmake --preset "$1" >/dev/null
  cmake --build --preset "$1" --target "fuzz-$2" | tail -1
  place=build-$1/$2
  mkdir -p "$place/corpus" "$place/small"
  length=512 ok=0
  case $2 in video | records | messages | map | map_section) length=4096 ;; esac  # complete inputs are longer
  # entropic: counting the rarity of a hundred thousand features took half of the time
  "build-$1/tests/fuzz/fuzz-$2" -entropic=0 -max_len=$length -timeout=10 -rss_limit_mb=4096 -max_total_time="$seconds" -print_final_stats=1 \
    -artifact_prefix="$place/" "$place/corpus" "tests/fuzz/seeds/$2" >"$place/log" 2>&1 || ok=1
  "build-$1/tests/fuzz/fuzz-$2" -merge=1 "$place/small" "$place/corpus" >/dev/null 2>&1 && rm -rf "$place/corpus" && mv "$place/small" "$place/corpus"
  echo "$1 $2: $(sed -n 's/^stat::number_of_executed_units: *//p' "$place/log") executions, $(ls "$place/corpus" | wc -l) inputs kept$([ $ok = 0 ] || echo ", FOUND: see $place")"
  [ $ok = 0 ] || found=1
}

found=0
for target in $targets; do
  run fuzz "$target"
  [ "$target" != session ] || run fuzz-tsan session
done
exit $found
