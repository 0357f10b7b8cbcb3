# SPDX-License-Identifier: Apache-2.0
"""Runs a whole recording through a pipeline and gives access to the resulting events."""
import re
from typing import Any, Callable, Iterable

import numpy as np

from . import abi
from ._outcome import Input, why_nothing
from ._recording import Recording
from ._session import Path, Session

Array = Any  # of NumPy, whose types do not describe structured arrays


def decode(picture: bytes) -> Array:
    """Decodes a picture: PGM without a copy, other formats with OpenCV or Pillow, whichever is installed."""
    head = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", picture)
    if head:
        width, height = int(head[1]), int(head[2])
        return np.frombuffer(picture, np.uint8, width * height, head.end()).reshape(height, width)
    try:
        import cv2  # pylint: disable=import-outside-toplevel
        image = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION)
        return image if image.ndim == 2 else np.ascontiguousarray(image[:, :, ::-1])
    except ImportError:
        pass
    try:
        import io  # pylint: disable=import-outside-toplevel
        from PIL import Image  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise ImportError("pictures are decoded by OpenCV (cv2) or Pillow; neither is installed") from error
    image = Image.open(io.BytesIO(picture))
    return np.asarray(image if image.mode in ("L", "RGB", "RGBA") else image.convert("RGB"))


def _row_type(kind: type[abi.Message]) -> np.dtype[Any]:
    """NumPy type of a message, with C strings as bytes fields instead of arrays of single bytes."""
    plain = np.dtype(kind)
    fields = [(name, *plain.fields[name][:2]) for name in plain.names] if plain.names and plain.fields else []
    formats = [f"S{f.shape[0]}" if f.base == np.dtype("S1") and f.shape else f for _, f, _ in fields]
    return np.dtype({"names": [n for n, _, _ in fields], "formats": formats, "offsets": [o for _, _, o in fields], "itemsize": plain.itemsize})


class Run:
    """The events of a run: structured arrays, one row per event, with the fields of the C struct.

    run.poses: p_n (N x 3, metres, North-East-Down), q_n (N x 4: w, x, y, z, rotates vectors from camera or body to n), covariance, state, and
    header: t_ns and flags. Only rows with flags & ODO_POSE_METRIC are in metres.

    run.nothing: why it came to nothing although the input moves, with the likeliest reason; "" if it came to something. Also a report.
    """

    def __init__(self, events: dict[type[abi.Message], bytearray], statistics: abi.Statistics) -> None:
        self._events, self.statistics, self.nothing = events, statistics, ""

    def of(self, kind: type[abi.Message]) -> Array:
        """All events of a type: run.of(odograph.Step)["length_m"]."""
        return np.frombuffer(self._events.get(kind, bytearray()), _row_type(kind))

    @property
    def poses(self) -> Array:
        return self.of(abi.Pose)

    def save(self, path: Path) -> None:
        """Writes the poses as published, from the first in metres on (all if none is), as TUM: t x y z qx qy qz qw. The same file as trajectory.tum
        of `odograph run`, except that it is not moved to a recording's first waypoint."""
        poses = self.poses
        waiting = np.isin(poses["reason"], (abi.ODO_REASON_INITIALISING, abi.ODO_REASON_NO_SCALE)) | (poses["header"]["flags"] & abi.ODO_POSE_METRIC == 0)
        rows: dict[int, str] = {}  # by time: a fix may correct the newest pose
        for pose in poses[0 if waiting.all() else int(np.argmin(waiting)):]:
            t_ns = int(pose["header"]["t_ns"])
            w, *xyz = pose["q_n"]
            rows[t_ns] = " ".join(f"{value:.12g}" for value in (*pose["p_n"], *xyz, w))
        with open(path, "w", encoding="utf-8") as file:
            for t_ns, row in rows.items():
                file.write(f"{'-' if t_ns < 0 else ''}{abs(t_ns) // 10**9}.{abs(t_ns) % 10**9:09d} {row}\n")

    @property
    def steps(self) -> Array:
        return self.of(abi.Step)

    @property
    def reports(self) -> list[str]:
        """Warnings and errors of the library and its plugins."""
        reports = [f"{row['plugin'].decode()}: {row['text'].decode()}" for row in self.of(abi.Report)]
        return reports + ([f"the run came to nothing: {self.nothing}"] if self.nothing else [])


def run(config: Path, recording: "Path | Recording", *, decode: Callable[[bytes], Array] = decode,  # pylint: disable=redefined-outer-name
        progress: bool = False, on_event: Callable[[Any], None] | None = None, **options: Any) -> Run:
    """Replays a recording like `odograph run`. `progress`: show a bar (tqdm). `options`: as for Session."""
    events: dict[type[abi.Message], bytearray] = {}

    def take(event: Any) -> None:
        events.setdefault(type(event), bytearray()).extend(bytes(event))
        if on_event:
            on_event(event)

    given = Input()
    messages: Iterable[Any] = recording if isinstance(recording, Recording) else Recording(recording)
    if progress:
        from tqdm.auto import tqdm  # pylint: disable=import-outside-toplevel
        messages = tqdm(messages, unit=" messages")
    with Session(config, on_event=take, **options) as session:
        for message in messages:
            given.see(message)
            if isinstance(message, abi.Frame):
                if message.picture:
                    session.push_frame(message.t_ns, decode(message.picture), like=message)
            elif not 0x1000 <= message.TYPE < 0x2000:  # skip events that the app recorded
                session.push(message)
        session.flush()
        result = Run(events, session.statistics())
    result.nothing = why_nothing(config, given, result)
    return result


def plot(result: Run, axes: Any = None) -> Any:
    """Plots the path from above, with steps. Returns the matplotlib axes."""
    if axes is None:
        import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel
        axes = plt.subplots()[1]
    poses = result.poses
    known = (poses["header"]["flags"] & abi.ODO_POSE_METRIC) != 0
    north, east = poses["p_n"][known, 0], poses["p_n"][known, 1]
    axes.plot(east, north)
    axes.set_aspect("equal", "datalim")
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.set_title(f"{result.statistics.distance_m:.1f} m, {result.statistics.steps} steps")
    return axes
