"""`python -m pinwheel` and the command `pinwheel`: the program that comes with the package."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).with_name("bin")


def beside(library: str) -> str | None:
    """The library `libpinwheel_...` of the package; None where the environment names another, or none is there."""
    names = (f"libpinwheel_{library}.so", f"libpinwheel_{library}.dylib", f"pinwheel_{library}.dll")
    found = [FOLDER / name for name in names if (FOLDER / name).is_file()]
    return str(found[0]) if found and f"PINWHEEL_{library.upper()}" not in os.environ else None


def program() -> Path:
    """The program that comes with the package."""
    found = FOLDER / ("pinwheel.exe" if os.name == "nt" else "pinwheel")
    if not found.is_file():
        raise FileNotFoundError(f"{found} is not there; install the package again with pip, which builds it")
    return found


def main() -> int:
    """Runs the program with this process's arguments; its exit status."""
    try:
        found = program()
    except FileNotFoundError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if os.name != "nt":
        os.execv(found, ["pinwheel", *sys.argv[1:]])
    return subprocess.run([found, *sys.argv[1:]], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
