# SPDX-License-Identifier: Apache-2.0
"""snippets.py SOURCE: every block of docs/languages.md occurs in a sample of samples/walk, line by line."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
samples = {path.name: [line.strip() for line in path.read_text().splitlines()] for path in (root / "samples/walk").iterdir()}
blocks = re.findall(r"```(\w+)\n(.*?)```", (root / "docs/languages.md").read_text(), flags=re.S)
wrong = []
for language, text in blocks:
    wanted = [line.strip() for line in text.splitlines()]
    if not any(wanted == lines[i:i + len(wanted)] for lines in samples.values() for i in range(len(lines))):
        wrong.append(f"docs/languages.md: no sample has this {language}:\n{text}")
print("\n".join(wrong))
sys.exit(len(wrong) > 0 or len(blocks) < 8)
