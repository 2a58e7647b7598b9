"""Provenance of results: scenario, records, versions and platform."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from types import MappingProxyType

from gbeam.results.base import Part
from gbeam.results.declared import INSIDE, fact, part, rows
from gbeam.version import __version__


@dataclass(frozen=True)
class ScenarioText:
    """Text of a scenario with its changes, and the folder that file names in it are relative to.

    Parameters
    ----------
    name : str
        Of its file, for messages.
    text : str
    folder : str
    overrides : tuple of str
        The ``key=value`` changes made to it, in order.
    """

    name: str
    text: str
    folder: str
    overrides: tuple[str, ...] = ()


@dataclass(frozen=True)
class RecordFile(Part):
    """A flight's record, or another file that a scenario names, as it was read."""

    motion: str = fact("name of the flight, or the path of the key that names another file")
    file: str = fact("path as the scenario and its folder make it")
    sha256: str = fact("hash of its bytes")
    content: bytes | None = fact(
        "all its bytes, where they are few enough to go with the result", key=None, default=None, repr=False
    )

    @property
    def path(self) -> str:
        """Path of the key that names the file in the scenario."""
        return self.motion if "." in self.motion else f"motion.{self.motion}.record.file"


@dataclass(frozen=True)
class Environment(Part):
    """Versions and platform that computed a result."""

    gbeam: str = fact("version of gbeam")
    python: str = fact("version of Python")
    platform: str = fact("system, its release and the processor's kind")
    dependencies: Mapping[str, str] = fact("version of each package that gbeam needs")

    def changes(self, environment: Environment) -> dict[str, tuple[str, str]]:
        """Return what differs in another environment, by name: the values in this one and in the other."""
        mine, theirs = self._facts(), environment._facts()
        changes = {}
        for name in mine | theirs:
            pair = mine.get(name, "missing"), theirs.get(name, "missing")
            if pair[0] != pair[1]:
                changes[name] = pair
        return changes

    def _facts(self) -> dict[str, str]:
        return {"gbeam": self.gbeam, "python": self.python, "platform": self.platform, **self.dependencies}


@dataclass(frozen=True)
class Provenance(Part):
    """Origin of a result."""

    scenario: str = fact("text of the scenario file; empty where there was none", default="", repr=False)
    overrides: tuple[str, ...] = fact("the ``key=value`` changes made to it, in order", default=())
    sha256: str = fact(
        "hash of the scenario with its changes: of what it says, not of how it is written",
        key="scenario_sha256",
        default="",
    )
    records: tuple[RecordFile, ...] = rows("records of flights, and other files of the scenario", "record", default=())
    command: str = fact("the command line; empty where gbeam was called from Python", default="")
    environment: Environment | None = part("versions and platform; None: the present ones", key=INSIDE, default=None)
    date: str = fact(
        "when the result was written, UTC, as ISO 8601 has it; empty: now, or what ``SOURCE_DATE_EPOCH`` says",
        default="",
    )

    def stated(self) -> tuple[Provenance, Environment]:
        """Return the provenance with date and environment filled in, and the environment, which takes time to find."""
        environment = self.environment or current_environment()
        return replace(self, environment=environment, date=self.date or _date()), environment


def _date() -> str:
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")  # of builds that must be the same again
    decimal = epoch.isdecimal() and len(epoch) < 12  # before the year 5139
    timestamp = datetime.fromtimestamp(int(epoch), UTC) if decimal else datetime.now(UTC)
    return timestamp.isoformat(timespec="seconds")


@cache
def current_environment() -> Environment:
    """The present environment."""
    from importlib.metadata import PackageNotFoundError, requires, version

    def version_of(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "missing"

    try:
        requirements = requires("gbeam") or []
    except PackageNotFoundError:  # from a source tree that is not installed
        requirements = []
    needed = (requirement for requirement in requirements if "extra ==" not in requirement)
    names = {re.split(r"[^\w.-]", requirement)[0] for requirement in needed} | {"jaxlib", "h5py", "numpy"}
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    dependencies = MappingProxyType({name: version_of(name) for name in sorted(names)})
    return Environment(__version__, sys.version.split()[0], system, dependencies)
