"""A report says which methods are the same algorithm, kind by kind, and does not repeat itself."""

from bodycheck.adapters.method import KINDS
from bodycheck.judging.schemes.classes import MethodClass
from bodycheck.reports.same_algorithm import MOST_CLASSES, WORDS, memberships, same_algorithm
from bodycheck.results.key import RunKey
from tests.support.wording import facts


def members(*names: str, distance: float = 0.0) -> MethodClass:
    return MethodClass(tuple(RunKey.of_method(*name.split()) for name in names), distance)


def text(**classes: tuple[MethodClass, ...]) -> str:
    found = same_algorithm(classes)  # type: ignore[arg-type]  # the names are kinds of scenes
    return found.text if found is not None else ""


def test_classes_are_told_with_their_distance_the_largest_first() -> None:
    two, three = members("mujoco a", "dart b", distance=2e-15), members("mjx c", "drake d", "brax e", distance=1.04e-13)
    names = ("flight", "mjx c", "drake d", "brax e", "mujoco a", "dart b", "newton f")
    told = text(flight=(two, members("newton f"), three))
    assert facts(told, *names) == ["flight", "mjx c", "drake d", "brax e", "2e-13", "mujoco a", "dart b", "2e-15"]


def test_kinds_with_the_same_classes_are_told_together() -> None:
    near, far = members("mujoco a", "dart b", distance=1e-15), members("mujoco a", "dart b", distance=3e-15)
    other = members("mujoco a", "dart c")
    names = ("flight", "drag", "plane", "mujoco a", "dart b", "dart c")
    assert facts(text(flight=(near,), drag=(far,), plane=(other,)), *names) == [
        *("flight", "drag", "mujoco a", "dart b", "3e-15"),
        *("plane", "mujoco a", "dart c", "0"),
    ]


def test_every_kind_of_scene_has_words() -> None:
    assert set(WORDS) == KINDS


def test_methods_that_stand_alone_are_no_finding() -> None:
    alone = members("mujoco a"), members("dart b")
    assert text(flight=alone) == text() == ""
    apart = memberships({"flight": alone})
    assert not apart[alone[0].methods[0]] & apart[alone[1].methods[0]]


def test_a_sentence_names_few_classes() -> None:
    many = tuple(members(f"mujoco a{place}", f"dart b{place}") for place in range(MOST_CLASSES + 2))
    assert facts(text(flight=many), "more classes")[-2:] == ["2", "more classes"]
    one, other = (memberships({"flight": many})[method] for method in many[-1].methods)
    assert one & other
