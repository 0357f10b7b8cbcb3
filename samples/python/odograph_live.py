#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Odograph from Python, through its C API and nothing else: an IMU and a camera, pictures handed over without a copy.

The declarations are in odograph_abi.py beside it. A picture is anything with the buffer protocol, a NumPy array of uint8
above all. It is borrowed until the library releases it.

    odograph_live.py LIBRARY CONFIG.yaml     # 10 s of a phone that is carried; prints steps and the last pose
"""
import ctypes as c
import math
import sys
import threading

import odograph_abi as abi


def make(kind, message_type, t_ns=0):
    """A message whose size, type and time are filled in."""
    message = kind()
    message.header.struct_size, message.header.type, message.header.t_ns = c.sizeof(kind), message_type, t_ns
    return message


def string(text):
    data = text.encode()
    return abi.odo_string(c.cast(c.c_char_p(data), c.POINTER(c.c_char)), len(data))


RETAIN = c.CFUNCTYPE(c.c_int32, c.c_void_p)
RELEASE = c.CFUNCTYPE(None, c.c_void_p)


class Session:
    """One pipeline. Callbacks come on the library's thread when live, within push in a replay."""

    def __init__(self, library, config_path, live, on_event, types):
        self.odo = abi.load(library)
        self.session = c.POINTER(abi.odo_session)()
        self.borrowed = {}  # pictures that the library holds, by number: [pixels, how often retained]
        self.numbers = 0
        self.lock = threading.Lock()
        error = abi.odo_error(c.sizeof(abi.odo_error))
        options = abi.odo_session_options(c.sizeof(abi.odo_session_options), abi.ODO_RUN_LIVE if live else abi.ODO_RUN_REPLAY)
        options.config_path = string(config_path)
        if self.odo.odo_session_create(c.byref(options), c.byref(self.session), c.byref(error)) != abi.ODO_OK:
            raise RuntimeError(error.message.decode())
        self.callback = abi.odo_callback(lambda _, event: on_event(event))  # the library calls it: it must stay alive
        self.retain = RETAIN(lambda owner: self.hold(owner, 1))
        self.release = RELEASE(lambda owner: self.hold(owner, -1) and None)
        self.odo.odo_session_set_callback(self.session, (c.c_uint32 * len(types))(*types), len(types), self.callback, None)

    def hold(self, owner, by):
        """The library, or a plugin, retains or releases a picture: from any thread, as often as it likes."""
        with self.lock:
            self.borrowed[owner][1] += by
            if self.borrowed[owner][1] == 0:
                del self.borrowed[owner]
        return abi.ODO_OK

    def push(self, message):
        return self.odo.odo_session_push(self.session, c.byref(message.header))

    def push_imu(self, t_ns, gyro_b, accel_b):
        three = c.c_double * 3
        return self.odo.odo_session_push_imu(self.session, t_ns, three(*gyro_b), three(*accel_b))

    def push_picture(self, t_ns, picture, width, height, row_stride):
        """A grey picture with the buffer protocol; it is not copied and must not change until it is released."""
        self.numbers += 1
        pixels = (c.c_ubyte * (row_stride * height)).from_buffer(picture)
        frame = make(abi.odo_frame, abi.ODO_TYPE_FRAME, t_ns)
        frame.format, frame.width, frame.height = abi.ODO_FORMAT_GREY8, width, height
        frame.planes[0].data, frame.planes[0].row_stride, frame.planes[0].pixel_stride = pixels, row_stride, 1
        frame.loan.owner = self.numbers
        frame.loan.retain, frame.loan.release = self.retain, self.release
        with self.lock:
            self.borrowed[self.numbers] = [pixels, 1]  # the call's own
        status = self.push(frame)
        self.hold(self.numbers, -1)
        return status

    def pose(self, t_ns=abi.ODO_TIME_LATEST):
        pose = make(abi.odo_pose, 0)
        return pose if self.odo.odo_session_get_pose(self.session, t_ns, c.byref(pose)) == abi.ODO_OK else None

    def flush(self):
        return self.odo.odo_session_flush(self.session)

    def close(self):
        self.odo.odo_session_destroy(self.session)
        self.session = c.POINTER(abi.odo_session)()


def main(library, config):
    steps, reports = [], []

    def on_event(event):
        if event.contents.type == abi.ODO_TYPE_STEP:
            steps.append(c.cast(event, c.POINTER(abi.odo_step)).contents.length_m)
        elif event.contents.type == abi.ODO_TYPE_REPORT:
            reports.append(c.cast(event, c.POINTER(abi.odo_report)).contents.text.decode())

    session = Session(library, config, False, on_event, [abi.ODO_TYPE_STEP, abi.ODO_TYPE_REPORT])
    camera = make(abi.odo_calibration, abi.ODO_TYPE_CALIBRATION)
    camera.model, camera.width, camera.height = abi.ODO_CAMERA_PINHOLE, 64, 48
    camera.fx = camera.fy = 60
    camera.cx, camera.cy = 31.5, 23.5
    session.push(camera)
    for i in range(1000):
        t = i * 0.01
        t_ns = 10 ** 9 + i * 10 ** 7
        session.push_imu(t_ns, (0, 0.01, 0.1 * math.sin(3 * t)), (0.1, 9.81 + 2.2 * math.sin(12 * t), 0.4))
        if i % 10 == 0:
            session.push_picture(t_ns, bytearray([90]) * (64 * 48), 64, 48, 64)
    session.flush()
    pose = session.pose()
    print(f"{len(steps)} steps, {sum(steps):.1f} m; {session.odo.odo_state_text(pose.state).decode()}; "
          f"{len(session.borrowed)} pictures still borrowed; {len(reports)} reports")
    for text in reports[:3]:
        print(text)
    session.close()
    return 0 if steps and not session.borrowed else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
