"""A report says which methods are the same algorithm, kind by kind, and does not repeat itself."""

from bodycheck.adapters.method import KINDS
from bodycheck.judging.schemes.classes import MethodClass
from bodycheck.reports.same_algorithm import MOST_CLASSES, WORDS, memberships, same_algorithm
from bodycheck.results.key import RunKey


def members(*names: str, distance: float = 0.0) -> MethodClass:
    return MethodClass(tuple(RunKey.of_method(*name.split()) for name in names), distance)


def text(**classes: tuple[MethodClass, ...]) -> str:
    found = same_algorithm(classes)  # type: ignore[arg-type]  # the names are kinds of scenes
    return found.text if found is not None else ""


def test_classes_are_told_with_their_distance_the_largest_first() -> None:
    two, three = members("mujoco a", "dart b", distance=2e-15), members("mjx c", "drake d", "brax e", distance=1.04e-13)
    assert text(flight=(two, members("newton f"), three)) == (
        "In flight, mjx c, drake d and brax e are one algorithm: their motions agree to rounding (2e-13); "
        "so are mujoco a and dart b (2e-15)."
    )


def test_kinds_with_the_same_classes_are_told_together() -> None:
    near, far = members("mujoco a", "dart b", distance=1e-15), members("mujoco a", "dart b", distance=3e-15)
    other = members("mujoco a", "dart c")
    assert text(flight=(near,), drag=(far,), plane=(other,)) == (
        "In flight and against drag, mujoco a and dart b are one algorithm: their motions agree to rounding (3e-15). "
        "On a plane, mujoco a and dart c are one algorithm: their motions agree to rounding (0)."
    )


def test_every_kind_of_scene_has_words() -> None:
    assert set(WORDS) == KINDS


def test_methods_that_stand_alone_are_no_finding() -> None:
    alone = members("mujoco a"), members("dart b")
    assert text(flight=alone) == text() == ""
    apart = memberships({"flight": alone})
    assert not apart[alone[0].methods[0]] & apart[alone[1].methods[0]]


def test_a_sentence_names_few_classes() -> None:
    many = tuple(members(f"mujoco a{place}", f"dart b{place}") for place in range(MOST_CLASSES + 2))
    assert text(flight=many).endswith("; and so are those of 2 more classes.")
    one, other = (memberships({"flight": many})[method] for method in many[-1].methods)
    assert one & other
