"""Free bodies of tensors, moments, particles and parts: what is accepted is the inertia of a body."""

import json
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bodycheck import Case, CaseFaults
from bodycheck.casefile.case import parse
from bodycheck.reference.exact.start import start
from bodycheck.reference.inertia import TRIANGLE_TOLERANCE, satisfies_triangle_inequality

#: Numbers of all sizes, and those near one another that leave nothing but rounding when they are subtracted.
SIZES = st.one_of(
    st.floats(1e-3, 1e3),
    st.sampled_from([1.0, 1.0 + 2**-52, 1.0 - 2**-53, 2.0, 2.0 + 2**-51, 1e-17, 1e-8, 1e-100, 1e100, 3e7]),
)
SIGNED = st.builds(lambda size, sign: size * sign, SIZES, st.sampled_from([-1.0, 0.0, 1.0]))
POINTS = st.tuples(SIGNED, SIGNED, SIGNED)


def tensor(diagonal: tuple[float, ...], off: tuple[float, ...]) -> dict[str, Any]:
    (a, b, c), (d, e, f) = diagonal, off
    return {"mass": 1.0, "inertia": [[a, d, e], [d, b, f], [e, f, c]]}


def rank_one(v: tuple[float, float, float], w: float) -> dict[str, Any]:
    """The tensor of a point mass, which has a moment of zero, with an error of w on its diagonal."""
    x, y, z = v
    diagonal = (y * y + z * z + w, x * x + z * z + w, x * x + y * y + w)
    return tensor(diagonal, (-x * y, -x * z, -y * z))


BODIES = st.one_of(
    st.builds(tensor, st.tuples(SIZES, SIZES, SIZES), POINTS),
    st.builds(tensor, st.tuples(SIZES, SIZES, SIZES), st.tuples(*3 * [SIGNED.map(lambda x: 1e-9 * x)])),
    st.builds(rank_one, st.tuples(*3 * [st.floats(0.1, 10)]), SIGNED.map(lambda x: 1e-16 * x)),
    st.tuples(SIZES, SIZES, SIZES).map(lambda moments: {"mass": 1.0, "inertia": list(moments)}),
    st.lists(st.tuples(SIZES, POINTS), min_size=1, max_size=4).map(
        lambda those: {"particles": [{"mass": m, "position": list(p)} for m, p in those]}
    ),
    st.lists(st.tuples(SIZES, POINTS, st.tuples(SIZES, SIZES, SIZES)), min_size=1, max_size=3).map(
        lambda those: {"parts": [{"shape": "brick", "mass": m, "position": list(p), "semi_axes": list(s)} for m, p, s in those]}
    ),
)


def test_products_of_inertia_with_the_other_sign_are_told() -> None:
    """Of a dumbbell along a diagonal with a little thickness; a CAD program may give the products as sums of m x y."""
    points = [(1.0, 0.9, 0.8), (-1.0, -0.9, -0.8), (0.1, -0.2, 0.0), (-0.1, 0.2, 0.0)]
    diagonal = tuple(sum(x * x for point in points for place, x in enumerate(point) if place != axis) for axis in range(3))
    products = tuple(-sum(point[one] * point[other] for point in points) for one, other in ((0, 1), (0, 2), (1, 2)))
    right, wrong = tensor(diagonal, products), tensor(diagonal, tuple(-product for product in products))
    a_free(right)
    with pytest.raises(CaseFaults, match="with the opposite signs of Ixy, Ixz and Iyz it would be possible") as caught:
        a_free(wrong)
    assert [fault.key for fault in caught.value.faults] == ["body.inertia"]
    with pytest.raises(CaseFaults) as caught:
        a_free(tensor((1.0, 1.0, 5.0), (0.1, 0.1, 0.1)))
    assert "opposite" not in str(caught.value), "no body has this with any signs"


def inline(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(own)}" for key, own in value.items()) + "}"
    return f"[{', '.join(map(inline, value))}]" if isinstance(value, list) else json.dumps(value)


def a_free(body: dict[str, Any]) -> Case:
    """The case of a free body that rotates."""
    text = "".join(f"{key} = {inline(value)}\n" for key, value in body.items())
    return parse(
        f'format = 1\nname = "free"\ntitle = "free"\n[body]\nshape = "none"\n{text}[initial]\n'
        "angular_velocity = [1.0, 2.0, 3.0]\n[run]\nduration = 1.0\nsamples = 3\n",
        "free",
    )


@settings(max_examples=400, deadline=None)
@given(BODIES)
@example(tensor((1.0, 1.0, 2.0), (1.0, 0.0, 0.0)))
@example(tensor((1.0, 1.0, 2.0), (1.0 - 2**-53, 0.0, 0.0)))
@example(rank_one((1.0, 1.0, 1.0), 0.0))
@example({"particles": [{"mass": 1.0, "position": [x, x / 3, x / 7]} for x in (1.0, 2.0, 4.0)]})
def test_the_moments_of_what_is_accepted_are_those_of_a_body(body: dict[str, Any]) -> None:
    try:
        case = a_free(body)
    except CaseFaults:
        return
    moments = case.scene.body.moments
    assert min(moments) > 0
    assert satisfies_triangle_inequality(moments)
    # The truth uses these moments, with all their digits.
    exact = sorted(Fraction(str(moment)) for moment in start(case.scene).moments)
    assert exact[0] > 0
    assert exact[2] <= (exact[0] + exact[1]) * (1 + 2 * Fraction(TRIANGLE_TOLERANCE))
