#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing: small changes at places that a seed chooses, and whether a test notices each. Needs python3-clang.

    mutate.py BUILD COPY [--count 110] [--seed 1] [--budget 60] [--headers] [--programs NAME,...] [--again]

Everything happens in COPY, a copy of the tree that is built once with all mutants in it: ODO_MUTANT chooses the one that runs.
A first run of every test case records which mutants it reaches. Each mutant then runs against the cases that reach it, the
quickest first, until one fails, crashes or takes too long, or --budget seconds are used. Kept results are left out: they
show that something changed, not what is right. A stopped run continues where it was; --again repeats the survivors, with
the tests as they are now. --headers: mutates headers too, so that nearly everything is built again. BUILD is a configured folder; nothing in it is changed."""
import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

from places import HEADER, ROOT, choose, mutated

PROGRAMS = ["odograph-host-tests", "odograph-plugin-tests", "odograph-tests", "odograph-isolation-tests"]
# Suites of kept results, of real recordings, and of tools and plugins that are not mutated.
LEFT_OUT = "kept_*,*_data,calibration,camera_imu*,city,degrade,documents,evaluation*,known_object*,magyq,phone_*,simulation,skyline,terrain,vit,vo_figures,world"
SLOW_S = 15  # a case that takes longer is left out


def write(path, content):
    """Leaves a file alone that has this content, so that it is not built again."""
    if not path.exists() or path.read_bytes() != content:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def prepare(tree, mutants):
    """The tree as it is now, with all mutants."""
    for name in subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, text=True, check=True).stdout.split("\0")[:-1]:
        original = ROOT / name
        edits = [(mutant["number"], *mutant["edit"]) for mutant in mutants if mutant["file"] == name]
        if not original.is_file():
            continue
        content = original.read_bytes()
        if any(content[start:end].decode() != mutant["before"] for mutant in mutants if mutant["file"] == name for start, end, _ in [mutant["edit"]]):
            raise SystemExit(f"{name} changed since its mutants were chosen: use a new COPY")
        if edits:
            content = f'#include "{tree}/mutant.hpp"\n'.encode() + mutated(content, edits)
        write(tree / name, content)
        (tree / name).chmod(original.stat().st_mode)
    write(tree / "mutant.hpp", HEADER.read_bytes())


def build(tree, mutants, programs):
    """Builds all, without the mutants that a compiler refuses; those are returned."""
    file = tree / "refused.json"
    refused = set(json.loads(file.read_text())) if file.exists() else set()
    while True:
        prepare(tree, [mutant for mutant in mutants if mutant["number"] not in refused])
        if not (tree / "build/build.ninja").exists():
            subprocess.run(["cmake", "--preset", "release", "-DODOGRAPH_TESTS=ON", "-DODOGRAPH_DATA=/nowhere", "-DODOGRAPH_REQUIRE_DATA=OFF"], cwd=tree, check=True)
        targets = [*programs, "odograph-plugins"] if "odograph-tests" in programs else programs
        done = subprocess.run(["ninja", "-j1", "-k0", "-C", str(tree / "build"), *targets], capture_output=True, text=True, check=False)
        (tree / "build.log").write_text(done.stdout + done.stderr)
        if done.returncode == 0:
            return refused
        errors = re.findall(r"error: .*\n.*odo_mutant\((\d+)\)", done.stdout)
        if not errors:
            raise SystemExit(f"the build failed, see {tree}/build.log")
        refused |= {int(number) for number in errors}
        file.write_text(json.dumps(sorted(refused)))


def run(tree, case, limit_s, **environment):
    """The reason for which a test case fails, or None."""
    program, number = case["program"], case["number"]
    command = [str(tree / "build/bin" / program), f"--test-suite-exclude={LEFT_OUT}", f"--first={number}", f"--last={number}", "--abort-after=1"]
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(command, cwd=tree / "build/tests", env={**os.environ, "TMPDIR": folder, **environment}, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            status = process.wait(limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.wait()
            return "takes too long"
    return None if status in (0, 77) else "crashes" if status < 0 else "fails"


def list_cases(tree, programs):
    for program in programs:
        command = [str(tree / "build/bin" / program), f"--test-suite-exclude={LEFT_OUT}", "--list-test-cases", "--no-colors"]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        names = [line for line in lines if not line.startswith(("[doctest]", "===="))]
        yield from ({"program": program, "number": number + 1, "name": name} for number, name in enumerate(names))


def measure(tree, file, programs):
    """Every case without a mutant: its time and the mutants that it reaches. Known ones are not run again."""
    known = {(case["program"], case["name"]): case for case in json.loads(file.read_text())} if file.exists() else {}
    cases, reached = [], tree / "reached"
    for case in list_cases(tree, programs):
        old = known.get((case["program"], case["name"]))
        if old is None:
            reached.write_bytes(bytes(4096))
            start = time.monotonic()
            failure = run(tree, case, SLOW_S, ODO_MUTANTS_REACHED=str(reached))
            old = {"seconds": time.monotonic() - start, "failure": failure, "reaches": [number for number, byte in enumerate(reached.read_bytes()) if byte]}
            if failure:
                print(f"left out: {case['name']} ({failure} without a mutant)", flush=True)
        cases.append({**old, **case})
        known[case["program"], case["name"]] = cases[-1]
        if len(cases) % 50 == 0:
            file.write_text(json.dumps(list(known.values())))
    file.write_text(json.dumps(list(known.values())))
    return [case for case in cases if not case["failure"]]


def hunt(tree, mutant, cases, budget_s):
    """What catches a mutant: (verdict, reason, case)."""
    able = sorted((case for case in cases if mutant["number"] in case["reaches"]), key=lambda case: case["seconds"])
    start = time.monotonic()
    for tried, case in enumerate(able):
        if time.monotonic() - start > budget_s:
            return "survived", f"{tried} of {len(able)} cases in {budget_s} s", ""
        failure = run(tree, case, 5 + 5 * case["seconds"], ODO_MUTANT=str(mutant["number"]))
        if failure:
            return "caught", failure, case["name"]
    return "survived", f"all {len(able)} cases that reach it pass", ""


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("copy", type=pathlib.Path)
    options.add_argument("--count", type=int, default=110)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--budget", type=float, default=60)
    options.add_argument("--headers", action="store_true")
    options.add_argument("--programs", default=",".join(PROGRAMS))
    options.add_argument("--again", action="store_true")
    options = options.parse_args()
    tree = options.copy.resolve()
    tree.mkdir(parents=True, exist_ok=True)
    chosen, results = tree / "mutants.json", tree / "results.json"
    if not chosen.exists():
        chosen.write_text(json.dumps(choose(options.build, options.seed, options.count, options.headers), indent=1))
    mutants = json.loads(chosen.read_text())
    programs = options.programs.split(",")
    refused = build(tree, mutants, programs)
    mutants = [mutant for mutant in mutants if mutant["number"] not in refused]
    cases = measure(tree, tree / "cases.json", programs)
    verdicts = json.loads(results.read_text()) if results.exists() else {}
    for mutant in mutants:
        old = verdicts.get(str(mutant["number"]))
        if old and not (options.again and old[0] == "survived"):
            continue
        verdicts[str(mutant["number"])] = verdict = hunt(tree, mutant, cases, options.budget)
        results.write_text(json.dumps(verdicts))
        print(mutant["number"], f"{mutant['file']}:{mutant['line']}", mutant["kind"], *verdict, sep=" | ", flush=True)
    with open(tree / "table.md", "w", encoding="utf-8") as table:
        table.write("| place | change | before | verdict | how | test |\n|---|---|---|---|---|---|\n")
        for mutant in mutants:
            before = " ".join(mutant["before"].split()).replace("|", "\\|")
            table.write(f"| {mutant['file']}:{mutant['line']} | {mutant['kind']} | `{before}` | " + " | ".join(verdicts[str(mutant["number"])]) + " |\n")
    caught = sum(verdict[0] == "caught" for number, verdict in verdicts.items())
    print(f"{len(mutants)} mutants, {len(refused)} more did not compile: {caught} caught, {len(mutants) - caught} survived ({tree}/table.md)")


if __name__ == "__main__":
    main()
