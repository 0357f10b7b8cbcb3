# SPDX-License-Identifier: Apache-2.0
"""The promises of the ABI as facts, KIND NAME = VALUE, and their comparison, with a release by the rules of growth."""
import re


def nodes(path):
    """The version node of each symbol in the library's linker map."""
    found = {}
    for node, body in re.findall(r"(\w[\w.]*) \{(.*?)\}", path.read_text(), flags=re.S):
        exported = body.split("local:")[0]
        found.update({name: node for name in re.findall(r"\b(odo_[\w*]+);", exported)})
    return found


def facts(abi, minimum, linker_map):
    """All facts by name, in header order."""
    found = {}
    for name, struct in abi.structs.items():
        found[f"struct {name}"] = f"{struct.size}" + (" frozen" if struct.frozen else "")
        for field in struct.fields:
            found[f"field {name}.{field.name}"] = f"{field.offset} {field.size} {field.type}"
    found.update({f"minimum {name}": f"{size}" for name, size in minimum.items()})
    found.update({f"message {name}": f"{number:#x}" for name, number in abi.messages().items()})
    found.update({f"constant {n}": f'"{v}"' if isinstance(v, str) else f"{v}" for n, v in abi.constants.items()})
    for f in abi.functions:
        found[f"{f.kind} {f.name}"] = " ".join(filter(None, [f.result, f.call, f"({', '.join(f.parameters)})"]))
    found.update({f"opaque {name}": "struct" for name in abi.opaque})
    found["symbol of the entry"] = abi.entry_symbol()
    found.update({f"symbol {name}": node for name, node in nodes(linker_map).items()})
    for macro in abi.macros:
        conditions = f" where {macro.conditions}" if macro.conditions else ""
        found[f"macro {macro.name}{conditions}"] = f"{macro.parameters} {macro.body}".strip() or "nothing"
    return found


def text_of(found):
    return "".join(f"{name} = {value}\n" for name, value in found.items())


def read(text):
    return dict(line.split(" = ", 1) for line in text.splitlines())


def differences(before, after, where):
    old, new = read(before), read(after)
    for name in list(old) + [name for name in new if name not in old]:
        if old.get(name) != new.get(name):
            yield f"{name}: {where} '{old.get(name, 'absent')}', now '{new.get(name, 'absent')}'"


def may_change(abi, name, before, after):
    """Whether a released fact may change: only the size of a struct that is not frozen, and the minor version, may increase."""
    kind, subject = name.split(" ")[:2]
    if kind == "struct" and "frozen" not in before + after:
        return int(after) >= int(before)
    if name == "constant ODO_ABI_MINOR":
        return int(after) >= int(before)
    return False


def breaks(abi, released, now):
    """Yields the violations of released facts by the current ones."""
    old, new = read(released), read(now)
    for name, before in old.items():
        after = new.get(name)
        if after is None or after != before and not may_change(abi, name, before, after):
            yield f"{name}: released as '{before}', now '{'absent' if after is None else after}': that breaks old binaries"
    for name in new:
        if name in old or not name.startswith("field "):
            continue
        struct, field = name[6:].split(".")
        end = int(old.get(f"struct {struct}", "0").split()[0])
        offset, _, kind = new[name].split(" ", 2)
        if end and int(offset) < end:
            yield f"{name}: new, but not at the end of the released struct"
        inner = kind.split("[")[0]
        if end and struct in abi.messages() and ("*" in kind or inner in abi.structs and abi.has_pointer(inner)):
            yield f"{name}: a pointer was appended to a message"
