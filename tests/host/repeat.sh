#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bit-identical results from the same recording: repeated, with 1, 2 and 8 threads for the libraries that use them, and
# with several runs at once. Times of day and durations are not compared.
#   repeat.sh ODOGRAPH CONFIG RUNS RECORDING...
set -eu
[ $# -ge 4 ] || { echo "usage: repeat.sh ODOGRAPH CONFIG RUNS RECORDING..."; exit 2; }
odograph=$1 config=$2 runs=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0 total=0
for recording in "$@"; do
  first=
  i=0
  while [ "$i" -lt "$runs" ]; do
    for threads in 1 2 8; do
      out=$work/out
      rm -rf "$out"
      # OpenCV's own threads, and the OpenMP of linked libraries.
      OPENCV_FOR_THREADS_NUM=$threads OMP_NUM_THREADS=$threads "$odograph" run -c "$config" -i "$recording" -o "$out" \
        >/dev/null 2>"$work/said" || [ $? -eq 1 ] || { cat "$work/said"; echo "FAILED: $recording does not run"; exit 1; }
      sum=$(cd "$out" && for file in trajectory.tum steps.csv scale.csv fixes.csv vo.csv; do
        [ ! -e $file ] || sha256sum $file
      done | sha256sum)
      total=$((total + 1))
      [ -n "$first" ] || first=$sum
      if [ "$sum" != "$first" ]; then
        echo "FAILED: $recording, run $i with $threads threads differs"
        failed=$((failed + 1))
      fi
    done
    i=$((i + 1))
  done
  echo "$recording: $first"
done
echo "$total runs of $# recordings, $failed differ"
[ $failed -eq 0 ]
