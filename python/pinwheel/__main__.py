"""`python -m pinwheel` and the command `pinwheel`: the program, with the engines that this Python has."""

from __future__ import annotations

import os
import sys
from pathlib import Path

FOLDER = Path(__file__).with_name("bin")


def beside(library: str) -> str | None:
    """Path of the package's library `libpinwheel_...`; None if the environment names another, or it is absent."""
    names = (f"libpinwheel_{library}.so", f"libpinwheel_{library}.dylib", f"pinwheel_{library}.dll")
    files = [FOLDER / name for name in names if (FOLDER / name).is_file()]
    return str(files[0]) if files and f"PINWHEEL_{library.upper()}" not in os.environ else None


def main() -> int:
    """Runs the program with this process's arguments; returns its exit status."""
    from pinwheel import _core

    for library in ("law", "fmu"):
        if place := beside(library):
            os.environ[f"PINWHEEL_{library.upper()}"] = place
    return _core.program(["pinwheel", *sys.argv[1:]], sys.executable)


if __name__ == "__main__":
    sys.exit(main())
