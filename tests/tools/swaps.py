#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""swaps.py ODOGRAPH PROJECT FOLDER: every plugin of each kind, put into a config by its one line, over two recordings.

Each combination is right, or refused or explained by name: the track differs from the same run without that line and is
near the truth, or a sentence of the run names the plugin. What is neither fails."""
import json
import pathlib
import re
import subprocess
import sys

odograph, project, work = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
OF_DRIVE = {"fix/skyline": "{model: city.json, sky: flood_fill, tilt_sigma: 1 deg, survey: false}",
            "scale/slant_distance": "{formula: points, window: 3 s, scale_drift: 0.2}"}
WRONG = 0.3  # of the path: twice what a basic odometry with steps is off in so short a walk
KINDS = ["attitude", "step_estimator", "vo_frontend", "scale_source", "absolute_fixers"]
INTERFACES = {"attitude": "attitude", "step_estimator": "step", "vo_frontend": "vo", "scale_source": "scale", "absolute_fixers": "fix"}


def run(*command):
    return subprocess.run([odograph, *map(str, command)], capture_output=True, text=True, check=False)


def plugins():
    """The shipped plugins, by the kind's key."""
    listed = [line.split()[0] for line in run("plugins").stdout.splitlines() if "/" in line.split(" ")[0]]
    return {key: sorted(p for p in listed if p.startswith(group + "/")) for key, group in INTERFACES.items()}


def config(chosen, extra, parameters):
    lines = ["odograph: 1", "walker: {height: 1.70 m}", "coupling: {type: paper" + extra + "}"]
    for kind in KINDS:
        if kind not in chosen:
            continue
        first, more = ("  - ", "    ") if kind == "absolute_fixers" else ("  ", "  ")
        lines.append(f"{kind}:\n{first}plugin: {chosen[kind]}")
        if chosen[kind] in parameters:
            lines.append(f"{more}parameters: {parameters[chosen[kind]]}")
    return "\n".join(lines) + "\n"


def played(name, recording, text):
    """Status, everything said, the track's error as a part of its length, and the track of a run."""
    folder = work / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pipeline.yaml").write_text(text, encoding="utf-8")
    done = run("run", "-c", folder / "pipeline.yaml", "-i", recording, "-o", folder, "--assets", work)
    summary = folder / "summary.json"
    said = done.stdout + done.stderr
    if done.returncode in (0, 1) and summary.exists():
        notices = json.loads(summary.read_text(encoding="utf-8"))["notices"]
        said += "".join(f"\n{key} {notice['text']}" for key, notice in notices.items())
    track = folder / "trajectory.tum"
    evaluated = run("eval", "--ref", recording, "--est", track, "--align", "yaw", "--json")
    off = float("inf")
    if evaluated.returncode == 0:
        found = json.loads(evaluated.stdout)
        off = found["ape_m"]["rmse"] / found["path_m"]
    return done.returncode, said, off, track.read_text(encoding="utf-8") if done.returncode in (0, 1) and track.exists() else ""


def judge(plugin, result, without):
    status, said, off, track = result
    if status not in (0, 1):
        return ("refused", "") if plugin in said else ("silent", f"status {status}, without the plugin's name: {said[-300:]}")
    if plugin in said:
        return "explained", ""
    if "came to nothing" in said:
        return "explained", "it came to nothing"
    if track == without[3]:
        return "silent", f"the track is that without it, status {status}"
    if off < WRONG:
        return "right", f"{100 * off:.1f} % of the path"
    times = re.search(r"tracking ([0-9.]+) s, degraded ([0-9.]+) s", said)
    if times and float(times[1]) < float(times[2]):
        return "explained", "degraded most of the time"
    return "silent", f"off by {100 * off:.0f} % of the path"


def main():
    made = plugins()
    if min(len(each) for each in made.values()) < 2:
        sys.exit(f"too few plugins: {made}")
    work.mkdir(parents=True, exist_ok=True)
    walk, drive = work / "walk.odo", work / "drive.odo"
    scenarios = project / "samples/scenarios"
    for command in (["sim", scenarios / "street_short.yaml", "--first", "14", "-o", walk],
                    ["sim", scenarios / "drive_short.yaml", "--first", "40", "-o", drive, "--city", work / "city.json"]):
        if run(*command).returncode:
            sys.exit(f"{command}: {run(*command).stderr}")
    bases = {"walk": (walk, {"attitude": "attitude/vqf", "step_estimator": "step/renaudin2012", "vo_frontend": "vo/five_point",
                             "scale_source": "scale/step_length", "absolute_fixers": "fix/gnss"}, "", {}),
             "drive": (drive, {"attitude": "attitude/vqf", "vo_frontend": "vo/gakne2018", "scale_source": "scale/slant_distance",
                               "absolute_fixers": "fix/skyline"}, ", fastest: 15 m/s, orientation: gyroscope}\n"
                       "navigation: {start: {position: [0 m, 0 m, -1.5 m]}", OF_DRIVE)}
    counts, silent = {}, []
    for base, (recording, chosen, extra, parameters) in bases.items():
        for kind in KINDS:
            rest = {key: value for key, value in chosen.items() if key != kind}
            companions = {"attitude": ["step_estimator"], "vo_frontend": ["scale_source"]}.get(kind, [])
            bare = {key: value for key, value in rest.items() if key not in companions}
            without = played(f"{base}/{kind}/none", recording, config(bare, extra, parameters))
            for plugin in made[kind]:
                result = played(f"{base}/{kind}/{plugin.replace('/', '_')}", recording, config({**rest, kind: plugin}, extra, parameters))
                verdict, why = judge(plugin, result, without)
                counts[verdict] = counts.get(verdict, 0) + 1
                print(f"{base:6} {kind:16} {plugin:24} {verdict} {why}", flush=True)
                if verdict == "silent":
                    silent.append(f"{base} {kind} {plugin}: {why}")
    print(f"{sum(counts.values())} combinations: " + ", ".join(f"{number} {verdict}" for verdict, number in sorted(counts.items())))
    if silent:
        sys.exit("silent:\n" + "\n".join(silent))


main()
