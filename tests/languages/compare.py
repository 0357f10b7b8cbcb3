# SPDX-License-Identifier: Apache-2.0
"""compare.py LANGUAGE REFERENCE OUTPUT LIVE: the poses of samples/walk in a language equal the command line's, to the last bit, and its
live result equals that of the other languages (LIVE, written by the first of them)."""
import os
import re
import sys

language, reference, output, live = sys.argv[1:]


def poses(path):
    with open(path, encoding="utf-8") as file:
        return [tuple(map(float, line.split()[1:])) for line in file if line.startswith("pose ")]


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
tracked = last(output)
if tracked != last(live) or tracked[:1] != ["live"] or not tracked[1] >= 15 or tracked[-1] != 0:
    sys.exit(f"{language}: {tracked}; expected {last(live)}, at least 15 steps, and nothing still borrowed")
print(f"{language}: {len(found)} poses of the recording, equal to the last bit; live {tracked[1]:.0f} steps, as the others")
