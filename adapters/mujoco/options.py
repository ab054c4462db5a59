"""MuJoCo's own options, which apply if a model has no element `option`, and the methods that its documentation names."""

import mujoco

from bodycheck.adapters.contract import KINDS, Kind, Role, Usage

#: The address of the documentation.
DOCUMENTATION = "https://mujoco.readthedocs.io/en/stable"


def available() -> tuple[str, ...]:
    """Return the integrators of the installed release, as its XML spells them, in the order of its enumeration."""
    spelling = {"EULER": "Euler", "RK4": "RK4"}
    members = (name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__)
    return tuple(spelling.get(name, name.lower()) for name in members)


def defaults() -> dict[str, str]:
    """Return MuJoCo's defaults, which apply if a model has no element `option`."""
    option = mujoco.MjOption()
    return {
        "integrator": available()[option.integrator],
        "timestep": f"{option.timestep:g} s",
        "tolerance": f"{option.tolerance:g} of the constraint solver",
    }


def roles() -> dict[Role, dict[Kind, Usage]]:
    """Return the method of MuJoCo's own options, and the one with the integrator that its documentation recommends."""
    option = mujoco.MjOption()
    usual = Usage(available()[option.integrator], option.timestep, f"{DOCUMENTATION}/XMLreference.html#option", True)
    advised = Usage("implicitfast", option.timestep, f"{DOCUMENTATION}/computation/index.html#geintegration", True)
    return {"default": dict.fromkeys(KINDS, usual), "recommended": dict.fromkeys(KINDS, advised)}
