# SPDX-License-Identifier: Apache-2.0
"""The truth of a recording and the errors of a track, by the command line `odograph`, which knows every format of both."""
import json
import os
import shutil
import subprocess
import tempfile
from decimal import Decimal
from typing import Any

import numpy as np

from . import abi
from ._library import OdographError
from ._recording import Recording
from ._run import Array, Run
from ._session import Path


def _command(*arguments: str) -> str:
    program = shutil.which("odograph")
    if not program:
        raise OdographError(abi.ODO_E_NOT_FOUND, "the command line `odograph` (package odograph) is not on PATH; it reads truths and evaluates")
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode and not done.stdout:
        raise OdographError(abi.ODO_E_DATA, done.stderr.strip())
    return done.stdout


def _path(source: "Path | Recording") -> str:
    return source.path if isinstance(source, Recording) else os.fspath(source)


def truth(recording: "Path | Recording") -> Array:
    """The true poses of a recording, a structured array with t_ns, p_n (N x 3, m) and q_n (N x 4: w, x, y, z): of the camera, or of the body if
    there is no camera. `recording` may be any that the command line reads."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "truth.tum")
        _command("convert", _path(recording), file)
        with open(file, encoding="utf-8") as text:
            rows = [line.split() for line in text if line.strip() and not line.startswith("#")]
    poses = np.zeros(len(rows), [("t_ns", np.int64), ("p_n", np.float64, 3), ("q_n", np.float64, 4)])
    poses["t_ns"] = [int(Decimal(row[0]).scaleb(9)) for row in rows]
    poses["p_n"] = [row[1:4] for row in rows]
    poses["q_n"] = [row[7:8] + row[4:7] for row in rows]
    return poses


def evaluate(reference: "Path | Recording", estimate: "Run | Path", *, align: str = "yaw", **options: Any) -> dict[str, Any]:
    """The errors of a run against a truth, as `odograph eval --json` prints them: evaluate(recording, run)["ape_m"]["rmse"].

    `reference`: a recording with a truth or with waypoints, or a file of poses (TUM, KITTI, EuRoC). `estimate`: a run, a folder of
    `odograph run`, or a file of poses. `align`: none, first, yaw (of a metric track), se3 or sim3. `options`: those of `odograph eval`:
    rpe_unit="metres".
    """
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(estimate, Run):
            track = os.path.join(folder, "run.tum")
            estimate.save(track)
        else:
            track = os.fspath(estimate)
        further = [text for name, value in options.items() for text in ("--" + name.replace("_", "-"), str(value))]
        result: dict[str, Any] = json.loads(_command("eval", "--ref", _path(reference), "--est", track, "--align", align, "--json", *further))
        return result
