"""Print the recommendation of the study to the terminal."""

from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import attribute, show
from bodycheck.studies.recommend import wording
from bodycheck.studies.recommend.rows import Recommendation

#: The columns of the table of methods that keep the limit.
ANSWERS = (
    attribute("engine"),
    attribute("version", asked=True),
    attribute("integrator"),
    attribute("timestep", "step s", ""),
    attribute("error"),
    attribute("margin", goes=1),
    attribute("worst", asked=True),
    attribute("monotone", "monotone", "", asked=True),
    attribute("cost", "cost s/s"),
    attribute("cost_low", "least s/s", asked=True),
    attribute("cost_high", "most s/s", asked=True),
    attribute("broken", "breaks at s", goes=3),
    attribute("steps", "runs", "d", goes=2),
)


def print_recommendation(recommendation: Recommendation, view: View) -> None:
    """Print sentences about the answer, its margin, the second method and methods that never keep the limit, then a table."""
    for sentence in (
        wording.headline(recommendation),
        wording.margin(recommendation),
        *wording.jumps(recommendation),
        wording.second(recommendation),
        *wording.never(recommendation),
    ):
        if sentence:
            tell(sentence)
    if recommendation.reached:
        say("")
        show(ANSWERS, recommendation.reached, view)
