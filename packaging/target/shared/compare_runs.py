#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far the trajectories of two builds part on the same recordings.
   compare_runs.py ONE OTHER   two folders with a run's folder for each recording; a table in Markdown"""
import math
import os
import sys


def poses(folder):
    with open(os.path.join(folder, "trajectory.tum"), encoding="utf-8") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    return {row[0]: [float(value) for value in row[1:]] for row in rows}


def angle_deg(p, q):
    apart = min(math.dist(p[3:], q[3:]), math.dist(p[3:], [-value for value in q[3:]]))  # of quaternions: 2 sin(angle / 4)
    return math.degrees(4 * math.asin(min(1.0, apart / 2)))


def compare(name, one, other):
    common = sorted(set(one) & set(other), key=float)
    if not common:
        return f"| {name} | {len(one)} and {len(other)} poses, none at the same time | | | | |"
    path = sum(math.dist(one[a][:3], one[b][:3]) for a, b in zip(common, common[1:]))
    apart = [math.dist(one[t][:3], other[t][:3]) for t in common]
    first = next((str(i + 1) for i, t in enumerate(common) if one[t] != other[t]), "none")
    turned = max(angle_deg(one[t], other[t]) for t in common)
    missing = len(set(one) ^ set(other))
    return f"| {name} | {len(common)}{f' ({missing} in one alone)' if missing else ''} | {path:.1f} | {first} | {1000 * max(apart):.3g} | {turned:.2g} |"


print("| recording | poses | path, m | first that differs | largest difference, mm | degrees |\n|---|---|---|---|---|---|")
for recording in sorted(os.listdir(sys.argv[1])):
    if os.path.exists(os.path.join(sys.argv[2], recording, "trajectory.tum")):
        print(compare(recording, *(poses(os.path.join(top, recording)) for top in sys.argv[1:3])))
