"""A live page of a scene, by the program that comes with the package: served to this machine, or by a notebook's messages.

page in the browser ──HTTP──────────────────────────────────────────────────────────> program
page in a cell ──message──> widget (_explore.js) ──kernel──> Explorer.answer ──HTTP──> program
"""

from __future__ import annotations

import atexit
import html
import subprocess
import sys
import tempfile
import webbrowser
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from types import TracebackType
from typing import Any
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import ProxyHandler, Request, build_opener

from pinwheel._columns import wanted
from pinwheel._scene import Scene
from pinwheel.errors import PinwheelError

_OPEN: set[Explorer] = set()
# Requests to this machine use no proxy.
_HERE = build_opener(ProxyHandler({}))


class Explorer:
    """A live page: sliders for the gear's dimensions, load and law; two states side by side.

    A notebook shows it in the cell, over the kernel's messages where anywidget is installed, so that the browser may be on
    another machine; `show` opens it in the browser of this one. It is served until `close`, the end of a `with`, or of
    this Python. The address is a secret: who has it may move the sliders. "Save scene" writes to the working folder.

    Attributes:
        scene: scene at the start
        url: address on this machine

    """

    def __init__(self, scene: Scene, height: int) -> None:
        self.scene, self.height = scene, height
        self._folder = tempfile.TemporaryDirectory(prefix="pinwheel-")
        file = Path(self._folder.name) / "scene.toml"
        scene.save(file)
        # A separate session: an interrupt of a cell does not end the server.
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
        """Opens the page in the browser."""
        webbrowser.open(self.url)

    def answer(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Answers a question of the page's script, a `path` with a `body` or without, by a `status` and a `text`."""
        at, body = urlsplit(self.url), message.get("body")
        own = {"Origin": f"{at.scheme}://{at.netloc}", "Content-Type": "application/json"}
        asked = Request(self.url + message["path"], None if body is None else body.encode(), own)
        try:
            with _HERE.open(asked) as reply:
                return {"status": reply.status, "text": reply.read().decode()}
        except HTTPError as error:
            return {"status": error.code, "text": error.read().decode()}
        except OSError as error:
            return {"status": 503, "text": str(error)}

    def widget(self) -> Any:
        """The page as a widget of anywidget, which a notebook's cell shows."""
        anywidget, traitlets = wanted("anywidget", "notebooks"), wanted("traitlets", "notebooks")
        shown = f"<Sliders of {self.scene.name}: run this cell to move them>"

        class Live(anywidget.AnyWidget):  # type: ignore[misc, name-defined]
            _esm = Path(__file__).with_name("_explore.js")
            height = traitlets.Int(self.height).tag(sync=True)

            def __repr__(self) -> str:
                return shown

        live = Live()

        def asked(_: object, message: Mapping[str, Any], __: object) -> None:
            name = {key: message[key] for key in ("id", "view") if key in message}
            # Answers in a separate thread: cells run meanwhile, and a newer question ends an older one.
            Thread(target=lambda: live.send(name | self.answer(message)), daemon=True).start()

        live.on_msg(asked)
        return live

    def close(self) -> None:
        """Ends the server; a second call does nothing."""
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

    def _repr_mimebundle_(self, **chosen: Any) -> Any:
        if self.closed or find_spec("anywidget") is None:
            return {"text/plain": repr(self), "text/html": self._repr_html_()}
        live = self.widget()
        data, about = live._repr_mimebundle_(**chosen)
        return {**data, "text/html": f"<p>{html.escape(repr(live)[1:-1])}</p>"}, about

    def _repr_html_(self) -> str:
        if self.closed:
            return f"<p>{html.escape(repr(self)[1:-1])}</p>"
        size = f'style="width: 100%; height: {self.height}px; border: 0"'
        return f'<iframe src="{html.escape(self.url)}" title="{html.escape(self.scene.name)}" {size}></iframe>'


def explore(scene: Scene | str, *, height: int = 900) -> Explorer:
    """A live page of a scene, in a notebook's cell or by `show` in the browser: what does each dimension do?

    Where the browser is on another machine than Python, a cell needs anywidget. `height`: of the frame in a cell, px.

    >>> with explore("paper") as page:
    ...     page.url.startswith("http://127.0.0.1:")
    True
    """
    return Explorer(scene if isinstance(scene, Scene) else Scene(scene), height)


@atexit.register
def _close_all() -> None:
    for one in tuple(_OPEN):
        one.close()
