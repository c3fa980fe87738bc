"""Runs one scene in one program, times it and writes its frames: the part that the `in_*.py` have in common.

Timed is the advance from frame to frame alone, without the making of the scene; processor time is that of all threads.
"""

import argparse
import json
import time

import numpy as np
from scenes import FRAMES_PER_SECOND, SCENES


def measure(start, version, clearance):
    """`start(scene, settings)` returns a function that advances to a time [s] and returns the positions of all points."""
    options = argparse.ArgumentParser()
    options.add_argument("scene", choices=SCENES)
    options.add_argument("settings", type=json.loads)
    options.add_argument("output")
    options.add_argument("--limit", type=float, required=True)
    given = options.parse_args()
    scene = SCENES[given.scene](given.settings.get("clearance", clearance))
    advance = start(scene, given.settings)
    frames, times = [scene.points], [0.0]
    wall, processor = time.perf_counter(), time.process_time()
    for frame in range(1, round(scene.duration * FRAMES_PER_SECOND) + 1):
        positions = np.array(advance(frame / FRAMES_PER_SECOND), float)
        if not np.isfinite(positions).all():
            break
        frames.append(positions)
        times.append(frame / FRAMES_PER_SECOND)
        if time.perf_counter() - wall > given.limit:
            break
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    np.savez(given.output, times=times, frames=frames, wall=wall, processor=processor, version=version)
