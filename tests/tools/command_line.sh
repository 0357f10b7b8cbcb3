#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The command line from a user's view: exit statuses and destinations of output.
set -u
odograph=$1 source=$2
. "$source/tests/support/expect.sh"
configs=$source/samples/configs
expect 0 "Exit status" "$odograph" --help
expect 0 "." "$odograph" --version
expect 2 "subcommand" "$odograph"
expect 2 "" "$odograph" nonsense
mkdir alone && cp "$odograph" alone/odograph
expect 2 "odograph-tools: No such file" alone/odograph bench walks
expect 0 "walk700" "$odograph" bench --help
expect 0 "attitude/vqf" "$odograph" plugins
expect 0 "tau_acc" "$odograph" plugins attitude/vqf
expect 2 "did you mean 'attitude/vqf'" "$odograph" plugins attitude/vfq
expect 0 "good" "$odograph" config check "$configs/antigny2019_paper.yaml"
printf '{"type":"CityJSON","version":"2.0","vertices":[],"CityObjects":{}}' >town.json
expect 0 "nothing that could be seen" "$odograph" city check town.json
expect 3 "a device" "$odograph" city check /dev/zero
expect 0 "time_ordering" "$odograph" config keys
printf 'odograph: 1\natitude:\n  plugin: x\n' >bad.yaml
expect 2 "bad.yaml:2:1: unknown key 'atitude'" "$odograph" config check bad.yaml
expect 2 "missing.yaml:1:1" "$odograph" config check missing.yaml
expect 3 "no recording in this folder" "$odograph" run -c "$configs/monocular.yaml" -i "$source" -o o
expect 3 "no such file" "$odograph" run -c "$configs/monocular.yaml" -i nothing -o o
printf 'odograph_scenario: 1\nwalker:\n  sped: 3\n' >bad_scenario.yaml
expect 2 "bad_scenario.yaml:3:3: walker: unknown key 'sped'" "$odograph" sim bad_scenario.yaml -o x.odo
tiny=$source/tests/data/tiny_walk.yaml
expect 0 "tiny.odo" "$odograph" sim "$tiny" -o tiny.odo --seed 3
expect 0 "written to" "$odograph" run -c "$configs/monocular_inertia.yaml" -i tiny.odo -o o --report
expect 2 "bad.yaml:2:1" "$odograph" run -c bad.yaml -i tiny.odo -o o
expect 0 "holds what the summary says" python3 "$source/tests/tools/page_figures.py" o/report.html o/summary.json
expect 0 "error rms" "$odograph" compare "$configs/phone_walk_odograph.yaml" "$configs/phone_walk.yaml" -i tiny.odo -o page.html
expect 0 "phone_walk_odograph.yaml" cat page.html
expect 0 "APE translation" "$odograph" eval --ref tiny.odo --est o --align yaw --plot eval.html
expect 0 '"axes":true' cat eval.html
expect 0 '"relative":{"t":[0' cat eval.html
cp tiny.odo same_walk.odo
expect 0 "http://127.0.0.1:" "$odograph" view -c "$configs/phone_walk.yaml" -i tiny.odo --port 0 --once
expect 0 "page-tiny.odo.html" "$odograph" compare "$configs/phone_walk.yaml" -i tiny.odo same_walk.odo -o page.html
expect 0 " m with true scale (" "$odograph" compare "$configs/phone_walk.yaml" -i tiny.odo
expect 0 '"rms_with_true_scale"' "$odograph" compare "$configs/phone_walk.yaml" -i tiny.odo --json
expect 0 '"error_m"' "$odograph" compare "$configs/phone_walk.yaml" -i tiny.odo --json
python3 -m json.tool out >/dev/null || { echo "FAILED: compare --json is not one JSON value"; failed=1; }
expect 3 "no such file" "$odograph" compare "$configs/phone_walk.yaml" -i nothing
expect 0 "written to" "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o --state walker.state
expect 0 "written to" "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o --state walker.state
expect 3 "walker.broken: " sh -c 'head -c 20 walker.state >walker.broken; "$@"' - "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o --state walker.broken
echo mine >victim && ln -s "$PWD/victim" walker.state.part
expect 0 "written to" "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o --state walker.state
[ "$(cat victim)" = mine ] || { echo "FAILED: a link beside the state is followed"; failed=1; }
mkfifo walker.pipe
expect 3 "is a folder, a pipe or a device" "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o --state walker.pipe
rm -rf o2
expect 3 "cannot be written" "$odograph" run -c "$configs/phone_walk_odograph.yaml" -i tiny.odo -o o2 --state no_folder/walker.state
[ -s o2/summary.json ] || { echo "FAILED: a state that cannot be saved costs the results"; failed=1; }
expect 0 '"distance_m"' "$odograph" run -c "$configs/phone_walk.yaml" -i tiny.odo -o o2 --json
python3 -m json.tool out >/dev/null || { echo "FAILED: --json is not one JSON object"; failed=1; }
expect 0 "APE" "$odograph" eval --ref tiny.odo --est o --align yaw
expect 0 '"ape_m"' "$odograph" eval --ref tiny.odo --est o --json
# Tracks that cannot be compared, and those that other programs write.
python3 - <<'EOF'
from math import cos, sin
rows = [(0.05 * i, cos(0.05 * i), sin(0.05 * i), sin(0.025 * i), cos(0.025 * i)) for i in range(40)]
def write(name, line, rows=rows, head=""):
    open(name, "w", encoding="utf-8").write(head + "".join(line(*row) + "\n" for row in rows))
tum = lambda t, x, y, s, c: f"{1000 + t:.6f} {x:.4f} {y:.4f} 0 0 0 {s:.6f} {c:.6f}"
kitti = lambda t, x, y, s, c: f"{c*c-s*s} {-2*s*c} 0 {x} {2*s*c} {c*c-s*s} 0 {y} 0 0 1 0"
write("ref.tum", tum)
write("whole.tum", lambda t, *rest: tum(int(t), *rest))
write("ns.txt", lambda t, x, y, s, c: f"{round((1000 + t) * 1e9)}.000000 {x:.4f} {y:.4f} 0 0 0 {s:.6f} {c:.6f}")
write("w_first.txt", lambda t, x, y, s, c: f"{1000 + t:.6f} {x:.4f} {y:.4f} 0 {c:.6f} 0 0 {s:.6f}", head="# timestamp tx ty tz qw qx qy qz\n")
write("seconds.csv", lambda t, x, y, s, c: f"{1000 + t:.6f},{x:.4f},{y:.4f},0,{c:.6f},0,0,{s:.6f}", head="timestamp,tx,ty,tz,qw,qx,qy,qz\n")
write("all.kitti", kitti)
write("each_4th.kitti", kitti, rows[::4])
EOF
expect 3 "rounded to seconds" "$odograph" eval --ref ref.tum --est whole.tum
for track in ns.txt w_first.txt seconds.csv; do
  "$odograph" eval --ref ref.tum --est $track --json >out.json && python3 -c "
import json
found = json.load(open('out.json'))
assert found['n'] == 40 and found['ape_deg']['max'] < 1e-3 and found['ape_m']['max'] < 1e-3, found['ape_deg']" || { echo "FAILED: $track"; failed=1; }
done
expect 3 "have no times" "$odograph" eval --ref all.kitti --est each_4th.kitti
expect 0 "poses 40" "$odograph" eval --ref all.kitti --est all.kitti
expect 2 "unknown alignment" "$odograph" eval --ref tiny.odo --est o --align sideways
expect 0 "poses" "$odograph" convert o track.gpx --origin 47.2,-1.55,20
expect 0 "poses" "$odograph" convert o track.kml --origin 47.2,-1.55,20
expect 0 "poses" "$odograph" convert o track.geojson --origin 47.2,-1.55,20
expect 2 "needs a geodetic origin" "$odograph" convert o track.gpx
expect 0 "poses" "$odograph" eval --ref tiny.odo --est o --offset 0.004 --max-diff 0.01
expect 3 "are the clocks the same" "$odograph" eval --ref tiny.odo --est o --offset 1000
expect 0 "good" "$odograph" config check "$configs/walk.yaml" "$configs/gnss_walk.yaml"
expect 2 "bad.yaml:2:1" "$odograph" config check "$configs/walk.yaml" bad.yaml
expect 0 "on a map" "$odograph" run -i tiny.odo -o mapped
expect 0 "fix/gnss" cat mapped/pipeline.yaml
[ "$(tail -n 1 mapped/corrected.tum)" = "$(tail -n 1 mapped/trajectory.tum)" ] || { echo "FAILED: nothing corrects the last pose"; failed=1; }
"$odograph" eval --ref tiny.odo --est mapped --json >out.json && "$odograph" eval --ref tiny.odo --est mapped/corrected.tum --json >corrected.json &&
  python3 -c "
import json
a, b = (json.load(open(name))['rpe_m']['max'] for name in ('out.json', 'corrected.json'))
assert b < a, f'the corrected track jumps by {b} m, the one that came out by {a} m'" && grep -q '"corrected"' out.json || { echo "FAILED: corrected.tum"; failed=1; }
expect 0 '"latitude_deg": 47.' cat mapped/summary.json
for kind in gpx kml geojson; do expect 0 "poses" "$odograph" convert mapped "mapped/track.$kind"; done
expect 0 "one foot's contact" "$odograph" steps tiny.odo
expect 0 "messages" "$odograph" convert tiny.odo copy.odo
[ "$(wc -c <copy.odo)" -le "$(wc -c <tiny.odo)" ] || { echo "FAILED: convert packs pictures anew"; failed=1; }
expect 0 "written to" "$odograph" run -c "$configs/monocular_inertia.yaml" -i copy.odo -o o3
expect 0 "true size" "$odograph" calibrate --print board.svg
expect 0 "</svg>" cat board.svg
expect 2 "expected COLUMNSxROWS" "$odograph" calibrate tiny.odo --squares many
expect 2 "no pictures; expected" "$odograph" calibrate
expect 3 "does not exist" "$odograph" calibrate nothing
expect 0 "beware" "$odograph" calibrate --imu tiny.odo -o c4
expect 3 "no such file" "$odograph" calibrate --imu nothing -o c4
expect 3 "--squares" "$odograph" calibrate tiny.odo
expect 0 "worst: focal length" "$odograph" bench calibrate --seeds 1 --pictures 12 --keep boards
expect 0 "'camera: FILE'" "$odograph" calibrate boards/pinhole_s1 -o c
expect 3 "not inner corners: they show 10x7" "$odograph" calibrate boards/pinhole_s1 -o c --squares 9x6
: >film.mp4
expect 3 "not a video" "$odograph" calibrate film.mp4 -o c3
printf 'odograph: 1\ncamera: c/camera.yaml\nvo_frontend: {plugin: vo/five_point}\n' >own_camera.yaml
expect 0 "good" "$odograph" config check own_camera.yaml
head -c 100000 tiny.odo >cut.odo
expect 3 "end mark is missing" "$odograph" run -c "$configs/phone_walk.yaml" -i cut.odo -o o4
expect 0 '"cut_off": true' cat o4/summary.json
# Every command reports losses, in words and by its status.
python3 - <<'PY'
data = bytearray(open("tiny.odo", "rb").read())
data[len(data) // 3] ^= 4
open("flip.odo", "wb").write(data)
PY
expect 3 "1 of " "$odograph" run -c "$configs/phone_walk.yaml" -i flip.odo -o o5
expect 0 '"records": 1' cat o5/summary.json
expect 3 "records are lost" "$odograph" steps flip.odo -c "$configs/phone_walk_odograph.yaml"
expect 3 "records are lost" "$odograph" eval --ref flip.odo --est o --align yaw
expect 3 "records are lost" "$odograph" convert flip.odo mended.odo
expect 0 "messages" "$odograph" convert mended.odo again.odo
expect 3 "records are lost" "$odograph" compare "$configs/phone_walk.yaml" -i flip.odo
# Input and output may be the same file, also through a link; a full disk keeps the existing file.
cp tiny.odo same.odo
ln -s same.odo link.odo
expect 0 "messages" "$odograph" convert same.odo same.odo
expect 0 "messages" "$odograph" convert same.odo link.odo
cmp -s copy.odo same.odo || { echo "FAILED: a recording converted into itself is another one"; failed=1; }
expect 3 "disk full" sh -c 'trap "" XFSZ; ulimit -f 100; "$@"' - "$odograph" convert same.odo same.odo
cmp -s copy.odo same.odo || { echo "FAILED: a full disk took the recording that was there"; failed=1; }
cp o/summary.json before.json
expect 3 "disk full" sh -c 'trap "" XFSZ; ulimit -f 1; "$@"' - "$odograph" run -c "$configs/phone_walk.yaml" -i tiny.odo -o o
cmp -s o/summary.json before.json || { echo "FAILED: a full disk took the results that were there"; failed=1; }
ls ./*.part o/*.part 2>/dev/null && { echo "FAILED: something unfinished was left"; failed=1; }
# In a folder with older results, those that this run does not write are removed.
expect 0 "written to" "$odograph" run -c "$configs/monocular_inertia.yaml" -i tiny.odo -o o6 --report
expect 0 "written to" "$odograph" run -c "$configs/phone_walk.yaml" -i tiny.odo -o o6
ls o6/vo.csv o6/report.html 2>/dev/null && { echo "FAILED: results of an older run were left"; failed=1; }
# EuRoC: items without a place in it are reported, a folder is not overwritten, a damaged picture costs only its frame.
expect 0 "skipped, because EuRoC/ASL cannot represent it" "$odograph" convert tiny.odo euroc
expect 2 "holds a recording" "$odograph" convert tiny.odo euroc
picture=$(ls euroc/mav0/cam0/data/*.png | sed -n 20p)
: >"$picture"
expect 3 "1 pictures cannot be read" "$odograph" run -c "$configs/monocular.yaml" -i euroc -o o7
expect 0 '"pictures": 1' cat o7/summary.json
expect 3 "1 pictures cannot be read" "$odograph" convert euroc mended2.odo
sed -i 's/resolution: .*/resolution: [320, 240]/' euroc/mav0/cam0/sensor.yaml
expect 3 "calibration of camera 0 is for 320 x 240" "$odograph" run -c "$configs/monocular.yaml" -i euroc -o o8
# What goes wrong with the sensors of any recording.
cat >faults.yaml <<'YAML'
odograph_faults: 1
seed: 3
faults:
  - {fault: drop, sensor: gyroscope, from: 2 s, for: 300 ms}
  - {fault: value, sensor: accelerometer, part: 0.01, value: 1e300}
  - {fault: repeat, sensor: magnetometer, part: 0.5}
  - {fault: delay, sensor: camera, from: 3 s, for: 1 s, by: 2 s}
  - {fault: black, sensor: camera, from: 5 s, for: 500 ms}
YAML
expect 0 "written to" "$odograph" run -c "$configs/monocular_inertia.yaml" -i tiny.odo -o o10 --faults faults.yaml
grep -q '"wild": 0' o10/summary.json && { echo "FAILED: --faults spoiled nothing"; failed=1; }
expect 0 "written to" "$odograph" run -c "$configs/monocular_inertia.yaml" -i tiny.odo -o o11 --faults faults.yaml
cmp -s o10/trajectory.tum o11/trajectory.tum || { echo "FAILED: the same faults gave another track"; failed=1; }
printf 'odograph_faults: 1\nfaults: [{fault: melt, sensor: imu}]\n' >melt.yaml
expect 2 "melt.yaml:2:18: faults[0].fault: 'melt'" "$odograph" run -c "$configs/phone_walk.yaml" -i tiny.odo -o o12 --faults melt.yaml
mkfifo pipe
expect 3 "a pipe or a device" timeout 10 "$odograph" run -c "$configs/phone_walk.yaml" -i pipe -o o9
expect 2 "a pipe or a device" timeout 10 "$odograph" config check pipe
printf 'odograph: 1\nb\033ad: 3\n' >escape.yaml
expect 2 'b\x1Bad' "$odograph" config check escape.yaml
expect 4 "FAIL" "$odograph" plugin check "$source/README.md"
expect 3 "nothing.so: does not exist" "$odograph" plugin check nothing.so
[ "$(cat out err | wc -l)" -le 1 ] || { echo "FAILED: a missing plugin takes more than a line"; failed=1; }
expect 3 "is not a regular file" "$odograph" plugin check "$source"
mkdir -p bare && touch bare/lonely.so
printf 'odograph: 1\nplugins: {search: [gone, bare]}\nattitude: {plugin: acme/lonely}\n' >lonely.yaml
expect 2 "there is no folder" "$odograph" config check lonely.yaml
cat out err | grep -q "bare/lonely.so has no manifest" || { echo "FAILED: a library without a manifest is not named"; failed=1; }
expect 0 "one foot's contact" "$odograph" steps tiny.odo -c "$configs/phone_walk_odograph.yaml" --each
expect 0 '"distance_m"' "$odograph" steps tiny.odo -c "$configs/phone_walk_odograph.yaml" --json
python3 -m json.tool out >/dev/null || { echo "FAILED: steps --json is not one JSON object"; failed=1; }
expect 0 "track length" "$odograph" bench tracks tiny.odo
expect 0 "Poses predicted 30 ms ahead" "$odograph" bench stream tiny.odo -c "$configs/monocular_inertia.yaml" --settle 1
expect 0 "Shape and cost" "$odograph" bench vo tiny.odo -c "$configs/monocular_odograph.yaml" --sensors --cut 1 --dark 2:1
expect 0 '"wrongly_certain_percent"' "$odograph" bench vo tiny.odo -c "$configs/monocular_odograph.yaml" --json
python3 -m json.tool out >/dev/null || { echo "FAILED: bench vo --json is not one JSON value"; failed=1; }
awk '{print $1, 0, 0, 0, $5, $6, $7, $8}' o/trajectory.tum >still.tum
expect 0 "Shape and cost" "$odograph" bench vo tiny.odo -c "$configs/monocular_odograph.yaml" --reference still.tum
expect 2 "expected FROM:FOR" "$odograph" bench vo tiny.odo --gap 10
expect 2 "is for one recording" "$odograph" bench vo tiny.odo copy.odo --reference o/trajectory.tum
expect 0 "4 s windows" "$odograph" bench tracks --excitation-only tiny.odo
expect 0 "typing" "$odograph" bench steps --seeds 1 -c "$configs/phone_walk_odograph.yaml"
cat >car.yaml <<'YAML'
odograph_scenario: 1
carrier: car
world: {type: downtown, unmapped: [[20, 40]]}
route:
  points: [[0, 0, 0], [60, 0, 0]]
camera: {width: 96, height: 72, focal: 60 px}
YAML
expect 0 "car.odo" "$odograph" sim car.yaml -o car.odo --city town.city.json
expect 0 "CityJSON" cat town.city.json
expect 0 "skylines a second" "$odograph" city build town.city.json -o town.skylines --spacing 20
expect 0 "places, 20.0 m apart" "$odograph" city query town.skylines
expect 0 "azimuth_deg elevation_deg height_m distance_m" "$odograph" city query town.skylines --at 0 0
expect 0 "11 skylines in" "$odograph" city query town.skylines --at 0 0 --to 6 8 --step 1
printf '0, 0\n100, 0\n' >road.csv
expect 0 "11 places" "$odograph" city build town.city.json -o road.skylines --spacing 10 --along road.csv
expect 3 "not a skyline database" "$odograph" city query town.city.json
head -c 2000 town.skylines >cut.skylines
expect 3 "bytes long" "$odograph" city query cut.skylines
expect 3 "nothing.skylines" "$odograph" city query nothing.skylines
expect 1 "Figure 11" "$odograph" bench drive --scenario car.yaml -c "$configs/monocular.yaml" --keep kept
printf 'odograph_scenario: 1\nworld: {type: city, model: nothing.city.json}\n' >city.yaml
expect 3 "nothing.city.json: no such file" "$odograph" sim city.yaml -o x.odo
printf '{"type": "CityJSON"}' >nothing.city.json
expect 3 "version" "$odograph" sim city.yaml -o x.odo
exit $failed
