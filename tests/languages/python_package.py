# SPDX-License-Identifier: Apache-2.0
"""python_package.py CONFIG RECORDING FOLDER MAP: further features of the package: error texts, arrays without copies, recordings written and read."""
import ctypes
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import odograph
from odograph import Imu, Pose, Recorder, Recording, Session

config, path, folder, place = sys.argv[1:]


def refused(call, *words):
    try:
        call()
    except Exception as error:  # pylint: disable=broad-except
        assert all(word in str(error) for word in words), f"'{error}' lacks one of {words}"
        return error
    raise AssertionError(f"was taken; expected an error with {words}")


# Errors name the cause.
error = refused(lambda: Session("odograph: 1\nattitude: {plugin: attitude/vqf, gain: 3}\n"), ":2:", "gain")
refused(lambda: Session("{odograph: 1, attitude: {plugin: attitude/vqf, gain: 3}}"), ":1:", "gain")
refused(lambda: Session(pathlib.Path("no: text")), "no: text", "cannot be opened")
assert isinstance(error, odograph.OdographError) and error.status == odograph.ODO_E_CONFIG
refused(lambda: Recording(config), "walk.yaml")
refused(lambda: Imu(gyro=(0, 0, 0)), "gyro", "gyro_b")
with Session(config) as session:
    refused(lambda: session.push_frame(0, np.zeros((4, 4))), "float64", "uint8")
    assert session.pose() is None
refused(session.flush, "closed")

# A map of an earlier session is saved as it was.
with Session("odograph: 1\nattitude: {plugin: attitude/vqf}\nabsolute_fixers: {plugin: fix/map}\n") as session:
    assert session.save_map() == b""
    refused(lambda: session.load_map(b"no map"))
    session.load_map(pathlib.Path(place).read_bytes())
    assert session.save_map() == pathlib.Path(place).read_bytes()

# What on_event raises comes out of push once, and events go on; it cannot close the session.
for live in (False, True):
    seen = []

    def on_event(event):
        seen.append(event)
        if len(seen) == 20:
            raise KeyboardInterrupt("once")
        if len(seen) == 200:
            session.close()

    raised = []
    with Session("odograph: 1\nattitude: {plugin: attitude/vqf}\n", live=live, on_event=on_event) as session:
        for i in range(400):
            try:
                session.push_imu(1_000_000_000 + i * 5_000_000, (0.1, 0, 0.02), (0.1, 0.2, 9.8))
                if live and i % 50 == 49:
                    session.flush()
            except BaseException as error:  # pylint: disable=broad-except
                raised.append(str(error))
        session.flush()
    assert len(raised) == 2 and raised[0] == "once" and "on_event" in raised[1], (live, raised)
    assert len(seen) > 300, (live, len(seen))

# Texts of events are bytes, not arrays of single ones; they take strings too.
report = odograph.Report()
report.plugin, report.text = "acme/vo", b"out of light"
assert report.plugin == b"acme/vo"
reported = odograph.Run({odograph.Report: bytearray(bytes(report))}, odograph.Statistics())
assert reported.reports == ["acme/vo: out of light"], reported.reports
assert {"run", "Session", "Recording", "Pose", "ODO_POSE_METRIC"} <= set(odograph.__all__)
assert all(hasattr(odograph, name) for name in odograph.__all__)  # of "from odograph import *"

# A callback's exception is raised by push.
def fail(_):
    raise KeyError("mine")


with Session("odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\ncoupling: {type: localizer}\n", on_event=fail) as session:
    refused(lambda: [session.push_imu(10**7 * i, (0, 0, 0), (0, 0, 9.81)) for i in range(200)], "mine")

# Arrays share the struct's memory.
pose = Pose(t_ns=5, p_n=(1, 2, 3))
view = np.asarray(pose.p_n)
view[1] = 7
assert list(pose.p_n) == [1, 7, 3] and view.ctypes.data == ctypes.addressof(pose) + Pose.p_n.offset and pose.t_ns == 5

# A run that comes to nothing states why, one of steps does not.
still = odograph.run("odograph: 1\n", path)
assert "no pose was published: the config has neither a step_estimator nor a vo_frontend" in still.nothing, still.nothing
assert still.reports[-1] == f"the run came to nothing: {still.nothing}"
assert not odograph.run("odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n", path).nothing

# A recording has a length, can be read twice, and is read as written.
recording = Recording(path)
first = list(recording)
assert len(recording) == len(first) > 500 and recording.loss == ""
frames = [message for message in recording if message.picture]
pixels = odograph.decode(frames[0].picture)
assert pixels.ndim == 2 and pixels.base is not None and pixels.shape == (frames[0].height, frames[0].width) or frames[0].width == 0
copy = os.path.join(folder, "copy.odo")
with Recorder(copy) as recorder:
    for message in first:
        recorder.write(message, message.picture)
assert [bytes(a) for a in Recording(copy)] == [bytes(a) for a in first]

# A run's arrays, and its plot.
run = odograph.run(config, copy)
assert run.poses["p_n"].shape == (len(run.poses), 3) and run.statistics.frames == len(frames) and len(run.steps) == run.statistics.steps

# Its track and its errors are the command line's.
track = os.path.join(folder, "python.tum")
run.save(track)
with open(track, encoding="utf-8") as ours, open(os.path.join(folder, "run", "trajectory.tum"), encoding="utf-8") as theirs:
    assert ours.read() == theirs.read()
truth = odograph.truth(recording)
assert len(truth) > 50 and np.allclose(np.linalg.norm(truth["q_n"], axis=1), 1) and (np.diff(truth["t_ns"]) > 0).all()
errors = odograph.evaluate(recording, run, align="se3", rpe_unit="metres")
by_hand = subprocess.run(["odograph", "eval", "--ref", path, "--est", os.path.join(folder, "run"), "--align", "se3", "--rpe-unit", "metres", "--json"],
                         capture_output=True, check=True).stdout
assert errors == json.loads(by_hand) and 0 < errors["ape_m"]["rmse"] < 1, errors["ape_m"]
refused(lambda: odograph.evaluate("missing.odo", run), "missing.odo")
refused(lambda: odograph.evaluate(recording, run, align="upwards"), "upwards", "sim3")


class Axes:
    def __getattr__(self, name):
        return lambda *values, **_: drawn.append((name, values))


drawn = []
odograph.plot(run, Axes())
assert drawn[0][0] == "plot" and len(drawn[0][1][0]) > 50
