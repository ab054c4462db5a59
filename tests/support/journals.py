"""Journals that tests change: with the checksums that belong to the changed lines, or as earlier versions wrote them."""

import json
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from typing import Any

Record = dict[str, Any]


def records(path: Path) -> list[Record]:
    """All lines of a journal, header and footer included, without their checksums."""
    found = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    return [{name: value for name, value in record.items() if name != "check"} for record in found]


def write(path: Path, lines: Iterable[Record]) -> None:
    """Write a journal with these lines and their checksums."""
    path.write_text("".join(sealed(json.dumps(line)) for line in lines), "utf-8")


def edit(path: Path, change: Callable[[Record], Record | None]) -> None:
    """Change the records of a journal; None leaves one out."""
    header, *lines, footer = records(path)
    kept = [new for record in lines if (new := change(record)) is not None]
    begin = change(header)
    assert begin is not None
    write(path, [begin, *kept, {**footer, "records": len(kept)}])


def write_without_checksums(path: Path, lines: Iterable[Record]) -> None:
    """Write a journal with these lines as earlier versions did."""
    path.write_text("".join(f"{json.dumps(line)}\n" for line in lines), "utf-8")


def spoil(path: Path, change: Callable[[str], str]) -> None:
    """Change the text of a journal, and give its lines the checksums that belong to them then."""
    text = "".join(f"{json.dumps(record, ensure_ascii=False)}\n" for record in records(path))
    path.write_text("".join(map(sealed, change(text).splitlines())), "utf-8")


def sealed(line: str) -> str:
    """A line that ends with the checksum of the rest."""
    body = line[:-1]
    return f'{body}, "check": "{sha256(body.encode()).hexdigest()[:16]}"}}\n'
