"""The command-line tool: `python -m crease`, and the script `crease`."""

import os
import shutil
import signal
import sys
import sysconfig
from typing import Optional

from ._crease import run_tool


def script() -> Optional[str]:
    """Path of the script `crease`, with which a batch starts the tool again for every job."""
    name = "crease.exe" if os.name == "nt" else "crease"
    own = os.path.join(sysconfig.get_path("scripts"), name)
    return own if os.path.isfile(own) else shutil.which("crease")


def main() -> int:
    own = script()
    if own:
        os.environ.setdefault("CREASE_EXECUTABLE", own)
    # Python's own handler waits until the tool returns. The tool has handlers where it has something to save.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_tool(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
