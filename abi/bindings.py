# SPDX-License-Identifier: Apache-2.0
"""Bindings written from the description: today Python's, by ctypes. generate.py writes what is returned here."""
import re

SCALARS = {"uint8_t": "_u8", "int32_t": "_i32", "uint32_t": "_u32", "int64_t": "_i64", "uint64_t": "_u64", "float": "_f32", "double": "_f64",
           "char": "_char"}

HEAD = '''# SPDX-License-Identifier: Apache-2.0
# Written by abi/generate.py; do not edit.
"""The C ABI of Odograph for ctypes: constants and structs under their C names, `load` for the library's functions."""
# pylint: disable=missing-class-docstring, multiple-statements
import ctypes as c

_P = c.POINTER
_u8, _i32, _u32, _i64, _u64 = c.c_uint8, c.c_int32, c.c_uint32, c.c_int64, c.c_uint64
_f32, _f64, _char = c.c_float, c.c_double, c.c_char

def _pointer(name, kind):
    """A pointer has 8 bytes on every target."""
    return [(name, kind)] if c.sizeof(c.c_void_p) == 8 else [(name, kind), (name + "_bits", c.c_uint32)]


'''

LOAD = '''

def load(path):
    """The library, its functions with their types. An older library has not all of them."""
    library = c.CDLL(path)
    for name, (result, parameters) in FUNCTIONS.items():
        if hasattr(library, name):
            function = getattr(library, name)
            function.restype, function.argtypes = result, parameters
    return library
'''


def ctype(text, returned=False):
    """A type as C spells it, perhaps with a parameter's name behind it, in ctypes."""
    function = re.fullmatch(r"(.*) \(ODO_CALL \*\)\((.*)\)", text)
    if function:
        return prototype(function[1], function[2].split(", "))
    base, stars, count = re.fullmatch(r"(?:struct )?(\w+) ?(\**) ?(?:\w+)?(?:\[(\d+)\])?", text.replace("const ", "").replace(
        "*const *", "**")).groups()
    if base == "void":
        name, stars = ("None", "") if not stars else ("c.c_void_p", stars[1:])
    elif base == "char" and stars and returned:
        name, stars = "c.c_char_p", stars[1:]  # terminated
    else:
        name = SCALARS.get(base, base)
    for _ in stars:
        name = f"_P({name})"
    return name + (f" * {count}" if count else "")


def prototype(result, parameters):
    kinds = ", ".join([ctype(result)] + [ctype(parameter) for parameter in parameters])
    return f"c.CFUNCTYPE({kinds})"


def quoted(value):
    return f'"{value}"' if isinstance(value, str) else f"{value}"


def fill(start, entries, end):
    """Entries behind one another, in lines of at most 120 characters."""
    lines = [start]
    for i, entry in enumerate(entries):
        entry += "," if i + 1 < len(entries) else end
        if len(lines[-1]) + len(entry) > 118:
            lines.append("   ")
        lines[-1] += (" " if lines[-1][-1] not in "[(" else "") + entry
    return "\n".join(lines)


def declare(struct):
    entries = [f'*_pointer("{field.name}", {ctype(field.type)})' if field.is_pointer else f'("{field.name}", {ctype(field.type)})'
               for field in struct.fields]
    if any(f"({struct.name})" in entry for entry in entries):
        return f"class {struct.name}(c.Structure): pass\n" + fill(f"{struct.name}._fields_ = [", entries, "]")
    return fill(f"class {struct.name}(c.Structure): _fields_ = [", entries, "]")


def python(description):
    constants = [f"{name} = {quoted(value)}" if isinstance(value, str) or abs(value) < 4096 else f"{name} = {value:#x}"
                 for name, value in description.constants.items()]
    opaque = [f"class {name}(c.Structure): pass" for name in description.opaque]
    callbacks = [f"{f.name} = {prototype(f.result, f.parameters)}" for f in description.functions if f.kind == "callback"]
    rows = [fill(f'    "{f.name}": (', [ctype(f.result, True), "[" + ", ".join(map(ctype, f.parameters)) + "]"], "),")
            for f in description.exported()]
    return (HEAD + "\n".join(constants) + "\n\n\n" + "\n".join(opaque) + "\n" + "\n".join(map(declare, description.structs.values())) +
            "\n\n\n" + "\n".join(callbacks) + "\n\nFUNCTIONS = {\n" + "\n".join(rows) + "\n}\n" + LOAD)


def check_python(text, description):
    """Differences between what ctypes makes of the declarations and the description."""
    module = {}
    exec(compile(text, "odograph_abi.py", "exec"), module)  # pylint: disable=exec-used
    for struct in description.structs.values():
        for field in struct.fields:
            made = getattr(module[struct.name], field.name)
            if (made.offset, made.size) != (field.offset, field.size):
                yield f"{struct.name}.{field.name} is at {made.offset}, of {made.size} bytes, in Python"
