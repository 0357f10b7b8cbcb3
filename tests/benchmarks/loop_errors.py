#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Errors of the loops of a run (places.csv) against the true track of a simulated recording, and how long after each
dark stretch the next one comes:
    odograph convert RECORDING.odo TRUTH.tum; loop_errors.py RUN TRUTH.tum"""
import bisect
import csv
import math
import sys


def rows_of(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def rotation(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


class Truth:
    """Poses of the camera."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.poses = [[float(x) for x in line.split()] for line in file if not line.startswith("#")]
        self.times = [pose[0] for pose in self.poses]

    def at(self, t_s):
        i = min(max(bisect.bisect(self.times, t_s), 1), len(self.poses) - 1)
        a, b = self.poses[i - 1], self.poses[i]
        part = (t_s - a[0]) / (b[0] - a[0])
        sign = 1 if sum(x * y for x, y in zip(a[4:8], b[4:8])) > 0 else -1
        q = [x * (1 - part) + sign * y * part for x, y in zip(a[4:8], b[4:8])]
        size = math.sqrt(sum(x * x for x in q))
        return [x * (1 - part) + y * part for x, y in zip(a[1:4], b[1:4])], rotation([x / size for x in q])

    def relative(self, from_s, t_s):
        """Position at t in the camera at the other time."""
        p1, _ = self.at(t_s)
        p0, R = self.at(from_s)
        d = [x - y for x, y in zip(p1, p0)]
        return [sum(R[k][i] * d[k] for k in range(3)) for i in range(3)]


def quantile(values, part):
    return sorted(values)[min(int(len(values) * part), len(values) - 1)] if values else float("nan")


def main(run, truth):
    truth = Truth(truth)
    loops = []
    for row in rows_of(run + "/places.csv"):
        if row["from"] != "key_frame":
            continue
        t_s, from_s = 1e-9 * int(row["t_ns"]), 1e-9 * int(row["key_frame_ns"])
        seen = [float(row["x_m"]), -float(row["y_m"]), -float(row["z_m"])]  # the body's y and z are the camera's, reversed
        loops.append((t_s, math.dist(seen, truth.relative(from_s, t_s)), float(row["sigma_m"]), row["used"] == "1"))
    errors = [loop[1] for loop in loops]
    print(f"{len(loops)} loops, {sum(loop[3] for loop in loops)} used; error {quantile(errors, 0.5):.3f} m in the median, "
          f"{quantile(errors, 0.95):.3f} at 95 %, {max(errors, default=0):.3f} at most; "
          f"{sum(error > 3 * math.sqrt(3) * sigma for _, error, sigma, _ in loops)} beyond three sigmas")
    dark = None
    states = [(1e-9 * int(row["t_ns"]), row["reason"]) for row in rows_of(run + "/states.csv")]
    for i, (t_s, reason) in enumerate(states):
        if reason == "too dark":
            dark = states[i + 1][0] if i + 1 < len(states) else None
        elif dark and reason != "initialising":
            after = [loop for loop in loops if loop[0] > dark]
            if after:
                print(f"light at {dark - truth.times[0]:.1f} s, next loop {after[0][0] - dark:.1f} s later, error "
                      f"{after[0][1]:.3f} m")
            dark = None


if __name__ == "__main__":
    main(*sys.argv[1:3])
