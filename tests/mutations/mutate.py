#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation test: small changes at lines that a seed draws, one at a time, and which test notices each.

    git worktree add ../mutants && cd ../mutants && cmake --preset release -DODOGRAPH_TESTS=ON && cmake --build --preset release
    python3 tests/mutations/mutate.py build [--count 30] [--seed 1] [--budget 600] [--jobs 2] [--tests REGEX] [--again]

BUILD is a Ninja build of a tree that may be changed: each mutant is written into it, built and tested, and the file restored. The tests are
those whose command has a program or library that ninja builds of the mutated file; they run by `ctest --stop-on-failure`, quick ones first,
for at most --budget seconds after the build, of those that match --tests. A test that uses the processor for five times as long as without a
mutant has noticed it; on a busy machine it may take longer. Kept results take no part: they show that something changed, not what is right. Nor do tests
that fail without a mutant: the first run executes all tests once. A stopped run continues where it was (BUILD/mutants.json); --again
repeats the survivors with the tests as they are now, on the same lines."""
import argparse
import json
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import time

# Drawn in turn, so that each top-level folder has its part.
FOLDERS = ["sdk", "plugins", "sdk", "plugins", "sdk", "plugins", "abi/include", "samples"]
LEFT_OUT = re.compile(r"^kept_")
BATCHES_S = [1, 10, 60, 1e9]  # tests of up to this long run together, so that quick ones come first
SWAPS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/", "/": "*", "&&": "||", "||": "&&",
         "+=": "-=", "-=": "+="}
OPERATOR = re.compile(r"(?<= )(" + "|".join(re.escape(key) for key in sorted(SWAPS, key=len, reverse=True)) + r")(?= )")
CONSTANT = re.compile(r"(?<![\w.'<])\d[\d']*(\.\d*(?:e[-+]?\d+)?|e[-+]?\d+)?(?![\w.'>])")
CONDITION = re.compile(r"(?<=\b(?:if|or) )\((?!const |auto |int )[^;()]*(?:\([^()]*\)[^;()]*)*\)(?= |$)|(?<=while )\([^;()]*(?:\([^()]*\)[^;()]*)*\)(?= |$)")
STATEMENT = re.compile(r"^\s+(?!return\b|throw\b|delete\b|using\b|typedef\b|break\b|continue\b|goto\b)[\w.:\[\]>*-]+(?:\(.*\)| [-+*/|&]?= .*);$")
NOT_CODE = re.compile(r"^\s*(#|//|\*|/\*|using\b|template\b|static_assert|extern\b|typedef\b|enum\b|namespace\b)|\bconstexpr\b|\boperator\b")


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def output_within(seconds, cpu_s, command, folder):
    """What a command prints until it ends or the time is over; then it is stopped with all programs that it started, none of which may use the
    processor for longer than cpu_s."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))) as started:
        try:
            return started.communicate(timeout=seconds)[0]
        except subprocess.TimeoutExpired:
            os.killpg(started.pid, signal.SIGKILL)
            return started.communicate()[0]


def blanked(line):
    """A line with spaces in place of its texts and comment."""
    return re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'|//.*|/\*.*?\*/', lambda found: " " * len(found.group(0)), line)


def changes(line):
    """What can be done to a line of code: (kind, new line)."""
    code, found = blanked(line), []
    if NOT_CODE.search(code):
        return found
    for match in OPERATOR.finditer(code):
        found.append((f"{match.group(1)} to {SWAPS[match.group(1)]}", line[:match.start()] + SWAPS[match.group(1)] + line[match.end():]))
    for match in CONSTANT.finditer(code):
        new = f"({match.group(0)} * 2)" if match.group(1) and re.search("[1-9]", match.group(0)) else f"({match.group(0)} + 1)"
        found.append(("constant", line[:match.start()] + new + line[match.end():]))
    for match in CONDITION.finditer(code):
        found.append(("condition negated", line[:match.start()] + f"(!{line[match.start():match.end()]})" + line[match.end():]))
    if STATEMENT.match(code.rstrip()) and code.count("(") == code.count(")") and line.strip() == code.strip():
        found.append(("statement removed", re.match(r"\s*", line).group(0) + ";"))
    return found


class Build:
    """What ninja and ctest say about a build folder."""

    def __init__(self, folder, tests):
        self.folder = folder.resolve()
        cache = (self.folder / "CMakeCache.txt").read_text()
        self.root = pathlib.Path(re.search(r"CMAKE_HOME_DIRECTORY:INTERNAL=(.*)", cache).group(1))
        self.objects = {}  # of each file of the tree
        built, names = None, {}
        for line in run("ninja", "-C", str(self.folder), "-t", "deps").stdout.splitlines():
            if not line.startswith(" "):
                built = line.split(": ")[0]
            elif line:
                if line not in names:
                    path = (self.folder / line.strip()).resolve()
                    ours = path.is_relative_to(self.root) and not path.is_relative_to(self.folder)
                    names[line] = str(path.relative_to(self.root)) if ours else ""
                if names[line]:
                    self.objects.setdefault(names[line], []).append(built)
        listed = json.loads(run("ctest", "--show-only=json-v1", cwd=self.folder).stdout)["tests"]
        self.commands = {test["name"]: test["command"] for test in listed
                         if "command" in test and re.search(tests, test["name"]) and not LEFT_OUT.search(test["name"])}

    def local(self, name):
        path = pathlib.Path(name)
        return str(path.relative_to(self.folder)) if path.is_relative_to(self.folder) else name

    def outputs_of(self, name):
        """All that is built again after a change of the file."""
        seen, new = set(self.objects[name]), list(self.objects[name])
        while new:
            lines = run("ninja", "-C", str(self.folder), "-t", "query", *new[:500]).stdout.splitlines()
            new, is_output = new[500:], False
            for line in lines:
                if line.startswith("  ") and not line.startswith("   "):
                    is_output = line.strip() == "outputs:"
                elif is_output and line.startswith("    ") and (output := line.strip()) not in seen:
                    seen.add(output)
                    new.append(output)
        return seen

    def tests_of(self, name):
        """Test -> the programs and libraries in its command that depend on the file."""
        outputs = self.outputs_of(name)
        needed = {test: [self.local(word) for word in command if self.local(word) in outputs] for test, command in self.commands.items()}
        return {test: words for test, words in needed.items() if words}

    def measured(self):
        """Seconds of each test, and those that failed in the last run."""
        costs, _, failed = (self.folder / "Testing/Temporary/CTestCostData.txt").read_text().partition("---\n")
        return {line.split()[0]: float(line.split()[2]) for line in costs.splitlines()}, failed.split()

    def compile(self, targets, jobs):
        return run("ninja", "-C", str(self.folder), f"-j{jobs}", *sorted(targets)).returncode == 0

    def first_failure(self, tests, seconds, jobs, budget_s):
        """The test that fails, or None; and how many were started."""
        start, started, slower_than = time.monotonic(), 0, -1
        for limit in BATCHES_S:
            batch = [test for test in tests if slower_than < seconds.get(test, 5) <= limit]
            slower_than, left_s = limit, budget_s - (time.monotonic() - start)
            if not batch or left_s <= 0:
                continue
            names = "^(" + "|".join(re.escape(test) for test in batch) + ")$"
            limit_s = int(10 + 5 * max(seconds.get(test, 5) for test in batch))  # of the processor; on a busy machine it takes longer
            command = ["ctest", "--stop-on-failure", f"-j{jobs}", "--timeout", str(10 * limit_s), "-R", names]
            text = output_within(left_s, limit_s, command, self.folder)
            started += len(re.findall(r"Test +#\d+:", text))
            if found := re.search(r"Test +#\d+: (\S+) .*\*\*\*(?!Skipped|Not Run)(Timeout)?", text):
                return found.group(1) + (", which took too long" if found.group(2) else ""), started
        return None, started


def draw(build, seed, number):
    """The mutant of that number: (file, index of its line, kind, new line)."""
    chance = random.Random(f"{seed} {number}")
    folder = FOLDERS[number % len(FOLDERS)] + "/"
    endings = (".hpp",) if folder.startswith("abi") else (".c", ".cpp", ".hpp")
    files = sorted(name for name in build.objects if name.startswith(folder) and name.endswith(endings))
    lines = {name: (build.root / name).read_text().splitlines() for name in files}
    while True:
        name = chance.choices(files, [len(lines[file]) for file in files])[0]
        at = chance.randrange(len(lines[name]))
        if found := changes(lines[name][at]):
            kinds = sorted({kind for kind, _ in found})
            kind = chance.choice(kinds)
            return name, at, kind, chance.choice([new for one, new in found if one == kind])


def verdict_of(build, mutant, options, measured, state):
    name, at, _, new = mutant
    seconds, failing = measured
    tests = {test: words for test, words in build.tests_of(name).items() if test not in failing}
    if not tests:
        return {"verdict": "survived", "by": "no test links the file"}
    lines = (build.root / name).read_text().splitlines()
    lines[at] = new
    (build.root / name).write_text("\n".join(lines) + "\n")
    targets, stale = {word for words in tests.values() for word in words}, set(state.get("stale", []))
    state["stale"] = sorted(targets | stale)
    # What the mutant before was built into is built again: tests also load plugins that are not in their command.
    if not build.compile(targets | stale, options.jobs):
        return {"verdict": "does not compile", "by": ""}
    state["stale"] = sorted(targets)
    failed, started = build.first_failure(sorted(tests), seconds, options.jobs, options.budget)
    return {"verdict": "caught", "by": failed} if failed else {"verdict": "survived", "by": f"{started} of {len(tests)} tests"}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--count", type=int, default=30)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--budget", type=float, default=600)
    options.add_argument("--jobs", type=int, default=2)
    options.add_argument("--tests", default="")
    options.add_argument("--again", action="store_true")
    options = options.parse_args()
    build, file = Build(options.build, options.tests), options.build / "mutants.json"
    state = json.loads(file.read_text()) if file.exists() else {}
    if "original" in state:  # stopped within a mutant
        (build.root / state["original"][0]).write_text(state["original"][1])
    if state.get("seed") != options.seed:
        state = {"seed": options.seed, "mutants": {}, "measured": state.get("measured"), "stale": state.get("stale", [])}
    if not state["measured"]:
        print("all tests without a mutant", flush=True)
        run("ctest", f"-j{options.jobs}", "-R", options.tests or ".", "-E", LEFT_OUT.pattern, cwd=build.folder)
        state["measured"] = build.measured()
    measured = state["measured"]
    print(f"seed {options.seed}; not used, as they fail without a mutant: {' '.join(measured[1]) or 'none'}", flush=True)
    number, rows = 0, []
    while len(rows) < options.count:
        row = state["mutants"].get(str(number))
        if not row or (options.again and row["verdict"] == "survived"):
            mutant = row["mutant"] if row else draw(build, options.seed, number)
            text = (build.root / mutant[0]).read_text()
            before = row["before"] if row else text.splitlines()[mutant[1]]
            state["original"] = [mutant[0], text]
            file.write_text(json.dumps(state))
            try:
                if text.splitlines()[mutant[1]] != before:
                    sys.exit(f"{mutant[0]}:{mutant[1] + 1} has changed since it was drawn")
                row = {"mutant": mutant, "before": before, **verdict_of(build, mutant, options, measured, state)}
            finally:
                (build.root / mutant[0]).write_text(text)
            state["mutants"][str(number)] = row
            del state["original"]
            file.write_text(json.dumps(state))
            print(number, f"{mutant[0]}:{mutant[1] + 1}", mutant[2], row["verdict"], row["by"], sep=" | ", flush=True)
        if row["verdict"] != "does not compile":
            rows.append(row)
        number += 1
    print("\n| place | change | line | verdict | test |\n|---|---|---|---|---|")
    for row in rows:
        line = row["before"].strip().replace("|", "\\|")
        print(f"| {row['mutant'][0]}:{row['mutant'][1] + 1} | {row['mutant'][2]} | `{line}` | {row['verdict']} | {row['by']} |".replace("||", "\\|\\|"))
    caught = sum(row["verdict"] == "caught" for row in rows)
    print(f"\n{caught} of {len(rows)} mutants caught; {number - len(rows)} more do not compile")


if __name__ == "__main__":
    main()
