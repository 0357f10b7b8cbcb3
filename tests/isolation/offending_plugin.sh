#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Plugins that end the app's process: each is named with the call, no exit status is 0, and results are written before
# a plugin is destroyed.
set -u
odograph=$1 faulty_plugins=$2 source=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
"$odograph" sim "$source/tests/data/tiny_walk.yaml" -o tiny.odo >/dev/null || exit 1
mkdir plugins
# faulty plugin, expected words
run() {
  faulty=$1
  rm -f plugins/*
  cp "$faulty_plugins/$faulty.so" plugins/
  "$odograph" plugin manifest "plugins/$faulty.so" >/dev/null || { echo "FAILED: no manifest of $faulty"; failed=1; return; }
  printf 'odograph: 1\nplugins: {search: [plugins]}\nattitude: {plugin: attitude/vqf}\nvo_frontend: {plugin: vo/five_point}\n' >config.yaml
  case $(cat plugins/*.json) in
    *attitude*) printf 'odograph: 1\nplugins: {search: [plugins]}\nattitude: {plugin: test/faulty}\n' >config.yaml ;;
    *step_estimator*) printf 'step_estimator: {plugin: test/faulty}\n' >>config.yaml ;;
    *scale_source*) printf 'scale_source: {plugin: test/faulty}\n' >>config.yaml ;;
    *absolute_fixer*) printf 'absolute_fixers: [{plugin: test/faulty}]\n' >>config.yaml ;;
    *vo_frontend*) printf 'odograph: 1\nplugins: {search: [plugins]}\nvo_frontend: {plugin: test/faulty}\n' >config.yaml ;;
  esac
  rm -rf out
  # shellcheck disable=SC3045  # dash and bash have -c
  (ulimit -c 0; exec "$odograph" run -c config.yaml -i tiny.odo -o out) >said 2>&1
  status=$?
}
expect() {
  run "$1"
  [ $status -ne 0 ] || { echo "FAILED: $1 ended with status 0"; failed=1; }
  grep -qF -- "$2" said || { echo "FAILED: $1: '$2' was not said"; cat said; failed=1; }
}
expect process_works__segfault "odograph: segmentation fault in plugin test/faulty in process"
expect process_works__exit "odograph: exit() was called in plugin test/faulty in process"
[ $status -eq 4 ] || { echo "FAILED: an exit in a plugin is status $status, expected 4"; failed=1; }
expect process_works__abort "odograph: aborted in plugin test/faulty in process"
expect process_works__stack_overflow "odograph: segmentation fault in plugin test/faulty in process"
expect life_create_destroy__crash_in_destroy "in plugin test/faulty in destroy"
[ -s out/summary.json ] || { echo "FAILED: a crash in destroy took the results"; failed=1; }
run events_numbers__nan
[ $status -eq 4 ] || { echo "FAILED: invalid events are status $status, expected 4"; cat said; failed=1; }
[ -s out/summary.json ] || { echo "FAILED: invalid events took the results"; failed=1; }
run process_works__throws
grep -qF "an exception was thrown by process: the fortieth sample is unlucky" said || { echo "FAILED: an exception was not told"; cat said; failed=1; }

# Found by its name in PATH, the program starts its own plugin host, not one of the current folder.
mkdir elsewhere
cd elsewhere || exit 1
printf 'odograph: 1\nattitude: {plugin: attitude/vqf, isolation: process}\n' >config.yaml
: >odograph
printf '#!/bin/sh\n: >started\n' >odograph-plugin-host
chmod +x odograph-plugin-host
(PATH=$(dirname "$odograph"):$PATH; export PATH; exec odograph run -c config.yaml -i ../tiny.odo -o out) >said 2>&1
grep -q "no process could be started\|needs the program" said && { echo "FAILED: an isolated plugin did not start from PATH"; cat said; failed=1; }
[ -s out/summary.json ] || { echo "FAILED: no results with an isolated plugin from PATH"; cat said; failed=1; }
[ ! -e started ] || { echo "FAILED: odograph-plugin-host of the current folder was started"; failed=1; }
exit $failed
