"""The truth of a scene: its reference trajectory together with a bound of the trajectory's own error.

The truth is computed from the smallest model that is exact. In free flight this is a closed form, with translation and rotation
solved independently. A flight has witnesses, some of which are computed from the case file by separate code; see `witnesses`.
Drag on the translation leads to quadratures, whose witness is an integration in three coordinates. A body that lies flat on a
plane has three coordinates; see `sliding`.
"""

from dataclasses import replace

from bodycheck.reference.bounds import Bounds
from bodycheck.reference.errors import NotModelled, WouldTip, within_range
from bodycheck.reference.flight import closed_form
from bodycheck.reference.flight.drag.translation import translation
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.modelled import missing_model
from bodycheck.reference.requirements import requirements, touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding.motion import Slide, slide
from bodycheck.reference.sliding.ways import BALANCE_WITNESS
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import CLOSED_FORM_BACKEND, INTEGRATION_BACKEND, Computed, Truth
from bodycheck.reference.witness import conserved_errors, excess
from bodycheck.reference.witnesses import Backend, backend, witnesses


def truth(scene: AnyScene, times: Array, solver: Backend | None = None, *, vouched: bool = True) -> Truth:
    """The truth of a scene.

    In free flight, the bounds are those of the closed form, plus, for each witness, the largest disagreement so far beyond the
    bounds of both. Without witnesses, they are the bounds of the closed form.

    Parameters
    ----------
    scene
        The scene.
    times
        (n,) ascending times >= 0 (s).
    solver
        Solver of the witnesses of a body that rotates in free flight; by default `witnesses.backend`.
    vouched
        Whether a flight is compared with its witnesses. Otherwise its bounds are those of its closed form alone.

    Returns
    -------
    Truth
        The trajectory at these times, with the bound of its error.

    Raises
    ------
    NotModelled
        If the reference has no model of the scene.
    OutOfReach
        If the motion cannot be computed, or takes too many integration steps.
    ValueError
        If the scene has a balanced pressure under the decoupled law of friction, or numbers that are not finite.
    """
    return computed(scene, times, solver, vouched=vouched).truth


def at(computed_truth: Truth, times: Array) -> Truth:
    """The truth of the scene of a known truth at ascending times (n,) >= 0, s.

    If the known truth has all of these times, the result is a part of it. Otherwise the truth is computed, which raises as
    `truth` does.
    """
    try:
        return computed_truth.at(times)
    except ValueError:  # it does not have all of them
        return truth(computed_truth.scene, times)


def computed(scene: AnyScene, times: Array, solver: Backend | None = None, *, vouched: bool = True) -> Computed:
    """The truth of a scene with the bounds and witnesses behind its bounds; arguments and exceptions as of `truth`."""
    if (missing := missing_model(scene)) is not None:
        raise NotModelled(missing)
    if touches(scene):
        from bodycheck.reference.contact.truth import computed_contact  # imported where it is needed

        with within_range("the motion"):
            return computed_contact(scene, times, vouched=vouched)
    if isinstance(scene, Mechanism):
        from bodycheck.reference.mechanisms.truth import computed_mechanism  # imported where it is needed

        return computed_mechanism(scene, times, vouched=vouched)
    with within_range("the motion"):
        if scene.plane is None:
            return _flown(scene, times, solver, vouched)
        slid = on_plane(scene, times)
        return Computed(slid, slid.bounds, ())


def _flown(scene: Scene, times: Array, solver: Backend | None, vouched: bool) -> Computed:
    """The truth of a body in free flight."""
    flown = closed_form.flight(scene, times)
    others = tuple(witnesses(scene, times, solver or backend())) if vouched else ()
    bounds = flown.bounds
    for witness in others:
        bounds = bounds.plus(excess(scene, flown.motion, flown.bounds, witness))
    names = tuple(witness.name for witness in others)
    model = f"closed form: {flown.form.name}"
    flight = Truth(scene, flown.motion, bounds, model, flown.form.reason, CLOSED_FORM_BACKEND, names)
    return Computed(with_drag(scene, flight) if requirements(scene).drag else flight, flown.bounds, others)


def on_plane(scene: Scene, times: Array) -> Truth:
    """The truth of a body that lies flat on a plane, at ascending times (n,) >= 0, s; raises as `truth` does."""
    try:
        solution = slide(scene, times)
    except WouldTip as error:
        raise NotModelled(f"a body that would tip: {error}") from error
    closed = solution.model.startswith("closed form")
    return Truth(
        scene,
        solution.trajectory,
        _slide_bounds(scene, solution),
        solution.model,
        solution.reason,
        CLOSED_FORM_BACKEND if closed else INTEGRATION_BACKEND,
        (BALANCE_WITNESS,),
        solution.stop,
    )


def with_drag(scene: Scene, flight: Truth) -> Truth:
    """The truth of a flight with drag, from the truth of the same flight without drag.

    Drag acts at the centre of mass and does not change the rotation.
    """
    motion = flight.trajectory
    moved = translation(scene, motion.t)
    slowed = replace(motion, position=moved.position, velocity=moved.velocity)
    errors = {
        "error": flight.bounds.error,
        "position_error": moved.position_error,
        "velocity_error": moved.velocity_error,
        "angular_velocity_error": flight.bounds.angular_velocity_error,
    }
    return replace(
        flight,
        trajectory=slowed,
        bounds=Bounds(**errors, **conserved_errors(scene, slowed, **errors)),
        model=f"{flight.model}, drag by quadratures",
        witnesses=(*flight.witnesses, *moved.witnesses),
    )


def _slide_bounds(scene: Scene, slide: Slide) -> Bounds:
    """The bounds of the errors of a slide."""
    motion = slide.trajectory
    errors = {
        "error": slide.error,
        "position_error": slide.position_error,
        "velocity_error": slide.velocity_error,
        "angular_velocity_error": slide.angular_velocity_error,
    }
    return Bounds(**errors, **conserved_errors(scene, motion, **errors))
