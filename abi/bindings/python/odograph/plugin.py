# SPDX-License-Identifier: Apache-2.0
"""Plugins in Python, for research: define a class with ID, SUMMARY, KIND, PARAMETERS and on(message, emit), and call `serve(Class)` at
the end of the file. plugin_host.c is compiled to a plugin library that runs the file in a separate process. `odograph plugin new
--language python` writes an example."""
import ctypes as c
import dataclasses
import hashlib
import socket
import struct
import sys
import traceback
from typing import Any, Callable

import numpy as np

from . import abi
from ._library import set_elements

CREATE, CONFIGURE, MESSAGE, RESET, DESTROY = range(1, 6)  # as in plugin_host.c
_REQUEST, _ANSWER = struct.Struct("=III"), struct.Struct("=iI")


@dataclasses.dataclass
class Parameter:
    """A numeric parameter, with its range and default in `unit`."""
    name: str
    unit: str
    min: float
    max: float
    default: float
    help: str


class Discard(Exception):
    """Raise it in `on` if the message is unusable and the state is unchanged (ODO_E_DISCARD)."""


def describe(kind: Any) -> str:
    """Returns plugin_description.h, the C description of the plugin for plugin_host.c."""
    def text(value: str) -> str:
        return '{"%s", %d}' % (value.replace("\\", "\\\\").replace('"', '\\"'), len(value.encode()))

    rows = [f"{{sizeof(odo_parameter), ODO_PARAMETER_REAL, {text(p.name)}, {text(p.unit)}, {text(p.help)}, {text(f'{p.default:g}')}, {{0, 0}}, "
            f"{p.min!r}, {p.max!r}, 1, 0}}" for p in kind.PARAMETERS] or ["{0}"]
    table = (f"static const odo_string plugin_id = {text(kind.ID)}, plugin_version = {text(kind.VERSION)}, plugin_summary = {text(kind.SUMMARY)}, "
             f"plugin_kind = {text(kind.KIND)};\nstatic const odo_parameter parameters[] = {{{', '.join(rows)}}};\n#define PARAMETER_COUNT {len(kind.PARAMETERS)}\n")
    return table + f'#define PLUGIN_DESCRIPTION "{hashlib.sha256(table.encode()).hexdigest()}"\n'


def _message(data: bytes) -> Any:
    size, number = struct.unpack_from("=II", data)
    kind = abi.MESSAGES.get(number)
    if kind is None:
        return None
    message = kind()
    known = min(size, c.sizeof(kind))
    c.memmove(c.byref(message), data, known)
    set_elements(message, data[:size])
    message.header.struct_size = known
    if kind is abi.Frame and len(data) > size:  # the pixels of the first plane follow the frame
        object.__setattr__(message, "pixels", np.frombuffer(data, np.uint8, offset=size).reshape(message.height, message.width, -1))
    return message


def _packed(event: Any) -> bytes:
    """The bytes of an event, with the landmarks of a Points or the outline of a Surface behind it."""
    elements = [bytes(element) for element in (*event.points, *event.outline)]
    if elements:
        event.count, event.stride, event.offset = len(elements), len(elements[0]), c.sizeof(event)
        event.header.struct_size = event.offset + event.count * event.stride
    return bytes(event) + b"".join(elements)


class _Server:
    def __init__(self, kind: Any, built: str) -> None:
        self.kind = kind
        self.stale = f'"{built}"' not in describe(kind)  # the library's table is not the file's
        self.instances: dict[int, Any] = {}
        self.values: dict[int, dict[str, float]] = {}

    def make(self, number: int) -> None:
        instance = self.kind()
        for parameter in self.kind.PARAMETERS:
            setattr(instance, parameter.name, self.values[number].get(parameter.name, parameter.default))
        self.instances[number] = instance

    def answer(self, what: int, number: int, data: bytes) -> bytes:
        """Handles a request. Returns the emitted events."""
        events = bytearray()
        if what == CREATE and self.stale:
            raise RuntimeError("PARAMETERS, ID, VERSION, SUMMARY or KIND have changed since the library was built: build it again")
        if what in (CREATE, CONFIGURE):
            rows = [line.split("=") for line in data.decode().splitlines()]
            self.values[number] = {name: float(value) for name, value in rows}
        if what in (CREATE, CONFIGURE, RESET):
            self.make(number)
        elif what == DESTROY:
            self.instances.pop(number, None)
        else:
            message = _message(data)
            if message is not None:
                emit: Callable[[Any], None] = lambda event: events.extend(_packed(event))
                self.instances[number].on(message, emit)
        return bytes(events)

    def run(self, connection: socket.socket) -> None:
        stream = connection.makefile("rwb")
        while len(head := stream.read(_REQUEST.size)) == _REQUEST.size:
            what, number, size = _REQUEST.unpack(head)
            status, events = abi.ODO_OK, b""
            try:
                events = self.answer(what, number, stream.read(size))
            except Discard:
                status = abi.ODO_E_DISCARD
            except Exception:  # pylint: disable=broad-except; the host reports it
                status, events = abi.ODO_E_ERROR, traceback.format_exc().strip().splitlines()[-1].encode()
            stream.write(_ANSWER.pack(status, len(events)) + events)
            stream.flush()


def serve(kind: Any) -> None:
    """Runs the plugin. Call it at the end of the plugin's file."""
    if sys.argv[1:] == ["--describe"]:
        print(describe(kind), end="")
    else:
        _Server(kind, sys.argv[2]).run(socket.socket(fileno=int(sys.argv[1])))
