# SPDX-License-Identifier: Apache-2.0
"""page_figures.py REPORT SUMMARY: the page of a run shows its summary's values, and makes no external request."""
import json
import re
import sys

page = open(sys.argv[1], encoding="utf-8").read()
summary = json.load(open(sys.argv[2], encoding="utf-8"))
data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.S).group(1))
run = data["runs"][0]
table = dict(run["table"])
failures = []


def same(what, on_page, in_summary):
    if on_page != in_summary:
        failures.append(f"{what}: {on_page!r} on the page, {in_summary!r} in the summary")


same("poses", len(run["t"]), summary["poses"])
same("numbers of positions", len(run["p"]), 3 * summary["poses"])
same("numbers of orientations", len(run["q"]), 4 * summary["poses"])
same("distance", table["Distance"], f"{summary['distance_m']:.2f} m")
same("steps", table["Steps"], str(summary["steps"]))
same("steps in the chart", len(run["steps"]["t"]), summary["steps"])
same("frames", table["Camera frames"], str(summary["frames"]))
states = summary["states_s"]
same("states", table["Tracking, degraded, lost"], f"{states['tracking']:.1f}, {states['degraded']:.1f}, {states['lost']:.1f} s")
same("config", run["config"], summary["config"])
if data["truth"]:
    errors = run["error"]["y"]
    rms = (sum(e * e for e in errors) / len(errors)) ** 0.5
    if abs(float(table["Error, rms"].split()[0]) - rms) > 1e-3:
        failures.append(f"error: {table['Error, rms']} in the table, {rms} by the chart")
    # With the page's alignment the error of the track equals the page's figure.
    (w, *v), shift, scale = run["laid"]["q"], run["laid"]["p"], run["laid"]["s"]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    p = [scale * x for x in run["p"][-3:]]
    u = cross(v, p)
    r = cross(v, u)
    laid = [p[k] + 2 * (w * u[k] + r[k]) + shift[k] for k in range(3)]
    distance = sum((a - b) ** 2 for a, b in zip(laid, data["truth"]["p"][-3:])) ** 0.5
    if abs(distance - errors[-1]) > 0.05:
        failures.append(f"the last place is {distance} m from the truth's, the chart says {errors[-1]}")
elsewhere = re.findall(r'(?:src|href)\s*=\s*["\'](?:https?:)?//[^"\']*|@import|url\(\s*["\']?http', page)
if elsewhere:
    failures.append(f"not self-contained: {elsewhere}")
for failure in failures:
    print("FAILED:", failure)
if not failures:
    print("the page holds what the summary says")
sys.exit(bool(failures))
