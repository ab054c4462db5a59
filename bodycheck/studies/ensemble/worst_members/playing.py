"""Animations of the worst members of an ensemble, for which these few members are run again."""

from collections.abc import Callable, Mapping
from pathlib import Path

from bodycheck.casefile.case import parse
from bodycheck.judging import judgement
from bodycheck.reference.truths import Truth
from bodycheck.reports.quantities import QUANTITIES
from bodycheck.reports.runs.motions.animation import animated
from bodycheck.reports.study import Animation
from bodycheck.results.header import Header
from bodycheck.running import campaign
from bodycheck.running.plan import Task
from bodycheck.studies.ensemble.findings.aggregates import Aggregates
from bodycheck.studies.ensemble.report.page_tables import method_lines

#: Most members that are shown, and most methods that are run with each of them.
MOST_MEMBERS, MOST_METHODS = 4, 4

#: Most characters of the data of one animation.
MOST_CHARACTERS = 200_000


def chosen(ensemble: Aggregates) -> dict[int, list[int]]:
    """Return the members that are shown, each with the indices of the methods that are run with it.

    Each of them has the largest value, with some method, of the figure that ranks methods. The members of the worst methods
    come first. A member is run with this method, and with the best other methods with the same time step.
    """
    figure = ensemble.figures.get(ensemble.ranking)
    if figure is None:
        return {}
    methods_by_member: dict[int, list[int]] = {}
    for index in reversed(ensemble.ranked):
        distribution = figure.distributions.get(index)
        if distribution is None or distribution.worst in methods_by_member or len(methods_by_member) == MOST_MEMBERS:
            continue
        sampling = ensemble.methods[index].engine_method.key("").method.sampling
        others = [
            other
            for other in ensemble.ranked
            if other != index and ensemble.methods[other].engine_method.key("").method.sampling == sampling
        ]
        methods_by_member[distribution.worst] = [index, *others[: MOST_METHODS - 1]]
    return methods_by_member


def animations(
    ensemble: Aggregates,
    text_of: Callable[[int], str],
    folder: Path,
    header: Header,
    jobs: int = 1,
) -> tuple[Animation, ...]:
    """Return the animations of the worst members.

    Parameters
    ----------
    ensemble
        The aggregates.
    text_of
        Function from the number of a member to its case file.
    folder
        An empty folder for the runs.
    header
        The header of the results.
    jobs
        The number of processes.
    """
    members, lines = chosen(ensemble), method_lines(ensemble)
    cases = {member: parse(text_of(member), f"member {member}") for member in members}
    keys = {index: ensemble.methods[index].engine_method.key("") for places in members.values() for index in places}
    tasks = [
        Task(cases[member], keys[index].engine, keys[index].method) for member, places in members.items() for index in places
    ]
    if not tasks:
        return ()
    with campaign.results(tasks, folder, header, jobs) as results:
        verdicts = judgement.judge(results)
        truths: dict[int, Mapping[float, Truth]] = {}
        for member, places in members.items():
            sampling = keys[places[0]].method.sampling
            truth = results.truth(cases[member].name, sampling)
            truths[member] = {sampling: truth} if isinstance(truth, Truth) else {}
    title = QUANTITIES[ensemble.ranking].title.lower()
    shown = []
    for member, places in members.items():
        by_line = {
            lines[index]: verdict
            for index in places
            for verdict in verdicts
            if (verdict.run.case, verdict.run.engine, verdict.run.method)
            == (cases[member].name, keys[index].engine, keys[index].method)
        }
        played = animated(cases[member].scene, by_line, truths[member], MOST_CHARACTERS)
        if played is not None:
            heading = f"Member {member}, with the largest {title} of {lines[places[0]].label}"
            shown.append(Animation(heading, played.data, played.alt, played.notes))
    return tuple(shown)
