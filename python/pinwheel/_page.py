"""Pages that open offline."""

from __future__ import annotations

import html
import json
import re
import tempfile
import textwrap
import webbrowser
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from pinwheel import _core

_STYLES = re.compile(r"\x1b\[[0-9;]*m")


def _with(match: re.Match[str]) -> str:
    key, value = match.groups()
    try:
        float(value)
    except ValueError:
        value = json.dumps(value)
    return f'`with_({{"{key}": {value}}})`'


# Python's form of the remedies in the program's messages.
_FLAGS: tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...] = (
    ("build with --features crossval", "the program has them where it is built with its feature crossval"),
    ("run it without --engines", "name no engines"),
    (r"leave it out: --engines\b", "leave it out of `engines`"),
    (r"with --engines\b", "by `engines`"),
    (r"--longest (?:SECONDS|([0-9.]+))", lambda match: f"`longest_s={match[1] or 'SECONDS'}`"),
    (r"--longest\b", "`longest_s`"),
    ("--verbose", "`details()`"),
    ("--fresh", "`fresh=True`"),
    (r"--against (\S+) --map (\S+)", r'`against=[("\1", "\2")]`'),
    (r"--set ([a-z0-9_.]+)=([^\s,;`)]+)", _with),
    (r"\bpinwheel (design|explain|engines)\b", r"`pinwheel.\1`"),
)


def plain(text: str) -> str:
    """Returns a terminal's text without colours, with remedies in their form for Python.

    >>> plain("--set contact.law=line-hertz, or give it more time (--longest 300)")
    '`with_({"contact.law": "line-hertz"})`, or give it more time (`longest_s=300`)'
    """
    lines = _STYLES.sub("", text).split("\n")
    done: list[str] = []
    while lines:
        first = lines.pop(0)
        block, indent = [first], 0
        # Continuation lines are indented to the text of the first line, after its label.
        while lines and (below := len(lines[0]) - len(lines[0].lstrip())) > 0 and first[below - 1 : below] in (" ", ""):
            if below != (indent or below):
                break
            indent = below
            block.append(lines.pop(0))
        if not indent and (label := re.match(r"\S.*?\s{2,}", first)):
            indent = label.end()
        head, text = first[:indent], " ".join([first[indent:], *(line.strip() for line in block[1:])])
        here = text
        for flag, ours in _FLAGS:
            here = re.sub(flag, ours, here)
        if here == text:
            done += block
        else:
            done += textwrap.wrap(here, 80, initial_indent=head, subsequent_indent=" " * indent, break_long_words=False)
    return "\n".join(done)


class Frame:
    """A page in a notebook's cell, which holds all of it: nothing is served."""

    def __init__(self, page: str, height: int) -> None:
        self.page, self.height = page, height

    def _repr_html_(self) -> str:
        size = f'style="width: 100%; height: {self.height}px; border: 0"'
        return f'<iframe srcdoc="{html.escape(self.page)}" sandbox="allow-scripts allow-downloads" {size}></iframe>'


class Paged:
    """Base of results with a page that opens offline; the page is pickled with the result."""

    _page: Callable[[], str] | str
    _called = "page"

    def page(self) -> str:
        """The page that opens offline, HTML."""
        return self._page if isinstance(self._page, str) else self._page()

    def show(self, path: str | Path | None = None) -> Path:
        """Opens the page in the browser, or writes it to `path`; returns its path."""
        return show(self.page(), self._called, path)

    def frame(self, height: int = 900) -> Frame:
        """The page for a notebook's cell, on a hub too; `height` in px."""
        return Frame(self.page(), height)

    def _table(self, head: Iterable[str], rows: Iterable[tuple[str, Iterable[str]]]) -> str:
        """Words and a table for a notebook's cell; a row has a note, which a pointer shows, and its cells."""
        lines = "".join(f"<th>{html.escape(word)}</th>" for word in head)
        for note, cells in rows:
            line = "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
            lines += f'</tr><tr title="{html.escape(note)}">{line}'
        return f"<p>{html.escape(repr(self)[1:-1])}</p><table><tr>{lines}</tr></table>"

    def __getstate__(self) -> dict[str, Any]:
        # A sweep's page is a file of its folder.
        return self.__dict__ | ({"_page": self.page()} if "_page" in self.__dict__ else {})


def show(page: str, name: str, path: str | Path | None) -> Path:
    """Writes a page, to a temporary file unless `path` is given, and opens it in the browser; returns its path."""
    target = Path(path) if path is not None else Path(tempfile.mkdtemp(prefix="pinwheel-")) / f"{name}.html"
    _core.write(target, page.encode(), "Pinwheel</title>")
    if path is None:
        webbrowser.open(target.as_uri())
    return target
