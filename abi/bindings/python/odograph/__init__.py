# SPDX-License-Identifier: Apache-2.0
"""Odograph: a metric 6-DoF pose of a hand-held phone from its camera and motion sensors.

    import odograph

    run = odograph.run("walk.yaml", "walk.odo", progress=True)
    run.poses["p_n"]                                    # N x 3, metres in North-East-Down
    odograph.plot(run)
    run.save("walk.tum")                                # for evo and others
    odograph.evaluate("walk.odo", run)["ape_m"]["rmse"] # against the recording's truth
    odograph.truth("walk.odo")["p_n"]

    with odograph.Session("walk.yaml", live=True) as session:
        session.push_imu(t_ns, gyro, accel)             # rad/s, m/s^2, every sample
        session.push_frame(t_ns, picture)               # a NumPy array, borrowed without a copy
        pose = session.pose()

Messages have the names and fields of the C headers, which state units, frames of reference and validity; constants keep
their C names. np.asarray(pose.p_n) gives an array field without a copy; texts are bytes in UTF-8, and take strings. run.reports are strings. Recordings are `*.odo`: `odograph convert` creates
them from other formats. `evaluate` and `truth` need the command line. docs/languages.md has examples.
"""
from . import abi
from .abi import *  # noqa: F401,F403  pylint: disable=wildcard-import
from ._evaluation import evaluate, truth
from ._library import OdographError, library, mode_text, reason_text, state_text, status_text, version
from ._recording import Recorder, Recording
from ._run import Run, decode, plot, run
from ._session import Session

__all__ = ["run", "Run", "plot", "decode", "evaluate", "truth", "Recording", "Recorder", "Session", "OdographError", "library", "version",
           "status_text", "state_text", "reason_text", "mode_text"]
__all__ += [name for name in vars(abi) if name.startswith(("ODO_", "odo_")) or (name[0] != "_" and isinstance(getattr(abi, name), type))]
