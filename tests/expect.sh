# SPDX-License-Identifier: Apache-2.0
# For scripts that try commands: sets failed where one does something else than it is to do.
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
