"""The page of contact: how bodies rest, roll, bounce and tip in all engines, by their sheets of contact.

It has the errors of all engines in all scenes, what law the contacts of each engine follow, the properties that probes
measured, and the settings that engines were given.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import get_args

from bodycheck.reports.runs.matrix import decade
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.engine_facts import newest, properties
from bodycheck.site.render import File, page
from bodycheck.studies.contact.rows import Setting
from bodycheck.studies.contact.wording import COLUMNS, law

#: The settings in words, as the study names them.
WORDS: dict[Setting, str] = {"defaults": "at defaults", "recommended": "as recommended", "best": "best found"}


@dataclass(frozen=True, eq=False)
class Cell:
    """An engine in a scene.

    Parameters
    ----------
    engine
        The engine.
    usual
        The row with the error of the position at the defaults, or with another setting if the engine has no defaults.
    best
        The row with the error of the position with the setting in which it is smallest; None if that is `usual`.
    why
        Why there is no error; empty if there is one.
    """

    engine: str
    usual: Entry | None
    best: Entry | None
    why: str

    @property
    def style(self) -> str:
        """Return the classes of the cell: the decade of its error, or that there is none."""
        value = None if self.usual is None else self.usual.get("value")
        return "unsupported" if value is None else f"error d{-decade(value)}"


@dataclass(frozen=True, eq=False)
class Law:
    """The law of the contacts of an engine with settings that share it, and the properties with the first of them."""

    engine: str
    version: str
    settings: str
    method: Entry
    sentence: str
    measured: tuple[Entry | None, ...]


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page, if any engine has a sheet of contact."""
    sheets = {engine: rows for engine in catalogue.engines if (rows := newest(catalogue, "contact.csv", engine))}
    if not sheets:
        return
    scenes = sorted({row.row["scene"] for rows in sheets.values() for row in rows})
    lines = [(scene, [_cell(catalogue, engine, rows, scene) for engine, rows in sheets.items()]) for scene in scenes]
    settings = [row for engine in sheets for row in newest(catalogue, "contact_settings.csv", engine)]
    yield page(
        links.CONTACT,
        "contact.html.jinja",
        catalogue,
        engines=list(sheets),
        without=[engine for engine in catalogue.engines if engine not in sheets],
        lines=lines,
        reasons=_reasons(lines),
        laws=[one for engine in sheets for one in _laws(catalogue, engine)],
        columns=COLUMNS,
        settings=settings,
        words=WORDS,
    )


def _cell(catalogue: Catalogue, engine: str, sheet: Sequence[Entry], scene: str) -> Cell:
    """Return the cell of an engine and a scene. sheet: the rows of contact.csv about the engine."""
    by_figure = {(row.row["setting"], row.get("figure")): row for row in sheet if row.row["scene"] == scene}
    errors = [row for setting in get_args(Setting) if (row := by_figure.get((setting, "position_error"))) is not None]
    if errors:
        best = min(errors, key=lambda row: row.row["value"])
        return Cell(engine, errors[0], None if best is errors[0] else best, "")
    statuses = {str(row.row["status"]) for row in by_figure.values()} or {"not measured"}
    run = next((run for run in catalogue.runs.get((engine, scene), ())[::-1] if run.get("reason")), None)
    reason = catalogue.without_method.get((engine, scene)) or (run.get("reason") if run is not None else None)
    return Cell(engine, None, None, f"{', '.join(sorted(statuses))}{f': {reason}' if reason else ''}")


def _reasons(lines: Sequence[tuple[str, Sequence[Cell]]]) -> list[tuple[str, list[str]]]:
    """Return each reason for which there is no error, with the engines and their scenes."""
    reasons: dict[str, dict[str, list[str]]] = {}
    for scene, cells in lines:
        for cell in cells:
            if cell.why:
                reasons.setdefault(cell.why, {}).setdefault(cell.engine, []).append(scene)
    return [(why, [f"{name}: {', '.join(scenes)}" for name, scenes in where.items()]) for why, where in reasons.items()]


def _laws(catalogue: Catalogue, engine: str) -> Iterator[Law]:
    """Yield what the contacts of an engine do, once for settings of which the same is to be said."""
    alike: dict[str, list[Setting]] = {}
    by_setting = properties(catalogue, engine)
    for setting, rows in by_setting.items():
        alike.setdefault(law([row for row, _ in rows]), []).append(setting)
    for sentence, settings in alike.items():
        rows = by_setting[settings[0]]
        by_key = {(row.property, row.condition): entry for row, entry in rows}
        yield Law(
            engine,
            rows[0][1].version,
            ", ".join(WORDS[setting] for setting in settings),
            rows[0][1],
            sentence[:1].upper() + sentence[1:],
            tuple(by_key.get(column.key) for column in COLUMNS),
        )
