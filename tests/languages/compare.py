# SPDX-License-Identifier: Apache-2.0
"""compare.py LANGUAGE REFERENCE OUTPUT LIVE: the poses of samples/walk in a language equal the command line's, to the last bit, and its
landmarks, hit test and live result equal those of the other languages (LIVE, written by the first of them)."""
import os
import re
import sys

language, reference, output, live = sys.argv[1:]


def poses(path):
    with open(path, encoding="utf-8") as file:
        return [tuple(map(float, line.split()[1:])) for line in file if line.startswith("pose ")]


def words(path, first):
    with open(path, encoding="utf-8") as file:
        return [line.split() for line in file if line.startswith(first + " ")]


def last(path):
    """Parsed numbers, since languages write them differently."""
    with open(path, encoding="utf-8") as file:
        return [float(word) if re.match(r"-?\d", word) else word for word in file.read().splitlines()[-1].split()]


expected, found = poses(reference), poses(output)
if len(expected) < 100 or expected != found:
    where = next((i for i, (a, b) in enumerate(zip(expected, found)) if a != b), min(len(expected), len(found)))
    sys.exit(f"{language}: {len(found)} poses of {len(expected)}; the first that differs is {where}: {found[where:where + 1]}, expected {expected[where:where + 1]}")
if not os.path.exists(live):
    os.symlink(output, live)
landmarks = [[float(x) for x in (each[1], each[3], each[4])] for each in words(output, "points")]
if len(landmarks) < 50 or landmarks != [[float(x) for x in (each[1], each[3], each[4])] for each in words(live, "points")]:
    sys.exit(f"{language}: {len(landmarks)} lines of landmarks; expected 50 or more, the same as in the other languages")
hits = [[float(x) for x in (*each[1:4], each[5])] for each in words(output, "hit")]
if len(hits) != 1 or hits != [[float(x) for x in (*each[1:4], each[5])] for each in words(live, "hit")] or not hits[0][1] > 0:
    sys.exit(f"{language}: hits {hits}; expected one of a surface, the same as in the other languages")
tracked = last(output)
if tracked != last(live) or tracked[:1] != ["live"] or not tracked[1] >= 15 or tracked[-1] != 0:
    sys.exit(f"{language}: {tracked}; expected {last(live)}, at least 15 steps, and nothing still borrowed")
print(f"{language}: {len(found)} poses of the recording, equal to the last bit; live {tracked[1]:.0f} steps, as the others")
