#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The ABI's one source is its headers; from the structs and type numbers in them this writes

  include/odograph/layout.h    static asserts of every offset and size, for C99 and C++
  include/odograph/messages.h  all messages as one list (for whoever names, dispatches, records), and the sizes of 1.0
  golden/layout_v1.txt         the layout as text, to compare releases by

`golden/minimum_v1.txt` holds the smallest size that a reader accepts of each struct: what version 1.0 of it had. A struct
that is new there is added with the size that it has; nothing else ever changes in it. Adding a message is one edit: its
struct in samples.h or events.h and its ODO_TYPE number in base.h, then this script.

`layout.py --check` writes nothing and fails when something is out of date, or when a struct of `golden/released_v1.txt`
(if there has been a release) lost, moved or changed a field: structs grow at their end only.
`layout.py --grow FOLDER` writes the headers as a later version might have them, for tests: each struct that may grow has
another field `grown` at its end, an array of two doubles.
Offsets are those of a 64-bit platform with natural alignment (x86-64, AArch64, RISC-V 64).
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
INCLUDE = HERE / "include/odograph"
HEADERS = ["base.h", "samples.h", "events.h", "odograph.h", "anchor.h", "plugin.h", "terrain.h"]
FROZEN = {"odo_string", "odo_plane", "odo_header", "odo_loan", "odo_borrowed"}  # embedded by value in others
SCALARS = {"uint8_t": 1, "int32_t": 4, "uint32_t": 4, "float": 4, "double": 8, "int64_t": 8, "uint64_t": 8, "char": 1}
WRITTEN = "/* SPDX-License-Identifier: Apache-2.0\n *\n * Written by abi/layout.py; do not edit. "


def structs(include=INCLUDE):
    """Yields (name, [(field, offset, size)], size); embedded structs must be defined before they are used."""
    known = {name: (size, size) for name, size in SCALARS.items()}
    for header in HEADERS:
        text = re.sub(r"/\*.*?\*/", "", (include / header).read_text(), flags=re.S).replace("ODO_CALL ", "")
        text = re.sub(r"ODO_POINTER\((.*), (\w+)\);", r"\1 \2;", text)
        text = re.sub(r"ODO_FUNCTION\((.*?), (\w+), \((.*)\)\);", r"\1 (*\2)(\3);", text)
        for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\n\} \1;", text, flags=re.S):
            fields, end, widest = [], 0, 1
            for line in re.sub(r"\([^()]*\(\*(\w+)\)", r"(*\1)", body).split(";"):
                line = " ".join(line.split())
                if not line:
                    continue
                pointer = re.search(r"\(\*(\w+)\)\(", line)
                if pointer:
                    names, size, align = [(pointer.group(1), 1)], 8, 8
                else:
                    base, rest = re.match(r"(?:const )?(?:struct )?(\w+) (.*)", line).groups()
                    names = []
                    is_pointer = "*" in rest
                    for declarator in rest.replace("*", "").replace("const ", "").split(","):
                        field, count = re.match(r"\s*(\w+)(?:\[(\d+)\])?", declarator).groups()
                        names.append((field, int(count or 1)))
                    size, align = (8, 8) if is_pointer else known[base]
                for field, count in names:
                    offset = -(-end // align) * align
                    if offset != end:
                        sys.exit(f"{header}: {name}.{field}: implicit padding of {offset - end} bytes before it")
                    fields.append((field, offset, size * count))
                    end, widest = offset + size * count, max(widest, align)
            if end % widest:
                sys.exit(f"{header}: {name}: implicit padding at the end")
            known[name] = (end, widest)
            yield name, fields, end


def type_numbers():
    """Message types by struct name, in the order of their numbers."""
    text = (INCLUDE / "base.h").read_text()
    numbers = re.findall(r"#define ODO_TYPE_(\w+) (0x[0-9A-Fa-f]+)u", text)
    return {"odo_" + name.lower(): name for name, number in sorted(numbers, key=lambda x: int(x[1], 16))}


def minimum_sizes(sizes):
    """What version 1.0 of each struct has; new structs are appended."""
    lines = (HERE / "golden/minimum_v1.txt").read_text().splitlines()
    minimum = {line.split()[0]: int(line.split()[1]) for line in lines}
    for name, size in sizes.items():
        if name not in FROZEN and minimum.setdefault(name, size) > size:
            sys.exit(f"{name} has {size} bytes, version 1.0 of it had {minimum[name]}: structs never shrink")
    return minimum


def render_messages(sizes, minimum):
    types = type_numbers()
    missing = [name for name in types if name not in sizes]
    if missing:
        sys.exit(f"base.h: no struct for the message types of {', '.join(missing)}")
    rows = [f"  X(ODO_TYPE_{label}, {name}, {name[4:]}, {name.upper()}_SIZE_MIN)" for name, label in types.items()]
    width = max(len(row) for row in rows) + 1
    table = " \\\n".join([row.ljust(width) for row in rows[:-1]] + [rows[-1]])
    constants = "\n".join(f"#define {name.upper()}_SIZE_MIN {minimum[name]}u" for name in minimum)
    return WRITTEN + """All messages as one list, and how large version 1.0 of each
 * struct was: a reader accepts what is at least as large, and takes fields behind its end for absent.
 */
#ifndef ODOGRAPH_MESSAGES_H
#define ODOGRAPH_MESSAGES_H

#include <odograph/types.h>

/* clang-format off */
/* X(type number, struct, name in files, size of 1.0) */
#define ODO_FOR_EACH_MESSAGE(X) \\
""" + table + "\n\n" + constants + "\n/* clang-format on */\n\n#endif\n"


def render():
    asserts, golden, sizes = [], [], {}
    for name, fields, size in structs():
        sizes[name] = size
        golden.append(f"{name} {size}")
        asserts.append(f"ODO_LAYOUT({name}, sizeof({name}) == {size})")
        for field, offset, length in fields:
            golden.append(f"{name}.{field} {offset} {length}")
            asserts.append(f"ODO_LAYOUT({name}_{field}, offsetof({name}, {field}) == {offset})")
    header = WRITTEN + """Including this header proves at compile time that this
 * compiler lays the ABI's structs out as every other one does.
 */
#ifndef ODOGRAPH_LAYOUT_H
#define ODOGRAPH_LAYOUT_H

#include <odograph/anchor.h>
#include <odograph/odograph.h>
#include <odograph/plugin.h>
#include <odograph/terrain.h>

#define ODO_LAYOUT(name, condition) typedef char odo_layout_of_##name[(condition) ? 1 : -1];
/* clang-format off */
""" + "\n".join(asserts) + """
/* clang-format on */
#undef ODO_LAYOUT

#endif
"""
    minimum = minimum_sizes(sizes)
    return {
        INCLUDE / "layout.h": header,
        INCLUDE / "messages.h": render_messages(sizes, minimum),
        HERE / "golden/layout_v1.txt": "\n".join(golden) + "\n",
        HERE / "golden/minimum_v1.txt": "".join(f"{name} {size}\n" for name, size in minimum.items()),
    }


def grow(folder):
    """The headers of a later version: a field more in each struct, the minor version higher where it is not a draft's."""
    folder = pathlib.Path(folder) / "odograph"
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(INCLUDE.glob("*.h*")):
        text = path.read_text()
        if path.name in HEADERS:
            text = re.sub(r"(typedef struct (\w+) \{.*?)(\n\} \2;)",
                          lambda m: m[0] if m[2] in FROZEN else f"{m[1]}\n  double grown[2];{m[3]}", text, flags=re.S)
        if path.name == "layout.h":
            text = "#include <odograph/odograph.h>\n#include <odograph/plugin.h>\n"
        target = folder / path.name
        if not target.exists() or target.read_text() != text:
            target.write_text(text)


def main():
    if "--grow" in sys.argv:
        return grow(sys.argv[sys.argv.index("--grow") + 1])
    targets = render()
    if "--check" not in sys.argv:
        for path, text in targets.items():
            path.write_text(text)
        return
    for path, text in targets.items():
        if not path.exists() or path.read_text() != text:
            sys.exit(f"{path} is out of date: run abi/layout.py")
    golden = targets[HERE / "golden/layout_v1.txt"]
    released = HERE / "golden/released_v1.txt"
    if released.exists():
        now = dict(line.split(" ", 1) for line in golden.splitlines())
        for line in released.read_text().splitlines():
            key, value = line.split(" ", 1)
            if "." in key and now.get(key) != value:
                sys.exit(f"{key} was '{value}' in the released ABI and is '{now.get(key)}' now: that breaks old binaries")
    print(f"{golden.count(chr(10))} layout facts hold")


main()
