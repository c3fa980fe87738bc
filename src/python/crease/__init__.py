"""Simulates how garments are worn and bakes the permanent wrinkles into their meshes.

`bake` wears a garment by a script, `transfer` puts its wrinkles on another one, `Sidecar` holds what the cloth remembers as
NumPy arrays, and `MemoryState` with `advance_memory` is the memory law for a simulator of your own. `run_tool` and
`python -m crease` are the command-line tool.
"""

from ._crease import (
    ConvergenceError,
    Crease,
    CreaseError,
    MemoryState,
    Sidecar,
    Worn,
    __version__,
    advance_memory,
    bake,
    fabrics,
    memories,
    run_tool,
    scripts,
    sheet,
    transfer,
)

__all__ = [
    "ConvergenceError",
    "Crease",
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
