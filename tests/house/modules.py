#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The modules' rules, read from the includes: permitted dependencies, no cycles between folders, operations forbidden to
libraries; the order of random numbers; and the maximum sizes of files, functions and classes."""
import collections
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = sys.argv[1]
MAX_LINES = 400
MAX_FUNCTION_LINES = 60
MAX_CLASS_LINES = 400
# 99 of 100 classes have at most 32, parameter tables up to 36; larger ones have several responsibilities.
MAX_DATA_MEMBERS = 40
# Larger ones, to be split; remove an entry when it fits or is gone.
LARGE_CLASSES = {
    "sdk/tools odograph::World",
    "plugins/vo/odograph odograph::vo::Odometry", "plugins/fix/skyline odograph::skyline::Matcher"}
# Folders of the host; each may include the preceding ones. The tools may include all of them.
HOST = ["platform", "base", "messages", "config", "plugin_host", "fusion", "checks", "core"]
# The files of a plugin and of sdk/math that may include the ABI; algorithms may not.
GLUE = {"frame_landmarks.hpp", "plugin.cpp", "step_plugin.hpp", "attitude_plugin.hpp", "horizontal_scale.hpp", "database_extension.hpp", "places_extension.hpp", "frame_view.hpp", "points_event.hpp", "photograph_prior.hpp"}
# A separate program, and the reader of ODOGRAPH_PLUGIN_PATH.
ENVIRONMENT = {"sdk/host/plugin_host/host_main.cpp", "sdk/host/platform/posix/process.cpp"}
HEAVY = re.compile(r"#include <(opencv2|embree|CLI/|nlohmann|ceres)")
# Operating system features beyond C and C++. In the host only platform/ and the isolation and loading of plugins may
# use them; the build excludes these on platforms without them (sdk/host/CMakeLists.txt).
SYSTEM = re.compile(r"#\s*include\s*<((sys|linux|mach|netinet|arpa)/[^>]*|unistd\.h|dlfcn\.h|fcntl\.h|poll\.h|sched\.h|spawn\.h|semaphore\.h|ucontext\.h"
                    r"|execinfo\.h|elf\.h|link\.h|unwind\.h|c?signal(\.h)?|csetjmp|setjmp\.h|pthread\.h|[Ww]indows\.h|io\.h)>"
                    r"|\b(v?fork|mmap|munmap|dlopen|dlsym|sigaction|pthread_\w+|getpid|kill|waitpid|sysconf|mkdtemp|isatty)\s*\("
                    r"|\b(_WIN32|__APPLE__|__ANDROID__|__EMSCRIPTEN__)\b")
PLUGIN_HOST = "sdk/host/plugin_host/"
SYSTEM_FILES = {PLUGIN_HOST + name for name in (
    "call_filter.cpp", "file_rules.cpp", "host_main.cpp", "supervisor.cpp", "library_check.cpp", "process_backend.cpp", "process_backend.hpp", "sandbox.cpp",
    "sealed_copy.cpp", "shared_memory.cpp", "shared_pixels.cpp", "thread_gate.cpp", "thread_gate.hpp")}
# Of the tools, which run on a developer's machine: child processes, pipes, the terminal.
SYSTEM_FILES |= {"sdk/tools/" + name for name in (
    "command_line/main.cpp", "console/console.cpp", "replay/marked_run.cpp", "replay/run_files.cpp", "validator/child.cpp", "validator/entry_cases.cpp",
    "validator/life_cases.cpp", "validator/plugin_driver.cpp")}
GENERATOR = r"\b(?:random|generator)_?\b"
# Functions, lambdas among them, that draw in their first lines.
DRAWING = re.compile(r"^\s*[\w:]+ (\w+)\([^()]*\)(?: const)? \{[^{}]*" + GENERATOR + r"|\b(\w+) = \[[^\]]*\](?:\([^()]*\))? \{[^{}]*" + GENERATOR, re.M)
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
    elif path.startswith("abi/bindings/"):
        if os.path.dirname(other) != os.path.dirname(path) and other != "plugins/vo/vit/vit_interface.hpp":  # the interface common to headset and plugin
            wrong.append(f"{path} includes {other}: a binding sees the ABI and itself")
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
            if count > MAX_LINES:
                wrong.append(f"{path} has {count} lines, {MAX_LINES} at most")


def has_ctags():
    return shutil.which("ctags") and "Universal Ctags" in subprocess.run(["ctags", "--version"], capture_output=True, text=True, check=False).stdout


def tags_of(files, kinds, folder=ROOT):
    """The tags of universal-ctags, which include the end of each function and class."""
    said = subprocess.run(["ctags", "--output-format=json", "--fields=+neKs", f"--c-kinds={kinds}", f"--c++-kinds={kinds}", "-L", "-", "-f", "-"],
                          input="\n".join(files), cwd=folder, capture_output=True, text=True, check=False).stdout
    return [json.loads(line) for line in said.splitlines()]


def check_functions():
    seen = 0
    for tag in tags_of([path for path, _ in sources("abi", "sdk", "plugins", "samples", "tests")], "f"):
        if "end" not in tag:
            continue
        seen += 1
        count = tag["end"] - tag["line"] + 1
        if count > MAX_FUNCTION_LINES:
            wrong.append(f"{tag['path']}:{tag['line']}: {tag['name']} has {count} lines, {MAX_FUNCTION_LINES} at most")
    if seen < 2000:
        wrong.append(f"ctags found {seen} functions only")


def class_sizes(files, folder=ROOT):
    """For each class its lines (definition and members defined outside it, in any file) and its data members without
    constants. The module precedes the name; of classes with the same name in unnamed namespaces of several files it is
    the largest."""
    lines, members, bodies = collections.Counter(), collections.Counter(), collections.defaultdict(list)
    tags = tags_of(files, "fcsm", folder)

    def class_of(tag, *names):
        module = "/".join(tag["path"].split("/")[:3 if tag["path"].startswith("plugins/") else 2])
        unnamed = tag["path"] if "__anon" in tag.get("scope", "") else ""  # each file has its own
        scopes = [name for name in (*tag.get("scope", "").split("::"), *names) if name and not name.startswith("__anon")]
        return f"{module} {'::'.join(scopes)}", unnamed

    for tag in tags:
        if tag["kind"] in ("class", "struct") and "end" in tag:
            lines[class_of(tag, tag["name"])] += tag["end"] - tag["line"] + 1
            bodies[class_of(tag, tag["name"])].append((tag["path"], tag["line"], tag["end"]))
    for tag in tags:
        owner = class_of(tag)
        if owner not in bodies:
            continue
        inside = any(path == tag["path"] and first <= tag["line"] <= last for path, first, last in bodies[owner])
        if tag["kind"] == "function" and "end" in tag and not inside:
            lines[owner] += tag["end"] - tag["line"] + 1
        if tag["kind"] == "member" and not re.match(r"/\^\s*static\b", tag["pattern"]):
            members[owner] += 1
    sizes = collections.defaultdict(lambda: (0, 0))
    for owner in lines:
        sizes[owner[0]] = (max(sizes[owner[0]][0], lines[owner]), max(sizes[owner[0]][1], members[owner]))
    return sizes


def check_classes():
    sizes = class_sizes([path for path, _ in sources("sdk/host", "plugins", "sdk/tools")])
    if len(sizes) < 700:
        wrong.append(f"ctags found {len(sizes)} classes only")
    large = {name for name, (lines, members) in sizes.items() if lines > MAX_CLASS_LINES or members > MAX_DATA_MEMBERS}
    for name in sorted(large - LARGE_CLASSES):
        wrong.append(f"class {name} has {sizes[name][0]} lines over all files and {sizes[name][1]} data members, {MAX_CLASS_LINES} and {MAX_DATA_MEMBERS} at most")
    for name in sorted(LARGE_CLASSES - large):
        wrong.append(f"class {name} is no longer large: strike it from the list in modules.py")


def check_class_sizes():
    """Tests the measure on classes of known size."""
    files = {"sdk/host/a.hpp": "namespace n {\nclass A {\n  int inside() {\n    return 1;\n  }\n  void outside();\n  struct B {\n    int y;\n  };\n"
                               "  static constexpr int kNone = 0;\n  int x, z = 2;\n  B b;\n};\n}\n",
             "sdk/host/a.cpp": "namespace n {\nvoid A::outside() {\n  x = 1;\n}\nvoid free() {\n}\n}\n",
             "sdk/host/b.cpp": "namespace {\nstruct A {\n  int x;\n};\n}\n"}
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
            with open(os.path.join(folder, path), "w", encoding="utf-8") as file:
                file.write(text)
        sizes = class_sizes(files, folder)
    expected = {"sdk/host n::A": (12 + 3, 3), "sdk/host n::A::B": (3, 1), "sdk/host A": (3, 1)}
    if dict(sizes) != expected:
        wrong.append(f"classes are measured as {dict(sizes)}; expected {expected}")


def check_system(path, text):
    """Operating system use in the SDK: only platform/ and the listed files."""
    if not path.startswith("sdk/") or path.startswith("sdk/host/platform/"):
        return
    found = SYSTEM.search(without_comments(text))
    if found and path not in SYSTEM_FILES:
        wrong.append(f"{path}: {found[0]}: sdk/host/platform alone knows an operating system")
    if not found and path in SYSTEM_FILES:
        wrong.append(f"{path} knows no operating system any more: strike it from the list in modules.py")


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"", "", text, flags=re.S)


def check_system_rule():
    """The rule itself, on lines that break it and on lines that do not."""
    for line in ("#include <unistd.h>", "#include <sys/mman.h>", "# include <csignal>", "  if (fork() == 0)", "#if defined(_WIN32)", "x = mmap (0"):
        if not SYSTEM.search(without_comments(line + "\n")):
            wrong.append(f"the rule of operating systems lets '{line}' pass")
    for line in ("#include <vector>", "// a child by fork()", 'say("mmap(")', "thread.join();", "system_step(x);"):
        if SYSTEM.search(without_comments(line + "\n")):
            wrong.append(f"the rule of operating systems refuses '{line}'")


def check_draws(path, text):
    """Random numbers drawn in two arguments of one call: GCC evaluates them from right to left on x86-64 and from left to right on arm64,
    as clang does everywhere, so that a seed would stand for another recording. In braces the order is the written one. An argument draws if
    it names a generator (to pass it on draws nothing) or calls a function of the same file that does."""
    code, open_brackets = without_comments(text), []
    functions = [rf"|(?<![.\w>]){a or b}\(" for a, b in DRAWING.findall(code)]
    draw = re.compile(GENERATOR + "".join(functions))
    for i, c in enumerate(code):
        if c in "([{":
            open_brackets.append((c, [i + 1]))
        elif c == "," and open_brackets:
            open_brackets[-1][1].append(i + 1)
        elif c in ")]}" and open_brackets:
            bracket, starts = open_brackets.pop()
            arguments = (code[a:b - 1].strip() for a, b in zip(starts, starts[1:] + [i + 1]))
            drawn = sum(bool(draw.search(argument)) and not re.fullmatch(GENERATOR, argument) for argument in arguments)
            if bracket == "(" and drawn > 1:
                wrong.append(f"{path}: {' '.join(code[starts[0]:i].split())}: two arguments draw random numbers, in an order that is not defined")


def check_draw_rule():
    """The rule itself, as the system's."""
    rejected = ("f(random.normal(), random_.uniform(0, 1))", "Vector3d(0, g(random.next()), 2 * random.normal())", "f(noise(generator), noise(generator))",
                "const auto noise = [&](double s) { return s * random.normal(); }; f(noise(1), noise(2))",
                "double noise() { return normal(generator_); } f(noise(), noise())")
    for line in rejected + ("Vector3d{random.normal(), random.normal()}", "f(random.normal(), x)", "f({random.normal(), random.normal()}, 3)",
                            "f(random, random.normal())", "double noise() { return normal(generator); } f(noise(), plane.noise())"):
        before = len(wrong)
        check_draws("", line)
        found = len(wrong) > before
        del wrong[before:]
        if found != (line in rejected):
            wrong.append(f"the rule of random numbers is wrong about '{line}'")


edges = collections.defaultdict(set)
for path, text in sources("abi", "sdk", "plugins", "samples"):
    for other in included(path, text):
        check_include(path, other)
        if os.path.dirname(path) != os.path.dirname(other):
            edges[os.path.dirname(path)].add(os.path.dirname(other))
    name = os.path.basename(path)
    if path.startswith("plugins/") and "#include <odograph/" in text and name not in GLUE:
        wrong.append(f"{path} includes the ABI: an algorithm knows nothing of it")
    if path.startswith("sdk/math/") and name not in GLUE:
        wrong += [f"{path} includes <{name}>: sdk/math sees itself, Eigen and the standard library"
                  for name in re.findall(r"#include <([^>]+)>", text) if not re.fullmatch(r"Eigen/\w+|[a-z_]+", name)]
    check_system(path, text)
    if path.startswith(("sdk/host/", "sdk/math/")) and HEAVY.search(text):
        wrong.append(f"{path}: the host uses a heavy library")
    if path.startswith(("sdk/host/", "sdk/math/", "plugins/")) and path not in ENVIRONMENT:
        for number, line in enumerate(text.splitlines(), 1):
            if LOUD.search(line):
                wrong.append(f"{path}:{number}: a library writes to the terminal, ends the program or reads its environment")
for path, text in sources("abi", "sdk", "plugins", "samples", "tests"):
    check_draws(path, text)
check_cycles(edges)
check_system_rule()
check_draw_rule()
check_lengths()
if has_ctags():
    check_functions()
    check_class_sizes()
    check_classes()
if wrong:
    sys.exit("\n".join(wrong))
if not has_ctags():
    print("SKIPPED: no universal-ctags, so no function and no class was measured")
    sys.exit(77)
