#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# No word of headers, documents, code and help texts is on codespell's list of misspellings, none on that of home-made words (words.txt).
set -eu
cd "$1"
command -v codespell >/dev/null || { echo "SKIPPED: no codespell"; exit 77; }
# North-East-Down, normalised estimation error squared, a city, to and fro, a stair's tread, a journal, static variables, names of variables,
# and what tests misspell on purpose.
codespell abi sdk plugins samples schemas docs packaging tests README.md CONTRIBUTING.md CHANGELOG.md \
  --skip '*.svg,*.png,*.jpg,*.inc,seeds,data' --ignore-words-list="ned,nees,linz,fro,tread,ther,statics,te,hist,ba,nd,ser,lod,thi,crate,inout,tesselator,heigth,hight,whats"
# Names and their parts, and phrases; in documents all words too, outside of code, links and quotations: software does not tell or believe.
part="ways?|turns?|rivals?|rooms?|chain(?:ed)?"
names="(?<![A-Za-z])(?<!\\bat_)(?<!first_at_)(?:$part|most|least|fewest)_(?=[a-z])(?!squares)|_(?:$part)\\b|\\b(?:gyro|gyroscope|vo|whose|level|turned) (?:chain|units?|level|acceleration|displacement|frame|camera|axis)\\b"
names="$names|\\b(?i:wayteacher|carryjudge|gyrochain|placeless|owes|straighten|weigh_depths|seen_turn|metres_per_unit|units_per_m|unit_drift|level_sigma)\\b"
git ls-files '*.[ch]' '*.[ch]pp' | xargs codespell -D tests/house/words.txt --ignore-regex '"[^"]*"' --regex "$names"
git ls-files '*.md' | grep -v '^CHANGELOG' | xargs codespell -D tests/house/words.txt --ignore-regex '`[^`]*`|\]\([^)]*\)|"[^"]*"' \
  --regex "$names|\\b(?:begins?|starts?) anew\\b|by hand|wrongly certain|held against|[\\w'-]+"
