#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `odograph map` from a user's view: statuses, words, and that nothing is written where something is wrong.
set -u
odograph=$1 source=$2
. "$source/tests/support/expect.sh"
cat >room.yaml <<'EOF'
odograph_scenario: 1
world: {type: room}
camera: {width: 480, height: 360, focal: 380, pitch: -15 deg}
walker: {gait: viewing, speed: 0.8 m/s, stand: 3 s}
route: {points: [[0, 0, 0], [5, 0, 0]]}
EOF
expect 0 "room.odo" "$odograph" sim room.yaml -o room.odo --seed 7
expect 2 "folder for the map does not exist" "$odograph" run -i room.odo -o o --map nowhere/room.map
expect 0 "written to" "$odograph" run -c "$source/samples/configs/walk_map.yaml" -i room.odo -o o --map room.map
expect 0 "key frames with" "$odograph" map show room.map
expect 0 '"key_frames"' "$odograph" map show room.map room.map --json
python3 -c "
import json
a, b = json.load(open('out'))['maps']
assert a == b and a['plugin'] == 'fix/map' and a['key_frames'] > 5 and a['bytes'] > 20000 * a['key_frames'] / 2, a
assert 3 < a['path_m'] < 7 and 3 < a['extent_m'][0] < 7 and a['anchors'] == [], a" || { echo "FAILED: what --json says"; failed=1; }
cp room.map copy.map
expect 0 "written to whole.map" "$odograph" map merge room.map copy.map -o whole.map
[ "$(wc -c <whole.map)" -eq "$(wc -c <room.map)" ] || { echo "FAILED: what both maps have is not there once"; failed=1; }
expect 0 "are left out" "$odograph" map thin room.map --size 0.06 -o room.map
[ "$(wc -c <room.map)" -le 60000 ] || { echo "FAILED: the thinned map is too large"; failed=1; }
expect 2 "a single key frame" "$odograph" map thin whole.map --size 0.001 -o none.map
expect 0 "written to map.ply" "$odograph" map export whole.map -o map.ply
python3 -c "
head, rows = open('map.ply').read().split('end_header\n')
rows = [row.split() for row in rows.splitlines()]
assert f'element vertex {len(rows)}\n' in head and all(len(row) == 6 for row in rows), head
assert rows[0][3:] == ['0', '0', '255'] and ['255', '0', '0'] in [row[3:] for row in rows]" || { echo "FAILED: map.ply"; failed=1; }
head -c 5000 whole.map >cut.map && : >empty.map && echo "odograph: 1" >other.map
for file in cut empty other; do
  expect 3 "$file.map: the data is not a map that this version reads" "$odograph" map show "$file.map"
  for command in "merge whole.map $file.map" "thin $file.map --size 1" "export $file.map"; do
    # shellcheck disable=SC2086  # words
    expect 3 "$file.map: the data is not a map" "$odograph" map $command -o none.map
  done
done
expect 3 "no such file" "$odograph" map show nothing.map
expect 3 "is a folder, a pipe or a device" "$odograph" map show .
expect 2 "" "$odograph" map merge whole.map -o none.map
cp whole.map kept.map
expect 3 "cannot be written" "$odograph" map thin whole.map --size 0.06 -o no_folder/x.map
expect 3 "cut.map: " "$odograph" map merge whole.map cut.map -o whole.map
cmp -s kept.map whole.map || { echo "FAILED: a map is overwritten by nothing"; failed=1; }
[ ! -e none.map ] || { echo "FAILED: something is written in spite of an error"; failed=1; }
exit $failed
