# SPDX-License-Identifier: Apache-2.0
"""A session: one pipeline, from samples to poses."""
import ctypes as c
import itertools
import os
import threading
from types import TracebackType
from typing import Any, Callable, Iterable, Sequence, Union

import numpy as np

from . import abi
from ._library import OdographError, check, copied, library, set_elements, sized, string

_RETAIN, _RELEASE = c.CFUNCTYPE(c.c_int32, c.c_void_p), c.CFUNCTYPE(None, c.c_void_p)
_FORMATS = {1: abi.ODO_FORMAT_GREY8, 3: abi.ODO_FORMAT_RGB8, 4: abi.ODO_FORMAT_RGBA8}
Path = Union[str, "os.PathLike[str]"]


class _Borrowed:
    """Borrowed pictures by number: the array and its reference count. Called on any thread."""

    def __init__(self) -> None:
        self.pictures: dict[int, list[Any]] = {}
        self.numbers = itertools.count(1)
        self.lock = threading.Lock()
        self.retain, self.release = _RETAIN(lambda owner: self.hold(owner, 1)), _RELEASE(lambda owner: self.hold(owner, -1) and None)

    def lend(self, picture: Any) -> int:
        number = next(self.numbers)
        with self.lock:
            self.pictures[number] = [picture, 1]  # the reference of the call
        return number

    def hold(self, owner: int, by: int) -> int:
        with self.lock:
            self.pictures[owner][1] += by
            if self.pictures[owner][1] == 0:
                del self.pictures[owner]
        return abi.ODO_OK


class Session:
    """A session: one pipeline. `config`: a YAML file (a pathlib.Path always is one), or its text: a string with a line break or ": ", as
    every YAML mapping has. `on_event` is called with each event of the types in `events` (default: all): within push and flush, or on the
    library's thread when `live`."""

    def __init__(self, config: Path, *, live: bool = False, on_event: Callable[[Any], None] | None = None, events: Iterable[type[abi.Message]] = (),
                 plugin_path: str = "", asset_path: str = "", seed: int = 0) -> None:
        self._odo, self._session = library(), c.POINTER(abi.odo_session)()
        self._borrowed = _Borrowed()
        self._failed: BaseException | None = None
        self._calling: int | None = None  # thread that is in on_event
        text, error, options = os.fspath(config), sized(abi.odo_error), sized(abi.odo_session_options)
        options.run, options.seed = abi.ODO_RUN_LIVE if live else abi.ODO_RUN_REPLAY, seed
        strings = {"config_text" if isinstance(config, str) and ("\n" in config or ": " in config) else "config_path": string(text), "plugin_path": string(plugin_path), "asset_path": string(asset_path)}
        for name, value in strings.items():
            setattr(options, name, value)
        check(self._odo.odo_session_create(c.byref(options), c.byref(self._session), c.byref(error)), error)
        if on_event:
            self._listen(on_event, [kind.TYPE for kind in events])

    def _listen(self, on_event: Callable[[Any], None], types: Sequence[int]) -> None:
        def call(_: Any, event: Any) -> None:
            before, self._calling = self._calling, threading.get_ident()
            try:
                on_event(copied(event))
            except BaseException as failed:  # pylint: disable=broad-except; must not propagate through the library: push or flush raises it
                self._failed = failed
            finally:
                self._calling = before

        self._callback = abi.odo_callback(call)  # keeps it alive for the library
        numbers = (c.c_uint32 * len(types))(*types) if types else None
        self._odo.odo_session_set_callback(self._session, numbers, len(types) if types else abi.ODO_ALL_EVENTS, self._callback, None)

    def _open(self) -> Any:
        if self._failed:
            failed, self._failed = self._failed, None
            raise failed
        if not self._session:
            raise OdographError(abi.ODO_E_STATE, "the session was closed")
        return self._session

    def push(self, message: abi.Message) -> int:
        """Pushes any input except a frame. Returns ODO_OK, or the status of a rejected message; last_error() has the reason."""
        status = self._odo.odo_session_push(self._open(), c.byref(message.header))
        self._open()
        return status

    def push_imu(self, t_ns: int, gyro_b: Sequence[float], accel_b: Sequence[float]) -> int:
        """Pushes an inertial sample: rotation rate (rad/s) and specific force (m/s^2) in b."""
        return self.push(abi.Imu(t_ns=t_ns, flags=abi.ODO_IMU_GYRO | abi.ODO_IMU_ACCEL, gyro_b=gyro_b, accel_b=accel_b))

    def push_frame(self, t_ns: int, picture: "np.ndarray[Any, Any]", **fields: Any) -> int:
        """Pushes a picture of uint8: height x width (grey), x 3 (RGB) or x 4 (RGBA), with any row stride. It is borrowed, not copied: do not
        change it until the library has released it (`borrowed` counts those not released). `fields`: further fields of the frame; `like`:
        a frame that gives all of them."""
        channels = picture.shape[2] if picture.ndim == 3 else 1
        if picture.dtype != np.uint8 or channels not in _FORMATS or picture.strides[-1] != 1 or picture.strides[1] != channels:
            raise ValueError(f"picture: {picture.dtype} {picture.shape} with strides {picture.strides}; expected uint8, pixels side by side")
        like = fields.pop("like", None)
        frame = abi.Frame() if like is None else abi.Frame.from_buffer_copy(like)
        frame.header.struct_size = c.sizeof(frame)
        frame.header.t_ns = t_ns
        frame.format, frame.height, frame.width, frame.plane_count = _FORMATS[channels], picture.shape[0], picture.shape[1], 1
        plane = frame.planes[0]
        plane.data = c.cast(picture.ctypes.data, c.POINTER(c.c_uint8))
        plane.row_stride, plane.pixel_stride, plane.rows = picture.strides[0], channels, 0
        for name, value in fields.items():
            setattr(frame, name, value)
        number = self._borrowed.lend(picture)
        frame.loan = abi.odo_loan(number, self._borrowed.retain, self._borrowed.release)
        try:
            return self.push(frame)
        finally:
            self._borrowed.hold(number, -1)

    @property
    def borrowed(self) -> int:
        """Number of pictures that the library still borrows."""
        return len(self._borrowed.pictures)

    def flush(self) -> None:
        """Processes all pushed samples without waiting for slower sensors."""
        check(self._odo.odo_session_flush(self._open()))
        self._open()

    def pose(self, t_ns: int = abi.ODO_TIME_LATEST, *, smooth: bool = False, of: int = abi.ODO_OF_PIPELINE) -> abi.Pose | None:
        """The pose at a time, which may be in the near future; None if not available. Check the flags. `smooth`: without jumps, for rendering."""
        pose = abi.Pose()
        world = abi.ODO_WORLD_SMOOTH if smooth else abi.ODO_WORLD_CORRECTED
        status = self._odo.odo_session_get_pose_of(self._open(), of, world, t_ns, c.byref(pose))
        return pose if status == abi.ODO_OK else None

    def create_anchor(self, kind: int, name: str = "", **place: Any) -> int:
        """Creates an anchor of kind ODO_ANCHOR_* with the fields of odo_anchor_place. Returns its id, or 0, which is no anchor's, while the
        position of the phone is unknown."""
        made, number = sized(abi.AnchorPlace), c.c_uint64()
        made.kind, made.t_ns, made.name = kind, abi.ODO_TIME_LATEST, string(name)
        for field, value in place.items():
            setattr(made, field, type(getattr(made, field))(*value) if isinstance(getattr(made, field), c.Array) else value)
        check(self._odo.odo_anchor_create(self._open(), c.byref(made), c.byref(number)))
        return number.value

    def anchor(self, number: int, t_ns: int = abi.ODO_TIME_LATEST, *, world: int = abi.ODO_WORLD_CORRECTED) -> abi.Anchor:
        anchor = sized(abi.Anchor)
        check(self._odo.odo_anchor_get(self._open(), number, world, t_ns, c.byref(anchor)))
        return anchor

    def anchors(self) -> list[int]:
        ids = (c.c_uint64 * self._odo.odo_anchor_list(self._open(), None, 0))()
        return list(ids)[:self._odo.odo_anchor_list(self._open(), ids, len(ids))]

    def remove_anchor(self, number: int) -> None:
        check(self._odo.odo_anchor_remove(self._open(), number))

    def hit_test(self, kind: int = abi.ODO_RAY_PIXEL, *, t_ns: int = abi.ODO_TIME_LATEST, most: int = 8, **ray: Any) -> list[abi.Hit]:
        """What a ray hits, nearest first: `kind` is ODO_RAY_*, `ray` are fields of odo_ray, such as pixel=(320, 240). Empty while the position
        or the scale is unknown."""
        made, hits, count = sized(abi.Ray), (abi.Hit * most)(), c.c_uint32()
        made.kind, made.t_ns = kind, t_ns
        for field, value in ray.items():
            setattr(made, field, type(getattr(made, field))(*value) if isinstance(getattr(made, field), c.Array) else value)
        hits[0].struct_size = c.sizeof(abi.Hit)
        check(self._odo.odo_session_hit_test(self._open(), c.byref(made), hits, most, c.byref(count)))
        return list(hits)[:count.value]

    def surfaces(self, *, world: int = abi.ODO_WORLD_CORRECTED) -> list[abi.Surface]:
        """The surfaces found so far, with their `outline`."""
        ids = (c.c_uint64 * self._odo.odo_surface_list(self._open(), None, 0))()
        found = []
        for number in list(ids)[:self._odo.odo_surface_list(self._open(), ids, len(ids))]:
            data = c.create_string_buffer(abi.ODO_LARGEST_SURFACE)
            surface = abi.Surface.from_buffer(data)
            surface.header.struct_size = len(data)
            if self._odo.odo_surface_get(self._open(), number, world, c.byref(surface)) == abi.ODO_OK:
                set_elements(surface, data.raw[:surface.header.struct_size])
                found.append(surface)
        return found

    def map_points(self, *, world: int = abi.ODO_WORLD_CORRECTED) -> Any:
        """The landmarks that the library keeps, each an odo_map_point."""
        points = (abi.MapPoint * abi.ODO_MOST_MAP_POINTS)()
        points[0].struct_size = c.sizeof(abi.MapPoint)
        count = self._odo.odo_session_get_points(self._open(), world, points, len(points))
        check(int(count))
        return points[:min(count, len(points))]

    def statistics(self) -> abi.Statistics:
        made = sized(abi.Statistics)
        check(self._odo.odo_session_get_statistics(self._open(), c.byref(made)))
        return made

    def last_error(self) -> str | None:
        """The latest error or warning since the last call, or None."""
        error = sized(abi.odo_error)
        check(self._odo.odo_session_last_error(self._open(), c.byref(error)))
        return None if error.status == abi.ODO_OK else error.message.decode()

    def to_geodetic(self, p_n: Sequence[float]) -> tuple[float, float, float]:
        """Latitude and longitude (rad) and ellipsoidal height (m) of a position in n."""
        return self._convert(self._odo.odo_session_to_geodetic, p_n)

    def from_geodetic(self, geodetic: Sequence[float]) -> tuple[float, float, float]:
        return self._convert(self._odo.odo_session_from_geodetic, geodetic)

    def _convert(self, function: Any, values: Sequence[float]) -> tuple[float, float, float]:
        three, out = (c.c_double * 3)(*values), (c.c_double * 3)()
        status = function(self._open(), three, out)
        if status != abi.ODO_OK:
            raise OdographError(status, "the origin of n is not known yet" if status > 0 else "no such place")
        return out[0], out[1], out[2]

    def save(self) -> bytes:
        """Anchors and parameters estimated by plugins, for `load` in a later session."""
        data = c.create_string_buffer(max(0, self._odo.odo_session_save(self._open(), None, 0)))
        check(self._odo.odo_session_save(self._open(), data, len(data)))
        return data.raw

    def save_map(self) -> bytes:
        """Maps of the places that this session has seen, with its anchors, for `load_map` in a later one."""
        data = c.create_string_buffer(max(0, self._odo.odo_map_save(self._open(), None, 0)))
        while (size := int(self._odo.odo_map_save(self._open(), data, len(data)))) != len(data):
            check(min(size, 0))
            data = c.create_string_buffer(size)
        return data.raw

    def load_map(self, data: bytes) -> None:
        """Raises an OdographError if the map is damaged, or of plugins that the session does not have."""
        check(self._odo.odo_map_load(self._open(), data, len(data)))

    def load(self, data: bytes) -> bool:
        """False if a plugin rejected its part, which last_error() names; the others are restored."""
        status = int(self._odo.odo_session_load(self._open(), data, len(data)))
        check(status)
        return status == abi.ODO_OK

    def close(self) -> None:
        """Not within on_event, where it raises an OdographError."""
        if self._calling == threading.get_ident():
            raise OdographError(abi.ODO_E_STATE, "close() within on_event: close the session after push or flush has returned")
        self._odo.odo_session_destroy(self._session)
        self._session = c.POINTER(abi.odo_session)()

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_session", None):
            self.close()
