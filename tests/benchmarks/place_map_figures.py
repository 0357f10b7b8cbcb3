#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sums up the lines of odograph-place-map-figures, a line for each file: how many queries were accepted, how many of
these are within 3 cm plus 1 % of the distance and 1 degree, the errors, and the wrong ones. Without a truth in the
lines, each accepted one is wrong, unless the file's pictures do show the place."""
import sys


def quantile(values, part):
    return sorted(values)[int(len(values) * part)] if values else float("nan")


def row_of(line):
    return {key: float(value) for key, value in (word.split("=") for word in line.split() if "=" in word)}


def is_wrong(row, far):
    return row["error_m"] > 0.3 + 0.1 * far or row["error_deg"] > 5


def visits(path):
    """Of the lines of --visits: the share that is recognised in 2 and in 3.5 s, and how well."""
    rows = [row_of(line) for line in open(path, encoding="utf-8") if line.startswith("visit ")]
    found = [row for row in rows if row["found"]]
    soon = sum(row["after"] <= 2 for row in found)
    within = sum(row["error_m"] < 0.03 + 0.01 * min(row["d"], 30) and row["error_deg"] < 1 for row in found)
    wrong = sum(is_wrong(row, min(row["d"], 30)) for row in found)
    return (f"{path}: {len(rows)} visits, {soon} recognised in 2 s, {len(found)} in 3.5 s, {within} within, {wrong} wrong; "
            f"median {quantile([row['error_m'] for row in found], 0.5):.3f} m") if rows else ""


def summary(path):
    queries = plausible = 0
    accepted, known = [], True
    highest = 0.0
    for line in open(path, encoding="utf-8"):
        if not line.startswith(("d=", "self ", "photo ", "cross ")):
            continue
        queries += 1
        row = row_of(line)
        if "plausible" not in row:
            continue
        plausible += int(row["plausible"])
        known = "error_m" in row
        if row["matched"] > 0.16 * row["visible"]:
            highest = max(highest, row["odds"])
        if row["accepted"] and row["odds"] > 40:
            accepted.append(row)
    text = f"{path}: {queries} queries, {len(accepted)} accepted, {plausible} plausible"
    if not known:
        return text + f", highest log odds with share {highest:.0f}"
    for row in accepted:
        row["far"] = min(max(row.get("d", row["range"]), 0.5), 30)
    within = sum(row["error_m"] < 0.03 + 0.01 * row["far"] and row["error_deg"] < 1 for row in accepted)
    wrong = sum(is_wrong(row, row["far"]) for row in accepted)
    values = {key: [row[key] for row in accepted] for key in ("error_m", "error_deg", "nees")}
    return text + (f", {within} within, {wrong} wrong; median and 95 %: {quantile(values['error_m'], 0.5):.3f} {quantile(values['error_m'], 0.95):.3f} m, "
                   f"{quantile(values['error_deg'], 0.5):.2f} {quantile(values['error_deg'], 0.95):.2f} deg, NEES / 6 {quantile(values['nees'], 0.5):.2f}")


for name in sys.argv[1:]:
    print("\n".join(text for text in (summary(name), visits(name)) if text))
