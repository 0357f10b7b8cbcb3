# SPDX-License-Identifier: Apache-2.0
"""Model of the ABI, parsed from its single source, the headers in include/odograph: structs with type, offset and size of
each field, constants, macros, functions and callbacks. generate.py generates files and facts from it.

All targets have the same layout: pointers have 8 bytes (ODO_POINTER, ODO_FUNCTION), each other type is aligned to its
size, and padding is explicit. A violation of the rules of base.h ends the program with a message.
"""
import dataclasses
import pathlib
import re
import sys

WRITTEN = {"layout.h", "messages.h"}  # by generate.py
SCALARS = {"uint8_t": 1, "int32_t": 4, "uint32_t": 4, "float": 4, "double": 8, "int64_t": 8, "uint64_t": 8, "char": 1}
# Of which message, and the name of their list in languages that have one.
ELEMENTS = {"odo_point": ("odo_points", "points"), "odo_vertex": ("odo_surface", "outline")}
LIMITS = {"INT64_MIN": -2**63, "INT64_MAX": 2**63 - 1, "UINT32_MAX": 2**32 - 1, "UINT64_MAX": 2**64 - 1}


@dataclasses.dataclass
class Field:
    name: str
    type: str  # as C spells it, without the name: "double[3]", "const char *", "void (ODO_CALL *)(void *owner)"
    offset: int
    size: int

    @property
    def is_pointer(self):
        return "*" in self.type

    def declare(self, name):
        """A declaration of `name` with this field's type."""
        function = self.type.find("*)(")
        if function >= 0:
            return self.type[:function + 1] + name + self.type[function + 1:]
        base, bracket, count = self.type.partition("[")
        return f"{base} {name}{bracket}{count}".replace("* ", "*")


@dataclasses.dataclass
class Struct:
    name: str
    header: str
    fields: list
    size: int
    alignment: int
    frozen: bool  # may be embedded by value, because it never grows


@dataclasses.dataclass
class Function:
    name: str
    kind: str  # function, entry, callback, inline
    result: str
    call: str  # ODO_CALL
    parameters: list  # as C spells them, with their names
    header: str


@dataclasses.dataclass
class Macro:
    name: str
    parameters: str  # "(type, name)", "" where it takes none
    conditions: str  # of #if around it
    body: str


class Description:
    def __init__(self, include):
        self.include = pathlib.Path(include)
        self.structs, self.functions, self.macros, self.constants, self.opaque = {}, [], [], {}, []
        self.headers = []
        for path in sorted(self.include.glob("*.h")):
            self._read(path.name)
        self._check()

    def _read(self, name):
        if name in self.headers or name in WRITTEN:
            return
        text = re.sub(r"\\\n", " ", (self.include / name).read_text())
        for other in re.findall(r"# *include <odograph/(\w+\.h)>", text):
            self._read(other)
        self.headers.append(name)
        self._read_macros(re.sub(r"/\*.*?\*/", " ", text, flags=re.S))
        text = re.sub(r"^ *#.*$", "", text, flags=re.M).replace('extern "C" {', "")
        frozen = dict(re.findall(r"Frozen at (\d+) bytes(?:(?!\*/).)*\*/\s*typedef struct (\w+)", text, flags=re.S))
        self._read_declarations(re.sub(r"/\*.*?\*/", "", text, flags=re.S), name, {s: int(n) for n, s in frozen.items()})

    def _read_macros(self, text):
        conditions = []
        for line in text.splitlines():
            directive = re.match(r" *# *(\w+) *(.*)", line)
            if not directive:
                continue
            word, rest = directive[1], " ".join(directive[2].split())
            if word in ("if", "ifdef", "ifndef"):
                conditions.append(f"{word} {rest}" if word != "if" else rest)
            elif word in ("elif", "else"):
                conditions[-1] = f"not ({conditions[-1]})" + (f" and {rest}" if rest else "")
            elif word == "endif":
                conditions.pop()
            elif word == "error":
                self.macros.append(Macro("#error", "", " and ".join(conditions[1:]), rest))
            elif word == "define" and not re.fullmatch(r"ODOGRAPH_\w+_H", rest):
                name, parameters, body = re.match(r"(\w+)(\([^)]*\))? ?(.*)", rest).groups()
                self._add_macro(Macro(name, parameters or "", " and ".join(conditions[1:]), body))

    def _add_macro(self, macro):
        value = evaluate(macro.body)
        if value is None or macro.parameters or macro.conditions:
            self.macros.append(macro)
        elif macro.name in self.constants:
            sys.exit(f"{macro.name} is defined twice")
        else:
            self.constants[macro.name] = value

    def _read_declarations(self, text, header, frozen):
        text = " ".join(re.sub(r"^\}$", "", text, flags=re.M).split())
        structs = r"typedef struct (\w+) \{(.*?)\} \1;"
        for name, body in re.findall(structs, text):
            self._add_struct(name, body, header, frozen.get(name))
        text = re.sub(structs, "", text)
        self.opaque += re.findall(r"typedef struct (\w+) \1;", text)
        forms = {"callback": r"typedef ([\w *]+?)\((ODO_CALL )?\*(\w+)\) ?\(([^()]*)\);",
                 "function": r"ODO_API ([\w *]+?)(ODO_CALL )?(odo_\w+) ?\(([^()]*)\);",
                 "entry": r"ODO_EXPORT ([\w *]+?)(ODO_CALL )?(ODO_PLUGIN_ENTRY) ?\(([^()]*)\);",
                 "inline": r"static inline ([\w *]+?)(ODO_CALL )?(odo_\w+)\(([^()]*)\) \{"}
        for kind, form in forms.items():
            for result, call, name, parameters in re.findall(form, text):
                self.functions.append(Function(name, kind, result.strip(), call.strip(), split(parameters), header))

    def _add_struct(self, name, body, header, frozen_size):
        fields, end, widest = [], 0, 1
        for member in filter(None, map(str.strip, body.split(";"))):
            for field, size, alignment in self._members(member, f"{header}: {name}"):
                if end % alignment:
                    sys.exit(f"{header}: {name}.{field.name}: implicit padding before it")
                field.offset = end
                fields.append(field)
                end, widest = end + size, max(widest, alignment)
        if end % widest:
            sys.exit(f"{header}: {name}: implicit padding at the end")
        if frozen_size not in (None, end):
            sys.exit(f"{header}: {name} is frozen at {frozen_size} bytes and has {end}")
        self.structs[name] = Struct(name, header, fields, end, widest, frozen_size is not None)

    def _members(self, member, where):
        """Yields the fields of one declaration, with sizes and alignments."""
        function = re.fullmatch(r"ODO_FUNCTION\((.*?), (\w+), \((.*)\)\)", member)
        pointer = re.fullmatch(r"ODO_POINTER\((.*), (\w+)\)", member)
        if function:
            yield Field(function[2], f"{function[1]} (ODO_CALL *)({function[3]})", 0, 8), 8, 8
        elif pointer:
            yield Field(pointer[2], pointer[1], 0, 8), 8, 8
        elif "*" in member or " " not in member:
            sys.exit(f"{where}: '{member}': a pointer is declared by ODO_POINTER or ODO_FUNCTION")
        else:
            base, names = member.split(" ", 1)
            embedded = self.structs.get(base)
            if embedded and not embedded.frozen:
                sys.exit(f"{where}: embeds {base}, which is not frozen")
            if not embedded and base not in SCALARS:
                sys.exit(f"{where}: '{member}': {base} has no fixed size")
            size, alignment = (embedded.size, embedded.alignment) if embedded else (SCALARS[base],) * 2
            for name in names.split(","):
                name, count = re.fullmatch(r"\s*(\w+)(?:\[(\d+)\])?\s*", name).groups()
                total = size * int(count or 1)
                yield Field(name, base + (f"[{count}]" if count else ""), 0, total), total, alignment

    def _check(self):
        for name, struct in self.structs.items():
            first = struct.fields[0].name
            if self.is_element(name):  # its message states its size
                continue
            if not struct.frozen and first not in ("struct_size", "header"):
                sys.exit(f"{name} begins with {first} instead of its size")
        for name, number in self.messages().items():
            if name not in self.structs:
                sys.exit(f"base.h: no struct for the message type {number:#x}, {name}")
            if not number & self.constants["ODO_BORROWED"] and self.has_pointer(name):
                sys.exit(f"{name}: a message that lends no memory has a pointer")
        if self.constants["ODO_PLUGIN_ENTRY_SYMBOL"] != self.entry_symbol():
            sys.exit("plugin.h: ODO_PLUGIN_ENTRY and ODO_PLUGIN_ENTRY_SYMBOL differ")

    def is_element(self, name):
        """Whether it follows a message, with that one's stride."""
        return name in ELEMENTS

    def has_pointer(self, name):
        fields = self.structs[name].fields
        return any(f.is_pointer or f.type.split("[")[0] in self.structs and self.has_pointer(f.type.split("[")[0]) for f in fields)

    def messages(self):
        """Type numbers by struct name, in the order of the numbers."""
        types = {"odo_" + name[9:].lower(): value for name, value in self.constants.items() if name.startswith("ODO_TYPE_")}
        if len(set(types.values())) != len(types):
            sys.exit("base.h: two messages have one type number")
        return dict(sorted(types.items(), key=lambda item: item[1]))

    def entry_symbol(self):
        return next(macro.body for macro in self.macros if macro.name == "ODO_PLUGIN_ENTRY")

    def exported(self):
        """The exported functions of the library."""
        return [function for function in self.functions if function.kind == "function"]


def split(parameters):
    return [] if parameters.strip() == "void" else [parameter.strip() for parameter in parameters.split(",")]


def evaluate(body):
    """The value of a constant: a number or a string; None for anything else."""
    text = re.fullmatch(r'"([^"]*)"', body)
    if text:
        return text[1]
    number = re.sub(r"\b(0[xX][0-9A-Fa-f]+|\d+)[uUlL]*\b", r"\1", body)
    if not re.fullmatch(r"(?:0[xX][0-9A-Fa-f]+|\d+|[A-Z0-9_]*_(?:MIN|MAX)|[-+|&<>() ])+", number):
        return None
    try:
        return eval(number, {"__builtins__": {}}, LIMITS)  # pylint: disable=eval-used; checked above
    except (NameError, SyntaxError):
        return None
