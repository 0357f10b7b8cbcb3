#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""config_table.py ROOT [--write]: the table of samples/configs/README.md, from the configs. Fails if it differs; --write replaces it."""
import glob
import os
import re
import sys

ROOT, WRITE = sys.argv[1], "--write" in sys.argv[2:]
PAGE = os.path.join(ROOT, "samples/configs/README.md")
BEGIN, END = "<!-- config_table.py: begin -->\n", "<!-- config_table.py: end -->\n"
KINDS = ("attitude", "step", "vo", "scale", "fix", "surface")
SENSORS = {"fix/gnss": "GNSS", "fix/barometer": "barometer", "fix/skyline": "city model", "fix/known_object": "objects' file", "fix/waypoint": "waypoints", "fix/terrain": "terrain model",
           "attitude/magyq": "magnetometer"}


def row(path):
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"(^|\s)#.*", "", file.read())
    ids = re.findall(r"plugin:\s*([a-z]+/\w+)", text)
    of = {kind: [name for name in ids if name.startswith(kind + "/")] for kind in KINDS}
    inertial = of["attitude"] or of["step"] or ("vo/odograph" in ids)
    used = (["camera"] if of["vo"] else []) + (["IMU"] if inertial else []) + [SENSORS[name] for name in ids if name in SENSORS]
    if re.search(r"magnetometer:\s*true", text):
        used.append("magnetometer")
    coupling = re.search(r"type:\s*(paper|localizer)", text)
    cells = [f"[{os.path.basename(path)}]({os.path.basename(path)})", ", ".join(used), *(", ".join(f"`{name}`" for name in of[kind]) for kind in KINDS),
             coupling[1] if coupling else "paper"]
    return "| " + " | ".join(cells) + " |\n"


TABLE = ("| config | uses | attitude | steps | front-end | scale | fixes | surfaces | coupling |\n|---|---|---|---|---|---|---|---|---|\n" +
         "".join(map(row, sorted(glob.glob(os.path.join(ROOT, "samples/configs/*.yaml"))))))
with open(PAGE, encoding="utf-8") as page:
    before, rest = page.read().split(BEGIN)
after = rest.split(END)[1]
if WRITE:
    with open(PAGE, "w", encoding="utf-8") as page:
        page.write(before + BEGIN + TABLE + END + after)
elif rest.split(END)[0] != TABLE:
    sys.exit(f"{PAGE}: the table differs from the configs; `python3 tests/house/config_table.py . --write` writes it")
