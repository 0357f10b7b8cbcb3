# SPDX-License-Identifier: Apache-2.0
# For scripts that run commands, in a new folder: sets failed if one has another status or output than expected.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
expect() { # status, words that must be in the output, command...
  want=$1 words=$2
  shift 2
  "$@" >out 2>err </dev/null
  got=$?
  if [ $got -ne "$want" ] || ! cat out err | grep -qF -- "$words"; then
    echo "FAILED: $* -> $got, expected $want and '$words'"; cat out err; failed=1
  fi
}
