#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tidy_commands.py: compile commands for clang-tidy. Those of build/, each file once and not in batches, without an option that clang does not have; then those of
files that this build does not compile: samples, which are projects of their own, Windows, Android, web, benchmarks, tests that compile for
themselves. None for files that include what is generated while they are used (plugin_host.c, embed_blocks.c) or a JDK's jni.h."""
import glob
import json
import os
import re
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LEFT_OUT = {"abi/bindings/java/odograph_jni.c", "abi/bindings/python/plugin_host.c", "tests/contract/embed_blocks.c"}
MINGW = next(iter(glob.glob("/usr/lib/gcc/x86_64-w64-mingw32/*-posix/include/c++")), None)
FLAGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wno-missing-field-initializers", "-DTWIN=1", "-DODOGRAPH_CAMERA_PLUGINS=1",
         *(f'-DODOGRAPH_{name}="/"' for name in ("BUILD", "DATA", "LIBRARY", "SOURCE")), "-I" + ROOT, f"-I{ROOT}/abi/include",
         f"-I{ROOT}/tests/samples/phone_platforms/android", "-isystem", "/usr/include/opencv4", "-isystem", "/usr/include/eigen3"]


def flags_of(name):
    windows = ["--target=x86_64-w64-mingw32", "-isystem", MINGW or "", "-isystem", f"{MINGW}/x86_64-w64-mingw32"] if "windows" in name else []
    return ["c++", "-std=c++20", *FLAGS, *windows] if name.endswith(".cpp") else ["cc", "-std=c99", *FLAGS]


with open(f"{ROOT}/build/compile_commands.json", encoding="utf-8") as file:
    commands = {}
    for c in reversed(json.load(file)):
        batch = re.findall(r'^#include "(.*)"$', open(c["file"], encoding="utf-8").read(), re.M) if c["file"].startswith(f"{ROOT}/build/") else []
        for source in [os.path.join(ROOT, each) for each in batch] or [c["file"]]:
            commands[source] = {**c, "file": source, "command": c["command"].replace(" -fno-gnu-unique", "").replace(c["file"], source)}
for name in subprocess.check_output(["git", "-C", ROOT, "ls-files", "*.c", "*.cpp"], text=True).split():
    path = os.path.join(ROOT, name)
    if path not in commands and name not in LEFT_OUT and (MINGW or "windows" not in name):
        commands[path] = {"directory": ROOT, "file": path, "arguments": [*flags_of(name), "-c", path]}
print(json.dumps(list(commands.values())))
