#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the header named by each case of the conformance suite contains its sentence, word for word. Lists the functions of
the headers that no case uses."""
import json
import re
import subprocess
import sys

program, headers = sys.argv[1:]


def words(text):
    """The text without comment marks and line breaks."""
    return re.sub(r"\s+", " ", re.sub(r"/\*|\*/|^\s*\*(?!\*)", " ", text, flags=re.M)).strip()


listed = json.loads(subprocess.run([program, "--list", "--json"], capture_output=True, text=True, check=True).stdout)["cases"]
texts, wrong, names = {}, [], set()
for case in listed:
    header = case["header"]
    if header not in texts:
        with open(f"{headers}/{header}", encoding="utf-8") as file:
            texts[header] = words(file.read())
    if words(case["sentence"]) not in texts[header]:
        wrong.append(f"{header} has no \"{case['sentence']}\" (case: {case['name']})")
    if case["name"] in names:
        wrong.append(f"two cases are named \"{case['name']}\"")
    names.add(case["name"])
print("\n".join(wrong) or f"{len(listed)} cases, each with a sentence of the headers")
sys.exit(1 if wrong else 0)
