#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""structure.py ROOT [--write]: the figure of the structure in docs/architecture.md, drawn from the includes: folders, their lines, and who
includes whom (without arrows that follow from others). Fails if the figure in the document differs; --write replaces it."""
import os
import re
import sys

ROOT, WRITE = sys.argv[1], "--write" in sys.argv[2:]
PAGE = os.path.join(ROOT, "docs/architecture.md")
BEGIN, END = "<!-- structure.py: begin -->\n", "<!-- structure.py: end -->\n"


def room(path):
    """The node of a file: a folder of the host, a kind of plugin, or a top-level part."""
    parts = path.split("/")
    if path.startswith(("sdk/host/", "plugins/")) and len(parts) > 3:
        return "/".join(parts[:3] if parts[0] == "sdk" else parts[:2])
    return "abi/include" if parts[0] == "abi" else "samples" if parts[0] == "samples" else "/".join(parts[:2])


def read():
    lines, edges = {}, {}
    for top in ("abi/include", "sdk", "plugins", "samples"):
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            for name in names:
                path = os.path.relpath(os.path.join(folder, name), ROOT)
                if not name.endswith((".c", ".h", ".cpp", ".hpp")) or (path.startswith("sdk/host/") and path.count("/") < 3):
                    continue
                with open(os.path.join(ROOT, path), encoding="utf-8") as file:
                    text = file.read()
                here = room(path)
                lines[here] = lines.get(here, 0) + text.count("\n")
                for other in re.findall(r'^\s*#\s*include\s+["<]([^">]+)[">]', text, re.M):
                    there = "abi/include" if other.startswith("odograph/") else room(other) if os.path.exists(os.path.join(ROOT, other)) else here
                    if there != here:
                        edges.setdefault(here, set()).add(there)
    return lines, {a: {b for b in edges[a] if b in lines} for a in edges}


def reaches(edges, start):
    seen, todo = set(), [start]
    while todo:
        for other in edges.get(todo.pop(), ()):
            if other not in seen:
                seen.add(other)
                todo.append(other)
    return seen


def figure():
    lines, edges = read()
    text = ["```mermaid", "flowchart TD"]
    number = {name: f"n{i}" for i, name in enumerate(sorted(lines))}
    for name in sorted(lines):
        # Two digits: a small change of the code leaves the figure as it is.
        text.append(f'  {number[name]}["{name}<br>{float(f"{lines[name]:.2g}") / 1000:g}k lines"]')
    for a in sorted(edges):
        implied = set().union(*(reaches(edges, b) for b in edges[a]))
        text += [f"  {number[a]} --> {number[b]}" for b in sorted(edges[a] - implied)]
    return "\n".join(text + ["```"]) + "\n"


with open(PAGE, encoding="utf-8") as file:
    page = file.read()
before, after = page.index(BEGIN) + len(BEGIN), page.index(END)
if WRITE:
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(page[:before] + figure() + page[after:])
elif [line for line in page[before:after].splitlines() if "-->" in line] != [line for line in figure().splitlines() if "-->" in line]:
    sys.exit("docs/architecture.md: the figure of the structure is no longer that of the includes; tests/house/structure.py ROOT --write draws it")
