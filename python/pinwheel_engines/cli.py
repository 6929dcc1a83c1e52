"""Command line of the engines: `python -m pinwheel_engines.mujoco SCENE`, `python -m pinwheel_engines.exudyn SCENE`.

Results go to standard output (or --out), progress and remarks to standard error. Exit status: 0 done, 2 bad input or
usage, 3 the engine is missing, diverged or failed.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import secrets
import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from pinwheel_engines.engines import ENGINES, run
from pinwheel_engines.errors import Diverged, PinwheelError, SceneError
from pinwheel_engines.result import Result
from pinwheel_engines.scene import Scene


def main(family: str, arguments: Sequence[str] | None = None) -> int:
    """Runs the command line of one family of engines (`mujoco` or `exudyn`); returns the exit status."""
    parser = _parser(family)
    wanted = parser.parse_args(arguments)
    engine = _engine(family, wanted.track, getattr(wanted, "form", None))
    try:
        scene = Scene.load(wanted.scene)
        changes = {"duration_s": wanted.duration, "sample_s": wanted.sample}
        scene = scene.with_keys("solver", **{key: value for key, value in changes.items() if value is not None})
        result = run(scene, engine, on_progress=_progress(scene.solver.duration_s), step_s=wanted.step)
    except Diverged as error:
        print(f"error: {error}", file=sys.stderr)
        if error.partial is not None and wanted.out is not None:
            _write(error.partial, wanted.out)
            print(f"the courses until then are in {wanted.out}", file=sys.stderr)
        return 3
    except PinwheelError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2 if isinstance(error, SceneError) else 3
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 3
    if wanted.stats:
        print(json.dumps(result.stats.to_dict(), indent=2), file=sys.stderr)
    try:
        _write(result, wanted.out)
    except OSError as error:
        print(f"error: cannot write the courses: {error}", file=sys.stderr)
        return 2
    return 0


def _parser(family: str) -> argparse.ArgumentParser:
    names = [name for name in ENGINES if name.startswith(family)]
    parser = argparse.ArgumentParser(
        prog=f"python -m pinwheel_engines.{family}",
        description=f"Runs a Pinwheel scene in {family} and writes its courses as CSV. The shared law is evaluated by the "
        "numpy implementation, which is slow (about 1 ms a call): shorten the run with --duration.",
        epilog="engines: " + "; ".join(f"{name}: {ENGINES[name].summary}" for name in names),
    )
    parser.add_argument("scene", type=Path, help="scene file (TOML) with every key, like reference/scenes/paper.toml")
    parser.add_argument(
        "--track",
        choices=["shared-law", "own-contact"],
        default="shared-law",
        help="who computes the contact forces: our law inside the engine's step (default), or the engine itself",
    )
    if family == "exudyn":
        parser.add_argument(
            "--form",
            choices=["explicit", "constrained"],
            default="explicit",
            help="shared-law only: kinematic tree with Runge-Kutta 4 (default), or bodies and joints with multipliers",
        )
    parser.add_argument("--duration", type=_seconds, metavar="S", help="end time, s (default: the scene's)")
    parser.add_argument("--sample", type=_seconds, metavar="S", help="sampling step, s (default: the scene's)")
    parser.add_argument(
        "--step", type=_seconds, metavar="S", help="the engine's step, s (default: the scene's or the engine's own)"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="CSV file for the courses (default: standard output)")
    parser.add_argument("--stats", action="store_true", help="print time, steps and settings as JSON on standard error")
    return parser


def _seconds(text: str) -> float:
    """Parses a positive, finite time, s."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no time above 0")
    return value


def _engine(family: str, track: str, form: str | None) -> str:
    if family == "exudyn" and track == "shared-law":
        return f"{family}-{track}-{form}"
    return f"{family}-{track}"


def _progress(duration_s: float) -> Callable[[float], bool] | None:
    """Shows a percentage on standard error if that is a terminal."""
    if not sys.stderr.isatty():
        return None
    shown = {"percent": -1}

    def show(time_s: float) -> bool:
        percent = int(100.0 * time_s / duration_s)
        if percent != shown["percent"]:
            shown["percent"] = percent
            print(f"\r{percent:3d} %", end="\n" if percent >= 100 else "", file=sys.stderr, flush=True)
        return False

    return show


def _write(result: Result, out: Path | None) -> None:
    """Writes the courses; a file appears complete or not at all."""
    text = result.to_csv()
    if out is None:
        sys.stdout.write(text)
        return
    if out.is_symlink() or (out.exists() and not _is_ours(out)):
        raise FileExistsError(f"{out} is there and holds no courses; name another file with --out")
    # Exclusive: never over or through anything of others.
    draft = out.with_name(f".pinwheel-{os.getpid()}-{secrets.token_hex(6)}")
    try:
        with draft.open("x", encoding="utf-8") as file:
            file.write(text)
        if out.exists():
            shutil.copymode(out, draft)
        draft.replace(out)
    finally:
        draft.unlink(missing_ok=True)


def _is_ours(file: Path) -> bool:
    """True if a file is empty or holds time series."""
    if not file.is_file():
        return False
    with file.open("rb") as content:
        return content.read(7) in (b"", b"time_s,")
