#!/usr/bin/env python3
"""Compares the sidecars of two builds number for number: compare_bakes.py OLD NEW [SCRIPT...]

Bakes every wear script of the repository on a garment of the repository, by the builds OLD and NEW in turn, and compares the
sidecars key by key. Keys under `run` describe the run and are left out. Prints the number of differences and the wall time of
both; exit code 1 if there is one."""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

GARMENTS = pathlib.Path(__file__).resolve().parents[2] / "garments"
BAKES = [
    ("press-crease", "handkerchief", None),
    ("crumple", "handkerchief", None),
    ("fold-thrice", "tshirt-draft", None),
    ("fold-thrice", "tshirt", None),
    ("trouser-crease", "trousers", None),
    ("sit-down", "trousers-on-legs", "trousers"),
    ("elbow-ten-bends", "sleeve", "sleeve"),
]


def bake(build, script, mesh, worn, out):
    mesh = GARMENTS / f"{mesh}.glb"
    command = [build, "bake", mesh, "--wear", GARMENTS / "wear" / f"{script}.json", "-o", out, "--quiet"]
    if worn:
        command += ["--garment", worn, "--body", mesh]
    start = time.monotonic()
    code = subprocess.run(list(map(str, command)), check=False).returncode
    if code not in (0, 3):
        sys.exit(f"{build} {script}: exit code {code}")
    return json.loads(out.with_suffix(".crease.json").read_text()), time.monotonic() - start


def differences(a, b, path=""):
    if isinstance(a, dict) and isinstance(b, dict):
        keys = (a.keys() | b.keys()) - ({"run"} if not path else set())
        return [d for k in sorted(keys) for d in differences(a.get(k), b.get(k), f"{path}/{k}")]
    return [] if a == b else [path]


def main():
    old, new, *wanted = sys.argv[1:]
    failed = False
    for script, mesh, worn in BAKES:
        if wanted and script not in wanted:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            a, old_s = bake(old, script, mesh, worn, folder / "old.glb")
            b, new_s = bake(new, script, mesh, worn, folder / "new.glb")
        found = differences(a, b)
        failed |= bool(found)
        print(f"{script} on {mesh}: {len(found)} differences {found[:5]}, {old_s:.1f} and {new_s:.1f} s", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main()
