#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generates files from the ABI description (description.py):

  include/odograph/layout.h            static asserts of every offset and size, for C99 and C++
  include/odograph/messages.h          list of all messages, and the sizes of version 1.0
  golden/contract_v1.txt               all promised facts, one per line
  golden/minimum_v1.txt                minimum accepted size of each struct

--check          writes nothing. Fails if a file is out of date, and lists the facts that differ. Fails if the tree breaks
                 the facts of the last release (golden/released_v1.txt): only new facts, and growth of a struct at its
                 end, are allowed.
--bindings FOLDER  writes the bindings for other languages, complete, as the build and the packages have them: a copy of
                 bindings/, and generated declarations:
    python/odograph/abi.py, abi.pyi  declarations for Python, and their types
    csharp/Abi.cs, rust/src/abi.rs, java/org/odograph/Abi.java, java/abi_jni.c  the same for C#, Rust, Java
    swift/Sources/Odograph/Messages.swift  type numbers of the messages for Swift
    javascript/abi.js, abi.d.ts      memory layout for JavaScript, and types for TypeScript
    javascript/prototypes.js         prototypes of the library's functions for koffi
--grow FOLDER    writes headers of a hypothetical later version, for tests: each struct that may grow has another field
                 `grown` at its end, an array of two doubles.
--probe          prints a C program that defines every function and uses every type. It compiles if the compiler agrees
                 with the description, and libabigail extracts the ABI from it.
--exchange [INCLUDE]  prints a C program that writes and reads every number of every message, with these or other headers.
--symbols        prints the symbols of the library, NAME@@NODE, and of a plugin.

golden/minimum_v1.txt only gains lines.
"""
import pathlib
import re
import shutil
import sys

from bindings_python import check_python, python, stub
from bindings_csharp import csharp
from bindings_java import java, jni
from bindings_js import javascript, prototypes, typescript
from bindings_rust import rust
from description import Description
from exchange import exchange_c
from facts import breaks, differences, facts, nodes, text_of

HERE = pathlib.Path(__file__).resolve().parent
INCLUDE = HERE / "include/odograph"
MAP = HERE.parent / "sdk/host/odograph.map"
CONTRACT, MINIMUM, RELEASED = (HERE / f"golden/{name}_v1.txt" for name in ("contract", "minimum", "released"))
HEAD = "/* SPDX-License-" "Identifier: Apache-2.0\n *\n * Written by abi/generate.py; do not edit. "


def minimum_sizes(abi):
    """Sizes of version 1.0 of each struct; new structs are appended."""
    lines = MINIMUM.read_text().splitlines()
    minimum = {line.split()[0]: int(line.split()[1]) for line in lines}
    for name, struct in abi.structs.items():
        if not struct.frozen and minimum.setdefault(name, struct.size) > struct.size:
            sys.exit(f"{name} has {struct.size} bytes, version 1.0 of it had {minimum[name]}: structs never shrink")
    return minimum


def messages_h(abi, minimum):
    rows = [f"  X(ODO_TYPE_{name[4:].upper()}, {name}, {name[4:]}, {name.upper()}_SIZE_MIN)" for name in abi.messages()]
    width = max(map(len, rows)) + 1
    table = " \\\n".join([row.ljust(width) for row in rows[:-1]] + [rows[-1]])
    constants = "\n".join(f"#define {name.upper()}_SIZE_MIN {size}u" for name, size in minimum.items())
    return HEAD + """List of all messages, and the size of version 1.0 of each
 * struct. A reader accepts a struct of at least this size, and treats fields beyond its end as absent.
 */
#ifndef ODOGRAPH_MESSAGES_H
#define ODOGRAPH_MESSAGES_H

#include <odograph/types.h>

/* clang-format off */
/* X(type number, struct, name in files, size of 1.0) */
#define ODO_FOR_EACH_MESSAGE(X) \\
""" + table + "\n\n" + constants + "\n/* clang-format on */\n\n#endif\n"


def layout_h(abi):
    asserts = []
    for name, struct in abi.structs.items():
        checks = [f"sizeof({name}) == {struct.size}"]
        checks += [f"offsetof({name}, {field.name}) == {field.offset}" for field in struct.fields]
        line = f"ODO_LAYOUT({name},"
        for i, check in enumerate(checks):
            if len(line) + len(check) > 113:
                asserts.append(line)
                line = "          "
            line += f" {check}" + (" &&" if i + 1 < len(checks) else ")")
        asserts.append(line)
    includes = "\n".join(f"#include <odograph/{header}>" for header in abi.headers)
    return HEAD + """Including this header verifies at compile time that the
 * compiler uses the layout of the ABI for every struct.
 */
#ifndef ODOGRAPH_LAYOUT_H
#define ODOGRAPH_LAYOUT_H

""" + includes + """

#define ODO_LAYOUT(name, condition) typedef char odo_layout_of_##name[(condition) ? 1 : -1];
/* clang-format off */
""" + "\n".join(asserts) + """
/* clang-format on */
#undef ODO_LAYOUT

#endif
"""


def probe_c(abi):
    lines = [f"#include <odograph/{header}>" for header in abi.headers]
    for name, value in abi.constants.items():
        if isinstance(value, int):
            literal = f"{value}" if value > -2**63 else f"({value + 1} - 1)"
            lines.append(f"typedef char probe_{name}[{name} == {literal} ? 1 : -1];")
        else:
            lines.append(f'typedef char probe_{name}[sizeof {name} == {len(value) + 1} ? 1 : -1];')
    for name, struct in abi.structs.items():
        lines += [f"extern {name} probe_{name};"]
        lines += [f"static {f.declare(f'*probe_{name}_{f.name}' if '[' not in f.type else f'(*probe_{name}_{f.name})')} = "
                  f"&probe_{name}.{f.name};" for f in struct.fields]
    for f in abi.functions:
        parameters = ", ".join(f.parameters) or "void"
        if f.kind in ("function", "entry"):
            body = "" if f.result == "void" else " return 0; "
            lines.append(f"{f.result} {f.call} {f.name}({parameters}) {{{body}}}")
        else:  # assigned to a pointer of the described type, so that the compiler compares them
            target = f.name if f.kind == "inline" else f"({f.name})0"
            lines.append(f"static {f.result} ({f.call} *probe_{f.name})({parameters}) = {target};")
    for name in abi.structs:
        lines.append(f"void odo_probe_{name[4:]}(const {name} *message) {{}}")
    return "\n".join(lines) + "\n"


def grow(abi, folder):
    folder = pathlib.Path(folder) / "odograph"
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(INCLUDE.glob("*.h*")):
        text = path.read_text()
        if path.name in abi.headers:
            text = re.sub(r"(typedef struct (\w+) \{(?:(?!typedef struct).)*?)(\n\} \2;)",
                          lambda m: m[0] if abi.structs[m[2]].frozen else f"{m[1]}\n  double grown[2];{m[3]}", text, flags=re.S)
        if path.name == "layout.h":
            text = "#include <odograph/odograph.h>\n#include <odograph/plugin.h>\n"
        target = folder / path.name
        if not target.exists() or target.read_text() != text:
            target.write_text(text)


def swift(abi):
    rows = [f"extension {name}: Message {{ public static var type: UInt32 {{ {number:#x} }} }}" for name, number in abi.messages().items()]
    return ("// Not compiled yet, because no Swift compiler was available.\n// SPDX-License-Identifier: Apache-2.0\n"
            "// Written by abi/generate.py; do not edit.\nimport COdograph\n\n" + "\n".join(rows) + "\n")


def generate(abi):
    minimum = minimum_sizes(abi)
    return {
        INCLUDE / "layout.h": layout_h(abi),
        INCLUDE / "messages.h": messages_h(abi, minimum),
        CONTRACT: text_of(facts(abi, minimum, MAP)),
        MINIMUM: "".join(f"{name} {size}\n" for name, size in minimum.items()),
    }


def write_bindings(abi, folder):
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(HERE / "bindings", folder, ignore=shutil.ignore_patterns("vit", "__pycache__", "target", "node_modules", "*.egg-info", "Cargo.lock"))
    for name, text in {
        "python/odograph/abi.py": python(abi),
        "python/odograph/abi.pyi": stub(abi),
        "java/org/odograph/Abi.java": java(abi),
        "java/abi_jni.c": jni(abi),
        "javascript/abi.js": javascript(abi),
        "javascript/abi.d.ts": typescript(abi),
        "javascript/prototypes.js": prototypes(abi),
        "swift/Sources/Odograph/Messages.swift": swift(abi),
        "rust/src/abi.rs": rust(abi, minimum_sizes(abi)),
        "csharp/Abi.cs": csharp(abi),
    }.items():
        (folder / name).write_text(text)


def check(abi, files):
    """Yields each fault as a line of text."""
    for path, text in files.items():
        found = path.read_text() if path.exists() else ""
        if path == CONTRACT:
            yield from differences(found, text, "golden")
        if found != text:
            yield f"{path.relative_to(HERE.parent)} is out of date: run abi/generate.py"
    if RELEASED.exists():
        yield from breaks(abi, RELEASED.read_text(), files[CONTRACT])
    else:
        yield f"{RELEASED.relative_to(HERE.parent)} is missing: packaging/release writes it"
    yield from check_python(python(abi), abi)
    functions, exported = {f.name for f in abi.exported()}, set(nodes(MAP))
    for name in sorted(functions ^ exported):
        yield f"{name}: " + ("declared, but not in odograph.map" if name in functions else "in odograph.map, but not declared")


def main():
    abi = Description(INCLUDE)
    if "--bindings" in sys.argv:
        return write_bindings(abi, pathlib.Path(sys.argv[sys.argv.index("--bindings") + 1]))
    if "--grow" in sys.argv:
        return grow(abi, sys.argv[sys.argv.index("--grow") + 1])
    if "--exchange" in sys.argv:
        return print(exchange_c(Description(pathlib.Path(sys.argv[-1]) / "odograph" if sys.argv[-1] != "--exchange" else INCLUDE)), end="")
    if "--probe" in sys.argv:
        return print(probe_c(abi), end="")
    if "--symbols" in sys.argv:
        symbols = nodes(MAP)
        return print("\n".join([f"{f.name}@@{symbols.get(f.name, '?')}" for f in abi.exported()] + [abi.entry_symbol()]))
    files = generate(abi)
    if "--check" in sys.argv:
        wrong = list(check(abi, files))
        if wrong:
            sys.exit("\n".join(wrong))
        return print(f"{files[CONTRACT].count(chr(10))} facts hold")
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


main()
