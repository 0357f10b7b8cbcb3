#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Applies violations of the contract one at a time; a check must detect each.

    abi_mutations.py PROJECT BUILD

Each row is applied to a copy; an edit that does not apply is an error. Where headers or the linker's map change, all that is
generated is generated anew, as a careless author would, and what is compared with is the contract before the edit as that of release 1.0. Where the host or a plugin changes, that one file is compiled as in the build and linked with the rest.
A check has noticed when it fails and names what the row expects; every check must pass on the unchanged tree, and the
contract's with each addition of GROWTH.
"""
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from abi_mutations_table import GROWTH, ROWS

PROJECT, BUILD = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
ABI = ("abi", "sdk/host/odograph.map")


def run(command, cwd=None):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, errors="replace", check=False)
    return done.returncode, done.stdout + done.stderr


def edit(path, before, after):
    text = path.read_text()
    if text.count(before) != 1:
        sys.exit(f"{path}: '{before}' is there {text.count(before)} times instead of once: the table is out of date")
    path.write_text(text.replace(before, after))


def copy_abi(folder):
    for part in ABI:
        source, target = PROJECT / part, folder / part
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(source, target) if source.is_dir() else shutil.copy(source, target)
    base = folder / "abi/include/odograph/base.h"
    base.write_text(re.sub(r"ODO_ABI_MAJOR \d+u", "ODO_ABI_MAJOR 1u", base.read_text()))
    status, text = run([sys.executable, folder / "abi/generate.py"])
    if status:
        sys.exit(text)
    shutil.copy(folder / "abi/golden/contract_v1.txt", folder / "abi/golden/released_v1.txt")


def contract(folder, _):
    generated, text = run([sys.executable, folder / "abi/generate.py"])
    return (generated, text) if generated else run([sys.executable, folder / "abi/generate.py", "--check"])


def binary(folder, _):
    run([sys.executable, folder / "abi/generate.py"])
    return run([PROJECT / "tests/contract/abi_binary.sh", folder])


def targets(folder, _):
    run([sys.executable, folder / "abi/generate.py"])
    return run([PROJECT / "tests/contract/abi_targets.sh", folder])


def relink(folder, file, target):
    """The target with the changed file in the place of its own object, or before the archive that has it."""
    output = folder / "linked" / target
    output.parent.mkdir(parents=True, exist_ok=True)
    commands = run(["ninja", "-C", BUILD, "-t", "commands", target])[1].splitlines()
    link = shlex.split(next(part for command in reversed(commands) for part in re.split(r" && ", command) if " -o " in part))
    link[link.index("-o") + 1] = str(output)
    link = [word for word in link if not word.startswith("-Wl,-Map=")]  # the map belongs to the build
    if file:
        source = folder / file
        for row in json.loads((BUILD / "compile_commands.json").read_text()):
            if row["file"] == str(PROJECT / file):
                break
            if row["file"].startswith(str(BUILD)) and f'"{file}"' in (batch := pathlib.Path(row["file"]).read_text()):
                source = folder / "batch.cpp"
                source.write_text(batch.replace(f'"{file}"', f'"{folder / file}"'))
                break
        compiler = shlex.split(row["command"])
        own = compiler[compiler.index("-o") + 1]
        compiler[compiler.index("-o") + 1] = str(folder / "changed.o")
        compiler[compiler.index("-c") + 1] = str(source)
        status, text = run(compiler + ["-O0", "-w"], BUILD)
        if status:
            sys.exit(f"{file} does not compile: {text}")
        if own in link:
            link[link.index(own)] = str(folder / "changed.o")
        else:
            link.insert(next(i for i, word in enumerate(link) if word.endswith((".o", ".a"))), str(folder / "changed.o"))
    status, text = run(link, BUILD)
    return output if status == 0 else sys.exit(f"{target} does not link: {text}")


def conformance(folder, file):
    """The cases of the conformance suite that the table names."""
    library = relink(folder, file, "lib/libodograph.so")
    names = [expected.removeprefix("fail  ") for _, _, check, expected in ROWS if check == "conformance"]
    found = [run([BUILD / "bin/odograph-host-conformance", library, "--only", name]) for name in names]
    return max(status for status, _ in found), "".join(text for _, text in found)


def config(folder, file):
    """Rewrites the manifest of a changed plugin; links a changed file of the host into the program."""
    plugins = BUILD / "lib/odograph/plugins"
    program = BUILD / "bin/odograph"
    if file and file.startswith("plugins/"):
        name = "_".join(file.split("/")[1:3])
        library = relink(folder, file, f"odograph_{name}")
        shutil.copytree(plugins, folder / "all", ignore=shutil.ignore_patterns("*.so"))
        shutil.copy(library, folder / f"all/{name}.so")
        run([BUILD / "bin/odograph-manifest", folder / f"all/{name}.so"])
        plugins = folder / "all"
    elif file:
        program = relink(folder, file, "odograph-cli")
    return run([sys.executable, PROJECT / "tests/contract/abi_config.py", PROJECT, program, plugins])


CHECKS = {check.__name__: check for check in (contract, binary, targets, conformance, config)}


def attempt(check, edits):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        is_abi = check in ("contract", "binary", "targets")
        if is_abi:
            copy_abi(folder)
        for file, before, after in edits:
            if not is_abi and not (folder / file).exists():  # a second edit of the same file adds to the first
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(PROJECT / file, folder / file)
            edit(folder / file, before, after)
        return CHECKS[check](folder, edits[0][0] if edits else None)


def main():
    for check in CHECKS:
        status, text = attempt(check, [])
        if status not in (0, 77):
            sys.exit(f"{check} fails on the unchanged tree: {text}")
        if status == 77:
            print(f"SKIPPED: {check}: {text.strip().splitlines()[-1]}")
    for name, edits in GROWTH:
        status, text = attempt("contract", edits)
        if status:
            sys.exit(f"{name}: allowed, but refused: {text}")
    caught, missed = {}, []
    for name, edits, check, expected in ROWS:
        status, text = attempt(check, edits)
        if status in (0, 77) or expected not in text:
            missed.append(f"{name}: {check} returned {status} without '{expected}':\n{text}")
        else:
            caught[check] = caught.get(check, 0) + 1
    print("\n".join(missed))
    print(f"{sum(caught.values())} of {len(ROWS)} caught, by " + ", ".join(f"{check} ({n})" for check, n in caught.items()) +
          f"; {len(GROWTH)} additions pass")
    sys.exit(1 if missed else 0)


main()
