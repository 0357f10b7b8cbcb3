#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Markdown: links to files and headings lead somewhere, tests that are cited exist, prose has at most 120 columns."""
import os
import re
import subprocess
import sys

ROOT = sys.argv[1]
LINK = re.compile(r"\]\(([^)\s]+)\)")
COLUMNS = 120
# A word that no line can be broken within: links and code with their spaces, and what adjoins them.
WORD = re.compile(r"(?:\[[^\]]*\]\([^)]*\)|`[^`]*`|\S)+")


def anchors(path):
    """As GitHub makes them of headings."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"```.*?```", "", file.read(), flags=re.S)
    found, out = {}, set(re.findall(r'<a (?:name|id)="([^"]+)"', text))
    for heading in re.findall(r"^#+ +(.*?)\s*$", text, re.M):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        anchor = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        count = found.get(anchor, 0)
        found[anchor] = count + 1
        out.add(f"{anchor}-{count}" if count else anchor)
    return out


def cited_tests(text):
    """Names in quotes: after the word test, and in the last column of a table whose head ends with it. "a ... b": both parts."""
    text = re.sub(r"`[^`]*`", "", text)
    cells = [row.rsplit("|", 2)[1] for table in re.findall(r"^\|.*\| test \|\n((?:\|.*\n)+)", text, re.M) for row in table.splitlines()]
    names = re.findall(r'[Tt]ests? "([^"]+)"', text) + [name for cell in cells for name in re.findall(r'"([^"]+)"', cell)]
    return [" ".join(part.split()) for name in names for part in name.split("...") if part.strip()]


def long_lines(text):
    """Numbers of prose lines that are too long; not in tables, headings, pictures, code and equations."""
    blank = lambda found: re.sub(r"[^\n]", "", found.group(0))
    text = re.sub(r"(?ms)^ *```.*?^ *```", blank, text)
    text = re.sub(r"(?m)(?<=\n\n)(?: {4,}(?![*-] |\d+\. ).*\n)+", blank, text)
    return [number for number, line in enumerate(text.split("\n"), 1)
            if len(line.rstrip()) > COLUMNS and not re.match(r"\s*(\||#|!\[)", line) and len(WORD.findall(line)) > 1]


def all_tests():
    sources = subprocess.run(["git", "-C", ROOT, "grep", "-hI", "", "--", "tests/*.cpp"], capture_output=True, check=True).stdout
    return " ".join(re.sub(r'"\s*\n\s*"', "", sources.decode("utf-8", "replace")).split())


wrong, count, cited, tests = [], 0, 0, all_tests()
for document in subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], capture_output=True, text=True, check=True).stdout.split():
    with open(f"{ROOT}/{document}", encoding="utf-8") as file:
        original = file.read()
    if not re.match(r"CHANGELOG|LICENSE|docs/pictures/", document):
        wrong += [f"{document}:{number}: more than {COLUMNS} columns" for number in long_lines(original)]
    whole = re.sub(r"```.*?```", "", original, flags=re.S)
    text = re.sub(r"`[^`\n]*`", "", whole)
    for name in cited_tests(whole) if document != "CHANGELOG.md" else []:
        cited += 1
        if name not in tests:
            wrong.append(f'{document}: no test "{name}"')
    for link in LINK.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        count += 1
        name, _, anchor = link.partition("#")
        path = os.path.normpath(os.path.join(ROOT, os.path.dirname(document), name)) if name else f"{ROOT}/{document}"
        if not os.path.exists(path):
            wrong.append(f"{document}: no file {name}")
        elif anchor and path.endswith(".md") and anchor not in anchors(path):
            wrong.append(f"{document}: no heading #{anchor} in {name or document}")
print("\n".join(wrong) or f"{count} links lead somewhere, {cited} tests are cited")
sys.exit(bool(wrong))
