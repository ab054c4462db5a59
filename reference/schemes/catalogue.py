"""The schemes that an engine's run is compared with, by the names that results show."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from bodycheck.reference.schemes.coordinates import (
    angles_and_world_rates,
    quaternion_and_body_rates,
    quaternion_and_world_rates,
)
from bodycheck.reference.schemes.formulations import Equations, averaged, body_twist, world_velocity
from bodycheck.reference.schemes.one_step import (
    Scheme,
    explicit_euler,
    implicit_midpoint,
    momentum_euler,
    of_sine,
    of_turn,
    rosenbrock_euler,
    semi_implicit_euler,
    substeps,
    torque_free_euler,
    velocity_verlet,
)
from bodycheck.reference.schemes.runge_kutta import (
    BOGACKI_SHAMPINE_3,
    BUTCHER_6,
    DORMAND_PRINCE_5,
    FEHLBERG_4,
    HEUN_2,
    HEUN_3,
    IMPLICIT_EULER,
    KUTTA_3,
    KUTTA_4,
    MERSON_4,
    MIDPOINT_2,
    RADAU_IIA_3,
    TRAPEZOIDAL,
    explicit,
    implicit,
)

#: Name of the classical Runge-Kutta scheme in the form of Munthe-Kaas for Lie groups.
MUNTHE_KAAS = "Runge-Kutta-Munthe-Kaas 4"

#: Suffix of the name of a scheme that integrates the body twist.
ON_TWIST = " on the body twist"

#: Numbers of substeps that engines take by default or are set to take.
SUBSTEPS = (2, 3, 4, 5, 8, 10)


@dataclass(frozen=True)
class Entry:
    """A scheme with the equations of motion that it integrates.

    Attributes
    ----------
    scheme
        The scheme.
    formulations
        The formulations that give the same rotation, by the suffix of the scheme's name; the suffix of the first is empty.
    order
        The order of the attitude of a tumbling body; 0 if it does not converge to the motion of the body.
    """

    scheme: Scheme
    formulations: Mapping[str, Equations]
    order: int

    @property
    def rotation(self) -> Equations:
        """The first formulation; the others give the same rotation."""
        return self.formulations[""]


#: Formulations by the suffixes of the names of their schemes, for each representation of the attitude.
EXPONENTIAL: Mapping[str, Equations] = {"": world_velocity, ON_TWIST: body_twist}
APART: Mapping[str, Equations] = {"": world_velocity}
AVERAGED: Mapping[str, Equations] = {"": averaged(world_velocity), ON_TWIST: averaged(body_twist)}
QUATERNION: Mapping[str, Equations] = {"": quaternion_and_body_rates}
QUATERNION_AND_WORLD_RATES: Mapping[str, Equations] = {"": quaternion_and_world_rates}
ANGLES: Mapping[str, Equations] = {"": angles_and_world_rates}

#: Explicit Runge-Kutta schemes by their textbook names.
EXPLICIT = {
    "explicit midpoint": MIDPOINT_2,
    "Heun 2": HEUN_2,
    "Kutta 3": KUTTA_3,
    "Heun 3": HEUN_3,
    "Bogacki-Shampine 3": BOGACKI_SHAMPINE_3,
    "Runge-Kutta 4": KUTTA_4,
    "Merson 4": MERSON_4,
    "Fehlberg 4": FEHLBERG_4,
    "Dormand-Prince 5": DORMAND_PRINCE_5,
    "Butcher 6": BUTCHER_6,
}

#: Implicit schemes by their textbook names.
IMPLICIT = {"implicit Euler": IMPLICIT_EULER, "trapezoidal rule": TRAPEZOIDAL, "Radau IIA 3": RADAU_IIA_3}

#: Schemes of order 1 that change the velocity before the pose.
EULER = {
    "semi-implicit Euler": semi_implicit_euler,
    "linearly implicit Euler": rosenbrock_euler,
    "semi-implicit Euler of the momentum": momentum_euler,
}

#: Suffixes of the names of schemes with coordinates of the attitude.
LINEAR, ON_BODY = " with linear quaternions", " of quaternion and body rates"
ON_WORLD, ON_ANGLES = " of quaternion and world rates", " of angles and world rates"


def _of_order_one() -> dict[str, Entry]:
    """Schemes of order 1 that are no Runge-Kutta schemes, and schemes without a gyroscopic torque."""
    entries = {"explicit Euler": Entry(explicit_euler, EXPONENTIAL, 1)}
    for name, scheme in EULER.items():
        entries[name] = Entry(scheme, APART if scheme is momentum_euler else EXPONENTIAL, 1)
        entries[name + LINEAR] = Entry(scheme, QUATERNION, 1)
    turned = "semi-implicit Euler with linear quaternions and rates "
    return entries | {
        "semi-implicit Euler" + ON_ANGLES: Entry(semi_implicit_euler, ANGLES, 1),
        "explicit Euler" + ON_WORLD: Entry(explicit_euler, QUATERNION_AND_WORLD_RATES, 1),
        "explicit Euler" + ON_BODY: Entry(explicit_euler, QUATERNION, 1),
        "explicit Euler" + ON_ANGLES: Entry(explicit_euler, ANGLES, 1),
        turned + "of the turn": Entry(of_turn(semi_implicit_euler), QUATERNION, 1),
        turned + "of its sine": Entry(of_sine(semi_implicit_euler), QUATERNION, 1),
        "no gyroscopic torque": Entry(torque_free_euler, APART, 0),
        "no gyroscopic torque" + LINEAR: Entry(torque_free_euler, QUATERNION, 0),
        "no gyroscopic torque" + LINEAR + " and rates of the turn": Entry(of_turn(torque_free_euler), QUATERNION, 0),
        "no gyroscopic torque" + LINEAR + " and rates of its sine": Entry(of_sine(torque_free_euler), QUATERNION, 0),
    }


def _runge_kutta() -> dict[str, Entry]:
    entries: dict[str, Entry] = {}
    for name, tableau in EXPLICIT.items():
        scheme = explicit(tableau)
        entries[MUNTHE_KAAS if tableau is KUTTA_4 else f"Munthe-Kaas with {name}"] = Entry(scheme, EXPONENTIAL, tableau.order)
        entries[name + ON_WORLD] = Entry(scheme, QUATERNION_AND_WORLD_RATES, tableau.order)
        entries[name + ON_BODY] = Entry(scheme, QUATERNION, tableau.order)
        entries[name + ON_ANGLES] = Entry(scheme, ANGLES, tableau.order)
        if tableau in (MIDPOINT_2, HEUN_2, KUTTA_4):
            entries[f"averaged {name}"] = Entry(scheme, AVERAGED, 2)
    for name, tableau in IMPLICIT.items():
        entries[name] = Entry(implicit(tableau), EXPONENTIAL, tableau.order)
        entries[name + ON_WORLD] = Entry(implicit(tableau), QUATERNION_AND_WORLD_RATES, tableau.order)
    return entries | {
        "implicit midpoint": Entry(implicit_midpoint, EXPONENTIAL, 2),
        "averaged trapezoidal rule": Entry(implicit(TRAPEZOIDAL), AVERAGED, 2),
        "velocity Verlet" + ON_WORLD: Entry(velocity_verlet, QUATERNION_AND_WORLD_RATES, 2),
    }


def _with_substeps(schemes: Mapping[str, Entry]) -> dict[str, Entry]:
    """Schemes that take several substeps in each step, made of the schemes of order 1 that engines use in substeps."""
    divided = [name + how for name in EULER for how in ("", LINEAR)]
    entries = {
        f"{count} substeps of {name}": replace(schemes[name], scheme=substeps(count, schemes[name].scheme))
        for name in divided
        for count in SUBSTEPS
    }
    for name in ("semi-implicit Euler" + ON_ANGLES, "implicit Euler" + ON_WORLD):
        entries[f"2 substeps of {name}"] = replace(schemes[name], scheme=substeps(2, schemes[name].scheme))
    return entries


_SINGLE = _of_order_one() | _runge_kutta()

#: All schemes by the names that results show.
CATALOGUE: dict[str, Entry] = _SINGLE | _with_substeps(_SINGLE)
