"""`python -m pinwheel.cluster FILE`: a sweep by threads or by a Dask cluster, from the command line.

Exit status: 0 all runs finished, 2 wrong input, 3 a run did not finish or workers were lost, 130 stopped.
"""

from __future__ import annotations

import argparse
import sys
from contextlib import ExitStack
from typing import Any

from pinwheel._sweep import sweep
from pinwheel.errors import ClusterError, PinwheelError


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    parser = argparse.ArgumentParser(prog="python -m pinwheel.cluster", description="Runs a sweep file (docs/sweeps.md).")
    parser.add_argument("file", help="sweep file (TOML)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, tcp://host:8786, or its scheduler file")
    parser.add_argument("--engines", metavar="A,B", help="instead of the file's")
    parser.add_argument("--jobs", type=int, metavar="N", help="threads without a scheduler [default: one a core]")
    parser.add_argument("--batch", type=int, metavar="N", help="runs of a batch [default: about half a second of work]")
    parser.add_argument("--out", metavar="DIR", help="output folder [default: out/NAME-sweep]")
    parser.add_argument("--resume", action="store_true", help="go on with the runs an earlier attempt finished")
    parser.add_argument("--force", action="store_true", help="begin anew, and replace an earlier output that was changed")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a key of every run; repeatable")
    asked = parser.parse_args(arguments)
    keys: dict[str, Any] = {}
    for pair in asked.set:
        key, equals, value = pair.partition("=")
        if not equals:
            parser.error(f"--set {pair}: write --set key=value")
        keys[key.strip()] = _value(value.strip())
    try:
        with ExitStack() as stack:
            client = None
            if asked.scheduler is not None:
                try:
                    from distributed import Client
                except ImportError:
                    parser.error('--scheduler needs Dask; pip install "distributed"')
                place = {"scheduler_file" if asked.scheduler.endswith(".json") else "address": asked.scheduler}
                try:
                    client = stack.enter_context(Client(**place, timeout="10s", set_as_default=False))
                except (OSError, ValueError) as error:
                    raise ClusterError(f"--scheduler {asked.scheduler}: no scheduler answers: {error}") from error
            results = sweep(
                asked.file,
                engines=[name.strip() for name in asked.engines.split(",")] if asked.engines else (),
                client=client,
                jobs=asked.jobs,
                batch=asked.batch,
                out=asked.out,
                resume=asked.resume,
                force=asked.force,
                **keys,
            )
    except KeyboardInterrupt:
        print("error: stopped; finished runs are kept: go on with --resume", file=sys.stderr)
        return 130
    except (PinwheelError, OSError) as error:
        text = str(error).replace("resume=True", "--resume").replace("force=True", "--force").replace("batch=1", "--batch 1")
        print(f"error: {text}", file=sys.stderr)
        return 3 if isinstance(error, ClusterError) else 2
    print(str(results).rstrip())
    return 3 if results.unfinished else 0


def _value(text: str) -> object:
    """A TOML value, or a bare word."""
    import tomllib

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


if __name__ == "__main__":
    sys.exit(main())
