#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The SBOMs of an unpacked installation against ldd and the linker's maps: nothing that they have is missing."""
import glob
import gzip
import json
import os
import re
import subprocess
import sys

root, build = sys.argv[1:]
maps = {}
for path in glob.glob(f"{build}/maps/*.map"):
    text = open(path, errors="replace").read()
    maps[os.path.basename(re.search(r"^OUTPUT\((\S+)", text, re.M).group(1))] = text
wrong, libraries, archives, files = [], 0, 0, 0
for path in sorted(glob.glob(f"{root}/share/doc/*/sbom.spdx.json.gz")):
    sbom = json.load(gzip.open(path))
    ids = {element["SPDXID"] for element in sbom["packages"] + sbom["files"]} | {"SPDXRef-DOCUMENT"}
    wrong += [f"{path}: {r}" for r in sbom["relationships"] if r["spdxElementId"] not in ids or r["relatedSpdxElement"] not in ids]
    notices = gzip.open(os.path.join(os.path.dirname(path), "notices.gz"), "rt").read()
    for entry in sbom["files"]:
        files += 1
        file = root + entry["fileName"].removeprefix("./usr")
        told = "".join(r.get("comment", "") + ", " for r in sbom["relationships"] if r["spdxElementId"] == entry["SPDXID"])
        for line in subprocess.run(["ldd", file], capture_output=True, text=True, check=True).stdout.splitlines():
            name = os.path.basename(line.split()[0])
            libraries += 1
            own = name.startswith("libodograph.so.")  # listed with its own package
            if "vdso" not in name and not own and name not in told.replace(",", " ").split():
                wrong.append(f"{path}: {entry['fileName']} is linked to {name}")
        for archive in set(re.findall(r"^(/\S+\.a)\(\S+\)", maps[os.path.basename(file)], re.M)):
            archives += 1
            if os.path.basename(archive) not in told.replace(",", " ").split() or os.path.basename(archive) not in notices:
                wrong.append(f"{path}: {entry['fileName']} has parts of {archive}")
print(f"{files} files, {libraries} libraries by ldd, {archives} archives by the linker: {len(wrong)} are missing")
sys.exit("\n".join(wrong) or files < 20 and "too few files")
