#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Odograph from Python, through its C API and nothing else: an IMU and a camera, pictures handed over without a copy.

A picture is anything with the buffer protocol, a NumPy array of uint8 above all. It is lent until the library releases it.

    odograph_live.py LIBRARY CONFIG.yaml     # 10 s of a phone that is carried; prints steps and the last pose
"""
import ctypes as c
import math
import sys
import threading

TYPE_IMU, TYPE_FRAME, TYPE_CALIBRATION = 0x1, 0x5, 0x6
TYPE_STEP, TYPE_REPORT = 0x1002, 0x100A
LATEST = -(2 ** 63)


class String(c.Structure):
    _fields_ = [("data", c.c_char_p), ("size", c.c_uint64)]

    def __init__(self, text=""):
        data = text.encode()
        super().__init__(data, len(data))


class Header(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("type", c.c_uint32), ("t_ns", c.c_int64), ("source", c.c_uint32),
                ("flags", c.c_uint32), ("quality", c.c_float), ("reserved", c.c_uint32)]


class Message(c.Structure):
    """A message: size, type and time are filled in."""

    def __init__(self, message_type, t_ns, flags=0):
        super().__init__()
        self.header = Header(c.sizeof(self), message_type, t_ns, 0, flags, 0, 0)


class Calibration(Message):
    _fields_ = [("header", Header), ("id", c.c_uint32), ("model", c.c_uint32), ("width", c.c_uint32),
                ("height", c.c_uint32), ("fx", c.c_double), ("fy", c.c_double), ("cx", c.c_double), ("cy", c.c_double),
                ("distortion", c.c_double * 8), ("distortion_count", c.c_uint32), ("reserved", c.c_uint32),
                ("q_b_c", c.c_double * 4), ("p_b_c", c.c_double * 3), ("time_offset_ns", c.c_int64),
                ("line_time_ns", c.c_int64)]


class Plane(c.Structure):
    _fields_ = [("data", c.c_void_p), ("row_stride", c.c_int64), ("pixel_stride", c.c_uint32), ("reserved", c.c_uint32)]


RETAIN = c.CFUNCTYPE(c.c_int32, c.c_void_p)
RELEASE = c.CFUNCTYPE(None, c.c_void_p)


class Frame(Message):
    _fields_ = [("header", Header), ("format", c.c_uint32), ("calibration", c.c_uint32), ("width", c.c_uint32),
                ("height", c.c_uint32), ("planes", Plane * 4), ("mask", Plane), ("exposure_ns", c.c_int64),
                ("line_time_ns", c.c_int64), ("owner", c.c_void_p), ("retain", RETAIN), ("release", RELEASE),
                ("fx", c.c_double), ("fy", c.c_double), ("cx", c.c_double), ("cy", c.c_double)]


class Step(Message):
    _fields_ = [("header", Header), ("t_start_ns", c.c_int64), ("t_end_ns", c.c_int64), ("length_m", c.c_double)]


class Report(Message):
    _fields_ = [("header", Header), ("count", c.c_uint64), ("severity", c.c_uint32), ("status", c.c_int32),
                ("plugin", c.c_char * 64), ("key", c.c_char * 64), ("text", c.c_char * 1024)]


class Pose(Message):
    _fields_ = [("header", Header), ("q_n", c.c_double * 4), ("p_n", c.c_double * 3), ("velocity_n", c.c_double * 3),
                ("covariance", c.c_double * 36), ("scale", c.c_double), ("scale_sigma", c.c_double),
                ("distance_m", c.c_double), ("state", c.c_uint32), ("reason", c.c_uint32),
                ("angular_velocity", c.c_double * 3), ("velocity_covariance", c.c_double * 9)]


class Options(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("run", c.c_uint32), ("config_path", String), ("config_text", String),
                ("plugin_path", String), ("seed", c.c_uint64), ("asset_path", String)]


class Error(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("status", c.c_int32), ("message", c.c_char * 2040)]


CALLBACK = c.CFUNCTYPE(None, c.c_void_p, c.POINTER(Header))


class Session:
    """One pipeline. Callbacks come on the library's thread when live, within push in a replay."""

    def __init__(self, library, config_path, live, on_event, types):
        self.odo = c.CDLL(library)
        self.odo.odo_state_text.restype = c.c_char_p
        self.session = c.c_void_p()
        self.lent = {}  # pictures that the library holds, by number: [pixels, how often retained]
        self.numbers = 0
        self.lock = threading.Lock()
        error = Error(c.sizeof(Error))
        options = Options(c.sizeof(Options), 0 if live else 1, String(config_path))
        if self.odo.odo_session_create(c.byref(options), c.byref(self.session), c.byref(error)) != 0:
            raise RuntimeError(error.message.decode())
        self.callback = CALLBACK(lambda _, event: on_event(event))  # kept: the library calls it
        self.retain = RETAIN(lambda frame: self.hold(frame, 1))
        self.release = RELEASE(lambda frame: self.hold(frame, -1) and None)
        self.odo.odo_session_set_callback(self.session, (c.c_uint32 * len(types))(*types), len(types), self.callback, None)

    def hold(self, frame, by):
        """The library, or a plugin, retains or releases a picture: from any thread, as often as it likes."""
        number = c.cast(frame, c.POINTER(Frame)).contents.owner
        with self.lock:
            self.lent[number][1] += by
            if self.lent[number][1] == 0:
                del self.lent[number]
        return 0

    def push(self, message):
        return self.odo.odo_session_push(self.session, c.byref(message))

    def push_imu(self, t_ns, gyro_b, accel_b):
        three = c.c_double * 3
        return self.odo.odo_session_push_imu(self.session, c.c_int64(t_ns), three(*gyro_b), three(*accel_b))

    def push_picture(self, t_ns, picture, width, height, row_stride):
        """A grey picture with the buffer protocol; it is not copied and must not change until it is released."""
        self.numbers += 1
        pixels = (c.c_ubyte * (row_stride * height)).from_buffer(picture)
        frame = Frame(TYPE_FRAME, t_ns)
        frame.format, frame.width, frame.height = 1, width, height
        frame.planes[0] = Plane(c.addressof(pixels), row_stride, 1, 0)
        frame.owner, frame.retain, frame.release = self.numbers, self.retain, self.release
        with self.lock:
            self.lent[self.numbers] = [pixels, 1]  # the call's own
        status = self.push(frame)
        self.hold(c.byref(frame), -1)
        return status

    def pose(self, t_ns=LATEST):
        pose = Pose(0, 0)
        return pose if self.odo.odo_session_get_pose(self.session, c.c_int64(t_ns), c.byref(pose)) == 0 else None

    def flush(self):
        return self.odo.odo_session_flush(self.session)

    def close(self):
        self.odo.odo_session_destroy(self.session)
        self.session = c.c_void_p()


def main(library, config):
    steps, reports = [], []

    def on_event(event):
        if event.contents.type == TYPE_STEP:
            steps.append(c.cast(event, c.POINTER(Step)).contents.length_m)
        elif event.contents.type == TYPE_REPORT:
            reports.append(c.cast(event, c.POINTER(Report)).contents.text.decode())

    session = Session(library, config, False, on_event, [TYPE_STEP, TYPE_REPORT])
    camera = Calibration(TYPE_CALIBRATION, 0)
    camera.model, camera.width, camera.height = 1, 64, 48
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
          f"{len(session.lent)} pictures still lent; {len(reports)} reports")
    for text in reports[:3]:
        print(text)
    session.close()
    return 0 if steps and not session.lent else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
