"""Results as a part of a page, for a notebook: a headline, sentences, and the first rows of a table."""

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from itertools import islice
from typing import Any

#: Most rows of a table that are shown, and the significant digits of its numbers.
MOST_ROWS, DIGITS = 12, 4


def shown(
    headline: str, sentences: Iterable[str], rows: Sequence[Mapping[str, Any]], columns: Sequence[str], units: Mapping[str, str]
) -> str:
    """Return HTML.

    Parameters
    ----------
    headline, sentences
        What the results say.
    rows, columns
        The table, and the columns of it that are shown where any row has a value.
    units
        The units of columns.
    """
    used = [name for name in columns if any(row.get(name) not in (None, "") for row in rows)]
    heads = "".join(f"<th>{escape(f'{name} {units.get(name, str())}'.rstrip())}</th>" for name in used)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(_text(row.get(name)))}</td>' for name in used)}</tr>" for row in islice(rows, MOST_ROWS)
    )
    left = len(rows) - MOST_ROWS
    more = f"<p>{left} more rows are in <code>to_frame()</code>.</p>" if left > 0 else ""
    said = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return (
        f"<p><b>{escape(headline)}</b></p>{f'<ul>{said}</ul>' if said else ''}"
        f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>{more}"
    )


def _text(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)
