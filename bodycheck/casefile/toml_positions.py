"""Find the positions of keys and values in a TOML document, which `tomllib` does not report."""

import tomllib
from collections.abc import Iterable
from typing import Any, NamedTuple

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

Path = tuple[str | int, ...]


class Position(NamedTuple):
    """Line and column, counted from 1, in characters."""

    line: int
    column: int


class Entry(NamedTuple):
    """The nodes of a syntax tree for a table, key or array element: the node with its name, and the node with its value."""

    name: Node
    value: Node | None = None


def positions(text: str, paths: Iterable[Path]) -> dict[Path, Position]:
    """Return the positions of paths, and of all tables and arrays around them, in a valid TOML document.

    A path may lead to a table, a key or an array element. Paths that the document does not contain are absent.
    """
    content = text.encode()
    return {(): Position(1, 1)} | {path: _position(content, entry.name) for path, entry in entries(text, paths).items()}


def entries(text: str, paths: Iterable[Path]) -> dict[Path, Entry]:
    """Return the syntax nodes of paths, and of all tables and arrays around them, in a TOML document.

    Other parts of the document, which may be large, are not searched.
    """
    search = _Search({path[:length] for path in paths for length in range(1, len(path) + 1)})
    root = Parser(Language(tree_sitter_toml.language())).parse(text.encode()).root_node
    for node in root.named_children:
        if node.type == "pair":
            search.pair(node, ())
        elif node.type in ("table", "table_array_element"):
            search.table(node)
    return search.found


def _position(content: bytes, node: Node) -> Position:
    before = content[node.start_byte - node.start_point.column : node.start_byte]
    return Position(node.start_point.row + 1, len(before.decode()) + 1)


class _Search:
    """A search for paths in a syntax tree.

    `wanted` contains the paths and the paths of all tables around them; `lengths` counts the elements of the arrays of tables
    found so far.
    """

    def __init__(self, wanted: set[Path]) -> None:
        self.wanted = wanted
        self.found: dict[Path, Entry] = {}
        self.lengths: dict[Path, int] = {}

    def table(self, node: Node) -> None:
        header = node.named_children[0]
        keys = _keys(header)
        path = self._inside(keys[:-1]) + keys[-1:]
        self._record(path, Entry(header))
        if node.type == "table_array_element":
            self.lengths[path] = self.lengths.get(path, 0) + 1
            path = (*path, self.lengths[path] - 1)
            self._record(path, Entry(header))
        if path in self.wanted:
            for child in node.named_children[1:]:
                if child.type == "pair":
                    self.pair(child, path)

    def pair(self, node: Node, base: Path) -> None:
        key, value = node.named_children[:2]
        path = base
        for name in _keys(key):
            path = (*path, name)
            self._record(path, Entry(key, value))
        self._value(value, path)

    def _inside(self, keys: Path) -> Path:
        """Return the path of a table's parents; a parent that is an array of tables means its last element."""
        path: Path = ()
        for key in keys:
            path = (*path, key)
            if path in self.lengths:
                path = (*path, self.lengths[path] - 1)
        return path

    def _value(self, node: Node, path: Path) -> None:
        if path not in self.wanted:
            return
        children = [child for child in node.named_children if child.type != "comment"]
        if node.type == "array":
            for index, child in enumerate(children):
                if (*path, index) in self.wanted:
                    self._record((*path, index), Entry(child, child))
                    self._value(child, (*path, index))
        elif node.type == "inline_table":
            for child in children:
                self.pair(child, path)

    def _record(self, path: Path, entry: Entry) -> None:
        # Dotted keys or headers may name a table several times; readers look for it at the first position.
        if path in self.wanted:
            self.found.setdefault(path, entry)


def _keys(node: Node) -> tuple[str, ...]:
    if node.type == "dotted_key":
        return tuple(name for child in node.named_children for name in _keys(child))
    text = (node.text or b"").decode()
    if node.type == "quoted_key":
        unquoted: dict[str, Any] = tomllib.loads(f"{text} = 0")
        return tuple(unquoted)
    return (text,)
