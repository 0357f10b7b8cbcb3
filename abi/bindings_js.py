# SPDX-License-Identifier: Apache-2.0
"""Generates the JavaScript and TypeScript binding: memory layout and types of the messages. generate.py writes the returned text.
Names are those of C. Header fields are members of each message, and 64-bit integers are bigints."""
from c_types import CALLS, is_event, parse
from description import ELEMENTS

CODES = {"uint8_t": "u8", "int32_t": "i32", "uint32_t": "u32", "int64_t": "i64", "uint64_t": "u64", "float": "f32", "double": "f64", "char": "char"}
STRUCTS = ["odo_string", "odo_error", *CALLS]  # in addition to the messages
HEAD = "// SPDX-License-" "Identifier: Apache-2.0\n// Written by abi/generate.py; do not edit.\n"
SKIPPED = {"struct_size", "reserved", "type"}  # not visible: size, padding and the type number, which `type` gives by name


def members(description, name, base=0, prefix=""):
    """Yields name, code, offset and count of each number or array, with embedded structs flattened. Addresses have the code `ptr`."""
    for field in description.structs[name].fields:
        kind, _, count = field.type.replace("struct ", "").partition("[")
        count = int(count[:-1]) if count else 1
        at, label = base + field.offset, prefix + field.name
        if field.is_pointer:
            yield label, "ptr", at, 1
        elif kind in CODES:
            yield label, CODES[kind], at, count
        else:
            inner = "" if field.name == "header" else label + "_"
            for i in range(count):
                size = description.structs[kind].size
                yield from members(description, kind, at + i * size, f"{inner[:-1]}{i}_" if count > 1 else inner)


def kept(description, name):
    return [m for m in members(description, name) if m[0] not in SKIPPED]


def constants(description):
    """Constants for users of messages and sessions."""
    return {name: value for name, value in description.constants.items()
            if not isinstance(value, str) and not name.startswith("ODO_LARGEST") and -2**31 <= value < 2**32}


def javascript(description):
    types = ",\n".join(f"  {name[4:]}: {number:#x}" for name, number in description.messages().items())
    rows = []
    for name in [*description.messages(), *filter(description.is_element, description.structs), *STRUCTS]:
        fields = ",\n".join(f"    {label}: ['{code}', {at}{', ' + str(count) if count > 1 else ''}]"
                            for label, code, at, count in kept(description, name))
        rows.append(f"  {name[4:]}: {{size: {description.structs[name].size}, fields: {{\n{fields},\n  }}}}")
    lines = [f"export const {name} = {value};" for name, value in constants(description).items()]
    return (HEAD + "\n".join(lines) + "\n\n// Type numbers of the messages.\nexport const TYPES = {\n" + types +
            ",\n};\n\n// Size of each struct in bytes; type, offset and count of each field.\nexport const STRUCTS = {\n" + ",\n".join(rows) + ",\n};\n")


def typescript(description):
    def kind(code, count, label):
        if code == "char":
            return "string"
        if code == "ptr":
            return "Pointer"
        one = "bigint" if code in ("i64", "u64") else "number"
        return f"{one}[]" if count > 1 else one

    def interface(name, message):
        title = "".join(part.capitalize() for part in name[4:].split("_"))
        body = [f"  type: '{name[4:]}';"] if message else []
        body += [f"  {label}: {kind(code, count, label)};" for label, code, _, count in kept(description, name)]
        body += [f"  {label}: {element[4:].capitalize()}[];" for element, (of, label) in ELEMENTS.items() if of == name]
        return title, f"export interface {title} {{\n" + "\n".join(body) + "\n}"

    made = [interface(name, True) for name in description.messages()]
    events = [title for (title, _), number in zip(made, description.messages().values()) if is_event(number)]
    inputs = [title for title, _ in made if title not in events]
    lines = [f"export const {name}: {value};" for name, value in constants(description).items()]
    return (HEAD + "\n".join(lines) + "\n\n/** An address: a number in a browser, a bigint in Node. */\nexport type Pointer = number | bigint;\n\n" + "\n\n".join(text for _, text in [*made, *[interface(name, False) for name in description.structs if description.is_element(name)], *[interface(name, False) for name in CALLS[1:]]]) +
            "\n\nexport type Input = " + " | ".join(inputs) + ";\nexport type Event = " + " | ".join(events) +
            ";\nexport type Message = Input | Event;\nexport type MessageName = Message['type'];\n"
            "export const TYPES: Record<MessageName, number>;\n"
            "export const STRUCTS: Record<string, {size: number; fields: Record<string, [string, number, number?]>}>;\n")


def prototypes(description):
    """Prototypes for koffi, with every pointer as void *."""
    def plain(text):
        kind = parse(text)
        if kind.base == "char" and kind.pointers and not kind.name:
            return "const char *"
        pointer = kind.pointers or kind.base in ("odo_callback", "odo_plugin_entry")
        return ("void *" if pointer else kind.base + " ") + kind.name

    rows = [f"  '{plain(f.result)}{f.name}({', '.join(plain(p) for p in f.parameters)})'," for f in description.exported()]
    return HEAD + "export const PROTOTYPES = [\n" + "\n".join(rows) + "\n];\n"
