"""Builds the package: maturin's backend, and the C libraries, which go into the wheel beside the module."""

import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

import maturin
from maturin import *  # noqa: F403 - a backend is a module of functions; those that are not below are maturin's

HERE = Path(__file__).resolve().parent
LIBRARIES = ("pinwheel_fmu", "pinwheel_law")
NO_RUST = """
Pinwheel is compiled on this machine, and there is no Rust: `cargo` was not found.
Install Rust from https://rustup.rs (1 GB, a few minutes) and call pip again, or install a wheel that was built elsewhere:
    pip wheel ./python --no-deps -w dist
"""


def _stop_without_rust() -> None:
    if shutil.which("cargo") is None:
        # Not an exception: pip would show its traceback, and maturin would fetch a Rust of its own without a word.
        print(NO_RUST, file=sys.stderr)
        raise SystemExit(1)


def _keep_libraries() -> None:
    """Copies the C libraries, which the module's compilation made too, into pinwheel/bin."""
    asked = re.search(r"--profile[ =](\S+)", os.environ.get("MATURIN_PEP517_ARGS", ""))
    profile = asked[1] if asked else "release"
    target = Path(os.environ.get("CARGO_TARGET_DIR", HERE.parent / "target")) / ("debug" if profile == "dev" else profile)
    place = HERE / "pinwheel/bin"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    for library in LIBRARIES:
        names = (f"lib{library}.so", f"lib{library}.dylib", f"{library}.dll")
        made = [target / "deps" / name for name in names if (target / "deps" / name).is_file()]
        if not made:
            raise SystemExit(f"{library} was not compiled: no such library in {target / 'deps'}")
        shutil.copy2(made[0], place)


def get_requires_for_build_wheel(_settings: dict | None = None) -> list[str]:
    """Returns no requirements beside maturin."""
    _stop_without_rust()
    return []


def build_wheel(directory: str, config_settings: dict | None = None, metadata_directory: str | None = None) -> str:
    """Builds the wheel."""
    _stop_without_rust()
    print("compiling: 3 to 8 minutes the first time", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory() as first:
        # The first call compiles; the second one packs the module with the libraries.
        maturin.build_wheel(first, config_settings, metadata_directory)
    _keep_libraries()
    return maturin.build_wheel(directory, config_settings, metadata_directory)
