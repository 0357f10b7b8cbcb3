# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh
# For the targets' scripts, sourced from the project's root.
set -eu
kept=${ODOGRAPH_TARGETS:-$HOME/.cache/odograph-targets}
mkdir -p "$kept"
export ODOGRAPH_TARGETS="$kept"

# install PACKAGE ...: Debian's packages that are missing on this machine.
install() {
  missing=""
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "installing:$missing"
  as_root=""
  [ "$(id -u)" = 0 ] || as_root=sudo
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

# once NAME KEY COMMAND ...: runs a step unless it ended well before with the same key, the text of all that it depends on.
once() {
  once_file=$kept/$1.done once_key=$2
  shift 2
  if [ -f "$once_file" ] && [ "$(cat "$once_file")" = "$once_key" ]; then return 0; fi
  rm -f "$once_file"
  "$@"
  printf '%s\n' "$once_key" > "$once_file"
}
