#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pins the ABI's layout: reads the structs out of the headers, which are the one source, and writes from them

  include/odograph/layout.h   static asserts of every offset and size, for C99 and C++
  golden/layout_v1.txt        the same as text, to compare releases by

`layout.py --check` writes nothing and fails when either is out of date, or when a struct of `golden/released_v1.txt`
(if there has been a release) lost, moved or changed a field: structs grow at their end only.
Offsets are those of a 64-bit platform with natural alignment (x86-64, AArch64, RISC-V 64).
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
HEADERS = ["types.h", "odograph.h", "plugin.h"]
SCALARS = {"uint8_t": 1, "int32_t": 4, "uint32_t": 4, "float": 4, "double": 8, "int64_t": 8, "uint64_t": 8, "char": 1}


def structs():
    """Yields (name, [(field, offset, size)], size); embedded structs must be defined before they are used."""
    known = {name: (size, size) for name, size in SCALARS.items()}
    for header in HEADERS:
        text = re.sub(r"/\*.*?\*/", "", (HERE / "include/odograph" / header).read_text(), flags=re.S)
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


def render():
    asserts, golden = [], []
    for name, fields, size in structs():
        golden.append(f"{name} {size}")
        asserts.append(f"ODO_LAYOUT({name}, sizeof({name}) == {size})")
        for field, offset, length in fields:
            golden.append(f"{name}.{field} {offset} {length}")
            asserts.append(f"ODO_LAYOUT({name}_{field}, offsetof({name}, {field}) == {offset})")
    header = """/* SPDX-License-Identifier: Apache-2.0
 *
 * Written by abi/layout.py; do not edit. Including this header proves at compile time that this compiler lays the ABI's
 * structs out as every other one does.
 */
#ifndef ODOGRAPH_LAYOUT_H
#define ODOGRAPH_LAYOUT_H

#include <odograph/odograph.h>
#include <odograph/plugin.h>

#if UINTPTR_MAX == UINT64_MAX
#define ODO_LAYOUT(name, condition) typedef char odo_layout_of_##name[(condition) ? 1 : -1];
/* clang-format off */
""" + "\n".join(asserts) + """
/* clang-format on */
#undef ODO_LAYOUT
#endif

#endif
"""
    return header, "\n".join(golden) + "\n"


def main():
    header, golden = render()
    targets = {HERE / "include/odograph/layout.h": header, HERE / "golden/layout_v1.txt": golden}
    if "--check" not in sys.argv:
        for path, text in targets.items():
            path.write_text(text)
        return
    for path, text in targets.items():
        if not path.exists() or path.read_text() != text:
            sys.exit(f"{path} is out of date: run abi/layout.py")
    released = HERE / "golden/released_v1.txt"
    if released.exists():
        now = dict(line.split(" ", 1) for line in golden.splitlines())
        for line in released.read_text().splitlines():
            key, value = line.split(" ", 1)
            if "." in key and now.get(key) != value:
                sys.exit(f"{key} was '{value}' in the released ABI and is '{now.get(key)}' now: that breaks old binaries")
    print(f"{golden.count(chr(10))} layout facts hold")


main()
