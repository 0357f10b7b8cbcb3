#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Replays a recording of H hours of sensor time by `odograph run`: nothing is lost, and summary.json agrees with the
# tables.
#   long_run.sh ODOGRAPH ODOGRAPH-ENDURANCE HOURS
set -eu
odograph=$1 endurance=$2 hours=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
"$endurance" record "$hours" long.odo
printf 'odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nabsolute_fixers: [{plugin: fix/gnss}, {plugin: fix/barometer}]\n' >long.yaml
"$odograph" run -c long.yaml -i long.odo -o out >/dev/null
python3 - "$hours" <<'PYTHON'
import json, sys
hours = float(sys.argv[1])
summary = json.load(open("out/summary.json"))
rows = {name: sum(1 for _ in open("out/" + name)) for name in ("trajectory.tum", "steps.csv", "fixes.csv")}
steps, fixes = rows["steps.csv"] - 1, rows["fixes.csv"] - 1
states_s, sensor_s = sum(summary["states_s"].values()), hours * 3600
times = [float(line.split()[0]) for line in open("out/trajectory.tum")]
checks = {
    "steps": summary["steps"] == steps,
    "poses": summary["poses"] == rows["trajectory.tum"],
    "fixes": summary["fixes"]["accepted"] + summary["fixes"]["rejected"] == fixes,
    "fixes of every second and tenth": fixes >= hours * 3600,
    "times in order": all(a < b for a, b in zip(times, times[1:])),
    "states fill the time": abs(states_s - sensor_s) < 5,
    "no fault": not any(summary["faults"].values()),
    "nothing lost": not any(summary["lost"].values()),
}
print("%g h: %d steps, %d poses, %d fixes, %.1f s in states of %.0f s, %.0f MB at most" %
      (hours, steps, rows["trajectory.tum"], fixes, states_s, sensor_s, summary["peak_rss_mb"]))
wrong = [name for name, good in checks.items() if not good]
print("FAILED: " + ", ".join(wrong) + "\n" + json.dumps(summary, indent=1)[:3000] if wrong else "summary.json adds up")
sys.exit(1 if wrong else 0)
PYTHON
