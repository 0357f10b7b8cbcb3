# SPDX-License-Identifier: Apache-2.0
"""The shared library, its errors and its texts."""
import ctypes as c
import functools
import os
from typing import Any

from . import abi


class OdographError(Exception):
    """An error of the library: `status` is ODO_E_*, the text states the reason."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


@functools.lru_cache(maxsize=None)
def library() -> c.CDLL:
    """Loads libodograph: from ODOGRAPH_LIBRARY, or by the dynamic loader."""
    path = os.environ.get("ODOGRAPH_LIBRARY", f"libodograph.so.{abi.ODO_ABI_MAJOR}")
    try:
        found = abi.load(path)
    except OSError as error:
        raise ImportError(f"{error}. Install libodograph, or name its file in ODOGRAPH_LIBRARY") from error
    number = found.odo_abi_version()
    if number >> 16 != abi.ODO_ABI_MAJOR:
        raise ImportError(f"{path} has ABI {number >> 16}.{number & 0xFFFF}, this package {abi.ODO_ABI_MAJOR}.{abi.ODO_ABI_MINOR}")
    return found


def version() -> str:
    """Version of the library, "major.minor.patch"."""
    return library().odo_version().decode()


def status_text(status: int) -> str:
    return library().odo_status_text(status).decode()


def state_text(state: int) -> str:
    return library().odo_state_text(state).decode()


def reason_text(reason: int) -> str:
    return library().odo_reason_text(reason).decode()


def mode_text(mode: int) -> str:
    return library().odo_mode_text(mode).decode()


def sized(kind: Any) -> Any:
    """A zeroed struct with struct_size set, for the library to fill."""
    return kind(c.sizeof(kind))


def string(text: str) -> abi.odo_string:
    data = text.encode()
    made = abi.odo_string(c.cast(c.c_char_p(data), c.POINTER(c.c_char)), len(data))
    setattr(made, "keeps", data)  # keeps the bytes alive, because the pointer refers to them
    return made


def check(status: int, error: Any = None) -> None:
    if status < 0:
        raise OdographError(status, (error.message.decode() if error else "") or status_text(status))


def copied(pointer: Any) -> Any:
    """Copies the message at a pointer to its header. If MESSAGES does not contain its type, copies the header only."""
    header = pointer.contents
    message = abi.MESSAGES.get(header.type, abi.odo_header)()
    size = min(header.struct_size, c.sizeof(message))
    c.memmove(c.byref(message), pointer, size)
    set_elements(message, c.string_at(pointer, header.struct_size))
    c.cast(c.byref(message), c.POINTER(c.c_uint32))[0] = size
    return message


def set_elements(message: Any, data: bytes) -> None:
    """Sets the landmarks of an odo_points or the outline of an odo_surface, of which `data` are all bytes."""
    lists = {abi.Points: ("points", abi.odo_point), abi.Surface: ("outline", abi.odo_vertex)}
    if type(message) in lists:
        name, kind = lists[type(message)]
        object.__setattr__(message, name, elements(message, kind, data))


def elements(message: Any, kind: Any, data: bytes) -> Any:
    """The elements behind a message, of which `data` are all bytes."""
    size, stride = c.sizeof(kind), message.stride
    count = min(message.count, max(0, len(data) - message.offset) // stride) if stride >= size else 0
    ends = range(message.offset, message.offset + count * stride, max(stride, 1))
    return (kind * count).from_buffer_copy(b"".join(data[at:at + size] for at in ends))
