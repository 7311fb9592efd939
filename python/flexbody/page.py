"""Pages of results for a browser or a notebook."""

from __future__ import annotations

import html as escapes
import os

__all__ = ["Page"]


class Page:
    """A page of HTML that needs nothing else: the moving machine, its curves and its tables."""

    html: str
    """The text of the page."""

    def __init__(self, text: str) -> None:
        self.html = text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page, whole or not at all."""
        from .machine import write

        write(path, self.html)

    def _repr_html_(self) -> str:
        frame = 'width="100%" height="720" style="border: 0"'
        return f'<iframe srcdoc="{escapes.escape(self.html, quote=True)}" {frame}></iframe>'

    def __repr__(self) -> str:
        return f"<Page of {len(self.html) // 1024} kB: save(path) writes it, a notebook shows it>"
