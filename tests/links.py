#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links of Markdown files to files and headings of the project lead somewhere."""
import os
import re
import subprocess
import sys

ROOT = sys.argv[1]
LINK = re.compile(r"\]\(([^)\s]+)\)")


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


wrong, count = [], 0
for document in subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], capture_output=True, text=True, check=True).stdout.split():
    with open(f"{ROOT}/{document}", encoding="utf-8") as file:
        text = re.sub(r"```.*?```|`[^`\n]*`", "", file.read(), flags=re.S)
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
print("\n".join(wrong) or f"{count} links lead somewhere")
sys.exit(bool(wrong))
