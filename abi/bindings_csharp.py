# SPDX-License-Identifier: Apache-2.0
"""Generates the C# binding: constants, blittable structs with the offset of each field, functions by P/Invoke. generate.py writes
the returned text."""
from c_types import is_event, parse, public_structs, title

SCALARS = {"uint8_t": "byte", "int32_t": "int", "uint32_t": "uint", "int64_t": "long", "uint64_t": "ulong", "float": "float", "double": "double",
           "char": "byte", "void": "void"}
VECTORS = {("double", 3): "Vector", ("double", 4): "Rotation"}  # defined in Odograph.cs
PLUGINS_ONLY = {"plugin.h", "terrain.h"}
HEAD = """// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
using System;
using System.Runtime.InteropServices;

namespace Odograph {
"""


def struct_name(description, name):
    return title(name) if name in public_structs(description) else name


def typed(description, text):
    """C# type of a parameter, a result or a field other than an array."""
    kind = parse(text)
    if kind.is_function or kind.base in ("odo_callback", "odo_plugin_entry"):
        return "IntPtr"
    return (SCALARS.get(kind.base) or struct_name(description, kind.base)) + "*" * kind.pointers


def fields(description, struct):
    for field in struct.fields:
        kind = parse(field.type)
        at = f"[FieldOffset({field.offset})] public "
        if not kind.count:
            yield at + f"{typed(description, field.type)} {field.name};"
        elif (kind.base, kind.count) in VECTORS:
            yield at + f"{VECTORS[kind.base, kind.count]} {field.name};"
        elif kind.base in SCALARS:
            yield at + f"fixed {SCALARS[kind.base]} {field.name}[{kind.count}];"
        else:
            size = field.size // kind.count
            for i in range(kind.count):
                yield f"[FieldOffset({field.offset + i * size})] public {struct_name(description, kind.base)} {field.name}{i};"


def constant(name, value):
    if isinstance(value, str):
        return f'    public const string {name} = "{value}";'
    status = name.startswith("ODO_E_") or name in ("ODO_OK", "ODO_NOT_READY", "ODO_END", "ODO_PARTIAL")
    kind = "int" if status else "uint" if 0 <= value < 2**32 else "long"
    return f"    public const {kind} {name} = {value};"


def methods(description):
    """Methods for each message: push it, and get it from an event."""
    push, get = [], []
    for name, number in description.messages().items():
        struct = title(name)
        get.append(f"    public bool TryGet(out {struct} message) {{ message = default({struct}); fixed ({struct}* p = &message) "
                   f"return Copy(p, {number:#x}, {description.structs[name].size}); }}")
        if not is_event(number) and not number & description.constants["ODO_BORROWED"]:
            push.append(f"    public int Push(ref {struct} message) {{ fixed ({struct}* p = &message) return Push(&p->header); }}")
    return ("  public sealed unsafe partial class Session {\n" + "\n".join(push) + "\n  }\n\n  public unsafe partial struct Event {\n" +
            "\n".join(get) + "\n  }\n")


def csharp(description):
    structs = []
    for struct in description.structs.values():
        if struct.header in PLUGINS_ONLY:
            continue
        number, name = description.messages().get(struct.name), struct_name(description, struct.name)
        lines = [f"  [StructLayout(LayoutKind.Explicit, Size = {struct.size})]", f"  public unsafe struct {name} {{"]
        lines += ["    " + field for field in fields(description, struct)]
        if number is not None:
            lines += [f"    public {name}(long t_ns) {{ this = default({name}); header.struct_size = {struct.size}; header.type = {number:#x}; "
                      "header.t_ns = t_ns; }"]
        structs.append("\n".join(lines + ["  }"]))
    functions = []
    for f in description.exported():
        parameters = ", ".join(f"{typed(description, p)} {parse(p).name}" for p in f.parameters)
        functions.append("    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]\n"
                         f"    public static extern {typed(description, f.result)} {f.name}({parameters});")
    opaque = [f"  public struct {name} {{}}" for name in description.opaque]
    return (HEAD + "  /// Constants under their C names, and the library's functions.\n  public static unsafe class Abi {\n"
            '    public const string Library = "odograph";\n\n' +
            "\n".join(constant(*item) for item in description.constants.items()) + "\n\n" + "\n".join(functions) + "\n  }\n\n" +
            "\n".join(opaque) + "\n\n" + "\n".join(structs) + "\n\n" + methods(description) + "}\n")
