"""Put drawn numbers into the document of a case file: for all members of an ensemble as arrays, or for one as a document."""

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.contradictions import uncheckable
from bodycheck.casefile.distributions import rivals
from bodycheck.casefile.key_paths import ARRAYS, ATTITUDE, base, find, keys, present, value_at
from bodycheck.casefile.mechanisms.model import standalone
from bodycheck.casefile.raw_values import mapping
from bodycheck.casefile.values import MAX_NAME_LENGTH, MAX_TEXT_LENGTH
from bodycheck.figures.columns import LIMITED
from bodycheck.reference.trajectory import Array

#: A quaternion is divided by its length if the length differs from 1 by more than this; a case file allows twice as much.
MAX_DEVIATION = 0.0005

#: Numbers between these limits make no motion that is too large for a case file: energy, moments and their inverses stay below
#: 1e120. Moments of inertia that are farther than this ratio from the limits of the triangle inequality are possible for a
#: body.
SMALLEST, LARGEST, SMALLEST_RATIO = 1e-40, 1e20, 1e-14

#: Tables about the whole ensemble, which the case of one member does not have.
NOT_OF_A_MEMBER = ("extremes", "ensemble")

#: The key of half the height, by the shape of a body that can lie on a plane. Of semi-axes, the last is half the height.
HALF_HEIGHTS = {"brick": "body.semi_axes", "cylinder": "body.half_length"}


def wholes(document: Mapping[str, Any], values: Mapping[str, Array]) -> dict[str, Array]:
    """Return drawn values as the values of whole keys: numbers, vectors and tensors.

    Parameters
    ----------
    document
        The document of the case file, without faults.
    values
        Arrays (m,) of numbers and (m, k) of vectors by their key paths, in SI units.

    Returns
    -------
    Arrays (m,), (m, k) or (m, 3, 3) by the paths of keys of the file. Components that are not drawn have the values of the
    file or the defaults; a body on a plane lies on it if the file gives no position. An off-diagonal component of a tensor is
    set at both places. An initial quaternion whose length is not 1 is divided by it, unless it is 0.

    Raises
    ------
    Unknown
        A key path leads to no number or vector that can be drawn.
    """
    document = standalone(document)
    keys_of_document, arrays = keys(document), dict[str, Array]()
    for text in sorted(values, key=lambda text: not text.startswith("body.")):  # the initial height depends on the body
        key, array = find(text, document, keys_of_document), np.asarray(values[text], dtype=float)
        if not key.place:
            arrays[text] = array
            continue
        name_of_whole = key.text_of_whole
        if name_of_whole not in arrays:
            height = (
                _half_height(document, arrays)
                if name_of_whole == "initial.position" and not present(document, key.whole)
                else None
            )
            arrays[name_of_whole] = np.tile(np.asarray(base(document, key), dtype=float), (len(array), *[1] * len(key.shape)))
            if height is not None:
                arrays[name_of_whole][:, 2] = height
        for order in {key.place, key.place[::-1]}:
            component: tuple[slice | int, ...] = (slice(None), *order)
            arrays[name_of_whole][component] = array
    for text in arrays:
        if text == ATTITUDE or (keys_of_document[text].whole[-1] == "quaternion" and keys_of_document[text].whole[0] in ARRAYS):
            arrays[text] = _directions(arrays[text])
    return arrays


def _half_height(document: Mapping[str, Any], drawn_values: Mapping[str, Array]) -> Any:
    """Return the height (m,) or () of the centre of a body on the plane, in m; None without a plane or a flat face."""
    text = HALF_HEIGHTS.get(mapping(document.get("body")).get("shape", ""), "")
    if not text or not present(document, ("scene", "plane")):
        return None
    sizes = drawn_values[text] if text in drawn_values else np.asarray(value_at(document, tuple(text.split("."))), dtype=float)
    return sizes[..., 2] if text == "body.semi_axes" else sizes


def _directions(quaternions: Array) -> Array:
    """Return quaternions (m, 4), each divided by its length unless the length is 0 or close to 1."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    with np.errstate(over="ignore"):  # numbers with infinite squares are too large for a case anyway
        length = np.sqrt(w * w + x * x + y * y + z * z)
    off = (np.abs(length - 1) > MAX_DEVIATION) & (length > 0) & np.isfinite(length)
    return np.asarray(np.where(off[:, None], quaternions / np.where(off, length, 1.0)[:, None], quaternions))


def member_document(document: Mapping[str, Any], whole: Mapping[str, Array], row: int, member: int) -> dict[str, Any]:
    """Return the document of one member as a separate case, without `[ensemble]` and `[extremes]`.

    Limits of expectations that no run of the member can break, because the run is shorter, are left out too.

    Parameters
    ----------
    document
        The document of the case file.
    whole
        The drawn values, as `wholes` returns them.
    row
        The row of the member in them.
    member
        The number of the member, which becomes the end of the name.

    Bodies and joints of a model are written out, so that the member needs no other file.
    """
    document = standalone(document)
    drawn_document = {name: copy.deepcopy(value) for name, value in document.items() if name not in NOT_OF_A_MEMBER}
    name, end = str(document["name"]), f"-{member}"
    drawn_document["name"] = name[: MAX_NAME_LENGTH - len(end)] + end
    drawn_document["title"] = f"Member {member} of {name}: {document['title']}"[:MAX_TEXT_LENGTH]
    keys_of_document = keys(document)
    for text, array in whole.items():
        path = keys_of_document[text].whole
        table: Any = drawn_document
        for part in path[:-1]:
            table = table.setdefault(part, {}) if isinstance(table, dict) else table[part]
        for rival in rivals(path):
            table.pop(rival[-1], None)
        table[path[-1]] = array[row].tolist()
    if "expect" in drawn_document:
        drawn_document["expect"] = _checkable(drawn_document)
    return drawn_document


def _checkable(document: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the expectations of a document without limits that cannot fail, unknown engines, and steps above the duration."""
    expectations, unknown = document["expect"], set()
    for path, _ in list(uncheckable(document)):
        match path:
            case (_, int(index), "engine" | "timestep"):
                unknown.add(index)
            case (_, int(index), str(name), str(end)) if len(expectations[index][name]) > 1:
                del expectations[index][name][end]
            case (_, int(index), str(name), *_):
                del expectations[index][name]
    said = {"status", *LIMITED}
    return [table for index, table in enumerate(expectations) if index not in unknown and said & set(table)]


def outside(whole: Mapping[str, Array], document: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Return which members (m,) may be invalid cases, because a number is extreme or not allowed by its key.

    Single numbers, quaternions and moments of inertia of all other members are valid. The limits here are somewhat stricter
    than those of case files: to decide about a reported member, build it.
    """
    document = standalone(document)
    keys_of_document = keys(document)
    bases = [base(document, key) for text, key in keys_of_document.items() if text not in whole]
    extreme = not all(_moderate(np.asarray(value, dtype=float)).all() for value in bases if value is not None)
    is_outside = np.full(len(next(iter(whole.values()))), extreme)
    for text, array in whole.items():
        numbers = array.reshape(len(array), -1)
        fine = _moderate(numbers)
        if keys_of_document[text].sign != "any":
            fine &= (numbers > 0) | ((numbers == 0) & (keys_of_document[text].sign == "not negative"))
        is_outside |= ~fine.all(axis=1)
    if ATTITUDE in whole:
        is_outside |= (whole[ATTITUDE] == 0).all(axis=1)
    if (inertia := whole.get("body.inertia")) is not None:
        usable = np.where(np.isfinite(inertia), inertia, 0.0)
        moments = np.sort(usable if usable.ndim == 2 else np.linalg.eigvalsh(usable), axis=1)
        least, middle, most = np.moveaxis(moments, -1, 0)
        is_outside |= (least <= SMALLEST_RATIO * most) | (most > (least + middle) * (1 + SMALLEST_RATIO))
    return is_outside


def _moderate(numbers: Array) -> NDArray[np.bool_]:
    """Return which numbers are 0 or of moderate size; False for NaN."""
    size = np.abs(numbers)
    return np.asarray((size <= LARGEST) & ((size >= SMALLEST) | (size == 0)))
