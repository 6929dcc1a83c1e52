"""Pages that open offline."""

from __future__ import annotations

import re
import tempfile
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

_STYLES = re.compile(r"\x1b\[[0-9;]*m")


def plain(text: str) -> str:
    """A terminal's text without its colours."""
    return _STYLES.sub("", text)


class Paged:
    """What has a page that opens offline; it travels to other processes with it."""

    _page: Callable[[], str] | str
    _called = "page"

    def page(self) -> str:
        """The page that opens offline, HTML."""
        return self._page if isinstance(self._page, str) else self._page()

    def show(self, path: str | Path | None = None) -> Path:
        """Opens the page in the browser, or writes it to `path`; where it is."""
        return show(self.page(), self._called, path)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_page": self.page()}


def show(page: str, name: str, path: str | Path | None) -> Path:
    """Writes a page, to a temporary file unless `path` is given, and opens it in the browser; its path."""
    target = Path(path) if path is not None else Path(tempfile.mkdtemp(prefix="pinwheel-")) / f"{name}.html"
    target.write_text(page, encoding="utf-8")
    if path is None:
        webbrowser.open(target.as_uri())
    return target
