"""Builds the package: maturin's backend, and the program with its libraries, which go into the wheel beside the module."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import maturin
from maturin import *  # noqa: F403 - a backend is a module of functions; those that are not below are maturin's

HERE = Path(__file__).resolve().parent
MADE = ("pinwheel-cli", "pinwheel-fmu", "pinwheel-law")
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


def _program() -> None:
    """The program and its libraries, as `MATURIN_PEP517_ARGS` asks for the module, into pinwheel/bin."""
    print("compiling the program and the module: 5 to 10 minutes the first time", file=sys.stderr, flush=True)
    asked = re.search(r"--profile[ =](\S+)", os.environ.get("MATURIN_PEP517_ARGS", ""))
    profile = asked[1] if asked else "release"
    packages = [word for name in MADE for word in ("-p", name)]
    # With what the module is compiled with too, so that most is compiled once.
    command = ["cargo", "build", "--locked", "--profile", profile, *packages, "--features", "pinwheel-cli/module"]
    subprocess.run(command, cwd=HERE.parent, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", HERE.parent / "target")) / ("debug" if profile == "dev" else profile)
    place = HERE / "pinwheel/bin"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    libraries = [name.replace("-", "_") for name in MADE[1:]]
    names = [*(f"{pre}{name}.{end}" for name in libraries for pre, end in (("lib", "so"), ("lib", "dylib"), ("", "dll")))]
    for name in ("pinwheel", "pinwheel.exe", *names):
        if (target / name).is_file():
            shutil.copy2(target / name, place / name)


def get_requires_for_build_wheel(_settings: dict | None = None) -> list[str]:
    """Nothing beside maturin."""
    _stop_without_rust()
    return []


def build_wheel(directory: str, config_settings: dict | None = None, metadata_directory: str | None = None) -> str:
    """Builds the wheel."""
    _stop_without_rust()
    _program()
    return maturin.build_wheel(directory, config_settings, metadata_directory)
