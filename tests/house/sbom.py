#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The SBOMs of an unpacked installation against other sources than those of packaging/sbom (linker's maps, ELF headers): the loader (ldd), and the
symbols that a file of the build has in common with each static archive that anything is linked with (nm). Nothing that they have is missing.

  tests/house/sbom.py INSTALLATION BUILD
"""
import glob
import gzip
import json
import os
import re
import subprocess
import sys

STRONG = "TDBR"  # global symbols of which a program has one definition


def lines_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def symbols(path, kinds):
    """Names that a file or the members of an archive define; what has a version is a library's, of which a program may hold a copy."""
    fields = (line.split() for line in lines_of("nm", "--defined-only", path))
    return {f[2] for f in fields if len(f) == 3 and f[1] in kinds and "@" not in f[2]}


def static_archives(build):
    """Archives outside of the build that a link command names, and the compiler's own: by path their global symbols."""
    found = set(re.findall(r"(?<=\s)/\S+\.a(?=\s)", open(f"{build}/build.ninja").read()))
    found |= {lines_of("c++", f"-print-file-name={name}")[0] for name in ("libgcc.a", "libgcc_eh.a", "libc_nonshared.a", "libstdc++.a")}
    return {path: symbols(path, STRONG) for path in sorted(found) if os.path.isabs(path) and not path.startswith(build)}


def built(build):
    """Files of the build by name, before they were stripped."""
    return {os.path.basename(path): path for path in glob.glob(f"{build}/bin/*") + glob.glob(f"{build}/lib/**/*.so*", recursive=True) if os.path.isfile(path)}


def main(root, build):
    archives, unstripped = static_archives(os.path.realpath(build)), built(build)
    wrong, libraries, parts, files = [], 0, 0, 0
    for path in sorted(glob.glob(f"{root}/share/doc/*/sbom.*.spdx.json.gz")):
        sbom = json.load(gzip.open(path))
        ids = {element["SPDXID"] for element in sbom["packages"] + sbom["files"]} | {"SPDXRef-DOCUMENT"}
        wrong += [f"{path}: {r}" for r in sbom["relationships"] if r["spdxElementId"] not in ids or r["relatedSpdxElement"] not in ids]
        folder, name = os.path.split(path)
        notices = gzip.open(f"{folder}/notices.{name.split('.')[1]}.gz", "rt").read()
        for entry in sbom["files"]:
            files += 1
            file = root + entry["fileName"].removeprefix("./usr")
            listed = re.split(r"[,\s]+", " ".join(r.get("comment", "") for r in sbom["relationships"] if r["spdxElementId"] == entry["SPDXID"]))
            for name in (os.path.basename(line.split()[0]) for line in lines_of("ldd", file)):
                libraries += 1
                own = name.startswith("libodograph.so.")  # listed with its own package
                if "vdso" not in name and not own and name not in listed:
                    wrong.append(f"{path}: {entry['fileName']} is linked to {name}")
            has = symbols(unstripped[os.path.basename(file)], STRONG + STRONG.lower())
            for archive in (a for a, defined in archives.items() if has & defined):
                parts += 1
                if os.path.basename(archive) not in listed or os.path.basename(archive) not in notices:
                    wrong.append(f"{path}: {entry['fileName']} has parts of {archive}: {', '.join(sorted(has & archives[archive])[:3])}")
    print(f"{files} files: {libraries} libraries by ldd, parts of static archives {parts} times by nm ({len(archives)} archives looked at): {len(wrong)} are missing")
    sys.exit("\n".join(wrong) or (files < 20 or parts < 5) and "too little was looked at")


main(*sys.argv[1:])
