#!/usr/bin/env python3
"""The same two scenes in crease and in other programs, one after another, and a table of what they cost and of what came out.

    python tests/bench/peers/run.py [--crease COMMAND] [--blender-python PYTHON] [--peer-python PYTHON] ...

README.md beside this file says how to install the others. One that is missing is named in the output and left out.
Crossings are counted in every frame, twelve a second, by `crossings.py`.
"""

import argparse
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import crossings
import numpy as np
from scenes import FRAMES_PER_SECOND, SCENES

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]

# Blender's own contact distances, 15 mm and 20 mm, are wider than the edges of both scenes, so that neighbours repel.
FINE = {"distance": 0.003, "clearance": 0.004}
PRESETS = ("Cotton", "Silk", "Denim", "Leather")
HIGH = {"quality": 15, "collision_quality": 5}
BLENDER = [(f"preset {preset}", {"preset": preset, **FINE}) for preset in PRESETS]
BLENDER += [(f"preset {preset}, quality 15, collisions 5", {"preset": preset, **FINE, **HIGH}) for preset in PRESETS]
BLENDER += [("preset Cotton, its own contact distances", {"preset": "Cotton"})]

PEERS = {
    "Blender": ("bpy", "in_blender.py", BLENDER),
    "MuJoCo": ("mujoco", "in_mujoco.py", [("steps of 2 ms", {"step": 0.002})]),
    "rapier": ("rapier3d", "in_rapier.py", [("steps of 1/60 s, edges of 1 kHz", {"step": 1 / 60, "frequency": 1000.0})]),
}
CREASE = [("default", []), ("quality draft", ["--quality", "draft"]), ("all points simulated", ["--no-grading"])]
WEAR = {
    "fold": [
        {"lay": {"facing": "up", "over": 0.5}},
        {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left", "angle": 180, "over": 2.0, "hold": 1.0}},
        {"unfold": {"all": True, "over": 2.0}},
    ],
    "strip": [
        {"hang": {"by": [[0.0, 1.0], [0.5, 1.0], [1.0, 1.0]], "for": 0.5}},
        {"release": {}},
        {"settle": {"for": 2.0}},
    ],
}


def commands():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--crease", default=os.environ.get("CREASE_COMMAND", ROOT / "target/release/crease"))
    options.add_argument("--blender-python", default=sys.executable, help="Python that has bpy [default: this one]")
    options.add_argument("--peer-python", default=sys.executable, help="Python that has mujoco and rapier3d [default: this one]")
    options.add_argument("--scenes", default="fold,strip")
    options.add_argument("--only", default="", help="run only what this regular expression finds, such as 'crease|Cotton$'")
    options.add_argument("--limit", type=float, default=600.0, help="wall time after which a peer is stopped [s]")
    options.add_argument("--keep", help="folder for the frames, OBJ or npz [default: none is kept]")
    return options.parse_args()


def has_module(python, module):
    probe = "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)"
    return shutil.which(python) is not None and subprocess.run([python, "-c", probe, module]).returncode == 0


def absolute(command):
    """Path of a command that holds in every folder; links of virtual environments are kept."""
    return os.path.abspath(shutil.which(command) or command)


def write_obj(path, scene):
    """Writes the scene with y up, as OBJ files have it."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"v {x:.9g} {z:.9g} {-y:.9g}\n" for x, y, z in scene.points)
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in scene.triangles + 1)


def read_points(path):
    """Reads points with y up, z up."""
    with open(path, encoding="utf-8") as file:
        x, y, z = np.array([line.split()[1:4] for line in file if line.startswith("v ")], float).T
    return np.stack([x, -z, y], 1)


def run_crease(command, scene, options, folder):
    """One bake that is timed and, with the same result, one that writes the frames."""
    write_obj(folder / "scene.obj", scene)
    (folder / "wear.json").write_text(json.dumps({"format": "crease-wear/1", "actions": WEAR[scene.name]}))
    bake = [command, "bake", folder / "scene.obj", "--unit", "m", "--wear", folder / "wear.json"]
    bake += ["-o", folder / "worn.glb", "--quiet", *options]
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    status = subprocess.run(bake).returncode
    wall, after = time.perf_counter() - wall, resource.getrusage(resource.RUSAGE_CHILDREN)
    if status:
        raise SystemExit(f"crease ended with exit code {status}")
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    simulated = json.loads((folder / "worn.report.json").read_text())["simulated_s"]
    subprocess.run([*bake, "--frames", folder / "frames", "--fps", str(FRAMES_PER_SECOND)], check=True)
    # The last frame is the result, in the pose of the file.
    frames = np.array([read_points(path) for path in sorted((folder / "frames").glob("*.obj"))[:-1]])
    times = np.arange(len(frames)) / FRAMES_PER_SECOND
    if scene.name == "fold":
        # The scene begins once the sheet lies, in the middle of the ground.
        frames = frames + (scene.points - frames[0])[0]
        times = times - WEAR["fold"][0]["lay"]["over"]
    return {"frames": frames, "times": times, "wall": wall, "processor": processor, "simulated": simulated}


def run_peer(python, script, scene, settings, limit, folder):
    output = folder / "frames.npz"
    call = [python, HERE / script, scene, json.dumps(settings), output, "--limit", str(limit)]
    with open(folder / "log", "w+", encoding="utf-8") as log:
        if subprocess.run(call, stdout=log, stderr=log, cwd=folder).returncode:
            log.seek(0)
            raise RuntimeError(log.read().strip().splitlines()[-1])
    result = dict(np.load(output))
    return {**result, "simulated": float(result["times"][-1])}


def row(name, settings, scene, result):
    frames = result["frames"]
    counts = [crossings.crossings(frame, scene.triangles) for frame in frames]
    stretches = [crossings.stretch(frame, scene.points, scene.triangles) for frame in frames]
    simulated = max(result["simulated"], 1e-9)
    wall, processor = float(result["wall"]) / simulated, float(result["processor"]) / simulated
    cells = [name, settings, f"{processor:.2f}", f"{wall:.2f}", f"{max(counts):,}", f"{100 * max(stretches):.1f} %"]
    return processor, f"| {' | '.join([*cells, scene.outcome(result['times'], frames)])} |"


def programs(given):
    """Name, settings and a function that runs a scene, of everything that is there."""
    crease = shutil.which(given.crease)
    if crease is None:
        raise SystemExit(f"no crease at {given.crease}: `cargo build --release`, or --crease")
    for settings, options in CREASE:
        yield "crease", settings, lambda scene, folder, options=options: run_crease(crease, scene, options, folder)
    for name, (module, script, variants) in PEERS.items():
        python = absolute(given.blender_python if module == "bpy" else given.peer_python)
        if not has_module(python, module):
            print(f"LEFT OUT: {name}: {python} has no module {module} (pip install {module})", file=sys.stderr)
            continue
        for settings, values in variants:
            yield name, settings, lambda scene, folder, python=python, script=script, values=values: run_peer(
                python, script, scene.name, values, given.limit, folder
            )


def main():
    given = commands()
    crossings.check()
    available = [p for p in programs(given) if re.search(given.only, f"{p[0]}, {p[1]}")]
    for name in given.scenes.split(","):
        print(f"\n`{name}`, {SCENES[name].columns} x {SCENES[name].rows} points:\n")
        print("| program | settings | processor time [s/s] | wall [s/s] | most crossings | stretch | outcome |")
        print("|---|---|---|---|---|---|---|", flush=True)
        first = None
        for program, settings, run in available:
            scene = SCENES[name](0.001)
            with tempfile.TemporaryDirectory() as temporary:
                folder = Path(temporary)
                try:
                    result = run(scene, folder)
                except RuntimeError as error:
                    print(f"| {program} | {settings} | failed: {error} | | | | |", flush=True)
                    continue
                if given.keep:
                    keep = Path(given.keep)
                    keep.mkdir(parents=True, exist_ok=True)
                    np.savez(keep / f"{name}-{program}-{settings}.npz".replace("/", "-").replace(" ", "_"), **result)
            processor, line = row(program, settings, scene, result)
            first = first or processor
            print(line, flush=True)
            print(f"{program}, {settings}: {processor / first:.1f} times the processor time of the first", file=sys.stderr)


if __name__ == "__main__":
    main()
