#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The shell scripts are free of warnings of shellcheck. Left out: SC2086 and SC2046 (words split on purpose); SC1091, SC2034, SC2154 and SC2164
# (variables and options of the scripts that source a file).
set -eu
cd "$1"
command -v shellcheck > /dev/null || { echo "SKIPPED: no shellcheck"; exit 77; }
git grep -lE '^#!/bin/(ba)?sh' -- . | xargs shellcheck --severity=warning --exclude=SC2086,SC2046,SC1091,SC2034,SC2154,SC2164
