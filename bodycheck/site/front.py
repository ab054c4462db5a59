"""The content of the front page: a matrix of engines by scenes for each kind of scene, and the changes, as text."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bodycheck.reports.quantities import bound, milliseconds, number
from bodycheck.reports.runs.kinds import KINDS, Kind
from bodycheck.reports.runs.matrix import decade
from bodycheck.results.verdicts import BETTER, OTHER, SCENES, WORSE
from bodycheck.site import cells, changes, links
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.cells import Cell
from bodycheck.site.changes import Change
from bodycheck.site.submissions.own_methods import in_words as in_words_of_roles

#: The most characters of the reason in the explanation of a cell; the page of the row has the whole reason.
LONGEST_REASON = 200

#: The text between the numbers of submissions that contradict each other.
DISPUTED = " or "

#: The most changes of an engine that the page lists individually.
NAMED_CHANGES = 5


@dataclass(frozen=True)
class Shown:
    """A cell as the page shows it.

    Parameters
    ----------
    text
        The number or the mark of the verdict.
    word
        The verdict in words, for readers who cannot see its mark; empty if the text is not the mark.
    mark
        The sign of a change: ▲ if the shown method became worse, ▼ if it became better, ◆ for any other change; or empty.
    style
        The CSS classes of the cell: its verdict, the decade of the error, "changed" if anything changed, and "disputed" if
        other submissions say something else.
    told
        The explanation of the cell: error, bound, method and change, in words.
    address
        The address of the raw row; empty if there is none.
    """

    text: str
    word: str
    mark: str
    style: str
    told: str
    address: str


@dataclass(frozen=True, eq=False)
class Head:
    """The head of an engine's column: the engine, and its newest version with the date; both empty if it has no runs."""

    engine: str
    version: str
    date: str


@dataclass(frozen=True, eq=False)
class Line:
    """A scene with a cell for each engine: `own` for its default method, `recommended` and `best` for these methods."""

    scene: Scene
    own: tuple[Shown, ...]
    recommended: tuple[Shown, ...]
    best: tuple[Shown, ...]

    @property
    def words(self) -> str:
        """Return the text that the filter of the page searches, in small letters."""
        return " ".join((self.scene.name, *self.scene.case.tags, self.scene.case.title)).lower()


@dataclass(frozen=True, eq=False)
class Group:
    """The scenes of one kind."""

    kind: Kind
    lines: tuple[Line, ...]

    @property
    def label(self) -> str:
        """Return the title of the shown quantity, with its unit."""
        return self.lines[0].scene.quantity.label


@dataclass(frozen=True, eq=False)
class News:
    """The changes of an engine.

    Parameters
    ----------
    engine, version
        The engine and its newest version.
    since
        The results with which it is compared, in words: versions, or dates of the same version.
    worse, better, other
        The numbers of scenes in which the engine's own method became worse, became better, or only other methods changed.
    largest
        The largest changes of any method: the case, the change in words, and the address of the raw row.
    comparison
        The address of the comparison of the two results that contain the largest change.
    """

    engine: str
    version: str
    since: str
    worse: int
    better: int
    other: int
    largest: tuple[tuple[str, str, str], ...]
    comparison: str


@dataclass(frozen=True, eq=False)
class Front:
    """The content of the front page of a catalogue."""

    catalogue: Catalogue

    @cached_property
    def cells(self) -> dict[tuple[str, str], Cell]:
        """Return the cells by the names of their engines and scenes."""
        return {
            (engine, name): cells.cell(self.catalogue, engine, scene)
            for name, scene in self.catalogue.scenes.items()
            for engine in self.catalogue.engines
        }

    @cached_property
    def heads(self) -> tuple[Head, ...]:
        """Return the heads of the columns."""
        newest: dict[str, Entry] = {}
        for (engine, _), runs in self.catalogue.runs.items():
            newest[engine] = max(newest.get(engine, runs[-1]), runs[-1], key=lambda entry: entry.order)
        return tuple(
            Head(name, newest[name].version, newest[name].source.date) if name in newest else Head(name, "", "")
            for name in self.catalogue.engines
        )

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Return the matrices, one for each kind of scene in the catalogue, without scenes that no engine has run."""
        by_kind: dict[str, list[Line]] = {kind.name: [] for kind in KINDS}
        for scene in self.catalogue.scenes.values():
            known = [self.cells[engine, scene.name] for engine in self.catalogue.engines]
            if all(cell.verdict == "not run" for cell in known):
                continue  # a case of another table alone
            recommended = [recommended_of(self.catalogue, cell, scene) for cell in known]
            best = [best_of(self.catalogue, cell, scene) for cell in known]
            columns = (
                tuple(shown(cell, scene, head) for cell, head in zip(of_scene, self.heads, strict=True))
                for of_scene in (known, recommended, best)
            )
            by_kind[scene.kind.name].append(Line(scene, *columns))
        return tuple(Group(kind, tuple(by_kind[kind.name])) for kind in KINDS if by_kind[kind.name])

    @cached_property
    def news(self) -> tuple[News, ...]:
        """Return the changes of each engine that has any changes."""
        found = (self._news(head) for head in self.heads)
        return tuple(one for one in found if one is not None)

    def _news(self, head: Head) -> News | None:
        changed = [cell for (engine, _), cell in self.cells.items() if engine == head.engine and cell.changes]
        if not changed:
            return None
        every = sorted(
            (change for cell in changed for change in cell.changes), key=lambda change: change.severity, reverse=True
        )
        own = [change for cell in changed for change in cell.changes if change.after is cell.run]
        largest = every[:NAMED_CHANGES]
        return News(
            head.engine,
            head.version,
            _since([change.before for change in every], head.version),
            sum(change.worse is True for change in own),
            sum(change.worse is False for change in own),
            len(changed) - sum(change.worse is not None for change in own),
            tuple((change.after.row["case"], in_words(change), links.row(change.after)) for change in largest),
            links.compare(head.engine, largest[0].before, largest[0].after),
        )


def best_of(catalogue: Catalogue, cell: Cell, scene: Scene) -> Cell:
    """Return the cell with the engine's best run in place of the run of its own method; unchanged if there is no best run."""
    if cell.best is None:
        return cell
    return replace(_with_run(catalogue, cell, cell.best, scene), reason="")


def recommended_of(catalogue: Catalogue, cell: Cell, scene: Scene) -> Cell:
    """Return the cell with the run of the engine's recommended method, or with the reason why there is no such run.

    The cell is unchanged if the engine has no run of the scene.
    """
    if cell.recommended is not None:
        return _with_run(catalogue, cell, cell.recommended, scene)
    if cell.run is None:
        return cell
    return Cell("not run", reason="no recommended method" if "role" in cell.run.row else "role not known")


def _with_run(catalogue: Catalogue, cell: Cell, run: Entry, scene: Scene) -> Cell:
    """Return the cell with another run of its engine in place of the run of its own method."""
    others = changes.contradictions(catalogue, scene, run)
    of_run = cells.of_run(run, scene)
    return replace(of_run, recommended=cell.recommended, best=cell.best, changes=cell.changes, others=others)


def shown(cell: Cell, scene: Scene, head: Head) -> Shown:
    """Return a cell as the page shows it."""
    text, numeric = cells.text(cell), cell.value is not None and cell.verdict in ("error", "broken")
    style = [cell.verdict.replace(" ", "-")]
    if numeric and cell.value is not None:
        style.append(f"d{-decade(cell.value)}")
    if cell.changes:
        style.append("changed")
    word = SCENES[cell.verdict].title if text == SCENES[cell.verdict].mark else ""
    if cell.others:
        style.append("disputed")
        text = DISPUTED.join((text, *(cells.text(cells.of_run(run, scene)) for run in cell.others)))
    address = links.row(cell.run) if cell.run is not None else ""
    return Shown(text, word, _mark(cell), " ".join(style), told(cell, scene, head), address)


def told(cell: Cell, scene: Scene, head: Head) -> str:
    """Return the explanation of a cell: the verdict, its reason, the method, the version and changes, in words."""
    parts = [SCENES[cell.verdict].title if cell.verdict != "error" else ""]
    if cell.value is not None:
        known = f", bound {bound(cell.bound, 2)}" if cell.bound is not None else ", bound unknown"
        parts[0] = f"{parts[0] or 'error'} {number(cell.value, 3)}{known} {scene.quantity.unit}".rstrip()
    if cell.reason:
        parts.append(cell.reason if len(cell.reason) <= LONGEST_REASON else f"{cell.reason[:LONGEST_REASON]}…")
    if cell.run is not None:
        parts.append(f"{method(cell.run)}, {in_words_of_roles(cell.run.row)}")
        if (cell.run.version, cell.run.source.date) != (head.version, head.date):
            parts.append(f"version {cell.run.version} of {cell.run.source.date}")
    for run in cell.others:
        parts.append(f"{run.source.named} says {_value(run, scene)}")
    if cell.run is not None and cell.others:
        parts.append(f"{cell.run.source.named} says {_value(cell.run, scene)}")
    if cell.changes:
        first = next((change for change in cell.changes if change.after is cell.run), cell.changes[0])
        more = f" and {len(cell.changes) - 1} more" if len(cell.changes) > 1 else ""
        parts.append(f"changed since {_since([first.before], first.after.version)}: {in_words(first)}{more}")
    return "; ".join(part for part in parts if part)


def _value(run: Entry, scene: Scene) -> str:
    """Return the error of a run in words, or its status if it has none."""
    value = run.get(scene.quantity.name)
    return str(run.get("status")) if value is None else scene.quantity.with_unit(value)


def method(run: Entry) -> str:
    """Return the method of a run in words."""
    integrator, timestep = run.method
    return f"{integrator} at {milliseconds(timestep, 4)}" if timestep is not None else integrator


def in_words(change: Change) -> str:
    """Return a change in words: the method, and the status or error before and after."""
    before, after = change.before.get(change.quantity), change.after.get(change.quantity)
    values = (before, after) if isinstance(before, str) else (number(before, 3), number(after, 3))
    return f"{method(change.after)} {values[0]} → {values[1]}"


def _mark(cell: Cell) -> str:
    """Return the sign of the change of a cell, or an empty text; see `Shown.mark`."""
    if not cell.changes:
        return ""
    own = next((change for change in cell.changes if change.after is cell.run), None)
    return {True: WORSE, False: BETTER, None: OTHER}[own.worse if own is not None else None]


def _since(befores: Sequence[Entry], version: str) -> str:
    """Return the earlier results in words: their versions, or the dates if they have the version `version`."""
    found = dict.fromkeys(
        entry.version if entry.version != version else f"{entry.version} of {entry.source.date}"
        for entry in sorted(befores, key=lambda entry: entry.order, reverse=True)
    )
    names = list(found)
    return names[0] if len(names) == 1 else f"{names[0]} and earlier"
