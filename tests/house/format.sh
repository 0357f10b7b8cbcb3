#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# All code is formatted as .clang-format says (clang-format 14, as Debian 12 has it).
set -eu
cd "$1"
command -v clang-format >/dev/null || { echo "SKIPPED: no clang-format"; exit 77; }
clang-format --version | grep -q 'version 14' || { echo "SKIPPED: another clang-format than 14"; exit 77; }
find abi sdk plugins samples tests -name '*.[ch]pp' -o -name '*.[ch]' | sort | xargs clang-format --dry-run -Werror
