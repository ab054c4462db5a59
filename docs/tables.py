"""Renew what pages take from the source code and from claims. Run: python docs/tables.py

- `docs/cases.md` has tables of figures and of axes from the source code, and `docs/driven.md` one of driven cases.
- A page has sentences of claims between the lines `<!-- claims: ENGINE/NAME ENGINE/NAME:WORDING -->` and
  `<!-- end of claims -->`.
- `docs/claims.md` is the list of all claims.
"""

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from bodycheck.casefile.axes import AXES
from bodycheck.casefile.case import load, shipped
from bodycheck.figures.columns import LIMITED
from claims import records
from claims.records import Claim

ROOT = Path(__file__).resolve().parents[1]

#: The pages with tables from the source code, and the page with all claims.
CASES, DRIVEN, CLAIMS = (ROOT / "docs" / name for name in ("cases.md", "driven.md", "claims.md"))

#: The tag of the cases of driven joints.
TAG = "driven"

#: What a table stands between: a line for its name, and a line that is the same for all.
BEGIN, END = "<!-- {} from the source code; renewed by: python docs/tables.py -->", "<!-- end of the table -->"

#: What sentences of claims stand between.
CLAIMED = re.compile(r"^(<!-- claims: (.*) -->)\n(?:(?!<!-- claims: ).*\n)*?(<!-- end of claims -->)$", re.MULTILINE)

#: The beginning of the page with all claims.
HEAD = """\
# Claims

These are the claims of this documentation about engines. Each has a command of bodycheck and a short script, which needs only
the engine, that give its numbers, and what the engine's documentation or a thread says of it. A *fault* is a deviation from
mechanics or from the engine's documentation, a *choice* is one that its authors made and documented, and a *default* is a
setting that users can change. `make claims` measures all claims again. This page is made by `python docs/tables.py`, and
CONTRIBUTING.md says how to add a claim.
"""


def tables() -> dict[Path, dict[str, str]]:
    """Return the tables of each page as Markdown, by the names that stand in the lines before them."""
    axes = [(f"`{axis.name}`", axis.unit or "1", _sentence(axis.meaning, axis.remark)) for axis in AXES.values()]
    figures = [(f"`{name}`", column.unit or "1", _sentence(column.told, column.remark)) for name, column in LIMITED.items()]
    driven = [(f"`{case.name}`", case.title) for case in map(load, shipped()) if TAG in case.tags]
    return {
        CASES: {
            "Axes": _table(("axis", "unit", "what it sets"), axes),
            "Figures": _table(("key", "unit", "what it is"), figures),
        },
        DRIVEN: {"Driven cases": _table(("case", "what it is"), driven)},
    }


def renewed(text: str, tables_of_page: Mapping[str, str]) -> str:
    """Return the text of a page with its tables renewed. Raises `ValueError` where the place of a table is missing."""
    for name, table in tables_of_page.items():
        before, begin, rest = text.partition(BEGIN.format(name))
        _, end, after = rest.partition(END)
        if not (begin and end):
            raise ValueError(f"the page has no place for the table {name!r}")
        text = f"{before}{begin}\n\n{table}\n\n{end}{after}"
    return text


def with_claims(text: str, page: Path) -> str:
    """Return the text of a page with the sentences of claims renewed.

    Raises `ValueError` for a first or last line without the other, and for a claim or a wording that does not exist.
    """
    renewed_text, places = CLAIMED.subn(lambda place: f"{place[1]}\n{_sentences(place[2], page)}\n{place[3]}", text)
    for mark in (r"^<!-- claims: .* -->$", r"^<!-- end of claims -->$"):
        if (lines := len(re.findall(mark, text, re.MULTILINE))) != places:
            raise ValueError(f"{page}: {lines} lines are {mark}, but {places} places of claims have a first and a last line")
    return renewed_text


def pages() -> dict[Path, str]:
    """Return the renewed text of every page that takes something from the source code or from claims."""
    texts = {page: page.read_text("utf-8") for page in (*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md")))}
    changed = {page: with_claims(text, page) for page, text in texts.items() if "<!-- claims: " in text}
    with_tables = {page: renewed(changed.get(page, texts[page]), of_page) for page, of_page in tables().items()}
    return {**changed, **with_tables, CLAIMS: page_of_claims()}


def page_of_claims() -> str:
    """Return the page with all claims: a table of them, and each with its evidence."""
    claims = records.claims().values()
    rows = [(f"[{one.name}](#{one.name.replace('/', '')})", one.kind, ", ".join(one.releases)) for one in claims]
    sections = (f"## {one.name}\n\n{_with_links(records.sentence(one), CLAIMS)}\n\n{_evidence(one)}\n" for one in claims)
    return "\n".join([HEAD, _table(("claim", "kind", "releases"), rows) + "\n", *sections])


def _sentences(names: str, page: Path) -> str:
    """Return the sentences of the claims that a first line names, each `ENGINE/NAME` or `ENGINE/NAME:WORDING`."""
    sentences = []
    for word in names.split():
        name, _, wording = word.partition(":")
        if name not in records.claims():
            raise ValueError(f"{page}: there is no claim {name!r} in the folder claims")
        sentences.append(_with_links(records.sentence(records.claims()[name], wording), page))
    return "\n".join(sentences)


def _with_links(sentence: str, page: Path) -> str:
    """Return a sentence whose links lead from the page instead of from the folder of the checkout."""
    return re.sub(r"\]\((?!https:)([^)]+)\)", lambda link: f"]({os.path.relpath(ROOT / link[1], page.parent)})", sentence)


def _evidence(claim: Claim) -> str:
    """Return the list of what shows a claim: command and script, documentation, and the experiment on its cause."""
    lines = [
        f"- {claim.kind.capitalize()}, measured in {', '.join(claim.releases)}",
        f"- `{claim.command}`",
        f"- `claims/{claim.name}.py`",
        *(f"- [{one.address.removeprefix('https://')}]({one.address}): “{_plain(one.says)}”" for one in claim.documentation),
    ]
    if cause := claim.cause:
        lines.append(f"- Cause: {cause.text} Experiment: {cause.experiment} Rejected: {'; '.join(cause.against)}.")
    return "\n".join(lines)


def _plain(text: str) -> str:
    """Return a text on one line that is no markup."""
    return re.sub(r"([*<>\[\]$_])", r"\\\1", " ".join(text.split()))


def _sentence(meaning: str, remark: str) -> str:
    return f"{meaning}; {remark}" if remark else meaning


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


if __name__ == "__main__":
    for page, text in pages().items():
        page.write_text(text, "utf-8")
