# SPDX-License-Identifier: Apache-2.0
"""Whether a run came to something, by the rules of `odograph run`."""
import math
import os
import re
from typing import Any

import numpy as np

from . import abi
from ._library import reason_text
from ._session import Path

WINDOW = 100  # samples of an accelerometer: one or two seconds
WALKING_SHARE = 0.07  # of the mean norm, its rms scatter in a window: 0.7 m/s^2, a slow walk in the hand
WALKING_WINDOWS = 4
GNSS_RAD = 20 / 6.4e6  # 20 m on the Earth, twice a phone's error
MOVED_M = 0.1  # less is jitter
MOTIONS = 20  # of a front-end up to scale, with a displacement


class Input:
    """What a recording holds, by its messages."""

    def __init__(self) -> None:
        self.types: set[int] = set()
        self._norms: list[float] = []
        self._windows = 0
        self._places: list[tuple[float, float]] = []

    def see(self, message: Any) -> None:
        self.types.add(message.TYPE)
        if isinstance(message, abi.Imu) and message.flags & abi.ODO_IMU_ACCEL:
            self._norms.append(math.hypot(*message.accel_b))
            if len(self._norms) == WINDOW:
                self._windows += float(np.std(self._norms)) > WALKING_SHARE * float(np.mean(self._norms))
                self._norms.clear()
        elif isinstance(message, abi.Gnss) and message.flags & abi.ODO_GNSS_POSITION:
            self._places.append((message.latitude_rad, message.longitude_rad * math.cos(message.latitude_rad)))

    @property
    def moves(self) -> bool:
        travels = bool(self._places) and float(np.ptp(self._places, axis=0).max()) > GNSS_RAD
        return self._windows >= WALKING_WINDOWS or travels


def _keys(config: Path) -> set[str]:
    """The top-level keys of a pipeline config in block style, and 'localizer' for that coupling."""
    text = os.fspath(config)
    if not (isinstance(config, str) and ("\n" in config or ": " in config)):
        with open(text, encoding="utf-8") as file:
            text = file.read()
    text = re.sub(r"#.*", "", text)
    return set(re.findall(r"^(\w+)\s*:", text, re.MULTILINE)) | ({"localizer"} if re.search(r"type\s*:\s*localizer\b", text) else set())


def why_nothing(config: Path, given: Input, result: Any) -> str:
    """Why a run over input with motion came to nothing, with the likeliest reason; "" if it came to something."""
    keys, poses = _keys(config), result.poses

    def likeliest() -> str:
        for report in result.of(abi.Report):
            if report["plugin"] == b"host" and report["severity"] >= abi.ODO_SEVERITY_WARNING:
                return str(report["text"].decode())
        if not keys & {"vo_frontend", "step_estimator"}:
            return "the config has neither a step_estimator nor a vo_frontend"
        if "step_estimator" not in keys and abi.ODO_TYPE_FRAME not in given.types:
            return "the config has a vo_frontend, and the recording no frames"
        states = result.of(abi.State)
        return (reason_text(int(states["reason"][-1])) if len(states) else "") or "nothing gave a displacement"

    def because(what: str) -> str:
        return f"{what}: {likeliest()}"

    if len(poses) == 0:
        return because("no pose was published")
    if "vo_frontend" in keys and abi.ODO_TYPE_FRAME in given.types and result.statistics.frames == 0:
        return because("all frames were dropped")
    inertial = abi.ODO_TYPE_IMU in given.types
    seen = result.of(abi.VoMotion)
    up_to_scale = seen["header"]["flags"] & (abi.ODO_VO_TRANSLATION | abi.ODO_VO_METRIC) == abi.ODO_VO_TRANSLATION
    moves = given.moves or int((up_to_scale & (seen["state"] == abi.ODO_TRACKING)).sum()) >= MOTIONS
    if inertial and not moves:
        return ""
    if float(np.linalg.norm(poses["p_n"] - poses["p_n"][0], axis=1).max()) < MOVED_M:
        return because("the input moves, and no pose does" if moves else "no pose moves")
    waiting = np.isin(poses["reason"], (abi.ODO_REASON_INITIALISING, abi.ODO_REASON_NO_SCALE)) | (poses["header"]["flags"] & abi.ODO_POSE_METRIC == 0)
    metric = "scale_source" in keys or (inertial and {"step_estimator", "localizer"} <= keys) or ("absolute_fixers" in keys and abi.ODO_TYPE_GNSS in given.types)
    return because("the poses never had a scale in metres") if metric and waiting.all() else ""
