# SPDX-License-Identifier: Apache-2.0
"""Generates the Python binding: ctypes declarations and their types. generate.py writes the returned text."""
from c_types import parse, public_structs, title

SCALARS = {"uint8_t": "_u8", "int32_t": "_i32", "uint32_t": "_u32", "int64_t": "_i64", "uint64_t": "_u64", "float": "_f32", "double": "_f64",
           "char": "_char"}

HEAD = '''# SPDX-License-Identifier: Apache-2.0
# Written by abi/generate.py; do not edit.
"""The C ABI of Odograph for ctypes: constants and structs with their C names; `load` declares the library's functions."""
# pylint: disable=missing-class-docstring, multiple-statements
import ctypes as c

_P = c.POINTER
_u8, _i32, _u32, _i64, _u64 = c.c_uint8, c.c_int32, c.c_uint32, c.c_int64, c.c_uint64
_f32, _f64, _char = c.c_float, c.c_double, c.c_char

def _pointer(name, kind):
    """Fields of a pointer, which has 8 bytes on every target."""
    return [(name, kind)] if c.sizeof(c.c_void_p) == 8 else [(name, kind), (name + "_bits", c.c_uint32)]


'''

SCALARS_OF = {"uint8_t": "c.c_uint8", "int32_t": "c.c_int32", "uint32_t": "c.c_uint32", "int64_t": "c.c_int64", "uint64_t": "c.c_uint64",
              "float": "c.c_float", "double": "c.c_double", "char": "c.c_char"}
MESSAGE_TYPES = """class Message(c.Structure):
    TYPE: int
    header: odo_header
    t_ns: int
    source: int
    flags: int
    quality: float
    picture: bytes | None
    points: c.Array[Any]
    outline: c.Array[Any]
    def __init__(self, **fields: Any) -> None: ..."""
MESSAGE = '''

class Message(c.Structure):
    """A message. Header fields are also attributes of it. Fields without an argument are zero; arrays accept sequences of their length."""
    TYPE = 0
    picture = None  # encoded picture of a recorded frame, PNG or JPEG
    points = ()  # the landmarks of an odo_points, each an odo_point
    outline = ()  # the vertices of an odo_surface, each an odo_vertex
    HEAD = ("t_ns", "source", "flags", "quality")

    def __init__(self, **fields):
        super().__init__()
        self.header.struct_size, self.header.type = c.sizeof(self), self.TYPE
        for name, value in fields.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        if name in self.HEAD:
            setattr(self.header, name, value)
        elif isinstance(value, str):
            super().__setattr__(name, value.encode())
        elif isinstance(getattr(self, name), c.Array) and not isinstance(value, (bytes, c.Array)):
            getattr(self, name)[:] = value
        else:
            super().__setattr__(name, value)

    def __getattr__(self, name):
        if name in self.HEAD:
            return getattr(self.header, name)
        raise AttributeError(f"{type(self).__name__} has no field '{name}'; it has {', '.join(f[0] for f in self._fields_)}")

'''

LOAD = '''

def load(path):
    """Loads the library and declares its functions. An older library may lack some of them."""
    library = c.CDLL(path)
    for name, (result, parameters) in FUNCTIONS.items():
        if hasattr(library, name):
            function = getattr(library, name)
            function.restype, function.argtypes = result, parameters
    return library
'''


def ctype(text, returned=False):
    """The ctypes name of a C type, which may be followed by a parameter name."""
    kind = parse(text)
    if kind.is_function:
        return "c.CFUNCTYPE(" + ", ".join([named(kind)] + [named(argument) for argument in kind.arguments]) + ")"
    return named(kind, returned)


def named(kind, returned=False):
    stars = kind.pointers
    if kind.base == "void":
        name, stars = ("c.c_void_p", stars - 1) if stars else ("None", 0)
    elif kind.base == "char" and stars and returned:
        name, stars = "c.c_char_p", stars - 1  # terminated
    else:
        name = SCALARS.get(kind.base, kind.base)
    return "_P(" * stars + name + ")" * stars + (f" * {kind.count}" if kind.count else "")


def prototype(result, parameters):
    return f"c.CFUNCTYPE({', '.join([ctype(result)] + [ctype(parameter) for parameter in parameters])})"


def quoted(value):
    return f'"{value}"' if isinstance(value, str) else f"{value}"


def fill(start, entries, end):
    """Joins entries in lines of at most 120 characters."""
    lines = [start]
    for i, entry in enumerate(entries):
        entry += "," if i + 1 < len(entries) else end
        if len(lines[-1]) + len(entry) > 118:
            lines.append("   ")
        lines[-1] += (" " if lines[-1][-1] not in "[(" else "") + entry
    return "\n".join(lines)


def declare(description, struct):
    number = description.messages().get(struct.name)
    base = "c.Structure" if number is None else "Message"
    entries = [f'*_pointer("{field.name}", {ctype(field.type)})' if field.is_pointer else f'("{field.name}", {ctype(field.type)})'
               for field in struct.fields]
    if any(f"({struct.name})" in entry for entry in entries):
        return f"class {struct.name}(c.Structure): pass\n" + fill(f"{struct.name}._fields_ = [", entries, "]")
    kind = "" if number is None else f"TYPE = {number:#x}; "
    return fill(f"class {struct.name}({base}): {kind}_fields_ = [", entries, "]")


def declarations(description):
    for struct in description.structs.values():
        yield declare(description, struct)
        if struct.name == "odo_header":
            yield MESSAGE


def python(description):
    constants = [f"{name} = {quoted(value)}" if isinstance(value, str) or abs(value) < 4096 else f"{name} = {value:#x}"
                 for name, value in description.constants.items()]
    aliases = [f"{title(name)} = {name}" for name in public_structs(description)]
    opaque = [f"class {name}(c.Structure): pass" for name in description.opaque]
    callbacks = [f"{f.name} = {prototype(f.result, f.parameters)}" for f in description.functions if f.kind == "callback"]
    rows = [fill(f'    "{f.name}": (', [ctype(f.result, True), "[" + ", ".join(map(ctype, f.parameters)) + "]"], "),")
            for f in description.exported()]
    return (HEAD + "\n".join(constants) + "\n\n\n" + "\n".join(opaque) + "\n" + "\n".join(declarations(description)) + "\n\n" + "\n".join(aliases) +
            "\n\nMESSAGES = {kind.TYPE: kind for kind in Message.__subclasses__()}\n\n" + "\n".join(callbacks) + "\n\nFUNCTIONS = {\n" + "\n".join(rows) + "\n}\n" + LOAD)


def check_python(text, description):
    """Yields differences between the layout in ctypes and the description."""
    module = {}
    exec(compile(text, "odograph_abi.py", "exec"), module)  # pylint: disable=exec-used
    for struct in description.structs.values():
        for field in struct.fields:
            made = getattr(module[struct.name], field.name)
            if (made.offset, made.size) != (field.offset, field.size):
                yield f"{struct.name}.{field.name} is at {made.offset}, of {made.size} bytes, in Python"


def stub(description):
    """The type stubs for the output of `python`."""
    def kind(text):
        made = parse(text)
        if made.is_function or made.pointers:
            return "Any"
        if made.base == "char":
            return "bytes"
        one = "float" if made.base in ("float", "double") else "int" if made.base in SCALARS else made.base
        return f"c.Array[{SCALARS_OF[made.base] if made.base in SCALARS else made.base}]" if made.count else one

    def declare_types(struct, message):
        lines = [f"class {struct.name}({'Message' if message else 'c.Structure'}):"]
        return "\n".join(lines + [f"    {field.name}: {kind(field.type)}" for field in struct.fields])

    constants = [f"{name}: {'str' if isinstance(value, str) else 'int'}" for name, value in description.constants.items()]
    structs = [declare_types(s, s.name in description.messages()) for s in description.structs.values()]
    structs.insert(list(description.structs).index("odo_header") + 1, MESSAGE_TYPES)
    aliases = [f"{title(name)} = {name}" for name in public_structs(description)]
    callbacks = [f"{f.name}: Any" for f in description.functions if f.kind == "callback"]
    return (HEAD.split('"""')[0] + "import ctypes as c\nfrom typing import Any\n\n" + "\n".join(constants) + "\n\n" +
            "\n".join(f"class {name}(c.Structure): ..." for name in description.opaque) + "\n" + "\n".join(structs) + "\n\n" + "\n".join(aliases + callbacks) +
            "\nMESSAGES: dict[int, type[Message]]\nFUNCTIONS: dict[str, Any]\ndef load(path: str) -> c.CDLL: ...\n")
