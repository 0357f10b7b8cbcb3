#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The modules' rules, read from the includes: who may see whom, no cycles between folders, what no library may do; and
how long files and functions may be."""
import collections
import json
import os
import re
import shutil
import subprocess
import sys

ROOT = sys.argv[1]
MAX_LINES = 400
MAX_FUNCTION_LINES = 60
# Folders of the host, each may include those before it. The tools may include all of them.
HOST = ["base", "messages", "config", "plugin_host", "estimator", "core"]
# The files of a plugin that may include the ABI; algorithms never do.
GLUE = {"plugin.cpp", "step_plugin.hpp", "attitude_plugin.hpp", "horizontal_scale.hpp", "database_extension.hpp", "frame_view.hpp"}
# A program of its own, and the reader of ODOGRAPH_PLUGIN_PATH.
ENVIRONMENT = {"sdk/host/plugin_host/host_main.cpp", "sdk/host/config/registry.cpp"}
HEAVY = re.compile(r"#include <(opencv2|embree|CLI/|nlohmann|ceres)")
LOUD = re.compile(r"std::(cout|cerr|exit|getenv)|(?<!sn)(?<!vsn)printf *\(|[^a-z_]getenv *\(")

wrong = []


def sources(*tops):
    for top in tops:
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            for name in sorted(names):
                if name.endswith((".c", ".h", ".cpp", ".hpp")):
                    path = os.path.relpath(os.path.join(folder, name), ROOT)
                    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
                        yield path, file.read()


def included(path, text):
    """Files of this project that a file includes, from the root."""
    for name in re.findall(r'^\s*#\s*include\s+"([^"]+)"', text, re.M):
        beside = os.path.normpath(os.path.join(os.path.dirname(path), name))
        yield name if os.path.exists(os.path.join(ROOT, name)) else beside


def plugin_of(path):
    """The folder of the plugin that a file belongs to: KIND/NAME, or shared."""
    parts = path.split("/")
    return "shared" if parts[1] == "shared" else "/".join(parts[1:3])


def check_include(path, other):
    if path.startswith("sdk/host/"):
        if not other.startswith(("sdk/host/", "sdk/math/")):
            wrong.append(f"{path} includes {other}: the host sees itself, sdk/math and the ABI alone")
        elif other.startswith("sdk/host/") and HOST.index(path.split("/")[2]) < HOST.index(other.split("/")[2]):
            wrong.append(f"{path} includes {other}: the host's folders see those before them: {', '.join(HOST)}")
    elif path.startswith("sdk/tools/"):
        if not other.startswith("sdk/"):
            wrong.append(f"{path} includes {other}: the tools see the SDK alone")
    elif path.startswith("plugins/"):
        if other.startswith("sdk/math/"):
            return
        if not other.startswith("plugins/"):
            wrong.append(f"{path} includes {other}: a plugin sees the ABI, sdk/math and itself, never the host")
        elif plugin_of(other) not in ("shared", plugin_of(path)):
            wrong.append(f"{path} includes {other}: plugins share plugins/shared and nothing else")
    elif path.startswith("sdk/math/"):
        if not other.startswith("sdk/math/"):
            wrong.append(f"{path} includes {other}: sdk/math sees itself, Eigen and the standard library")
    elif path.startswith("samples/"):
        if not other.startswith(os.path.dirname(path) + "/"):
            wrong.append(f"{path} includes {other}: a sample sees what is installed")
    elif path.startswith("abi/"):
        wrong.append(f"{path} includes {other}: the ABI's headers are found as <odograph/...>")


def check_cycles(edges):
    """Folders that reach themselves."""
    def reach(start):
        seen, todo = set(), [start]
        while todo:
            for other in edges[todo.pop()]:
                if other not in seen:
                    seen.add(other)
                    todo.append(other)
        return seen

    for folder in sorted(edges):
        if folder in reach(folder):
            wrong.append(f"{folder} includes itself by way of {', '.join(sorted(o for o in edges[folder] if folder in reach(o)))}")


def check_lengths():
    files = subprocess.run(["git", "-C", ROOT, "ls-files"], capture_output=True, text=True, check=False).stdout.split()
    for path in files:
        if path.endswith((".c", ".h", ".cpp", ".hpp", ".py", ".sh")) and os.path.exists(os.path.join(ROOT, path)):
            with open(os.path.join(ROOT, path), encoding="utf-8") as file:
                lines = file.readlines()
            count = len(lines)
            if count > MAX_LINES and "Written by abi/generate.py" not in "".join(lines[:4]):
                wrong.append(f"{path} has {count} lines, {MAX_LINES} at most")


def check_functions():
    """By universal-ctags, which says where each function ends. False where there is none."""
    if not shutil.which("ctags") or "Universal Ctags" not in subprocess.run(["ctags", "--version"], capture_output=True, text=True, check=False).stdout:
        return False
    files = [path for path, _ in sources("abi", "sdk", "plugins", "samples", "tests")]
    said = subprocess.run(["ctags", "--output-format=json", "--fields=+ne", "--c-kinds=f", "--c++-kinds=f", "-L", "-", "-f", "-"],
                          input="\n".join(files), cwd=ROOT, capture_output=True, text=True, check=False).stdout
    seen = 0
    for tag in map(json.loads, said.splitlines()):
        if "end" not in tag:
            continue
        seen += 1
        count = tag["end"] - tag["line"] + 1
        if count > MAX_FUNCTION_LINES:
            wrong.append(f"{tag['path']}:{tag['line']}: {tag['name']} has {count} lines, {MAX_FUNCTION_LINES} at most")
    if seen < 2000:
        wrong.append(f"ctags found {seen} functions only")
    return True


edges = collections.defaultdict(set)
for path, text in sources("abi", "sdk", "plugins", "samples"):
    for other in included(path, text):
        check_include(path, other)
        if os.path.dirname(path) != os.path.dirname(other):
            edges[os.path.dirname(path)].add(os.path.dirname(other))
    name = os.path.basename(path)
    if path.startswith("plugins/") and "#include <odograph/" in text and name not in GLUE:
        wrong.append(f"{path} includes the ABI: an algorithm knows nothing of it")
    if path.startswith("sdk/math/"):
        wrong += [f"{path} includes <{name}>: sdk/math sees itself, Eigen and the standard library"
                  for name in re.findall(r"#include <([^>]+)>", text) if not re.fullmatch(r"Eigen/\w+|[a-z_]+", name)]
    if path.startswith(("sdk/host/", "sdk/math/")) and HEAVY.search(text):
        wrong.append(f"{path}: the host uses a heavy library")
    if path.startswith(("sdk/host/", "sdk/math/", "plugins/")) and path not in ENVIRONMENT:
        for number, line in enumerate(text.splitlines(), 1):
            if LOUD.search(line):
                wrong.append(f"{path}:{number}: a library writes to the terminal, ends the program or reads its environment")
check_cycles(edges)
check_lengths()
counted = check_functions()
if wrong:
    sys.exit("\n".join(wrong))
if not counted:
    print("SKIPPED: no universal-ctags, so no function was measured")
    sys.exit(77)
