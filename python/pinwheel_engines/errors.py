"""Everything that can go wrong, as types the caller can tell apart.

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
        """An error that is worded elsewhere, its attributes to be set."""
        return cls.__new__(cls, message)

    def __reduce__(self) -> tuple[Any, ...]:
        """Errors travel between processes, whatever their constructors ask for."""
        return type(self)._of, (str(self),), self.__dict__


class InputError(PinwheelError, ValueError):
    """Input that cannot be used: what is wrong and the remedy."""


class SceneError(InputError):
    """The scene is faulty: names the key, its value and the remedy."""

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
    """The numbers ran away.

    `time_s`: simulated time at which it was seen; `quantity`: which one and its value;
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
