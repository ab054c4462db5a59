"""The gravity of an MJCF file that is not along -z: the axes of the world can be turned until it is."""

from bodycheck.casefile.robots.mjcf.features import Features
from bodycheck.casefile.robots.mjcf.options import Options
from bodycheck.reference.exact.numbers import MP, Quaternion4, vector
from bodycheck.reference.exact.rotations import IDENTITY, conjugate
from bodycheck.robots.elements import Element
from bodycheck.robots.orientations import from_z


def upright(root: Element, of_file: Options, features: Features) -> Quaternion4:
    """Return the rotation of the world that turns the gravity of a file into -z, and add the rotation to the features."""
    x, y, z = of_file.gravity
    if not (x or y or z > 0):
        return IDENTITY
    listed = " ".join(f"{part:g}" for part in of_file.gravity)
    text = f"are {listed} m/s^2: the world is turned so that gravity points along -z, and no contact is looked for"
    stated = [option for option in root.all("option") if "gravity" in option.attributes]
    features.add((None, False, text, ("gravity", "gravities")), stated[-1])
    return conjugate(from_z(vector((-x, -y, -z))))


def strength(of_file: Options) -> float:
    """Return the gravitational acceleration of a file without its direction (m/s^2)."""
    return float(MP.sqrt(sum(MP.mpf(part) ** 2 for part in of_file.gravity)))
