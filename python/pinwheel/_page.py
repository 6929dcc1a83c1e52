"""Pages that open offline."""

from __future__ import annotations

import re
import tempfile
import webbrowser
from pathlib import Path

_STYLES = re.compile(r"\x1b\[[0-9;]*m")


def plain(text: str) -> str:
    """A terminal's text without its colours."""
    return _STYLES.sub("", text)


def show(page: str, name: str, path: str | Path | None) -> Path:
    """Writes a page, to a temporary file unless `path` is given, and opens it in the browser; its path."""
    target = Path(path) if path is not None else Path(tempfile.mkdtemp(prefix="pinwheel-")) / f"{name}.html"
    target.write_text(page, encoding="utf-8")
    if path is None:
        webbrowser.open(target.as_uri())
    return target
