#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The mutation tool on a small file: each kind of change is found and compiles, a check notices it, and what no check covers survives.

    sample_test.py COMPILER"""
import os
import pathlib
import subprocess
import sys
import tempfile

from places import HEADER, Places, mutated

SAMPLE = pathlib.Path(__file__).parent / "sample.cpp"
KINDS = {"arithmetic", "boundary", "comparison", "condition", "constant", "logic", "returned value", "statement removed"}

places = Places(SAMPLE, ["-x", "c++", "-std=c++20", "-include", str(HEADER)])
checks = places.text.index(b"int main")
found = [(kind, *place) for kind, all_of_kind in sorted(places.found.items()) for place in all_of_kind if place[0] < checks]
assert {kind for kind, *_ in found} == KINDS, found
forbidden = {number for number, line in enumerate(places.text.splitlines()) if b"constexpr" in line or b"static_assert" in line or b'"' in line}
wrong = []
with tempfile.TemporaryDirectory() as folder:
    for number, (kind, start, end, new) in enumerate(found):
        line = places.text[:start].count(b"\n")
        assert line not in forbidden, f"line {line + 1} must not be mutated"
        source, program = pathlib.Path(folder) / "sample.cpp", f"{folder}/sample"
        source.write_bytes(f'#include "{HEADER}"\n'.encode() + mutated(places.text, [(number, start, end, new)]))
        subprocess.run([sys.argv[1], "-std=c++20", "-O0", "-o", program, str(source)], check=True)
        plain = subprocess.run([program], check=False).returncode
        caught = subprocess.run([program], env={**os.environ, "ODO_MUTANT": str(number)}, check=False).returncode != 0
        if plain != 0 or caught != (b"untested" not in places.text.splitlines()[line]):
            wrong.append(f"line {line + 1}, {kind}: {'caught' if caught else 'survived'}, without the mutant status {plain}")
print("\n".join(wrong) or f"{len(found)} mutants behave as they should")
sys.exit(bool(wrong))
