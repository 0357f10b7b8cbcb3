#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The field's words (docs/notation.md): home-made ones are found in names, in comments and in documents."""
import re
import subprocess
import sys

ROOT = sys.argv[1]
CODE = (".c", ".h", ".cpp", ".hpp")
TEXT = (".md", ".yaml", ".json", ".py", ".sh", ".txt")

# In names: what not to say, what to say.
NAMES = [
    (r"(^|_)[wW]ays?(_|$)", "path, displacement, distance"),
    (r"(^|_)(t|kT|T)urns?(_|$)|^kTurn[A-Z]", "rotation, yaw"),
    (r"(^|_)(most|least|fewest)_[a-z]|^k(Most|Least|Fewest)(?=[A-Z_]|$)", "max, min"),
    (r"metres_per_unit|units_per_m|unit_drift|^unit_$", "scale"),
    (r"(^|_)chain(ed|s)?(_|$)|Chain", "composed motions, gyroscope attitude filter"),
    (r"(^|_)rival(_|$)|Rival", "second-best likelihood ratio"),
    (r"(^|_)rooms?(_|$)|kRoom", "module, capacity"),
    (r"(^|_)owes(_|$)|Owes", "emits"),
    (r"Haven|Trouble|WayTeacher|CarryJudge|^Climb$|^climbs?_?$|placeless|Placeless", "docs/notation.md"),
    (r"(^|_)(straighten|weigh)(_|$)|seen_turn|unseen_sigma|weigh_depths", "undistort, weight, unobserved motion sigma"),
    (r"(^|_)level(led)?_(sigma|rms|attitude)|gyro_level", "horizontal, gravity-aligned"),
]
# Names of others, and the few that mean another thing.
OTHERS = re.compile(r"waypoint|Waypoint|^at_(most|least)$|first_at_least|least_squares|level_of_detail", re.I)

# In sentences.
PHRASES = [
    (r"\bways?\b", "path, displacement, distance",
     r"way round|(either|any|same|this|that|one|other|both) ways?\b|(gives?|gave|giving) way|by the way|on (its|their|the) way|under way|ways? (to|of) [a-z]+ing|ways to|no way to|the way (back|there|home|in|out)|which way|half ?way|way (up|down)"),
    (r"\b(an?|the|its|this|that|each|every|frame's|in|no) turns?\b(?! out)", "rotation, yaw", r"in turn\b|take turns|half a turn|a quarter turn|take(s|n)? (its|their|the) turn|(an?|one) turn of"),
    (r"\blevelled\b|\bturned level\b|\blevel (acceleration|displacement|frame|camera|axis)", "horizontal, gravity-aligned", r"$^"),
    (r"\b(keeps?|changes?|knows?) (its|the|their) unit\b|\bunit (of length )?(drifts|changes|is lost)", "scale", r"$^"),
    (r"\bgyro(scope)? chain\b|\bGyroChain\b", "gyroscope attitude filter", r"$^"),
    (r"\bVO units?\b|\bwhose unit\b", "scale, up to scale", r"$^"),
    (r"\bowes\b|\bplugin owes\b", "emits", r"$^"),
]
# This list itself, what is history, and files that hold whole words of others.
SKIP = re.compile(r"^(CHANGELOG|LICENSE|tests/words\.py|tests/fuzz/seeds/|docs/pictures/)")

wrong = []


def check_names(path, number, line):
    for name in set(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", line)):
        for pattern, better in NAMES:
            if re.search(pattern, name) and not OTHERS.search(name):
                wrong.append(f"{path}:{number}: '{name}': {better}")


def check_sentence(path, number, text):
    for pattern, better, idioms in PHRASES:
        for found in re.finditer(pattern, text, re.I):
            around = text[max(0, found.start() - 30):found.end() + 30]
            if not re.search(idioms, around, re.I):
                wrong.append(f"{path}:{number}: '{around.strip()}': {better}")


def code_of(line):
    """A line without its strings and its comment, and the comment."""
    bare = re.sub(r'"(\\.|[^"\\])*"', '""', line)
    at = bare.find("//")
    if re.match(r"\s*(/\*|\*)", line):
        return "", line
    return (bare, "") if at < 0 else (bare[:at], line[line.find("//"):])


files = subprocess.run(["git", "-C", ROOT, "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines()
for path in files:
    if SKIP.match(path) or not path.endswith(CODE + TEXT):
        continue
    with open(f"{ROOT}/{path}", encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            if path.endswith(CODE):
                code, comment = code_of(line)
                check_names(path, number, code)
                check_sentence(path, number, comment)
            elif path.endswith(".md"):
                check_sentence(path, number, line)
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
