#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One row of the fleet's table: a config on a recording, its errors, and its provenance.

  row.py ODOGRAPH CONFIG RECORDING NAME DATA_SET

An error in config, recording or plugin (status 2 to 4) is a result and is stored in the row. Any other failure, for example a
killed process, ends with its own status, and the engine retries.
"""
import glob
import hashlib
import json
import os
import subprocess
import sys
import tempfile

program, config, recording, name, data_set = sys.argv[1:]


def sha256(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def called(*arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode not in range(5):
        sys.exit(f"{' '.join(arguments)}: status {done.returncode}\n{done.stderr}")
    return done


walk = os.path.splitext(os.path.basename(recording))[0]
row = {"config": name, "data_set": data_set, "walk": walk, "config_sha256": sha256(config), "recording_sha256": sha256(recording),
       "simulation_seed": int(walk[5:]) if walk.startswith("seed_") else None}
with tempfile.TemporaryDirectory() as work:
    folder = f"{work}/{data_set}"
    os.mkdir(folder)
    for path in glob.glob(glob.escape(recording.rsplit("_accelerometer", 1)[0]) + "*"):  # including the step counts of Oxford's walks
        os.symlink(os.path.abspath(path), f"{folder}/{os.path.basename(path)}")
    run = called("run", "-c", config, "-i", recording, "-o", f"{work}/run", "--json")
    bench = called("bench", "steps", "--data", folder, "-c", config, "--each", "--json", "--fresh", "--keep", f"{work}/keep")
if run.returncode > 1 and not run.stdout or bench.returncode > 1:
    row["failure"] = (run.stderr + bench.stderr).strip().splitlines()[-1]
else:
    summary = json.loads(run.stdout)
    figures = next(r for r in json.loads(bench.stdout) if r["recording"] == walk)
    row |= {"odograph": summary["versions"]["odograph"], "abi": summary["versions"]["abi"], "seed": summary["seed"],
            "plugins": {p["id"]: p["version"] + " " + p["sha256"] for p in summary["plugins"]},
            "tracking_s": summary["states_s"]["tracking"], "lost_s": summary["states_s"]["lost"], "status": run.returncode}
    row |= {key: figures[key] for key in ("true_m", "distance_percent", "position_m", "count_percent", "steps", "person", "place")}
print(json.dumps(row, indent=1))
