"""Files of Abaqus, CalculiX, Nastran and Gmsh as text: keywords and cards, and elements on nodes that are not there."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

NASTRAN, ABAQUS = (".bdf", ".fem", ".nas"), (".inp",)  # endings
Listed = tuple[set[int], Iterator[tuple[int, list[int]]]]
# Nodes at most of Nastran's elements, behind which other fields are.
CARDS = {"CTETRA": 10, "CHEXA": 20, "CPENTA": 15, "CTRIA3": 3, "CTRIA6": 6, "CQUAD4": 4, "CQUAD8": 8}


def abaqus_keywords(text: str) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Keywords of a file of Abaqus or CalculiX, with their options and the fields of their lines."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("**")]
    starts = [i for i, line in enumerate(lines) if line.startswith("*")]
    for first, end in pairwise([*starts, len(lines)]):
        while lines[first].rstrip().endswith(",") and first + 1 < end:
            lines[first + 1] = lines[first].rstrip() + lines[first + 1]
            first += 1
        word, *options = lines[first][1:].split(",")
        pairs = (each.partition("=") for each in options if each.strip())
        rows = [[each.strip() for each in line.split(",")] for line in lines[first + 1 : end]]
        yield " ".join(word.upper().split()), {key.strip().upper(): value.strip() for key, _, value in pairs}, rows


def abaqus_elements(rows: list[list[str]]) -> Iterator[tuple[int, list[int]]]:
    """Numbers of elements and of their nodes in the lines of a keyword."""
    listed: list[str] = []
    for row in rows:
        listed += row
        if row[-1]:  # a comma at the end goes on in the next line
            yield int(listed[0]), [int(each) for each in listed[1:] if each]
            listed = []


def ending_of(source: Any) -> str:
    """The ending of a file's name, in small letters; empty of what is no file."""
    return Path(source).suffix.lower() if isinstance(source, (str, os.PathLike)) else ""


def missing_node(source: Any) -> str | None:
    """Say which element of a text file of Abaqus, CalculiX, Nastran or Gmsh is on a node that is not there."""
    listed = READERS.get(ending_of(source))
    if listed is None:
        return None
    try:
        nodes, elements = listed(Path(source).read_text(encoding="utf-8"))
        for element, on in elements:
            for node in on:
                if node not in nodes:
                    return f"has element {element} on node {node}, which is not in {Path(source).name}"
    except (ValueError, IndexError, KeyError, UnicodeDecodeError):
        pass  # not a text file, or damaged elsewhere
    return None


def _abaqus(text: str) -> Listed:
    blocks = list(abaqus_keywords(text))
    nodes = {int(row[0]) for word, _, rows in blocks if word == "NODE" for row in rows}

    every = (rows for word, _, rows in blocks if word == "ELEMENT")
    return nodes, (element for rows in every for element in abaqus_elements(rows))


def _nastran(text: str) -> Listed:
    cards: list[list[str]] = []
    for line in text.splitlines():
        bare = line.partition("$")[0].rstrip()
        width = 16 if "*" in bare[:8] else 8
        fields = bare.split(",")[:9] if "," in bare else [bare[i : i + width] for i in (0, *range(8, 72, width))]
        fields[0] = fields[0][:8].strip(" *_")
        if fields[0][:1].isalpha():
            cards.append(fields)
        elif cards and bare:
            cards[-1] += fields[1:]
    nodes = {int(card[1]) for card in cards if card[0] == "GRID"}
    elements = [card for card in cards if card[0] in CARDS]
    return nodes, ((int(e[1]), [int(n) for n in e[3 : 3 + CARDS[e[0]]] if n.strip()]) for e in elements)


def _gmsh(text: str) -> Listed:
    def rows(name: str) -> list[list[str]]:
        inside = text.partition(f"${name}\n")[2].partition(f"$End{name}")[0]
        return [line.split() for line in inside.splitlines()]

    new, nodes, elements = float(rows("MeshFormat")[0][0]) >= 4, rows("Nodes")[1:], rows("Elements")[1:]
    if not new:
        return {int(row[0]) for row in nodes}, ((int(e[0]), [int(n) for n in e[3 + int(e[2]) :]]) for e in elements)
    numbers, at = set[int](), 0
    while at < len(nodes):  # a head with the count, so many numbers, so many places
        count = int(nodes[at][3])
        numbers |= {int(row[0]) for row in nodes[at + 1 : at + 1 + count]}
        at += 1 + 2 * count

    def listed() -> Iterator[tuple[int, list[int]]]:
        at = 0
        while at < len(elements):
            count = int(elements[at][3])
            yield from ((int(e[0]), [int(n) for n in e[1:]]) for e in elements[at + 1 : at + 1 + count])
            at += 1 + count

    return numbers, listed()


READERS: dict[str, Callable[[str], Listed]] = {".msh": _gmsh}
READERS |= dict.fromkeys(ABAQUS, _abaqus) | dict.fromkeys(NASTRAN, _nastran)
