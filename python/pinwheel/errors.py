"""Exceptions of the package, as types that a caller can tell apart. Every message is one line and carries the remedy.

    PinwheelError
      InputError (ValueError)     input that cannot be used
        SceneError                a scene: .key, .remedy
        NoEngine                  there is no such engine here
        Missing (KeyError)        there is no such column, figure, key or engine in a result
      EngineFailed                an engine broke: .engine, .reason; of a comparison .comparison, with all others
      Unsupported                 an engine cannot honour the scene: .engine, .reason
      Diverged                    the run diverged: .engine, .time_s, .quantity, .partial (the run until then)
      ClusterError                workers or their scheduler were lost

Ctrl-C is `KeyboardInterrupt`, a file that cannot be written `OSError`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pinwheel_engines.errors import (
    Cancelled,
    EngineFailed,
    InputError,
    PinwheelError,
    SceneError,
    Unsupported,
)

if TYPE_CHECKING:
    from pinwheel._run import Run
    from pinwheel_engines.errors import Diverged as _Diverged

    class Diverged(_Diverged):
        """The run diverged; `partial` is the run until then."""

        partial: Run | None  # type: ignore[assignment]

else:
    from pinwheel_engines.errors import Diverged

__all__ = [
    "Cancelled",
    "ClusterError",
    "Diverged",
    "EngineFailed",
    "InputError",
    "Missing",
    "NoEngine",
    "PinwheelError",
    "SceneError",
    "Unsupported",
]


class NoEngine(InputError):
    """There is no such engine in this Python."""


class Missing(InputError, KeyError):
    """There is no such column, figure, key or engine in a result."""

    # A KeyError alone shows its message in quotes.
    __str__ = Exception.__str__


class ClusterError(PinwheelError):
    """Workers or their scheduler were lost; runs that were finished are kept."""
