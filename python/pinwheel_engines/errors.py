"""Exceptions of the package, one type for each kind of failure.

Messages are one line and carry the remedy. A run that diverged keeps what it had computed until then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from pinwheel_engines.result import Result


class PinwheelError(Exception):
    """Root of all errors raised by this package."""

    @classmethod
    def _of(cls, message: str) -> Self:
        """Makes an error from a complete message, without attributes."""
        return cls.__new__(cls, message)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles an error by its message and attributes, independent of its constructor."""
        return type(self)._of, (str(self),), self.__dict__


class InputError(PinwheelError, ValueError):
    """Unusable input; the message names the fault and the remedy."""


class SceneError(InputError):
    """Faulty scene; the message names the key, its value and the remedy."""

    key: str | None = None
    """Full name of the key at fault, where there is one."""
    remedy: str = ""


class Unsupported(PinwheelError):
    """The engine cannot honour this scene and never approximates in silence."""

    def __init__(self, engine: str, reason: str) -> None:
        super().__init__(f"{engine} cannot run this scene: {reason}")
        self.engine = engine
        self.reason = reason


class Diverged(PinwheelError):
    """The run diverged.

    `time_s`: simulated time of the detection; `quantity`: name and value of the diverged quantity;
    `partial`: the courses of the samples before that, None when there are none.
    """

    def __init__(self, engine: str, time_s: float, quantity: str) -> None:
        super().__init__(f"{engine} diverged at t = {time_s:.6f} s: {quantity}")
        self.engine = engine
        self.time_s = time_s
        self.quantity = quantity
        self.partial: Result | None = None


class FrozenForces(PinwheelError):
    """The engine did not ask for the contact forces in every stage of its step."""


class Cancelled(PinwheelError):
    """The caller's progress function asked to stop."""

    def __init__(self) -> None:
        super().__init__("stopped")


class EngineFailed(PinwheelError):
    """The engine itself reported an error; the text is its own."""

    def __init__(self, engine: str, reason: str) -> None:
        super().__init__(f"{engine} failed: {reason}")
        self.engine = engine
        self.reason = reason
