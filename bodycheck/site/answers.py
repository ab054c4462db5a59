"""The sentences with which the front page opens: accuracy at low cost, defaults, changes, contact and scenes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reports.quantities import count, listing, milliseconds, number
from bodycheck.reports.runs.choices import ENOUGH
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.costs.standings import Costs, Priced
from bodycheck.site.engine_facts import newest
from bodycheck.site.front import News, method
from bodycheck.site.telling import Piece, Sentence

#: The most engines that a sentence names.
MOST_NAMED = 4


@dataclass(frozen=True)
class Answer:
    """A sentence or two, with links, that a page says of a subject."""

    subject: str
    sentence: Sentence


def answers(catalogue: Catalogue, costs: Costs | None, news: Sequence[News]) -> Iterator[Answer]:
    """Yield what the front page opens with. costs: those of the scene that it shows. news: the changes of engines."""
    if costs is not None:
        yield Answer("Accurate at low cost", cheapest(costs))
        if (sentence := defaults(costs)) is not None:
            yield Answer("Defaults", sentence)
    yield Answer("Changes", changed(catalogue, news))
    if (bodies := contact(catalogue)) is not None:
        yield Answer("Contact", bodies)
    yield Answer("Scenes", scenes(catalogue))


def cheapest(costs: Costs) -> Sentence:
    """Return which method of all engines is the cheapest accurate one in a scene, or which is the most accurate one.

    Engines whose costs come from few time steps may have a cheaper method, which the sentence says.
    """
    where = Piece(costs.scene.name, links.scene(costs.scene.name))
    unit = costs.scene.quantity.unit
    runs = [run for one in costs.standings for run in one.runs]
    if (chosen := costs.cheapest) is None:
        best = min(runs, key=lambda run: run.error)
        return (
            Piece(f"No method stays within {number(ENOUGH)} {unit} in "),
            *(where, Piece(f". {_engine(best)} is closest, with "), _error(best, unit), Piece(f"; it takes {_time(best)}.")),
        )
    once = sum(not one.repeated for one in costs.standings)
    few = f" {count(once, 'of the engines was', 'of the engines were')} measured at one or two time steps only." if once else ""
    return (
        Piece(f"Of {len(runs)} methods of {count(len(costs.standings), 'engine')} in "),
        *(where, Piece(", "), Piece(chosen.run.engine, links.engine(chosen.run.engine))),
        Piece(f" with {method(chosen.run)} is the cheapest that stays within {number(ENOUGH)} {unit}. It is off by "),
        _error(chosen, unit),
        Piece(f" and takes {_time(chosen)} of computing for a second of motion.{few}"),
    )


def defaults(costs: Costs) -> Sentence | None:
    """Return how far defaults are off in a scene, and which engines have a better method; None if no default is known."""
    known = [one for one in costs.standings if one.default]
    if not known:
        return None
    unit = costs.scene.quantity.unit
    far, repairable = costs.far, costs.repairable
    if not far:
        return (Piece(f"Those of all {count(len(known), 'engine')} stay within {number(ENOUGH)} {unit} there."),)
    first = far[0]
    pieces = [
        Piece(f"{len(far)} of {count(len(known), 'default')} {'is' if len(far) == 1 else 'are'} off by more than "),
        Piece(f"{number(ENOUGH)} {unit} there, {first.engine}’s {method(first.usual.run)} by "),
        _error(first.usual, unit),
    ]
    if repairable:
        gain = max(repairable, key=lambda one: one.gain)
        named = listing([one.engine for one in repairable], MOST_NAMED, "engine")
        has = "has another method" if len(repairable) == 1 else "have other methods"
        stays = "stays" if len(repairable) == 1 else "stay"
        pieces += [
            Piece(f". {named} {has} that {stays} within it at the same cost or less: "),
            Piece(f"{gain.engine} with {method(gain.best.run)} is off by "),
            _error(gain.best, unit),
            Piece(f", where {method(gain.usual.run)} is off by "),
            _error(gain.usual, unit),
        ]
    return (*pieces, Piece("."))


def changed(catalogue: Catalogue, news: Sequence[News]) -> Sentence:
    """Return which engines changed, each with a comparison."""
    followed = [name for name in catalogue.engines if len(catalogue.versions[name]) > 1]
    if not news:
        if not followed:
            return (Piece("There are results of one version of each engine, and so nothing to compare yet."),)
        named = listing(followed, MOST_NAMED, "engine")
        return (Piece(f"Nothing beyond rounding, from the versions of {named} that were measured before to the newest."),)
    pieces: list[Piece] = []
    for one in news[:MOST_NAMED]:
        parts = [f"{one.worse} worse" if one.worse else "", f"{one.better} better" if one.better else ""]
        parts.append(f"{one.other} in other methods than the default" if one.other else "")
        scenes = one.worse + one.better + one.other
        pieces += [
            Piece("; " if pieces else ""),
            Piece(f"{one.engine} {one.version}", links.release(one.engine, one.version)),
            Piece(f" differs from {one.since} in {count(scenes, 'scene')} ({', '.join(part for part in parts if part)}): "),
            Piece("run by run", one.comparison),
        ]
    more = len(news) - MOST_NAMED
    return (*pieces, Piece(f"; and {count(more, 'more engine')}." if more > 0 else "."))


def contact(catalogue: Catalogue) -> Sentence | None:
    """Return which engines have a contact sheet, and how far each is off at its defaults; None if there is no sheet."""
    sheets = [rows for engine in catalogue.engines if (rows := newest(catalogue, "contact.csv", engine))]
    if not sheets:
        return None
    errors = [
        [row for row in rows if row.get("figure") == "position_error" and row.row["value"] is not None] for rows in sheets
    ]
    worst = [max(rows, key=lambda row: (_usual(row), row.row["value"])) for rows in errors if rows]
    worst.sort(key=lambda row: row.row["value"])
    pieces = [
        Piece("How bodies rest, roll, bounce and tip", links.CONTACT),
        Piece(f" in {count(len(sheets), 'engine')}, at defaults and with the best settings"),
    ]
    for index, row in enumerate(worst[:MOST_NAMED]):
        joint = " and " if index == min(len(worst), MOST_NAMED) - 1 else ", "
        scene, setting = row.row["scene"], "defaults" if _usual(row) else f"{row.row['setting']} settings"
        pieces += [
            Piece(joint if index else ". Positions are off by at most "),
            Piece(f"{number(row.row['value'], 2)} m", links.row(row)),
            Piece(f" with {row.engine}’s {setting}, in "),
            Piece(scene, links.scene(scene) if scene in catalogue.scenes else ""),
        ]
    return (*pieces, Piece("."))


def _usual(row: Entry) -> bool:
    """Return whether a row of contact.csv has the setting of the defaults, which counts if an engine has any."""
    return bool(row.row["setting"] == "defaults")


def scenes(catalogue: Catalogue) -> Sentence:
    """Return how many scenes there are."""
    amount = count(len(catalogue.scenes), "scene")
    return (Piece(amount, links.SCENES), Piece(", each with pictures of its motion, its case file and all engines."))


def _engine(run: Priced) -> str:
    return f"{run.run.engine} with {method(run.run)}"


def _error(run: Priced, unit: str) -> Piece:
    return Piece(f"{number(run.error, 2)} {unit}", links.row(run.run))


def _time(run: Priced) -> str:
    return milliseconds(run.cost, 2)
