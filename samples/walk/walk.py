# SPDX-License-Identifier: Apache-2.0
"""A recording read, and a walk tracked live, in Python.

    python3 walk.py CONFIG.yaml RECORDING.odo
"""
import math
import sys

import numpy as np
import odograph
from odograph import Frame, Points, Pose, Step

CONFIG = """\
odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
"""


def show(event):
    if isinstance(event, Points):  # landmarks, the most certain first
        print("points", len(event.points), "first", event.points[0].id, event.points[0].p_c[2])
    if not isinstance(event, Pose):
        return
    x, y, z = event.p_n
    qw, qx, qy, qz = event.q_n
    print("pose", event.t_ns, x, y, z, qx, qy, qz, qw)


def place(session):
    """Puts an anchor on what lies ahead, 45 degrees down: usually the floor."""
    for hit in session.hit_test(odograph.ODO_RAY_VIEW, direction=(0, 1, 1), most=1):
        anchor = session.create_anchor(odograph.ODO_ANCHOR_HIT, "on the floor", t_ns=hit.t_ns, q=hit.q_n, p=hit.p_n, surface=hit.surface, sigma_m=hit.sigma_m)
        print("hit", hit.what, hit.surface, hit.distance_m, "anchor", anchor)


def replay(config, recording):
    with odograph.Session(config, on_event=show, events=[Pose, Points]) as session:
        for message in odograph.Recording(recording):
            if isinstance(message, Frame):
                session.push_frame(message.t_ns, odograph.decode(message.picture), like=message)
            elif not 0x1000 <= message.TYPE < 0x2000:  # recorded events are not input
                session.push(message)
        session.flush()
        place(session)


def live():
    steps = []
    pictures = [np.full((48, 64), 90, np.uint8) for _ in range(4)]  # as from a camera
    with odograph.Session(CONFIG, live=True, on_event=steps.append, events=[Step]) as session:
        for i in range(1000):
            t, t_ns = i * 0.01, 1_000_000_000 + i * 10_000_000
            session.push_imu(t_ns, (0, 0.01, 0), (0.1, 9.81 + 2.2 * math.sin(12 * t), 0.4))
            if i % 10 == 0:
                session.push_frame(t_ns, pictures[i // 10 % 4])  # borrowed, not copied
                session.flush()  # needed only because the simulated time does not wait
        pose = session.pose()
        label = session.create_anchor(odograph.ODO_ANCHOR_VIEW, "a label", p=(0, 0, -3))
        north, east, down = session.anchor(label).p_n
        print("live", len(steps), "steps", *pose.p_n, f"label {north:.2f} {east:.2f} {down:.2f} borrowed", session.borrowed)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    replay(sys.argv[1], sys.argv[2])
    live()
