"""Places of a scenario's values in its text, TOML or JSON."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from gbeam.scenario.values.paths import Path, Place, Span

if TYPE_CHECKING:
    from tree_sitter import Node


def locate_toml(text: str) -> dict[Path, Place]:
    """Map every path, such as ``("beam", "masses", 0, "at")``, to its place."""
    finder = _Finder(text)
    finder.document(syntax_tree(text.encode()))
    return finder.places


def syntax_tree(code: bytes) -> Node:
    """The syntax tree of a TOML text."""
    import tree_sitter
    import tree_sitter_toml

    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_toml.language())).parse(code).root_node


class _Finder:
    """Walks one syntax tree and notes the places it passes."""

    def __init__(self, text: str) -> None:
        # tree-sitter breaks lines at \n only, and counts columns in bytes.
        self.lines = text.split("\n")
        self.columns: dict[int, Sequence[int]] = {}
        self.places: dict[Path, Place] = {}

    def span(self, node: Node) -> Span:
        """Place of a node, cut at the end of its first line."""
        (row, start), (last, stop) = node.start_point, node.end_point
        if row not in self.columns:
            self.columns[row] = _columns(self.lines[row])
        columns = self.columns[row]
        return Span(row + 1, columns[start] + 1, columns[stop if last == row else -1] + 1)

    def note(self, path: Path, key: Node, value: Node) -> None:
        """Keep the first place of `path`: a table may be opened again by a later header or dotted key."""
        self.places.setdefault(path, Place(self.span(key), self.span(value)))

    def document(self, root: Node) -> None:
        """Pairs before the first header, then the tables."""
        counts: dict[Path, int] = {}
        for node in root.named_children:
            if node.type == "pair":
                self.pair((), node)
            elif node.type in ("table", "table_array_element"):
                path: Path = ()
                keys = list(keys_of(node.named_children[0]))
                for i, (name, key) in enumerate(keys):
                    path += (name,)
                    self.note(path, key, key)
                    opens = node.type == "table_array_element" and i == len(keys) - 1
                    if opens:
                        counts[path] = counts.get(path, -1) + 1
                    if path in counts:  # a header below an array of tables belongs to its latest element
                        path += (counts[path],)
                        self.note(path, key, key)
                for pair in node.named_children[1:]:
                    if pair.type == "pair":
                        self.pair(path, pair)

    def pair(self, path: Path, node: Node) -> None:
        """``key = value``."""
        inside = _inside(node)
        if len(inside) != 2:
            return
        key_node, value = inside
        for name, key in keys_of(key_node):
            path += (name,)
            self.note(path, key, value)
        self.value(path, value)

    def value(self, path: Path, node: Node) -> None:
        """Descend into tables and lists."""
        if node.type == "inline_table":
            for pair in _inside(node):
                self.pair(path, pair)
        elif node.type == "array":
            for i, child in enumerate(_inside(node)):
                self.note((*path, i), child, child)
                self.value((*path, i), child)


def _columns(line: str) -> Sequence[int]:
    """The column of every byte of a line, and last where its text ends; made once a line, which may be a megabyte."""
    end = len(line.rstrip())
    if line.isascii():
        return [*range(len(line) + 1), end]
    counts = [i for i, letter in enumerate(line) for _ in letter.encode()]
    return [*counts, len(line), end]


def _inside(node: Node) -> list[Node]:
    return [child for child in node.named_children if child.type not in ("comment", "ERROR")]


def keys_of(node: Node) -> Iterator[tuple[str, Node]]:
    """Names in a key, with their nodes; several in a dotted one."""
    text = (node.text or b"").decode()
    if node.type == "dotted_key":
        for child in node.named_children:
            yield from keys_of(child)
    elif node.type == "bare_key":
        yield text, node
    elif node.type == "quoted_key":
        yield tomllib.loads(f"key = {text}")["key"], node


_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]:,]|[^\s{}\[\]:,"]+')


def locate_json(text: str) -> dict[Path, Place]:
    """Map every path to its place."""
    reader = _Reader(text)
    reader.value((), None)
    return reader.places


class _Reader:
    """Reads token after token and notes the places it passes."""

    def __init__(self, text: str) -> None:
        self.lines = text.split("\n")
        self.tokens = self._tokens()
        self.places: dict[Path, Place] = {}

    def _tokens(self) -> Iterator[tuple[str, Span]]:
        for number, line in enumerate(self.lines, start=1):
            for match in _TOKEN.finditer(line):
                yield match[0], Span(number, match.start() + 1, match.end() + 1)

    def value(self, path: Path, key: Span | None) -> None:
        """Read the next value."""
        token, span = next(self.tokens)
        self.value_from(path, key, token, span)

    def value_from(self, path: Path, key: Span | None, token: str, span: Span) -> None:
        """Read the value whose first token has been taken."""
        last = span
        if token in ("[", "{"):
            index = 0
            for inner, last in self.tokens:
                if inner in ("]", "}"):
                    break
                if inner == ",":
                    continue
                if token == "[":
                    self.value_from((*path, index), None, inner, last)
                    index += 1
                else:
                    next(self.tokens)  # the colon
                    self.value((*path, json.loads(inner)), last)
        end = last.end if last.line == span.line else len(self.lines[span.line - 1].rstrip()) + 1
        whole = Span(span.line, span.column, end)
        self.places[path] = Place(key or whole, whole)


BLOCKS = ("table", "table_array_element")  # [table] and [[element]], with the lines below them
# The node to cut, and the node of the value; None where a longer key only passes through the entry.
Written = tuple["Node", "Node | None"]


class Layout:
    """Places of every entry of a TOML text: several where headers and dotted keys share a table."""

    def __init__(self, code: bytes) -> None:
        self.root = syntax_tree(code)
        self.entries: dict[Path, list[Written]] = {}
        self.bases: dict[int, Path] = {}  # of pairs: the table that they stand in
        counts: dict[Path, int] = {}
        for node in self.root.named_children:
            if node.type == "pair":
                self._pair((), node)
            elif node.type in BLOCKS:
                base = self._header(node, counts)
                for pair in node.named_children[1:]:
                    if pair.type == "pair":
                        self._pair(base, pair)

    def _note(self, path: Path, whole: Node, value: Node | None) -> None:
        self.entries.setdefault(path, []).append((whole, value))

    def _header(self, node: Node, counts: dict[Path, int]) -> Path:
        path: Path = ()
        names = [name for name, _ in keys_of(node.named_children[0])]
        for i, name in enumerate(names, 1):
            path += (name,)
            opens = node.type == "table_array_element" and i == len(names)
            if opens:
                counts[path] = counts.get(path, -1) + 1
            listed = path in counts
            self._note(path, node, node if i == len(names) and not listed else None)
            if listed:
                path += (counts[path],)
                self._note(path, node, node if i == len(names) else None)
        return path

    def _pair(self, base: Path, node: Node) -> None:
        inside = [*_known(node)]
        if len(inside) != 2:
            return
        self.bases[node.id] = base
        names = [name for name, _ in keys_of(inside[0])]
        for i in range(1, len(names)):
            self._note((*base, *names[:i]), node, None)
        self._value((*base, *names), node, inside[1])

    def _value(self, path: Path, whole: Node, value: Node) -> None:
        self._note(path, whole, value)
        if value.type == "inline_table":
            for pair in _known(value):
                self._pair(path, pair)
        elif value.type == "array":
            for i, each in enumerate(_known(value)):
                self._value((*path, i), each, each)


def _known(node: Node) -> Iterator[Node]:
    return (child for child in node.named_children if child.type not in ("comment", "ERROR"))
