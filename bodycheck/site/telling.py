"""Sentences with links that describe changes, for pages and for the feed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.changes import Change
from bodycheck.site.releases import Upgrade, lasts, order_changed
from bodycheck.studies.releases.findings import ORDINALS, WHOLE

#: The most scenes that a sentence names.
MOST_NAMED = 4


@dataclass(frozen=True)
class Piece:
    """A part of a sentence.

    Parameters
    ----------
    text
        The text of the part.
    address
        The address inside the site to which the text links; empty for plain text.
    """

    text: str
    address: str = ""


#: A sentence with its full stop.
Sentence = tuple[Piece, ...]


def plain(sentence: Sentence) -> str:
    """Return the text of a sentence."""
    return "".join(piece.text for piece in sentence)


def of_upgrade(upgrade: Upgrade) -> Iterator[Sentence]:
    """Yield sentences about an upgrade, based on the runs of its two releases."""
    before = upgrade.before.version
    yield from tally(upgrade.changes, len(upgrade.pairs), f"in {before}")
    yield from methods(upgrade)


def tally(changes: Sequence[tuple[Scene, Change]], compared: int, earlier: str) -> Iterator[Sentence]:
    """Yield sentences about how many runs changed, and about the largest changes.

    changes: the changes with their scenes. compared: the number of runs that have an earlier run of the same method. earlier: a
    phrase that says where the earlier runs are.
    """
    if not compared:
        yield (Piece(f"There are no runs of the same methods {earlier}."),)
        return
    better = [one for one in changes if one[1].quantity != "status" and not one[1].worse]
    worse = [one for one in changes if one[1].quantity != "status" and one[1].worse]
    statuses = [one for one in changes if one[1].quantity == "status"]
    if not changes:
        yield (Piece(f"{count(compared, 'run')} with the same method {earlier}: nothing changed beyond rounding."),)
        return
    yield (
        Piece(
            f"{count(compared, 'run')} with the same method {earlier}: {len(better)} with a smaller error, "
            f"{len(worse)} with a larger one, {len(statuses)} that {'ends' if len(statuses) == 1 else 'end'} in another way, "
            f"and {compared - len(changes)} without a change beyond rounding."
        ),
    )
    for found, word in ((better, "smaller"), (worse, "larger")):
        if found:
            yield _largest(*max(found, key=lambda one: one[1].severity), word)
    yield from _ended(statuses)


def methods(upgrade: Upgrade) -> Iterator[Sentence]:
    """Yield sentences about the integrators with which only one of the two releases has runs."""
    for names, release in ((upgrade.new_methods, upgrade.after), (upgrade.gone_methods, upgrade.before)):
        if names:
            yield (Piece(f"Only {release.version} has runs with {listing(names)}."),)


def orders(catalogue: Catalogue, measured: Sequence[Entry]) -> Iterator[Sentence]:
    """Yield sentences about the methods whose order of convergence has changed since a release.

    A sentence is about all quantities in which the order of a method changed in the same way on a case. For each quantity of a
    method, only the first case is mentioned.

    measured: rows of changes.csv of studies of releases, all about the same later release.
    """
    alike: dict[tuple[object, ...], list[Entry]] = {}
    told = set()
    for change in measured:
        row = change.row
        key = (row["integrator"], row["quantity"])
        if order_changed(change) and key not in told and row["quantity"] in QUANTITIES:
            told.add(key)
            words = ordinal(row["order_before"]), ordinal(row["order_after"])
            same = (row["integrator"], row["case"], row["from_version"], *words, lasts(catalogue, change))
            alike.setdefault(same, []).append(change)
    for group in alike.values():
        yield _order(catalogue, group)


def _order(catalogue: Catalogue, alike: Sequence[Entry]) -> Sentence:
    """Return the sentence about a changed order of a method. alike: one row per quantity, all with the same orders in words."""
    row = alike[0].row
    since = f"From {row['to_version']} on" if lasts(catalogue, alike[0]) else f"In {row['to_version']}"
    subjects = [change.row["quantity"].rpartition("_")[0].replace("_", " ") for change in alike]
    observed = [Piece(number(change.row["order_after"], 3), links.row(change)) for change in alike]
    before = list(dict.fromkeys(number(change.row["order_before"], 3) for change in alike))
    schemes = ""
    if row.get("scheme_before") and row.get("scheme_after") and row["scheme_before"] != row["scheme_after"]:
        schemes = f" Its scheme is {row['scheme_after']}, and was {row['scheme_before']}."
    return (
        Piece(f"{since}, {row['integrator']} is of {ordinal(row['order_after'])} order in {listing(subjects)} (observed "),
        *_joined(observed),
        Piece(" in "),
        Piece(row["case"], links.scene(row["case"]) if row["case"] in catalogue.scenes else ""),
        Piece(
            f"); in {row['from_version']}, the last release measured before, it was of {ordinal(row['order_before'])} order "
            f"({listing(before)}).{schemes}"
        ),
    )


def _joined(pieces: Sequence[Piece]) -> Iterator[Piece]:
    """Yield pieces as an enumeration, with commas and "and" between them."""
    for place, piece in enumerate(pieces):
        if place:
            yield Piece(" and " if place == len(pieces) - 1 else ", ")
        yield piece


def ordinal(order: float) -> str:
    """Return an observed order in words, such as "fourth" close to a whole number, or "2.45-th" otherwise."""
    whole = round(order)
    return ORDINALS[whole] if whole in ORDINALS and abs(order - whole) <= WHOLE * whole else f"{order:.2f}-th"


def _largest(scene: Scene, change: Change, word: str) -> Sentence:
    quantity = scene.quantity
    before, after = change.before, change.after
    times = f"{number(change.factor, 3)} times {word}" if change.factor is not None else word
    return (
        Piece(f"The largest change to a {word} error: {after.get('integrator')} at {milliseconds(after.get('timestep'))} in "),
        Piece(scene.name, links.scene(scene.name)),
        Piece(f" went from {quantity.title.lower()} "),
        Piece(f"{number(before.get(quantity.name), 3)} {quantity.unit}".rstrip(), links.row(before)),
        Piece(" to "),
        Piece(f"{number(after.get(quantity.name), 3)} {quantity.unit}".rstrip(), links.row(after)),
        Piece(f", {times}."),
    )


def _ended(statuses: Sequence[tuple[Scene, Change]]) -> Iterator[Sentence]:
    """Yield a sentence for each pair of an earlier and a later status, with the names of the scenes."""
    grouped: dict[tuple[str, str], dict[str, Scene]] = {}
    for scene, change in statuses:
        key = (str(change.before.get("status")), str(change.after.get("status")))
        grouped.setdefault(key, {})[scene.name] = scene
    for (then, now), scenes in sorted(grouped.items()):
        named = list(scenes)[:MOST_NAMED]
        pieces = [Piece(f"Runs that ended as {then} and now end as {now}: ")]
        for place, name in enumerate(named):
            pieces += [Piece(", ")] * bool(place) + [Piece(name, links.scene(name))]
        more = len(scenes) - len(named)
        yield (*pieces, Piece(f" and {count(more, 'more scene')}." if more else "."))
