"""What changed, as sentences with links: for pages and for the feed."""

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
        Its text.
    address
        The address inside the site to which it leads; empty for plain text.
    """

    text: str
    address: str = ""


#: A sentence with its full stop.
Sentence = tuple[Piece, ...]


def plain(sentence: Sentence) -> str:
    """Return the text of a sentence."""
    return "".join(piece.text for piece in sentence)


def of_upgrade(upgrade: Upgrade) -> Iterator[Sentence]:
    """Yield sentences on an upgrade, from the runs of its two releases."""
    before = upgrade.before.version
    yield from tally(upgrade.changes, len(upgrade.pairs), f"in {before}")
    yield from methods(upgrade)


def tally(changes: Sequence[tuple[Scene, Change]], compared: int, earlier: str) -> Iterator[Sentence]:
    """Yield sentences on how many runs changed, and on the largest changes.

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
    """Yield sentences on the integrators of which only one of the two releases has runs."""
    for names, release in ((upgrade.new_methods, upgrade.after), (upgrade.gone_methods, upgrade.before)):
        if names:
            yield (Piece(f"Only {release.version} has runs with {listing(names)}."),)


def orders(catalogue: Catalogue, measured: Sequence[Entry]) -> Iterator[Sentence]:
    """Yield sentences on the methods whose order of convergence has changed since a release.

    A sentence is about all quantities in which the order of a method changed alike on a case. For each quantity of a method,
    only the first case is mentioned.

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
    """Return the sentence on the order of a method in some quantities whose orders, in words, are the same before and after."""
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
    """Yield pieces as a list in a sentence."""
    for place, piece in enumerate(pieces):
        if place:
            yield Piece(" and " if place == len(pieces) - 1 else ", ")
        yield piece


def ordinal(order: float) -> str:
    """Return an observed order in words: "fourth" where it is close to four, "2.45-th" where it is close to none."""
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
    """Yield a sentence for each change of status, with the scenes."""
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
