"""Prints the licence texts of all crates of the program, which MIT and other licences require with a copy."""

import json
import subprocess
from pathlib import Path

CARGO = ["cargo", "metadata", "--locked", "--format-version", "1"]
HOST = next(l[6:] for l in subprocess.check_output(["rustc", "-vV"], text=True).splitlines() if l.startswith("host: "))
data = json.loads(subprocess.check_output([*CARGO, "--filter-platform", HOST]))
nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
todo = [package["id"] for package in data["packages"] if package["name"] == "pinwheel-cli"]
reached = set()
while todo:
    if (at := todo.pop()) not in reached:
        reached.add(at)
        normal = (d for d in nodes[at]["deps"] if any(kind["kind"] is None for kind in d["dep_kinds"]))
        todo += [dependency["pkg"] for dependency in normal]
for package in sorted(data["packages"], key=lambda package: package["name"]):
    if package["id"] in reached and package["source"]:
        print(f"\n=== {package['name']} {package['version']}: {package['license']}\n")
        texts = [p for p in Path(package["manifest_path"]).parent.iterdir() if p.is_file()]
        for text in sorted(texts):
            if text.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE")):
                print(text.read_text("utf-8", "replace"))
