"""The JSON Schemas of case files as files of the built documentation, so that editors can fetch them by address."""

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

from bodycheck.casefile import authoring

#: The folder of the schemas in the built documentation.
FOLDER = "schemas"

#: The names of the files, each with what makes it.
SCHEMAS = {"case.schema.json": authoring.schema, "case.draft-07.schema.json": authoring.draft_07}


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the schemas beside the built pages."""
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _write(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.name == "html":
        folder = Path(app.outdir) / FOLDER
        folder.mkdir(exist_ok=True)
        for name, text in SCHEMAS.items():
            (folder / name).write_text(text(), "utf-8", newline="\n")
