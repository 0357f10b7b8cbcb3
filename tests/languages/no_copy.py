# SPDX-License-Identifier: Apache-2.0
"""A frame through Python is not copied: the plugin receives NumPy's own memory, the process allocates nothing of a picture's size,
and Python frees its allocations for a frame."""
import ctypes
import sys
import tracemalloc

import numpy as np
import odograph

CONFIG = "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: test/pixels}\ncoupling: {type: localizer}\n"
WIDTH, HEIGHT, WARM, FRAMES = 640, 480, 50, 1000
KEPT = 16 * FRAMES  # bytes: less than one object a frame, more than the interpreter's own lists of freed objects (80 of 56 bytes a kind)

own = ctypes.CDLL(None)
own.odo_test_seen.restype, own.odo_test_all.restype, own.odo_test_large.restype = ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint64
own.odo_test_count.argtypes = [ctypes.c_uint64]
pictures = [np.full((HEIGHT, WIDTH), 60 + i, np.uint8) for i in range(12)]
addresses = {picture.ctypes.data for picture in pictures}  # once: looked at in the loop, they would be counted
foreign = 0


def push(session, number):
    t_ns = 10**9 + number * 40_000_000
    for k in range(4):
        session.push_imu(t_ns + k * 10_000_000, (0, 0.01, 0), (0.1, 9.81, 0.4))
    session.push_frame(t_ns, pictures[number % len(pictures)])


def seen_of(number):
    return own.odo_test_seen() in addresses


with odograph.Session(CONFIG) as session:
    for number in range(WARM):
        push(session, number)
    session.flush()  # no frame in flight: its memory is still in use, not kept
    tracemalloc.start()
    own.odo_test_count(WIDTH * HEIGHT // 4)
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    for number in range(WARM, WARM + FRAMES):
        push(session, number)
        foreign += not seen_of(number)
    session.flush()
    now, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    large, frames = own.odo_test_large(), session.statistics().frames
    np.empty(WIDTH * HEIGHT, np.uint8).fill(1)  # the counter works
    counted = own.odo_test_large() - large
print(f"Python: {frames} frames of {WIDTH * HEIGHT} bytes, {FRAMES} of them counted: {foreign} at another address, {large} allocations of a picture's size, "
      f"{(now - before) / FRAMES:.1f} bytes of Python's kept a frame, {peak - before} at most at a time; {session.borrowed} still borrowed")
sys.exit(bool(frames < WARM + FRAMES - 5 or foreign or large or not counted or now - before > KEPT or peak - before > 2 * KEPT or session.borrowed))
