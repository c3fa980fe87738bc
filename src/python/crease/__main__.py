"""The command-line tool: `python -m crease`, and the script `crease`."""

import os
import shutil
import sys

from ._crease import run_tool


def main() -> int:
    # A batch starts the tool again for every job.
    own = sys.argv[0] if os.path.basename(sys.argv[0]).startswith("crease") else shutil.which("crease")
    if own and "CREASE_EXECUTABLE" not in os.environ:
        os.environ["CREASE_EXECUTABLE"] = os.path.abspath(own)
    return run_tool(["crease", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
