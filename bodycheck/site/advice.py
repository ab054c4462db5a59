"""The sentences that open the page of an engine: what to use the engine for, what to mind, and what its contacts do.

Every number is in a table of the page or leads to its raw row.
"""

from collections.abc import Iterator, Sequence

from bodycheck.reports.quantities import count, listing, milliseconds, number
from bodycheck.reports.runs.choices import ENOUGH
from bodycheck.reports.runs.kinds import KINDS
from bodycheck.site import links
from bodycheck.site.answers import Answer
from bodycheck.site.catalogue import Catalogue, Scene
from bodycheck.site.cells import Cell
from bodycheck.site.costs.standings import Costs, Priced, Standing
from bodycheck.site.engine_facts import MethodFacts, properties
from bodycheck.site.front import method
from bodycheck.site.telling import Piece, Sentence, ordinal
from bodycheck.studies.contact.wording import law

#: The kind of scenes in which the model of contact matters more than the method.
CONTACT = "contact"

#: The most scenes or kinds that a sentence names.
MOST_NAMED = 3

#: The cells of an engine with their scenes.
Found = Sequence[tuple[Scene, Cell]]


def advice(
    catalogue: Catalogue, engine: str, cells: Found, methods: Sequence[MethodFacts], costs: Sequence[Costs]
) -> Iterator[Answer]:
    """Yield what to use an engine for, what to mind, and what its contacts do, each if anything is known of it.

    cells: the cell of each scene. methods: the facts about its methods. costs: accuracy against cost by scene, with those first
    that say most; see `standings.shown`.
    """
    ran = [(scene, cell) for scene, cell in cells if cell.value is not None]
    if ran:
        yield Answer("Use it for", (*_best(engine, methods, costs), *_within(ran)))
    if minded := (*_worst(ran), *_endings(cells)):
        yield Answer("Mind", minded)
    yield Answer("Contact", _contact(catalogue, engine, cells))


def _within(ran: Found) -> Sentence:
    """Return in how many scenes of each kind the engine's own method is accurate enough. ran: the scenes with errors."""
    close = [(scene, cell) for scene, cell in ran if (cell.value or 0.0) <= ENOUGH]
    parts = []
    for kind in KINDS:
        of_kind = [scene for scene, _ in ran if scene.kind is kind]
        if of_kind:
            amount = sum(scene.kind is kind for scene, _ in close)
            parts.append(f"{amount} of {len(of_kind)} ({kind.title[0].lower()}{kind.title[1:]})")
    return (
        Piece(f" Its own method stays within {number(ENOUGH)} rad or m in "),
        Piece(f"{len(close)} of {count(len(ran), 'scene')}", "#scenes"),
        Piece(f": {listing(parts)}."),
    )


def _best(engine: str, methods: Sequence[MethodFacts], costs: Sequence[Costs]) -> Sentence:
    """Return which method is the most accurate at the cost of the own one, in the scene that says most about costs."""
    standing = next(
        (
            (of_scene.scene, one)
            for of_scene in costs
            for one in of_scene.standings
            if one.engine == engine and of_scene.scene.kind.name != CONTACT
        ),
        None,
    )
    if standing is None:
        return ()
    scene, one = standing
    unit = scene.quantity.unit
    if one.best is one.usual:
        return (
            Piece(f"Of {count(len(one.runs), 'method')} in "),
            Piece(scene.name, links.scene(scene.name)),
            Piece(f", none is more accurate at the cost of {method(one.usual.run)}, which is off by "),
            *(_error(one.usual, unit), Piece(f" and takes {_time(one.usual)} for a second of motion.")),
            *_dearer(one, unit),
        )
    order = next((fact.claimed for fact in methods if fact.name == one.best.run.method[0] and fact.claimed), None)
    of_order = f", a method of {ordinal(order)} order" if order else ""
    return (
        Piece(f"At no more than the cost of its own method take {method(one.best.run)}{of_order}: in "),
        *(Piece(scene.name, links.scene(scene.name)), Piece(" it is off by "), _error(one.best, unit)),
        Piece(f" for {_time(one.best)} of computing a second of motion, and {method(one.usual.run)} by "),
        *(_error(one.usual, unit), Piece(f" for {_time(one.usual)}.")),
    )


def _dearer(one: Standing, unit: str) -> Sentence:
    """Return the cheapest method that is accurate enough, where the own one is not; empty if there is none."""
    accurate = [run for run in one.runs if run.error <= ENOUGH]
    if one.usual.error <= ENOUGH or not accurate:
        return ()
    cheapest = min(accurate, key=lambda run: run.cost)
    times = number(cheapest.cost / one.usual.cost, 2)
    return (Piece(f" {method(cheapest.run)} is off by "), _error(cheapest, unit), Piece(f" at {times} times the cost."))


def _worst(ran: Found) -> Sentence:
    """Return in which scene without contact the engine's own method is farthest off."""
    free = [(scene, cell) for scene, cell in ran if scene.kind.name != CONTACT and (cell.value or 0.0) > ENOUGH]
    if not free:
        return ()
    scene, cell = max(free, key=lambda one: one[1].value or 0.0)
    assert cell.run is not None  # the scene has an error
    assert cell.value is not None
    return (
        Piece(f"{method(cell.run)} is off by more than {number(ENOUGH)} rad or m in {count(len(free), 'scene')} "),
        Piece("without contact, most in "),
        Piece(scene.name, links.scene(scene.name)),
        Piece(", by "),
        Piece(f"{number(cell.value, 2)} {scene.quantity.unit}", links.row(cell.run)),
        Piece("."),
    )


def _endings(cells: Found) -> Sentence:
    """Return how many scenes the engine fails, refuses or does not model, with the names of the failed ones."""
    pieces: list[Piece] = []
    for verdict, word in (("failed", "fails in"), ("refused", "refuses"), ("unsupported", "does not model")):
        scenes = [scene for scene, cell in cells if cell.verdict == verdict]
        if scenes:
            pieces += [Piece(", " if pieces else " It "), Piece(f"{word} {count(len(scenes), 'scene')}")]
            if verdict != "unsupported":
                names = [Piece(scene.name, links.scene(scene.name)) for scene in scenes[:MOST_NAMED]]
                more = len(scenes) - len(names)
                pieces.append(Piece(" ("))
                pieces += [piece for name in names for piece in (name, Piece(", "))][:-1]
                pieces.append(Piece(f" and {more} more)" if more else ")"))
    return (*pieces, Piece(".")) if pieces else ()


def _contact(catalogue: Catalogue, engine: str, cells: Found) -> Sentence:
    """Return what the contacts of the engine do at its defaults, or in how many scenes with contact it has results."""
    known = properties(catalogue, engine)
    if known:
        setting, rows = next(iter(known.items()))
        sentence = law([row for row, _ in rows])
        setting_link = Piece("At its defaults" if setting == "defaults" else "With the " + setting + " settings", "#contact")
        return setting_link, Piece(f" {sentence}")
    scenes = [(scene, cell) for scene, cell in cells if scene.kind.name == CONTACT]
    ran = [(scene, cell) for scene, cell in scenes if cell.value is not None]
    if not ran:
        return (Piece(f"No results: it has run none of the {count(len(scenes), 'scene')} of contact."),)
    scene, cell = max(ran, key=lambda one: one[1].value or 0.0)
    assert cell.run is not None  # the scene has an error
    return (
        Piece(
            f"It runs {len(ran)} of {count(len(scenes), 'scene')} of contact, and has no sheet of contact. It is off most in "
        ),
        Piece(scene.name, links.scene(scene.name)),
        Piece(", by "),
        Piece(f"{number(cell.value, 2)} {scene.quantity.unit}", links.row(cell.run)),
        Piece("."),
    )


def _error(run: Priced, unit: str) -> Piece:
    return Piece(f"{number(run.error, 2)} {unit}", links.row(run.run))


def _time(run: Priced) -> str:
    return milliseconds(run.cost, 2)
