#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The table of exit statuses of docs/commands.md over small recordings: results of nothing, lost input, wrong commands.
# Each row: status, words that must appear, command.
set -u
odograph=$1 source=$2
. "$source/tests/support/expect.sh"
configs=$source/samples/configs
steps=$configs/phone_walk_odograph.yaml
"$odograph" sim "$source/tests/data/tiny_walk.yaml" -o tiny.odo --seed 3 >/dev/null 2>&1
head -c 100000 tiny.odo >cut.odo
python3 - <<'EOF'
import os
import random
from math import pi, sin, cos

HEAD = "t_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n"

def imu(folder, *, walks=1, gyro=1, accel=1, unit=1, begin=0, seconds=12):
    """A walk of 17 steps, or a phone at rest."""
    os.makedirs(folder, exist_ok=True)
    with open(folder + "/imu.csv", "w", encoding="utf-8") as file:
        file.write(HEAD)
        for i in range(50 * seconds):
            t = i / 50
            r = walks * max(0, min(1, (t - 1) / 0.3)) * max(0, min(1, (seconds - 1 - t) / 0.3))
            p = 2 * pi * 1.8 * (t - 1)
            noise = [0.02 * sin(1e3 * k * t + k) for k in range(6)]
            a = (r * 0.6 * sin(p / 2) + noise[0], r * 1.1 * cos(p) + noise[1], 9.81 + r * (2.3 * sin(p) + 0.6 * sin(2 * p + 0.7)) + noise[2])
            g = (r * 0.15 * sin(p + 0.2) + 0.1 * noise[3], r * 0.1 * sin(p / 2) + 0.1 * noise[4], r * 0.12 * sin(p / 2 + 0.4) + 0.1 * noise[5])
            numbers = [f"{gyro * x:.4f}" for x in g] + [f"{accel * x:.4f}" for x in a]
            file.write(",".join([str(begin + round(t * 1e9) // unit)] + numbers) + "\n")

def film(folder, *, moves=4, begin=0, frames=24):
    """Pictures of a wall, past which the camera is moved."""
    os.makedirs(folder + "/images", exist_ok=True)
    random.seed(1)
    wall = [bytes(v for v in random.choices(range(256), k=120) for _ in range(6)) for _ in range(20)]
    with open(folder + "/times.csv", "w", encoding="utf-8") as times:
        for i in range(frames):
            with open(f"{folder}/images/{i:04d}.pgm", "wb") as file:
                file.write(b"P5\n160 120\n255\n" + b"".join(wall[y // 6][moves * i:moves * i + 160] for y in range(120)))
            times.write(f"{begin + i * 10**8}\n")
    with open(folder + "/camera.yaml", "w", encoding="utf-8") as file:
        file.write("model: pinhole\nwidth: 160\nheight: 120\nfx: 120\nfy: 120\ncx: 79.5\ncy: 59.5\n")

def gnss(folder, speed, seconds=12):
    with open(folder + "/gnss.csv", "w", encoding="utf-8") as file:
        file.write("t_ns,latitude,longitude,height,accuracy\n" + "".join(f"{i * 10**9},{48 + 9e-6 * speed * i:.7f},11,500,4\n" for i in range(seconds)))

imu("walk"), imu("rest", walks=0)
imu("ms", unit=10**6, begin=1_700_000_000_000), imu("us", unit=1000), imu("degrees", gyro=57.29578)
imu("g", accel=1 / 9.80665)
film("film"), film("still", moves=0)
imu("film_rest", walks=0), film("film_rest", moves=0, frames=119)
imu("ahead"), film("ahead", begin=3600 * 10**9)
imu("drive", walks=0), film("drive", frames=60), gnss("drive", 10)
imu("parked", walks=0), gnss("parked", 0)
imu("rows"), open("rows/imu.csv", "a", encoding="utf-8").write("x,1,2,3,4,5,6\n")
os.makedirs("euroc_g/mav0/imu0")
with open("g/imu.csv", encoding="utf-8") as plain, open("euroc_g/mav0/imu0/data.csv", "w", encoding="utf-8") as euroc:
    euroc.write("#" + plain.read())
data = bytearray(open("tiny.odo", "rb").read())
data[len(data) // 3] ^= 4
open("flip.odo", "wb").write(data)
EOF
printf 'odograph: 1\n' >empty.yaml
printf 'odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/step_length}\n' >scale.yaml
printf 'odograph: 1\nattitude: {plugin: attitude/vqf}\nabsolute_fixers: [{plugin: fix/gnss}]\ncoupling: {type: localizer}\n' >gnss.yaml
printf 'odograph: 1\nvo_frontend: {plugin: vo/five_point}\nabsolute_fixers: [{plugin: fix/gnss}]\n' >drive.yaml
printf 'odograph: 1\natitude: {plugin: x}\n' >unknown.yaml
printf 'odograph: 1\nabsolute_fixers: [{plugin: fix/terrain, parameters: {model: hill.obj}}]\n' >hill.yaml

# The input holds motion and the run comes to nothing: 1, with the likeliest reason.
expect 1 "neither a step_estimator nor a vo_frontend" "$odograph" run -c empty.yaml -i walk -o o
expect 1 "the recording no frames" "$odograph" run -c "$configs/monocular.yaml" -i walk -o o
expect 1 "no inertial samples" "$odograph" run -c "$steps" -i film -o o
expect 1 "no inertial samples" "$odograph" run -c "$configs/walk.yaml" -i film -o o
expect 1 "in ms (multiply by 1,000,000)" "$odograph" run -i ms -o o
expect 1 "in ms (multiply by 1,000,000) or us" "$odograph" run -c "$steps" -i us -o o
expect 1 "Multiply by pi/180" "$odograph" run -i degrees -o o
expect 1 "after the inertial samples: on another clock?" "$odograph" run -c "$configs/walk.yaml" -i ahead -o o
expect 1 "no pose does" "$odograph" run -c scale.yaml -i film -o o
expect 1 "never had a scale in metres" "$odograph" run -c drive.yaml -i drive -o o
expect 1 "came to nothing" "$odograph" run -c gnss.yaml -i drive -o o
expect 1 "came to nothing" "$odograph" view --once --port 0 -c empty.yaml -i walk
expect 1 "after the inertial samples: on another clock?" "$odograph" view --once --port 0 -c "$configs/walk.yaml" -i ahead
expect 1 "came to nothing" "$odograph" compare "$steps" empty.yaml -i walk
expect 1 "came to nothing" "$odograph" compare "$steps?step_estimator.plugin=step/weinberg2002" -i us
expect 1 "came to nothing" "$odograph" steps us
expect 1 "came to nothing" "$odograph" bench vo ahead -c "$configs/walk.yaml" --fresh
expect 1 "came to nothing" "$odograph" bench vo ahead -c "$configs/walk.yaml"
expect 1 "in g? Multiply by 9.80665" "$odograph" run -i euroc_g -o o
# A phone at rest, and a track up to scale, are results: 0.
expect 0 "still" "$odograph" run -i rest -o o
expect 0 "still" "$odograph" run -c "$configs/walk.yaml" -i film_rest -o o
expect 0 "still" "$odograph" run -c gnss.yaml -i parked -o o
expect 0 "still" "$odograph" compare "$steps" -i rest
expect 0 "0 steps" "$odograph" steps rest
expect 0 "units" "$odograph" run -c "$configs/monocular.yaml" -i film -o o
expect 0 "units" "$odograph" compare "$configs/monocular.yaml" -i film
expect 0 "http" "$odograph" view --once --port 0 -c "$configs/monocular.yaml" -i film
expect 0 " m, " "$odograph" run -i walk -o o
expect 0 "17 steps" "$odograph" run -c "$steps" -i walk -o o
expect 0 "error rms" "$odograph" compare "$steps" --set walker.height=1.9m -i tiny.odo
expect 0 "walker.height=1.9m" "$odograph" compare "$steps?walker.height=1.9m" -i tiny.odo
# Lost or bad input: 3, also where the run came to nothing.
expect 3 "end mark is missing" "$odograph" run -c "$steps" -i cut.odo -o o
expect 3 "came to nothing" "$odograph" run -c empty.yaml -i cut.odo -o o
expect 3 "records are lost" "$odograph" view --once --port 0 -c "$steps" -i flip.odo
expect 3 "records are lost" "$odograph" compare "$steps" -i flip.odo
expect 3 "records are lost" "$odograph" steps flip.odo
expect 3 "records are lost" "$odograph" convert flip.odo o.odo
expect 3 "recording is lost" "$odograph" bench vo flip.odo -c "$configs/monocular.yaml"
expect 3 "is no time" "$odograph" run -i rows -o o
expect 3 "in g?" "$odograph" run -i g -o o
expect 3 "no such file" "$odograph" run -i nothing -o o
expect 3 "cannot be opened" "$odograph" eval --ref nothing --est tiny.odo
expect 3 "no such file" "$odograph" convert nothing o.odo
expect 3 "nothing.json: no such file" "$odograph" city check nothing.json
expect 3 "nothing.so: does not exist" "$odograph" plugin check nothing.so
expect 0 "share/odograph/samples/configs/city_drive.yaml" "$odograph" city bench --help
# A wrong command or config: 2.
expect 2 "--input is required" "$odograph" run
expect 2 "unknown key 'atitude'" "$odograph" run -c unknown.yaml -i walk -o o
expect 2 "unknown key 'atitude'" "$odograph" view --once --port 0 -c unknown.yaml -i walk
expect 2 "unknown key 'atitude'" "$odograph" compare unknown.yaml -i walk
expect 2 "unknown key 'atitude'" "$odograph" bench vo tiny.odo -c unknown.yaml
expect 2 "unknown key 'atitude'" "$odograph" config check unknown.yaml
expect 2 "tallness" "$odograph" run -i walk -o o --set walker.tallness=1.8m
expect 2 "tallness" "$odograph" compare "$steps" -i walk --set walker.tallness=1.8m
expect 2 "tallness" "$odograph" compare "$steps?walker.tallness=1.8m" -i walk
expect 2 "unknown alignment" "$odograph" eval --ref tiny.odo --est tiny.odo --align sideways
expect 2 "" "$odograph" plugin
# A plugin that fails, refuses its parameters or is not the one of its manifest: 4.
expect 4 "no file 'hill.obj' beside the config" "$odograph" run -c hill.yaml -i walk -o o
expect 4 "FAIL" "$odograph" plugin check "$source/README.md"
mkdir changed
cp "$(dirname "$odograph")"/../lib/odograph/plugins/step_weinberg2002.* changed
echo >>changed/step_weinberg2002.so
expect 2 "its hash differs" "$odograph" config check "$configs/phone_walk.yaml" --plugins changed
expect 4 "its hash differs" "$odograph" run -c "$configs/phone_walk.yaml" --plugins changed -i walk -o o
"$odograph" plugin new step_estimator acme/probe --language c >/dev/null
printf 'double drand48(void) { return 7; }\n' >drand48.c
sed -i 's/^struct odo_instance {/double drand48(void);\nstatic double first(void) { return drand48(); }\nstruct odo_instance {/; s/->gain = \(.*\);$/->gain = (\1) + 0 * first();/' probe/*.c
build() { "${CC:-cc}" -std=c99 -shared -fPIC -I "$source/abi/include" "$@" -o probe.so probe/*.c drand48.c -lm; }
build && "$odograph" plugin manifest probe.so >/dev/null
expect 4 "it exports drand48, and calls those of this program instead; compile with -fvisibility=hidden" "$odograph" plugin check probe.so --only entry.exports
build -fvisibility=hidden && "$odograph" plugin manifest probe.so >/dev/null
expect 0 "1 passed" "$odograph" plugin check probe.so --only entry.exports
exit $failed
