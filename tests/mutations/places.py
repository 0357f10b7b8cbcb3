#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Places in C++ sources that can be mutated, from clang's syntax tree, and a blind choice among them (for mutate.py)."""
import json
import os
import pathlib
import random
import re
import sys

sys.path.append("/usr/lib/python3/dist-packages")  # Debian's python3-clang, for another Python
try:
    from clang.cindex import CursorKind as K, Index, TypeKind
except ImportError:
    print("SKIPPED: no python3-clang")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADER = pathlib.Path(__file__).parent / "mutant.hpp"
FOLDERS = ["sdk/host", "sdk/math", "plugins/attitude/vqf", "plugins/step/odograph", "plugins/vo/odograph", "plugins/fix/gnss", "plugins/fix/barometer",
           "plugins/fix/waypoint", "plugins/scale"]
NUMBERS = {getattr(TypeKind, name) for name in "INT UINT LONG ULONG LONGLONG ULONGLONG SHORT USHORT FLOAT DOUBLE".split()}
OPERATORS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/", "/": "*", "&&": "||", "||": "&&"}
KINDS = {"<": "boundary", ">": "boundary", "=": "comparison", "!": "comparison", "&": "logic", "|": "logic"}
FUNCTIONS = {K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.DESTRUCTOR, K.FUNCTION_TEMPLATE, K.CONVERSION_FUNCTION}
CLOSED = {K.STATIC_ASSERT, K.ENUM_DECL, K.TEMPLATE_NON_TYPE_PARAMETER, K.TEMPLATE_TYPE_PARAMETER, K.TYPE_ALIAS_DECL}


class Places:
    """The places of one file that can be mutated: kind -> [(start, end, text with @ for the switch)]."""

    def __init__(self, path, arguments):
        self.path, self.text, self.found = str(path), path.read_bytes(), {}
        self.unit = Index.create().parse(self.path, arguments, options=1)  # with a record of macros
        top = [node for node in self.unit.cursor.get_children() if node.location.file and node.location.file.name == self.path]
        self.macros = [self.span(node) for node in top if node.kind == K.MACRO_INSTANTIATION]
        for node in top:
            self.walk(node, None)

    @staticmethod
    def span(node):
        return node.extent.start.offset, node.extent.end.offset

    def source(self, start, end):
        return self.text[start:end].decode()

    def add(self, kind, node, new, macro_is_whole=False):
        start, end = self.span(node)
        if any(m[0] <= start and end <= m[1] and not (macro_is_whole and m == (start, end)) for m in self.macros):
            return
        self.found.setdefault(kind, []).append((start, end, new))

    def walk(self, node, parent):
        start, end = self.span(node)
        children = list(node.get_children())
        head = self.source(start, self.span(children[-1])[0] if node.kind in FUNCTIONS and children else end)
        if node.kind in CLOSED or (node.kind in FUNCTIONS | {K.VAR_DECL} and re.search(r"\bconst(expr|eval)\b", head)):
            return
        statement = parent is not None and (parent.kind == K.COMPOUND_STMT or node.kind in (K.RETURN_STMT, K.DECL_STMT)) and node.kind != K.COMPOUND_STMT
        if (statement or node.kind.is_expression()) and '"' in head and node.kind not in (K.IF_STMT, K.FOR_STMT, K.WHILE_STMT, K.LAMBDA_EXPR):
            if not any(child.kind == K.LAMBDA_EXPR for child in node.walk_preorder()):
                return  # texts of errors and reports
        self.consider(node, parent, children, self.source(start, end))
        for child in children[1 if node.kind == K.CASE_STMT else 0:]:
            if child.location.file and child.location.file.name == self.path:
                self.walk(child, node)

    def consider(self, node, parent, children, text):
        if node.kind in (K.BINARY_OPERATOR, K.CALL_EXPR) and len(children) >= 2:
            self.operator(node, children)
        if node.kind in (K.IF_STMT, K.WHILE_STMT) and "constexpr" not in text[:14]:
            for child in children:
                if child.kind.is_expression() and self.text[self.span(child)[1]:].lstrip().startswith(b")"):
                    self.add("condition", child, f"(@ != static_cast<bool>({self.source(*self.span(child))}))", True)
                    break
        if node.kind in (K.INTEGER_LITERAL, K.FLOATING_LITERAL) and (parent is None or parent.type.kind != TypeKind.CONSTANTARRAY):
            zero = not re.search(r"[1-9]", text)
            self.add("constant", node, f"(@ ? {text} {'+ 1' if zero or node.kind == K.INTEGER_LITERAL else '* 2'} : {text})")
        if node.kind == K.RETURN_STMT and children:
            value, kind = self.source(*self.span(children[0])), children[0].type.get_canonical().kind
            if kind == TypeKind.BOOL:
                self.add("returned value", children[0], f"(@ != ({value}))", True)
            elif kind in (TypeKind.INT, TypeKind.UINT):
                self.add("returned value", children[0], f"(@ ? !({value}) : ({value}))", True)
        assigns = node.kind == K.BINARY_OPERATOR and re.search(r"[^=!<>]=[^=]", text) or node.kind == K.COMPOUND_ASSIGNMENT_OPERATOR
        if parent is not None and parent.kind == K.COMPOUND_STMT and (node.kind == K.CALL_EXPR or assigns):
            self.add("statement removed", node, f"if (!@) {text}")

    def operator(self, node, children):
        left, right = children[0], children[-1]
        between = self.source(self.span(left)[1], self.span(right)[0]).strip()
        if between not in OPERATORS:
            return
        a, b = self.source(*self.span(left)), self.source(*self.span(right))
        if node.kind == K.CALL_EXPR:  # matrices: the sign, as a - b and a + b are of different types
            if between in "+-" and "Eigen::" in node.type.get_canonical().spelling:
                self.add("arithmetic", right, f"(@ ? -1.0 : 1.0) * ({b})")
        elif between not in "+-*/" or node.type.get_canonical().kind in NUMBERS:
            self.add(KINDS.get(between[0], "arithmetic"), node, f"(@ ? ({a} {OPERATORS[between]} {b}) : ({a} {between} {b}))")

    def compile(self, edits):
        self.unit.reparse([(self.path, mutated(self.text, edits).decode())], options=1)
        return not any(message.severity >= 3 for message in self.unit.diagnostics)


def mutated(text, edits):
    for number, start, end, new in sorted(edits, key=lambda edit: -edit[1]):
        text = text[:start] + new.replace("@", f"odo_mutant({number})").encode() + text[end:]
    return text


def choose(build, seed, count, headers):
    """Draws a file by its lines, a kind of change among those that it has, and a place. Headers: only if asked for."""
    chance = random.Random(seed)
    database = {os.path.relpath(entry["file"], ROOT): entry["command"].split() for entry in reversed(json.loads((build / "compile_commands.json").read_text()))}
    files = [str(path.relative_to(ROOT)) for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.[ch]pp")) if not {"none", "windows"} & set(path.parts)]
    files = [name for name in files if name in database or (headers and name.endswith(".hpp"))]
    lines = [len((ROOT / name).read_text().splitlines()) for name in files]
    parsed, mutants = {}, []
    while len(mutants) < count:
        name = chance.choices(files, lines)[0]
        if name not in parsed:
            near = max((file for file in database if file.endswith(".cpp")), key=lambda file: len(os.path.commonprefix([file, name])))
            flags = [flag for flag in database[near] if re.match(r"-(D|I|std|isystem)|/usr/include", flag)]
            parsed[name] = Places(ROOT / name, ["-x", "c++", "-w", "-include", str(HEADER), *flags])
        places = parsed[name]
        if not places.found:
            continue
        kind = chance.choice(sorted(places.found))
        start, end, new = chance.choice(places.found[kind])
        mine = [edit for edit in mutants if edit["file"] == name]
        edits = [(edit["number"], *edit["edit"]) for edit in mine] + [(len(mutants), start, end, new)]
        if any(start < edit["edit"][1] and edit["edit"][0] < end for edit in mine):
            continue
        if name.endswith(".hpp") and not places.compile(edits):
            continue  # sources nearly always compile: the build leaves out the others
        mutants.append({"number": len(mutants), "file": name, "line": places.text[:start].count(b"\n") + 1, "kind": kind,
                        "before": places.source(start, end), "edit": (start, end, new)})
        print(len(mutants), name, kind, flush=True)
    return mutants
