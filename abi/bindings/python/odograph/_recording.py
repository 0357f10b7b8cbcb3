# SPDX-License-Identifier: Apache-2.0
"""Reading and writing recordings (*.odo)."""
import ctypes as c
import os
from types import TracebackType
from typing import Any, Iterator

from . import abi
from ._library import OdographError, check, copied, library, sized, string
from ._session import Path


class Recording:
    """Iterates over copies of the messages of a recording in time order; a frame has its encoded `picture`. It can be iterated repeatedly
    and has a length, so that `tqdm(recording)` shows a bar. Records that cannot be read are skipped. `loss` describes missing data."""

    def __init__(self, path: Path) -> None:
        self.path, self._odo = os.fspath(path), library()
        self._length: int | None = None
        handle = self._opened()
        self.loss: str = self._loss(handle)
        self._odo.odo_recording_close(handle)

    def _loss(self, handle: Any) -> str:
        loss = sized(abi.odo_error)
        check(self._odo.odo_recording_loss(handle, c.byref(loss)))
        return loss.message.decode()

    def _opened(self) -> Any:
        handle, error, path = c.POINTER(abi.odo_recording)(), sized(abi.odo_error), string(self.path)
        check(self._odo.odo_recording_open(c.byref(path), c.byref(handle), c.byref(error)), error)
        return handle

    def _messages(self) -> Iterator[tuple[Any, Any, int]]:
        handle, message = self._opened(), c.POINTER(abi.odo_header)()
        picture, size = c.c_void_p(), c.c_uint64()
        try:
            status = abi.ODO_OK
            while status != abi.ODO_END:
                status = self._odo.odo_recording_next(handle, c.byref(message), c.byref(picture), c.byref(size))
                if status == abi.ODO_OK:
                    yield message, picture.value, size.value
                elif status != abi.ODO_E_DATA:
                    check(status)
        finally:
            self.loss = self._loss(handle)
            self._odo.odo_recording_close(handle)

    def __iter__(self) -> Iterator[Any]:
        for pointer, picture, size in self._messages():
            message = copied(pointer)
            if picture:
                object.__setattr__(message, "picture", c.string_at(picture, size))
            yield message

    def __len__(self) -> int:
        if self._length is None:
            self._length = sum(1 for _ in self._messages())
        return self._length


class Recorder:
    """Writes a recording, which is complete only after it is closed."""

    def __init__(self, path: Path) -> None:
        self._odo, self._recorder = library(), c.POINTER(abi.odo_recorder)()
        error, name = sized(abi.odo_error), string(os.fspath(path))
        check(self._odo.odo_recorder_create(c.byref(name), c.byref(self._recorder), c.byref(error)), error)

    def write(self, message: abi.Message, picture: bytes | None = None) -> None:
        """Appends a message, and for a frame the encoded picture (PNG or JPEG)."""
        if not self._recorder:
            raise OdographError(abi.ODO_E_STATE, "the recorder was closed")
        check(self._odo.odo_recorder_write(self._recorder, c.byref(message.header), picture, len(picture) if picture else 0))

    def close(self) -> None:
        recorder, self._recorder = self._recorder, c.POINTER(abi.odo_recorder)()
        check(self._odo.odo_recorder_close(recorder))

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
