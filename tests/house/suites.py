#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""ctest runs every suite of the test programs; one without its real recordings is shown as skipped, and fails if they are
required."""
import json
import os
import re
import subprocess
import sys
import tempfile

CTEST, BUILD = sys.argv[1:]
wrong = []


def output(*command, **environment):
    return subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **environment})


def properties(test):
    return {p["name"]: p["value"] for p in test.get("properties", [])}


tests = json.loads(output(CTEST, "--test-dir", BUILD, "--show-only=json-v1").stdout)["tests"]
suites, data = {}, set()
for test in tests:
    if "data" in properties(test).get("LABELS", []):
        data.add(test["name"])
    chosen = [a.removeprefix("--test-suite=") for a in test.get("command", []) if a.startswith("--test-suite=")]
    if chosen:
        suites.setdefault(test["command"][0], set()).update(chosen)
        if properties(test).get("SKIP_RETURN_CODE") != 77:
            wrong.append(f"{test['name']}: a skip would be shown as passed")

for program, registered in suites.items():
    if not os.path.exists(program):  # only a part was built
        continue
    listed = output(program, "--list-test-suites", "--no-intro", "--no-colors").stdout.splitlines()
    there = {line for line in listed if line and not line.startswith(("[doctest]", "="))}
    for name in sorted(there ^ registered):
        wrong.append(f"{os.path.basename(program)}: {name} is {'not run by ctest' if name in there else 'no suite of it'}")


def results(folder, required):
    """ctest's result for each entry that needs data."""
    said = output(CTEST, "--test-dir", BUILD, "-L", "^data$", ODOGRAPH_DATA=folder, ODOGRAPH_REQUIRE_DATA=required).stdout
    return dict(re.findall(r"Test +#\d+: (\S+) [.]*[* ]*(Passed|Skipped|Failed|Not Run)", said))


with tempfile.TemporaryDirectory() as empty:
    for folder, required, expected in [(empty + "/nowhere", "OFF", "Skipped"), (empty, "ON", "Failed")]:
        shown = results(folder, required)
        for name in sorted(data):
            if shown.get(name) not in (expected, "Not Run"):
                wrong.append(f"{name}: {shown.get(name)} without its data and with ODOGRAPH_REQUIRE_DATA={required}, not {expected}")
if not data:
    wrong.append("no entry has the label 'data'")
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
