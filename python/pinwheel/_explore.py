"""A live page of a scene, served to this machine by the program that comes with the package."""

from __future__ import annotations

import atexit
import html
import subprocess
import sys
import tempfile
import webbrowser
from pathlib import Path
from types import TracebackType

from pinwheel._scene import Scene
from pinwheel.errors import PinwheelError

_OPEN: set[Explorer] = set()


class Explorer:
    """A live page: sliders for the gear's dimensions, load and law; two states side by side.

    A notebook shows it in the cell; `show` opens it in the browser. It is served until `close`, the end of a `with`, or of
    this Python. The address is a secret: who has it may move the sliders. "Save scene" writes to the working folder.

    Attributes:
        scene: what it began with
        url: its address on this machine

    """

    def __init__(self, scene: Scene, height: int) -> None:
        self.scene, self.height = scene, height
        self._folder = tempfile.TemporaryDirectory(prefix="pinwheel-")
        file = Path(self._folder.name) / "scene.toml"
        scene.save(file)
        # A session of its own: what interrupts a cell does not end it.
        self._program = subprocess.Popen(
            [sys.executable, "-m", "pinwheel", "explore", file, "--embed"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            text=True,
        )
        assert self._program.stdout is not None and self._program.stderr is not None
        kind, _, self.url = self._program.stdout.readline().strip().partition(": ")
        if kind != "page":
            why = self._program.stderr.read().strip()
            self.close()
            raise PinwheelError(why.removeprefix("error: "))
        _OPEN.add(self)

    def show(self) -> None:
        """Opens it in the browser."""
        webbrowser.open(self.url)

    def close(self) -> None:
        """Ends it; again does nothing."""
        _OPEN.discard(self)
        streams = (self._program.stdin, self._program.stdout, self._program.stderr)
        for stream in streams:
            if stream is not None:
                stream.close()
        try:
            self._program.wait(10.0)
        except subprocess.TimeoutExpired:
            self._program.kill()
            self._program.wait()
        self._folder.cleanup()

    @property
    def closed(self) -> bool:
        """True after the server has stopped."""
        return self._program.poll() is not None

    def __enter__(self) -> Explorer:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Explorer of {self.scene.name}: {'closed' if self.closed else self.url}>"

    def _repr_html_(self) -> str:
        if self.closed:
            return f"<p>{html.escape(repr(self)[1:-1])}</p>"
        size = f'style="width: 100%; height: {self.height}px; border: 0"'
        return f'<iframe src="{html.escape(self.url)}" title="{html.escape(self.scene.name)}" {size}></iframe>'


def explore(scene: Scene | str, *, height: int = 900) -> Explorer:
    """A live page of a scene, in a notebook's cell or by `show` in the browser: what does each dimension do?

    The browser must be on this machine. `height`: of the frame in a cell, px.

    >>> with explore("paper") as page:
    ...     page.url.startswith("http://127.0.0.1:")
    True
    """
    return Explorer(scene if isinstance(scene, Scene) else Scene(scene), height)


@atexit.register
def _close_all() -> None:
    for one in tuple(_OPEN):
        one.close()
