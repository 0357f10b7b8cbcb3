#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# No word of headers, documents, code and help texts is on codespell's list of misspellings.
set -eu
cd "$1"
command -v codespell >/dev/null || { echo "SKIPPED: no codespell"; exit 77; }
# North-East-Down, normalised estimation error squared, a city, to and fro, a stair's tread, a journal, static variables, names of variables,
# and what tests misspell on purpose.
exec codespell abi sdk plugins samples schemas docs packaging tests README.md CONTRIBUTING.md CHANGELOG.md \
  --skip '*.svg,*.png,*.jpg,*.inc,seeds,data' --ignore-words-list="ned,nees,linz,fro,tread,ther,statics,te,hist,ba,nd,ser,lod,thi,crate,inout,tesselator,heigth,hight,whats"
