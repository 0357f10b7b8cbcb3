#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `odograph city check` on generated hostile models and, if given, a copy of 3DGI/cityjson-corpus: each
valid file must load, each invalid one be rejected with a message, in at most 2 s of processor time and 500 MB. Prints a
table.
Usage: city_files.py ODOGRAPH [CORPUS]; ODOGRAPH_SLOWER=10 permits ten times the processor time, for an emulated processor"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

MOST_S, MOST_MB = 2.0 * float(os.environ.get("ODOGRAPH_SLOWER", "1")), 500
BAD_DATA = 3  # exit status of odograph


def check(program, file):
    """Exit status, output, seconds of processor time and MB."""
    child = subprocess.Popen([program, "city", "check", str(file)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    said = child.stdout.read().decode(errors="replace").strip()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, said, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def surface(rings, vertices, **more):
    building = {"type": "Building", "geometry": [{"type": "MultiSurface", "lod": "1", "boundaries": [rings]}]}
    return {"type": "CityJSON", "version": "2.0", "CityObjects": {"a": building}, "vertices": vertices, **more}


def holes(count):
    """A wall with `count` windows."""
    across = math.ceil(math.sqrt(count))
    size = 4 * across + 4
    vertices, rings = [[0, 0, 0], [size, 0, 0], [size, size, 0], [0, size, 0]], [[0, 1, 2, 3]]
    for k in range(count):
        x, y, first = 4 * (k % across) + 2, 4 * (k // across) + 2, len(vertices)
        vertices += [[x, y, 0], [x, y + 1, 0], [x + 1, y + 1, 0], [x + 1, y, 0]]
        rings.append([first, first + 1, first + 2, first + 3])
    return surface(rings, vertices)


def scribble(count):
    """A ring that crosses itself at almost every edge."""
    corners = [[k * 7919 % 10007, k * 104729 % 10009, 0] for k in range(count)]
    return surface([list(range(count))], corners)


def write_hostile(folder):
    """Files that have crashed readers of city models, and whether each must be rejected."""
    triangle = [[0, 0, 0], [9, 0, 0], [0, 9, 0]]
    texts = {
        "holes_90.json": (json.dumps(holes(90)), False),
        "holes_1000.json": (json.dumps(holes(1000)), False),
        "holes_4000.json": (json.dumps(holes(4000)), False),
        "scribble_20000.json": (json.dumps(scribble(20000)), True),
        "vertex_1e400.json": (json.dumps(surface([[0, 1, 2]], triangle)).replace("9, 0", "1e400, 0"), True),
        "vertex_2_64.json": (json.dumps(surface([[0, 1, 2]], [[2**64, 0, 0]] + triangle[1:])), True),
        "translate_1e300.json": (json.dumps(surface([[0, 1, 2]], triangle, transform={
            "scale": [1, 1, 1], "translate": [1e300, 0, 0]})), True),
        "outside_extent.json": (json.dumps(surface([[0, 1, 2]], triangle, metadata={
            "geographicalExtent": [0, 0, 0, 1, 1, 1]})), False),
        "nested.json": ("[" * 100000, True),
        "cut.json": (json.dumps(surface([[0, 1, 2]], triangle))[:-9], True),
        "empty.json": ("", True),
        "zero_material.obj": ("mtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", False),
        "no_vertex.obj": ("v 0 0 0\nf 1 2 3\n", True),
        "cut.gml": ("<CityModel><cityObjectMember><Building>", True),
        "page.gml": ("<html></html>", True),
        "nested.gml": ("<CityModel>" + "<a>" * 100000, True),
        "laughs.gml": ("<!DOCTYPE a [<!ENTITY e0 'ha'>" + "".join(
            f"<!ENTITY e{k} '{f'&e{k - 1};' * 10}'>" for k in range(1, 12)) + "]><CityModel>&e11;</CityModel>", True),
    }
    for name, (text, _) in texts.items():
        (folder / name).write_text(text)
    (folder / "large.json").write_text("{")
    os.truncate(folder / "large.json", 300_000_000)
    (folder / "zero.json").symlink_to("/dev/zero")
    os.mkfifo(folder / "fifo.json")
    cases = [(folder / name, wrong) for name, (_, wrong) in texts.items()]
    return cases + [(folder / name, True) for name in ("large.json", "zero.json", "fifo.json")]


def judge(program, cases, root):
    failed = 0
    for file, invalid in cases:
        code, said, cpu_s, mb = check(program, file)
        right = code == (BAD_DATA if invalid else 0) and said != "" and (not invalid or (cpu_s <= MOST_S and mb <= MOST_MB))
        failed += not right
        first = said.split("\n")[-1 if "warning" in said else 0].replace(str(file) + ": ", "").strip()
        print(f"{'ok   ' if right else 'WRONG'} {'invalid' if invalid else 'valid':8}{cpu_s:6.2f} s {mb:6.0f} MB  "
              f"{file.relative_to(root)}: {first[:120]}")
    print(f"{len(cases)} files, {sum(wrong for _, wrong in cases)} of them invalid; {failed} answered wrongly")
    return failed


def main():
    program, corpus = sys.argv[1], pathlib.Path(sys.argv[2] if len(sys.argv) > 2 and sys.argv[2] else "/nowhere")
    with tempfile.TemporaryDirectory() as folder:
        failed = judge(program, write_hostile(pathlib.Path(folder)), folder)
    about = ("case.json", "invariants.json", "profile.json", "acquisition.json")  # metadata files, not models
    files = sorted(f for f in (corpus / "cases").rglob("*.json*") if f.name not in about)
    if files:
        failed += judge(program, [(f, "invalid" in f.relative_to(corpus).parts) for f in files], corpus / "cases")
    else:
        print("no corpus there")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
