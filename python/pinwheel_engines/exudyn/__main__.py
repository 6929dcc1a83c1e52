"""Command line: `python -m pinwheel_engines.exudyn SCENE`; see `--help`."""

import sys

from pinwheel_engines.cli import main

if __name__ == "__main__":
    sys.exit(main("exudyn"))
