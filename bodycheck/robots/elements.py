"""Read an XML file from a stranger as elements that know their lines; refuse document type definitions and entities."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from bodycheck.errors import BadInput
from bodycheck.files import reading

#: Limits of a file: its size, how deep its elements are nested, and how many there are.
MAX_BYTES = 16 << 20
MAX_DEPTH = 200
MAX_ELEMENTS = 200_000

#: Most characters of a stranger's text that are quoted in a message or in a case.
MAX_QUOTED = 60


@dataclass(eq=False)
class Element:
    """An element of an XML file, with the name of its file and its line.

    Attributes
    ----------
    text
        The pieces of text directly in the element, except pieces of white space alone.
    """

    tag: str
    attributes: dict[str, str]
    file: str
    line: int
    children: list["Element"] = field(default_factory=list)
    text: list[str] = field(default_factory=list)

    def all(self, tag: str) -> Iterator["Element"]:
        """Yield the children with a tag, in their order."""
        return (child for child in self.children if child.tag == tag)

    def everything(self) -> Iterator["Element"]:
        """Yield the element and everything in it, in the order of the file."""
        left = [self]
        while left:
            element = left.pop()
            yield element
            left += reversed(element.children)

    def first(self, tag: str) -> "Element | None":
        """Return the first child with a tag; None if there is none."""
        return next(self.all(tag), None)

    def only(self, tag: str) -> "Element | None":
        """Return the child with a tag; None if there is none. Raises `BadInput` if there are several."""
        children = list(self.all(tag))
        if len(children) > 1:
            refuse(children[1], None, f"a second <{tag}> of one <{self.tag}>; allowed: one")
        return children[0] if children else None


def read(path: Path) -> Element:
    """Return the root of an XML file. Raises `BadInput` if the file does not exist, is too large, or is not XML."""
    return parsed(content(path), path.name)


def content(path: Path) -> bytes:
    """Return the content of a file that the user named. Raises `BadInput` if it is missing, too large, or no file."""
    try:
        return reading.content(path, MAX_BYTES, follow=True)
    except reading.Refused as error:
        raise BadInput(f"{path}: {error.reason}") from error
    except OSError as error:
        raise BadInput(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:  # a path with a null character
        raise BadInput(f"{path}: cannot be read: {error}") from error


def parsed(content: bytes, file: str) -> Element:
    """Return the root element of the content of an XML file named `file`. Raises `BadInput` if the content is not XML."""
    return _Reader(quoted(file)[1:-1]).read(content)


class _Reader:
    """Builds elements from the events of expat."""

    def __init__(self, file: str) -> None:
        self.file, self.count = file, 0
        self.top = Element("", {}, file, 0)
        self.open = [self.top]
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = lambda tag: self.open.pop()
        self.parser.CharacterDataHandler = self.characters
        self.parser.buffer_text = True
        self.parser.StartDoctypeDeclHandler = self.declared
        self.parser.EntityDeclHandler = self.declared

    def read(self, content: bytes) -> Element:
        try:
            self.parser.Parse(content, True)
        except expat.ExpatError as error:
            text = expat.errors.messages[error.code]
            raise BadInput(f"{self.file}:{error.lineno}: is not XML: {text}") from error
        except (ValueError, LookupError) as error:  # an encoding that is unknown or does not fit
            raise BadInput(f"{self.file}: is not XML: {error}") from error
        (root,) = self.top.children
        return root

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, self.file, self.parser.CurrentLineNumber)
        self.count += 1
        if len(self.open) > MAX_DEPTH:
            refuse(element, None, f"elements are nested more than {MAX_DEPTH} deep")
        if self.count > MAX_ELEMENTS:
            refuse(element, None, f"the file has more than {MAX_ELEMENTS} elements")
        self.open[-1].children.append(element)
        self.open.append(element)

    def characters(self, text: str) -> None:
        if not text.isspace():
            self.open[-1].text.append(text)

    def declared(self, *_: object) -> NoReturn:
        line = self.parser.CurrentLineNumber
        raise BadInput(f"{self.file}:{line}: read a document type definition; robot models need none, and it is refused")


def refuse(element: Element, attribute: str | None, text: str) -> NoReturn:
    """Raise `BadInput` that names file, line, element and attribute."""
    raise BadInput(f"{place(element, attribute)}: {text}")


def refuse_root(root: Element) -> NoReturn:
    """Raise `BadInput` for the root of a file that is neither a URDF nor an MJCF file."""
    refuse(root, None, "is no robot model; allowed: <robot> (URDF) or <mujoco> (MJCF)")


def place(element: Element, attribute: str | None = None) -> str:
    """Return file, line, element and attribute as messages state them."""
    tag = quoted(element.tag)[1:-1]
    return f"{element.file}:{element.line}: <{tag}{f' {attribute}' if attribute else ''}>"


def printable(text: str) -> str:
    """Return a stranger's text on one line, with escapes for unprintable characters."""
    return "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode("ascii") for sign in text)


def quoted(text: str) -> str:
    """Return a stranger's text between quotes, on one line of printable characters and of limited length."""
    short = text if len(text) <= MAX_QUOTED else f"{text[:MAX_QUOTED]}…"
    return ascii(short) if not short.isprintable() else f"'{short}'"
