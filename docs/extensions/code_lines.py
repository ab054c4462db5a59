"""Lines of code that are too long for a page are continued below, with an indent, and so each is an element of the page."""

from collections.abc import Iterable, Iterator
from typing import Any

from pygments.formatters import HtmlFormatter
from sphinx.application import Sphinx
from sphinx.highlighting import PygmentsBridge


class LineFormatter(HtmlFormatter[str]):  # type: ignore[misc]  # Pygments has no types
    """Puts every line of code, with the break at its end, into `<span class="line">`."""

    def wrap(self, source: Iterable[tuple[int, str]]) -> Iterator[tuple[int, str]]:
        lines = ((is_code, f'<span class="line">{text}</span>' if is_code else text) for is_code, text in source)
        wrapped: Iterator[tuple[int, str]] = super().wrap(lines)
        return wrapped


def setup(app: Sphinx) -> dict[str, Any]:
    """Let Sphinx write code in this way."""
    PygmentsBridge.html_formatter = LineFormatter
    return {"parallel_read_safe": True, "parallel_write_safe": True}
