#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts what one inertial sample costs on its way to its attitude, and one frame on its way to its pose: the host's
functions and files that are entered, mutexes locked, messages copied or moved. Needs valgrind and a build without
optimisation, in which each function is a call:

    cmake --preset debug && cmake --build --preset debug --target odograph-count-frame
    tests/benchmarks/count_frame.py build-debug/bin/odograph-count-frame [--list] [--files 35] [--locks 6] [--copies 2]

--list prints the files, and the callers of each lock and copy. Exits with 1 if one of the two exceeds a given limit, or
if the trace has nothing of the host. Structs of the ABI that are assigned as a whole are not counted: they call nothing.
"""
import argparse
import collections
import glob
import os
import re
import subprocess
import sys
import tempfile

PUSHES = {"push_imu": "an inertial sample to its attitude", "push_frame": "a frame to its pose"}
CALLERS = 12  # how many are kept apart for each lock and copy
LOCK = re.compile(r"_*pthread_mutex_(lock|trylock|clocklock|timedlock)\b")
COPY = re.compile(r"odograph::AnyMessage::(copy|take|assign)\(|^odo_\w+ odograph::copy_as<")
WORK = re.compile(r"^(?:.* )?odograph::(?!AnyMessage|OwnedMessage|.*copy_as<)")


class Trace:
    """What one push has entered, from callgrind's file: functions and files of the host, calls of locks and copies."""

    def __init__(self, path, source):
        self.functions, self.files = set(), set()
        self.locks, self.copies = collections.Counter(), collections.Counter()
        host = os.path.join(source, "sdk", "host") + os.sep
        names = {}  # of files and functions: "(3) text" at first, then "(3)"
        file = called = ""
        for line in open(path, encoding="utf-8", errors="replace"):
            key, _, text = line.rstrip("\n").partition("=")
            if key == "calls":
                self.call(called, int(text.split()[0]))
            if key not in ("fl", "fi", "fe", "fn", "cfi", "cfl", "cfn"):
                continue
            number, _, name = text.partition(" ")
            kind = key[-2:] == "fn"
            text = names.setdefault((kind, number), name)
            if key == "fl":
                file = os.path.normpath(text)
            elif key == "cfn":
                called = text
            elif key == "fn" and file.startswith(host):
                self.functions.add(text.split("'")[0])
                self.files.add(file[len(host):])

    def call(self, function, count):
        callee, *callers = function.split("'")
        by = next((caller for caller in callers if WORK.search(caller)), "?")
        for pattern, counter in ((LOCK, self.locks), (COPY, self.copies)):
            if pattern.search(callee):
                counter[(callee.split("(")[0], by.split("(")[0])] += count


def traces(program, source):
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--collect-atstart=yes"]
        for function in PUSHES:
            command += [f"--zero-before={function}", f"--dump-after={function}"]
        for function in ("pthread_mutex_*", "odograph::AnyMessage::*", "*odograph::copy_as*"):
            command.append(f"--separate-callers{CALLERS}={function}")
        run = subprocess.run(command + [program], capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(run.stderr)
        for path in sorted(glob.glob(f"{folder}/out.*")):
            text = open(path, encoding="utf-8", errors="replace").read(4096)
            for function, what in PUSHES.items():
                if f"--dump-after={function}" in text.split("desc: Trigger:")[-1].splitlines()[0]:
                    yield what, Trace(path, source)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--list", action="store_true")
    for limit in ("functions", "files", "locks", "copies"):
        parser.add_argument(f"--{limit}", type=int)
    options = parser.parse_args()
    source = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    found = dict(traces(options.program, source))
    if set(found) != set(PUSHES.values()):
        sys.exit("callgrind has not written both traces")
    beyond = []
    print(f"{'':36}{'functions':>10}{'files':>7}{'locks':>7}{'copies':>8}")
    for what, trace in found.items():
        counts = {"functions": len(trace.functions), "files": len(trace.files),
                  "locks": sum(trace.locks.values()), "copies": sum(trace.copies.values())}
        print(f"{what:36}{counts['functions']:>10}{counts['files']:>7}{counts['locks']:>7}{counts['copies']:>8}")
        for name, count in counts.items():
            limit = getattr(options, name)
            if limit is not None and count > limit:
                beyond.append(f"{what}: {count} {name}; expected at most {limit}")
        if counts["files"] < 5 or counts["copies"] < 1:
            beyond.append(f"{what}: no trace of the host: is the program built without optimisation?")
    if options.list:
        for what, trace in found.items():
            print(f"\n{what}:")
            for file in sorted(trace.files):
                print(f"  {file}")
            for counter in (trace.locks, trace.copies):
                for (callee, by), count in sorted(counter.items()):
                    print(f"  {count} x {callee} by {by}")
    for line in beyond:
        print(line, file=sys.stderr)
    return 1 if beyond else 0


if __name__ == "__main__":
    sys.exit(main())
