#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""YAML keys, ids of shipped plugins and their parameters, as facts, compared with abi/golden/config_v1.txt.

    abi_config.py PROJECT ODOGRAPH PLUGIN_FOLDER [--write]

A fact is a key's path with its type, unit, range, choices and default, as the program's JSON Schemas and the plugins'
manifests state them; help texts are not promised. The facts of abi/golden/config_released_v1.txt are those of the last release
(packaging/release): facts may be added to them, and a key that the reader demands may not; may_change has what else may change.
"""
import doctest
import json
import pathlib
import re
import subprocess
import sys

PROJECT, PROGRAM, PLUGINS = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
sys.path.insert(0, str(PROJECT / "abi"))
from facts import differences, read, text_of  # noqa: E402
SCHEMAS = ("pipeline", "camera", "scenario", "faults", "odoplugin")
# Follows the help text in a schema's description.
STATED = re.compile(r"(?:(?:^|; )in (?P<unit>[^;]+))?(?:(?:^|; )default (?P<default>[^;]*))?$")


def kind_of(node):
    """Type, range, choices and accepted units of a value."""
    alternatives = node.get("oneOf") or node.get("anyOf") or [node]
    texts = []
    for one in alternatives:
        text = one.get("const") or one.get("type") or ("one of" if "enum" in one else "any")
        text = str(text) + "".join(f" {word} {one[word]}" for word in ("pattern", "minItems", "maxItems") if word in one)
        if "minimum" in one or "maximum" in one:
            text += f" {one.get('minimum', '-inf')} to {one.get('maximum', 'inf')}"
        if "enum" in one:
            text += " " + "|".join(map(str, one["enum"]))
        texts.append(text)
    return " or ".join(texts)


def schema_facts(node, path, required, found):
    stated = STATED.search(node.get("description", ""))
    words = [kind_of(node)] + [f"{name} {value}" for name, value in stated.groupdict().items() if value is not None]
    found[f"key {path}"] = "; ".join(words + (["required"] if required else []))
    for name, child in node.get("properties", {}).items():
        schema_facts(child, path + name if path[-1] == ":" else f"{path}.{name}", name in node.get("required", []), found)
    if isinstance(node.get("items"), dict):
        schema_facts(node["items"], f"{path}[]", False, found)
    for word in ("oneOf", "anyOf"):
        for i, alternative in enumerate(node.get(word, [])):
            if alternative.get("properties") or isinstance(alternative.get("items"), dict):
                schema_facts(alternative, f"{path}({i})", False, found)


def plugin_facts(manifest, found):
    identity = manifest["id"]
    interfaces = manifest.get("interfaces") or [manifest["interface"]]
    found[f"plugin {identity}"] = " ".join(interfaces)
    for parameter in manifest.get("parameters", []):
        rest = {name: value for name, value in sorted(parameter.items()) if name not in ("name", "help")}
        found[f"parameter {identity}.{parameter['name']}"] = json.dumps(rest, ensure_ascii=False)


def facts():
    found = {}
    for name in SCHEMAS:
        schema = subprocess.run([PROGRAM, "config", "schema", name], capture_output=True, text=True, check=True).stdout
        schema_facts(json.loads(schema), f"{name}:", False, found)
    for path in sorted(PLUGINS.glob("*.odoplugin.json")):
        plugin_facts(json.loads(path.read_text()), found)
    return found


def widens(old, new):
    """Whether a key accepts all that it accepted before, by its choices or its range."""
    choices, limits = ([re.fullmatch(pattern, kind) for kind in (old, new)] for pattern in (r"one of (\S+)", r"(.*?) (\S+) to (\S+)"))
    if all(choices):
        return {*choices[0][1].split("|")} <= {*choices[1][1].split("|")}
    return all(limits) and limits[0][1] == limits[1][1] and float(limits[1][2]) <= float(limits[0][2]) and float(limits[1][3]) >= float(limits[0][3])


def may_change(name, before, after):
    """Whether a released fact may change: defaults of plugins' parameters, choices and ranges that widen, what is no longer demanded.

    >>> made = '{"choices": "%s", "count": 1, "default": "%s", "max": %s, "min": 0, "type": "real", "unit": "%s"}'
    >>> may_change("parameter a/b.c", made % ("", 1, 5, "m"), made % ("", 2, 6, "m"))
    True
    >>> may_change("parameter a/b.c", made % ("", 1, 5, "m"), made % ("", 1, 4, "m"))
    False
    >>> may_change("parameter a/b.c", made % ("", 1, 5, "m"), made % ("", 1, 5, "s"))
    False
    >>> may_change("parameter a/b.c", made % ("x|y", 1, 5, "m"), made % ("x|z|y", 1, 5, "m"))
    True
    >>> may_change("key p:k", "one of x|y; default x; required", "one of x|y|z; default x")
    True
    >>> may_change("key p:k", "one of x|y; default x", "one of x|y; default y")
    False
    >>> may_change("key p:k", "number 0 to 5; in s", "number 0 to inf; in s"), may_change("key p:k", "number 0 to 5", "number 1 to 5")
    (True, False)
    >>> may_change("key p:k", "number", "number; required")
    False
    >>> may_change("plugin a/b", "odo.attitude/1", "odo.attitude/1 odo.attitude/2")
    True
    """
    if name.startswith("parameter "):
        old, new = json.loads(before), json.loads(after)
        same = all(old[part] == new[part] for part in ("type", "count", "unit"))
        return same and new["min"] <= old["min"] and new["max"] >= old["max"] and {*old["choices"].split("|")} <= {*new["choices"].split("|")}
    if name.startswith("plugin "):
        return {*before.split()} <= {*after.split()}
    (old, *stated), (new, *restated) = before.split("; "), after.split("; ")
    return (old == new or widens(old, new)) and restated in (stated, [text for text in stated if text != "required"])


def breaks(released, now):
    old, new = read(released), read(now)
    for name, before in old.items():
        if new.get(name) != before and not (name in new and may_change(name, before, new[name])):
            yield f"{name}: released as '{before}', now '{new.get(name, 'absent')}': that breaks old configs"
    for name, value in new.items():
        if name not in old and value.endswith("; required") and name.rpartition(".")[0] in old:
            yield f"{name}: new and required: old configs do not have it"


def main():
    golden, released = (PROJECT / f"abi/golden/{name}_v1.txt" for name in ("config", "config_released"))
    text = text_of(facts())
    if "--write" in sys.argv:
        return golden.write_text(text)
    if doctest.testmod().failed:
        sys.exit(1)
    wrong = list(differences(golden.read_text(), text, "golden"))
    wrong += breaks(released.read_text(), text) if released.exists() else [f"{released} is missing: packaging/release writes it"]
    if wrong:
        sys.exit("\n".join(wrong))
    return print(f"{len(read(text))} facts of configs and plugins hold")


main()
