#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lengths between tile joints on the floor of `phone_house`, by hit tests, and the floor's height below the phone:

    ODOGRAPH_LIBRARY=build/lib/libodograph.so PYTHONPATH=build/bindings/python \\
        tests/benchmarks/floor_lengths.py [CONFIG] [RECORDING]

RECORDING is what `odograph convert` makes of it.

The joints were marked by hand to two pixels. Tiles of one room are of one size, which nobody measured: only the spread of the lengths means
something."""
import sys

import numpy as np
import odograph
from odograph import abi

CONFIG = sys.argv[1] if len(sys.argv) > 1 else "samples/configs/walk.yaml"
RECORDING = sys.argv[2] if len(sys.argv) > 2 else "phone_house.odo"

# Frame, and pixels on joints in the upright picture, column and row: the third's distance from the line through the first two, a joint
# parallel to its own. The recorded picture lies on its side: its column is the row, its row counts from the right.
TURNED_ROWS = 479
SIDES = [
    ("short", 305, (352.6, 464.4), (428.5, 636.8), (470.0, 441.3)),
    ("short", 1430, (10.3, 455.2), (349.6, 475.9), (81.3, 365.9)),
    ("short", 1430, (10.3, 455.2), (349.6, 475.9), (339.9, 376.6)),
    ("long", 1380, (373.9, 546.9), (387.4, 518.0), (87.1, 400.5)),
    ("long", 1430, (339.9, 376.6), (349.6, 475.9), (10.3, 455.2)),
    ("long", 1430, (339.9, 376.6), (349.6, 475.9), (81.3, 365.9)),
]
LATER = 10  # frames after which the pose of a frame is certainly there


def hit(session, t_ns, pixel):
    hits = session.hit_test(abi.ODO_RAY_PIXEL, t_ns=t_ns, pixel=(pixel[1], TURNED_ROWS - pixel[0]),
                            wanted=abi.ODO_HIT_SURFACE | abi.ODO_HIT_FLOOR)
    return next((h for h in hits if h.surface), None)


def measure(session, number, t_ns):
    for side, frame, *pixels in SIDES:
        if frame != number:
            continue
        hits = [hit(session, t_ns, pixel) for pixel in pixels]
        if not all(hits):
            print(f"frame {number}: {side}: no surface")
            continue
        a, b, c = (np.array(h.p_n) for h in hits)
        length = np.linalg.norm(np.cross(b - a, c - a)) / np.linalg.norm(b - a)
        below = a[2] - session.pose(t_ns, of=abi.ODO_OF_CAMERA).p_n[2]
        print(f"frame {number}: {side} side {length:.3f} m, floor {below:.2f} m below, scale to {100 * hits[0].scale_sigma:.1f} %")


def main():
    times = []
    with odograph.Session(CONFIG) as session:
        for message in odograph.Recording(RECORDING):
            if not isinstance(message, abi.Frame):
                session.push(message)
                continue
            session.push_frame(message.t_ns, odograph.decode(message.picture), like=message)
            times.append(message.t_ns)
            if len(times) > LATER:
                measure(session, len(times) - 1 - LATER, times[-1 - LATER])


main()
