"""The kinds of scenes in a report, each with the quantity that shows discrepancies best."""

from dataclasses import dataclass

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import needs, touches, turns
from bodycheck.reports.quantities import QUANTITIES, Quantity


@dataclass(frozen=True)
class Kind:
    """A kind of scene.

    Parameters
    ----------
    name
        Name of the anchor.
    title
        Name for readers.
    quantity
        The column of results that the matrix shows.
    why
        The reason for this choice, in a sentence or two for readers.
    """

    name: str
    title: str
    quantity: str
    why: str

    @property
    def figure(self) -> Quantity:
        """The quantity of the column."""
        return QUANTITIES[self.quantity]


#: The names of the kinds of scenes with contact, and of mechanisms in which nothing turns.
CONTACT, SLIDING = "contact", "sliding"

KINDS = (
    Kind(
        "turning",
        "Free flight of a turning body",
        "attitude_error",
        "No torque acts. The attitude error shows how well the rotation is solved.",
    ),
    Kind("translation", "Flight without rotation", "position_error", "Nothing rotates. The position error shows everything."),
    Kind("drag", "Flight against drag", "position_error", "Drag acts on the centre of mass and does not affect the rotation."),
    Kind(
        CONTACT,
        "Contact",
        "position_error",
        "Contacts determine where bodies go, which the position error shows.",
    ),
    Kind(
        "mechanism",
        "Bodies on joints",
        "attitude_error",
        "The attitude error is that of the body that is turned most against where it should be.",
    ),
    Kind(
        SLIDING,
        "Bodies on slides",
        "position_error",
        "Nothing turns. The position error is that of the body that is farthest from where it should be.",
    ),
)


def kind_of(scene: AnyScene) -> Kind:
    """Return the kind of a scene: from its requirements; for a mechanism from whether bodies touch, and whether any turns."""
    name: str = needs(scene).kind
    if isinstance(scene, Mechanism):
        name = CONTACT if touches(scene) else name if turns(scene) else SLIDING
    return next(kind for kind in KINDS if kind.name == name)
