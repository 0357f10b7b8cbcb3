#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The fleet's table and its report.

  report.py OUT CONFIG ...   the others are compared with the first config

An interval is the 95 % percentile bootstrap of a mean over walks, 2000 draws; that of a difference draws walks, not rows, so that an
easy walk is easy for both configs. The draws are seeded: the same rows give the same report.
"""
import csv
import glob
import json
import random
import sys

DRAWS = 2000
FIGURES = {"distance_percent": "distance, % off", "position_m": "position, m off", "count_percent": "step count, % off"}


def mean(values):
    return sum(values) / len(values)


def interval(values):
    draw = random.Random(0)
    means = sorted(mean(draw.choices(values, k=len(values))) for _ in range(DRAWS))
    return means[int(0.025 * DRAWS)], means[int(0.975 * DRAWS) - 1]


def cell(values):
    if not values:
        return "-"
    if len(values) == 1:
        return f"{values[0]:.2f} (one walk)"
    low, high = interval(values)
    return f"{mean(values):.2f} [{low:.2f}, {high:.2f}]"


def line(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |\n"


out, names = sys.argv[1], sys.argv[2:]
rows = [json.load(open(path)) for path in sorted(glob.glob(f"{out}/rows/*/*/*.json"))]
rows = [row for row in rows if row["config"] in names]
columns = sorted({key for row in rows for key in row}, key=lambda k: (k not in ("config", "data_set", "walk"), k))
with open(f"{out}/table.csv", "w", newline="") as file:
    table = csv.DictWriter(file, columns)
    table.writeheader()
    table.writerows({k: json.dumps(v, sort_keys=True) if isinstance(v, dict) else v for k, v in row.items()} for row in rows)

data_sets = sorted({row["data_set"] for row in rows})
text = "# Fleet\n\nMeans of what each walk is off by, with their 95 % intervals over walks.\n\n"
text += line("config", "data set", "walks", "failed", *FIGURES.values()) + line(*["---"] * (4 + len(FIGURES)))
errors = {}
for name in names:
    for data_set in data_sets:
        chosen = [row for row in rows if row["config"] == name and row["data_set"] == data_set]
        cells = []
        for figure in FIGURES:
            known = {row["walk"]: abs(row[figure]) for row in chosen if row.get(figure) is not None}
            errors[name, data_set, figure] = known
            cells.append(cell(list(known.values())))
        text += line(name, data_set, len(chosen), sum("failure" in row for row in chosen), *cells)
if len(names) > 1:
    text += f"\n## Against {names[0]}, walk by walk (negative: better)\n\n"
    text += line("config", "data set", *FIGURES.values()) + line(*["---"] * (2 + len(FIGURES)))
    for name in names[1:]:
        for data_set in data_sets:
            cells = []
            for figure in FIGURES:
                first, other = errors[names[0], data_set, figure], errors[name, data_set, figure]
                cells.append(cell([other[walk] - first[walk] for walk in sorted(other.keys() & first.keys())]))
            text += line(name, data_set, *cells)
failed = [row for row in rows if "failure" in row]
if failed:
    text += "\n## Failed\n\n" + line("config", "data set", "walk", "what") + line(*["---"] * 4)
    text += "".join(line(row["config"], row["data_set"], row["walk"], row["failure"].replace("|", "\\|")) for row in failed)
made = sorted({(row.get("odograph"), row["config"], row["config_sha256"][:12]) for row in rows if "failure" not in row})
text += "\n## Made with\n\n" + line("odograph", "config", "its SHA-256") + line(*["---"] * 3) + "".join(line(*m) for m in made)
text += "\nPlugins, recordings and seeds of each row are in `table.csv`.\n"
open(f"{out}/report.md", "w").write(text)
print(text)
