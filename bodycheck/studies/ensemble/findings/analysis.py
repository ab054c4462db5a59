"""The analysis of an ensemble's runs: counts, distributions, dependences, and maps over the strongest numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reports.quantities import PLOTTED
from bodycheck.studies.ensemble.findings import maps
from bodycheck.studies.ensemble.findings.aggregates import Aggregates, aggregate
from bodycheck.studies.ensemble.findings.maps import Map
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, Dependence, dependences, numbers, strongest
from bodycheck.studies.ensemble.findings.stored import Ensemble
from bodycheck.studies.ensemble.rows import DependenceRow

#: The most methods of which maps are drawn.
MOST_MAPS = 6


@dataclass(frozen=True, eq=False)
class Analysis:
    """The analysis of an ensemble's runs.

    Attributes
    ----------
    aggregates
        Counts and distributions.
    dependences
        The dependences of figures on the drawn numbers.
    maps
        Maps of failures and of the figure that methods are ranked by.
    """

    aggregates: Aggregates
    dependences: tuple[Dependence, ...]
    maps: tuple[Map, ...]

    def dependence_rows(self) -> list[DependenceRow]:
        """Return the rows of sensitivity.csv: method by method, and figure by figure."""
        methods = [method.engine_method for method in self.aggregates.methods]
        return [
            DependenceRow(
                case=self.aggregates.case,
                engine=methods[one.method].engine,
                version=methods[one.method].version,
                integrator=methods[one.method].integrator,
                timestep=methods[one.method].timestep,
                figure=one.figure,
                number=one.number,
                rank_correlation=one.rank_correlation,
                share=one.share,
            )
            for one in sorted(self.dependences, key=lambda one: one.method)
        ]


def analyse(ensemble: Ensemble) -> Analysis:
    """Return the analysis of an ensemble's runs. One column of the runs is in memory at a time."""
    aggregates = aggregate(ensemble)
    drawn = tuple(name for name in PLOTTED if name in aggregates.figures and aggregates.figures[name].edges.size)
    figure_dependences = tuple(dependences(ensemble, numbers(ensemble), drawn))
    return Analysis(aggregates, figure_dependences, _maps(ensemble, aggregates, figure_dependences))


def _maps(ensemble: Ensemble, aggregates: Aggregates, figure_dependences: Sequence[Dependence]) -> tuple[Map, ...]:
    """Return the map of failures, if there are any, and the map of the figure that methods are ranked by."""
    worst_first = aggregates.ranked[::-1]
    failing = [index for index in worst_first if aggregates.methods[index].ways]
    figure = aggregates.figures.get(aggregates.ranking)
    having = [index for index in worst_first if figure is not None and index in figure.distributions and figure.edges.size]
    by_figure = _two([one for one in figure_dependences if one.figure == aggregates.ranking])
    by_failure = _two([one for one in figure_dependences if one.figure == FAILURE]) or by_figure
    drawn = []
    if failing and by_failure is not None:
        drawn.append(maps.made(ensemble, FAILURE, by_failure, failing[:MOST_MAPS]))
    if having and by_figure is not None:
        drawn.append(maps.made(ensemble, aggregates.ranking, by_figure, having[:MOST_MAPS]))
    return tuple(drawn)


def _two(figure_dependences: Sequence[Dependence]) -> tuple[str, str] | None:
    """Return the two numbers with the strongest dependences; None if there are fewer."""
    names = strongest(figure_dependences)
    return (names[0], names[1]) if len(names) == 2 else None
