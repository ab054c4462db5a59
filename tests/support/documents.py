"""What documents contain."""

import re
from pathlib import Path


def blocks(document: Path, language: str) -> list[str]:
    """The fenced blocks of a document in a language."""
    return re.findall(rf"```{language}\n(.*?)```", document.read_text(encoding="utf-8"), re.DOTALL)
