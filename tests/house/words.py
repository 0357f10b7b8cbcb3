#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The field's words (docs/notation.md): home-made ones are found in names, in comments and in documents.

Documents (Markdown) are checked further: software does not tell, say, speak, believe, know or doubt, and prose has at most 120 columns.
"""
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
# In Markdown, outside of code and quotations. Software and data do not speak or believe.
VERBS = [
    (r"\b(tells?|told)\b", "reports, emits, provides, states, distinguishes"),
    (r"\b(says|said|speaks?|spoken)\b", "states, refers to"),
    (r"\bbeliev(e|es|ed|ing)\b", "accepts, uses"),
    (r"\b(knows|knew)\b", "has; scale is observable, is known to x %"),
    (r"\bdoubt(s|ed|ful)?\b", "uncertainty, covariance, standard deviation"),
    (r"\b(teach(es)?|taught)\b", "calibrates, biases"),
    (r"\b(begins?|began|begun|starts?|started) anew\b", "restarts, re-initialises"),
    (r"\b(tak(es?|en|ing)|took) ([a-z]+ ){1,4}for (granted|one|an?|the)\b", "treats x as y"),
    (r"\bby hand\b", "manually, empirically"),
    (r"\bwrongly certain\b|\bis held against\b", "overconfident; is compared with"),
]
COLUMNS = 120
# A word that no line can be broken within: links and code with their spaces, and what adjoins them.
WORD = re.compile(r"(?:\[[^\]]*\]\([^)]*\)|`[^`]*`|\S)+")

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


def blanked(text, pattern):
    """The text with spaces in place of what matches; lines stay where they are."""
    return re.sub(pattern, lambda found: re.sub(r"[^\n]", " ", found.group(0)), text)


def check_markdown(path, text):
    text = blanked(text, r"(?ms)^ *```.*?^ *```")
    text = blanked(text, r"(?m)(?<=\n\n)(?: {4,}(?![*-] |\d+\. ).*\n)+")  # indented code: equations
    for number, line in enumerate(text.split("\n"), 1):
        if len(line.rstrip()) > COLUMNS and not re.match(r"\s*(\||#|!\[)", line) and len(WORD.findall(line)) > 1:
            wrong.append(f"{path}:{number}: {len(line)} columns: {COLUMNS} but in tables, code and links")
    prose = blanked(blanked(text, r"`[^`]*`|\]\([^)]*\)"), r'"(?:[^"\n]|\n(?!\n)){0,200}"')
    for number, line in enumerate(prose.split("\n"), 1):
        for pattern, better in VERBS:
            for found in re.finditer(pattern, line, re.I):
                wrong.append(f"{path}:{number}: '{found.group(0)}': {better}")


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
    if path.endswith(".md"):
        with open(f"{ROOT}/{path}", encoding="utf-8") as file:
            check_markdown(path, file.read())
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
