from os import PathLike
from typing import Any, Callable, Literal, Mapping, Optional, Sequence, Union, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]
_Indices = npt.NDArray[np.uint32]
_Mesh = tuple[npt.ArrayLike, npt.ArrayLike]
_Path = Union[str, PathLike[str]]
_Unit = Union[float, Literal["m", "dm", "cm", "mm", "in"]]
_Axis = Literal["y", "z"]

__version__: str
__all__ = [
    "ConvergenceError",
    "CreaseError",
    "MemoryState",
    "Sidecar",
    "Worn",
    "__version__",
    "advance_memory",
    "bake",
    "fabrics",
    "memories",
    "run_tool",
    "scripts",
    "sheet",
    "transfer",
]

class CreaseError(ValueError):
    """Input that cannot be used: the message names file or argument, place and cure."""

class ConvergenceError(CreaseError):
    """A bake that could not go on to the end of its script."""

@final
class Crease:
    """A crease of a garment: a curve on its surface. All arrays are copies."""

    @property
    def triangles(self) -> _Indices:
        """Triangle of the sidecar's mesh that every place along it lies in."""
    @property
    def weights(self) -> _Floats:
        """Barycentric weights of the corners of that triangle, (p, 3)."""
    @property
    def angle(self) -> _Floats:
        """Change of the rest angle between each two places [rad]."""
    @property
    def stiffness_ratio(self) -> _Floats:
        """Bending stiffness between each two places relative to new cloth."""
    @property
    def width(self) -> float:
        """Width of cloth over which it bends [m]."""

@final
class Sidecar:
    """What worn cloth remembers. All arrays are copies."""

    @staticmethod
    def load(path: _Path) -> Sidecar:
        """Reads a sidecar file, plain or compressed with gzip."""
    @staticmethod
    def parse(text: Union[str, bytes]) -> Sidecar:
        """Reads the content of a sidecar file: text, or bytes, plain or compressed with gzip."""
    def save(self, path: _Path) -> None: ...
    def to_json(self) -> str: ...
    @property
    def simulated(self) -> Optional[Sidecar]:
        """The memory on the simulated mesh, where that is not the mesh of the file; `transfer` takes folds from it."""
    @property
    def creases(self) -> list[Crease]:
        """Creases along which the garment was folded, the strongest first; none where the sidecar does not list them."""
    @property
    def points(self) -> _Floats:
        """Points of the welded mesh before the wear, (n, 3) [m]."""
    @property
    def triangles(self) -> _Indices:
        """Corners, (m, 3)."""
    @property
    def source_point(self) -> _Indices:
        """Point of every vertex of the file."""
    @property
    def displacement(self) -> _Floats:
        """What the wear adds to the points, (n, 3) [m]."""
    @property
    def hinge_points(self) -> _Indices:
        """Points of every hinge, (h, 4): the common edge, then the opposite corners."""
    @property
    def source_angle(self) -> _Floats:
        """Angle of every hinge before the wear [rad], 0 where flat."""
    @property
    def rest_angle(self) -> _Floats:
        """Angle that every hinge remembers [rad]."""
    @property
    def stiffness_ratio(self) -> _Floats:
        """Bending stiffness of every hinge relative to new cloth."""
    @property
    def rest_stretch_warp(self) -> _Floats:
        """Rest length of every triangle along warp relative to new cloth."""
    @property
    def rest_stretch_weft(self) -> _Floats:
        """Rest length of every triangle along weft relative to new cloth."""

@final
class Worn:
    """A worn garment."""

    @property
    def sidecar(self) -> Sidecar: ...
    @property
    def displacement(self) -> _Floats:
        """What the wear adds to every vertex of the file, (v, 3) [m]; for arrays, to every point."""
    @property
    def report(self) -> dict[str, Any]:
        """Content of the tool's report file."""
    @property
    def warnings(self) -> list[str]:
        """What the tool prints as warnings."""
    @property
    def converged(self) -> bool:
        """Whether the worn shape is an equilibrium."""
    @property
    def failure(self) -> Optional[str]:
        """Reason why the tool would end with exit code 3: an action that did not take place, no equilibrium, or no memory."""
    def to_glb(
        self, *, apply: bool = False, unworn: bool = True, keep_normals: bool = False, fine: bool = False
    ) -> bytes:
        """The file with the wear as morph target `worn`, or with `apply` as its base shape; the shape before is then the morph target
        `unworn`, unless that is False. `keep_normals` rotates the normals of flat-shaded vertices with the wear instead of making
        them smooth. `fine` adds vertices along creases and in wrinkles; those of the file come first."""
    def save(
        self,
        path: _Path,
        *,
        apply: bool = False,
        unworn: bool = True,
        keep_normals: bool = False,
        fine: bool = False,
    ) -> None:
        """Writes the file of `to_glb`, whose name ends in .glb, and the sidecar NAME.crease.json beside it; with `fine` also NAME.fine.glb.
        The file that was read is never overwritten."""

@final
class MemoryState:
    """Memory of elements: hinges, or lengths."""

    def __new__(cls, rest: npt.ArrayLike) -> MemoryState:
        """New cloth with these rest values, a number or (n,): rest angles [rad], or stretch ratios [-], which are above 0."""
    def __len__(self) -> int: ...
    @property
    def rest(self) -> _Floats:
        """Rest values now, (n,) [rad] or [-]."""
    @property
    def stiffness_ratio(self) -> _Floats:
        """Stiffness relative to new cloth, (n,) [-]."""

def bake(
    garment: Union[_Path, _Mesh],
    wear: Union[_Path, Mapping[str, Any]],
    *,
    fabric: Optional[_Path] = None,
    quality: str = "standard",
    memory: bool = True,
    strength: float = 1.0,
    grading: bool = True,
    hems: bool = True,
    seams: bool = True,
    sewing_mask: Optional[str] = None,
    unit: Optional[_Unit] = None,
    up: Optional[_Axis] = None,
    part: Optional[str] = None,
    weld_mm: Optional[float] = None,
    force_size: bool = False,
    allow_folder: Optional[_Path] = None,
    forget: bool = False,
    progress: Optional[Callable[[str, float, float], Any]] = None,
) -> Worn:
    """Wears a garment, as `crease bake` does without a body.

    `garment` is a file, or a pair of positions (by default in metres, y up) and triangles. `wear` is a file, the name of a script of `scripts()`,
    or its content as a dict. `fabric` is a name of `fabrics()` or a file; the default is cotton-jersey. `quality` is draft,
    standard or reference. `strength` scales what the garment comes to remember. Without `grading`, the triangles of the garment are simulated instead of a mesh with edges along the fold
    lines; without `hems` and `seams`, open borders and seams are single, and with `sewing_mask`, a vertex
    attribute from 0 to 1 such as COLOR_0.g, where that is 0. `unit` is that of the file or the positions, `up` their axis, `part` the node or group that is
    the garment; vertices on borders are joined up to `weld_mm` apart; `force_size` takes a garment of any size. Its files may lie in its folder and in `allow_folder`. A worn file whose
    sidecar is beside it begins with what it remembers, unless `forget`. `progress` is called with the stage, the simulated time and its end [s]; a result of False stops the bake
    with KeyboardInterrupt, as does Ctrl-C.
    """

def transfer(
    sidecars: Union[Sidecar, _Path, Sequence[Union[Sidecar, _Path]]],
    to: Union[_Path, _Mesh],
    *,
    fabric: Optional[_Path] = None,
    match_by: str = "auto",
    align: str = "auto",
    strength: float = 1.0,
    mask: Optional[str] = None,
    sewing_mask: Optional[str] = None,
    only: Optional[Literal["creases", "bagging"]] = None,
    mirror: Optional[Literal["x"]] = None,
    unit: Optional[_Unit] = None,
    up: Optional[_Axis] = None,
    part: Optional[str] = None,
    weld_mm: Optional[float] = None,
    force_size: bool = False,
    allow_folder: Optional[_Path] = None,
) -> Worn:
    """Puts memory on another garment, as `crease transfer` does.

    A worn .glb stands for the sidecar that it names, a name of `memories()` for that memory. `match_by` is auto, uv, surface or same; `align` is auto, joints, box or
    none. `strength` scales every change, and so does `mask`, a vertex attribute of the target from 0 to 1 such as COLOR_0.g. `only`
    transfers creases or bagging, `mirror` from left to right. The default of `fabric` is that of the first sidecar. `unit`, `up`,
    `part`, `weld_mm`, `force_size` and `allow_folder` are those of `bake`, for the target.
    """

def advance_memory(
    state: MemoryState,
    before: npt.ArrayLike,
    after: npt.ArrayLike,
    duration: float,
    *,
    fabric: Optional[_Path] = None,
    kind: str = "angles",
    initial_rest: Optional[npt.ArrayLike] = None,
    gain: Optional[npt.ArrayLike] = None,
) -> tuple[int, int]:
    """Advances memory over a step of `duration` [s] in which values go linearly from `before` to `after`.

    Each of `before`, `after`, `initial_rest` and `gain` is a number for all elements of `state`, or (n,), one for each. `fabric` is a
    name of `fabrics()` or a file; the default is cotton-jersey. `kind` is angles [rad] or lengths (stretch ratios [-], above 0).

    `initial_rest` is the rest value of new cloth, [rad] or [-]: what recovers after release goes towards it, and bagging is limited by
    the distance from it. By default it is what `state` was made with; give it for a state that was made with what worn cloth
    remembers. `gain` [-], above 0, is the reference length (`reference_length_mm` of the fabric; bakes use at least 20 mm) over the
    width of a hinge where that is narrower, 1 by default. Returns the numbers of gradual and critical events.
    """

def sheet(size: tuple[float, float], cells: tuple[int, int]) -> tuple[_Floats, _Indices]:
    """Positions [m] and triangles of a flat rectangular sheet of `size` [m], cut into `cells` along both sides."""

def fabrics() -> list[str]:
    """Names of the fabrics of the program."""

def scripts() -> list[str]:
    """Names of the wear scripts of the program."""

def memories() -> list[str]:
    """Names of the ready memories of the program, for `transfer`."""

def run_tool(words: Sequence[str]) -> int:
    """Runs the command-line tool with the words after `crease`; returns its exit code.

    It prints to the standard output and the standard error of the process, not to `sys.stdout` and `sys.stderr`. Every run has threads of
    its own (`--threads`). Ctrl-C during a run is that of the tool; Python raises KeyboardInterrupt for it when the run has returned.
    """
