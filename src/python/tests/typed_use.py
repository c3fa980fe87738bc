"""Uses of the package that a type checker accepts: mypy --strict src/python/tests/typed_use.py"""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import crease


def told(stage: str, time: float, end: float) -> bool:
    print(f"{stage}: {time:.1f} of {end:.1f} s")
    return True


def bake(folder: Path) -> npt.NDArray[np.float64]:
    worn = crease.bake(folder / "shirt.obj", "fold-thrice", fabric=folder / "own.json", unit="cm", progress=told)
    again: crease.Worn = crease.bake(crease.sheet((0.3, 0.3), (30, 30)), {"format": "crease-wear/1", "actions": []}, unit=None)
    worn.save(folder / "worn.glb", apply=True)
    content: bytes = again.to_glb()
    report: dict[str, Any] = worn.report
    print(len(content), report["steps"], worn.failure or "done", *worn.warnings)
    return worn.displacement


def transfer(sidecar: crease.Sidecar, positions: list[list[float]], triangles: list[list[int]]) -> float:
    carried = crease.transfer([sidecar, "other.crease.json"], (positions, triangles), match_by="surface", strength=0.5, only="creases")
    rest: npt.NDArray[np.float64] = carried.sidecar.rest_angle
    on_mesh = carried.sidecar.simulated
    return float(rest.max()) if on_mesh is None else float(on_mesh.rest_angle.max())


def memories(content: bytes) -> list[crease.Sidecar]:
    carried = [crease.transfer(name, "shirt.glb").sidecar for name in crease.memories()]
    return [*carried, crease.Sidecar.parse(content), crease.Sidecar.parse(content.decode())]


def law() -> tuple[int, int]:
    state = crease.MemoryState([0.0, 0.1])
    return crease.advance_memory(state, [0, 0], np.array([1.0, 2.0]), 0.1, fabric="denim", initial_rest=[0.0, 0.1], gain=1.0)


def tool() -> int:
    return crease.run_tool(["inspect", "shirt.glb"])
