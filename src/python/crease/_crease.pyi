from os import PathLike
from typing import Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.uint32]
Mesh = tuple[npt.ArrayLike, npt.ArrayLike]
Path = Union[str, PathLike[str]]

__version__: str

class CreaseError(ValueError):
    """Input that cannot be used: the message names file, place and cure."""

class ConvergenceError(CreaseError):
    """A result that did not converge."""

class Sidecar:
    """What worn cloth remembers. All arrays are copies."""

    @staticmethod
    def load(path: Path) -> Sidecar: ...
    @staticmethod
    def parse(text: str) -> Sidecar: ...
    def save(self, path: Path) -> None: ...
    def to_json(self) -> str: ...
    @property
    def points(self) -> Floats:
        """Points of the welded mesh before the wear, (n, 3) [m]."""
    @property
    def triangles(self) -> Indices:
        """Corners, (m, 3)."""
    @property
    def source_point(self) -> Indices:
        """Point of every vertex of the file."""
    @property
    def displacement(self) -> Floats:
        """What the wear adds to the points, (n, 3) [m]."""
    @property
    def hinge_points(self) -> Indices:
        """Points of every hinge, (h, 4): the common edge, then the opposite corners."""
    @property
    def source_angle(self) -> Floats:
        """Angle of every hinge before the wear [rad], 0 where flat."""
    @property
    def rest_angle(self) -> Floats:
        """Angle that every hinge remembers [rad]."""
    @property
    def stiffness_ratio(self) -> Floats:
        """Bending stiffness of every hinge relative to new cloth."""
    @property
    def rest_stretch_warp(self) -> Floats:
        """Rest length of every triangle along warp relative to new cloth."""
    @property
    def rest_stretch_weft(self) -> Floats:
        """Rest length of every triangle along weft relative to new cloth."""

class Worn:
    """A worn garment."""

    @property
    def sidecar(self) -> Sidecar: ...
    @property
    def displacement(self) -> Floats:
        """What the wear adds to every vertex of the file, (v, 3) [m]; for arrays, to every point."""
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def converged(self) -> bool: ...
    def to_glb(self, *, apply: bool = False, unworn: bool = True) -> bytes:
        """The file with the wear as morph target `worn`, or as its base shape."""
    def save(self, path: Path, *, apply: bool = False, unworn: bool = True) -> None:
        """Writes the file, and the sidecar beside it."""

class MemoryState:
    """Memory of hinges or lengths."""

    def __init__(self, rest: npt.ArrayLike) -> None:
        """New cloth with these rest angles [rad] or stretches."""
    def __len__(self) -> int: ...
    @property
    def rest(self) -> Floats: ...
    @property
    def stiffness_ratio(self) -> Floats: ...

def bake(
    garment: Union[Path, Mesh],
    wear: Union[Path, Mapping[str, Any]],
    *,
    fabric: str = "kow-tshirt",
    quality: str = "standard",
    memory: bool = True,
    unit: Optional[float] = None,
    part: Optional[str] = None,
    progress: Optional[Callable[[str, float, float], Any]] = None,
) -> Worn:
    """Wears a garment.

    `garment` is a file, or positions [m] (y up) and triangles. `wear` is a file, the name of a script of `scripts()`, or its
    content. `unit` is metres per unit of the file, `part` the node or group that is the garment. `progress` is called with
    the stage, the simulated time and its end [s]; a result of False stops the bake, as does Ctrl-C.
    """

def transfer(
    sidecars: Union[Sidecar, Path, Sequence[Union[Sidecar, Path]]],
    to: Union[Path, Mesh],
    *,
    fabric: Optional[str] = None,
    match_by: str = "auto",
    align: str = "auto",
    strength: float = 1.0,
    unit: Optional[float] = None,
    part: Optional[str] = None,
) -> Worn:
    """Puts memory on another garment. `match_by` is auto, uv, surface or same; `align` is auto, joints, box or none."""

def advance_memory(
    state: MemoryState,
    before: npt.ArrayLike,
    after: npt.ArrayLike,
    duration: float,
    *,
    fabric: str = "kow-tshirt",
    kind: str = "angles",
    initial_rest: Optional[npt.ArrayLike] = None,
    gain: Optional[npt.ArrayLike] = None,
) -> tuple[int, int]:
    """Advances memory over a step in which values go linearly from `before` to `after`.

    `kind` is angles [rad] or lengths (stretch ratios). `gain` is the reference length over the width of a hinge where that is
    narrower, 1 by default. Returns the numbers of gradual and critical events.
    """

def sheet(size: tuple[float, float], cells: tuple[int, int]) -> tuple[Floats, Indices]:
    """Positions [m] and triangles of a flat rectangular sheet."""

def fabrics() -> list[str]:
    """Names of the fabrics of the program."""

def scripts() -> list[str]:
    """Names of the wear scripts of the program."""

def run_tool(words: Sequence[str]) -> int:
    """Runs the command-line tool; returns its exit code."""
