"""Provenance of results: scenario, records, versions and platform."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from types import MappingProxyType


@dataclass(frozen=True)
class RecordFile:
    """A flight's record as it was read.

    Parameters
    ----------
    motion : str
        Name of the flight.
    file : str
        Path as the scenario and its folder make it.
    sha256 : str
        Of its bytes.
    content : bytes or None
        All of them, where they are few enough to go with the result.
    """

    motion: str
    file: str
    sha256: str
    content: bytes | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Environment:
    """Versions and platform that computed a result.

    Parameters
    ----------
    gbeam, python, platform : str
        Versions; system, its release and the processor's kind.
    dependencies : mapping of str to str
        Version of each package that gbeam needs.
    """

    gbeam: str
    python: str
    platform: str
    dependencies: Mapping[str, str]

    def changes(self, other: Environment) -> dict[str, tuple[str, str]]:
        """Differences to another: its name, here and there."""
        mine, theirs = self._facts(), other._facts()
        names = [*mine, *(name for name in theirs if name not in mine)]
        pairs = {name: (mine.get(name, "missing"), theirs.get(name, "missing")) for name in names}
        return {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}

    def _facts(self) -> dict[str, str]:
        return {"gbeam": self.gbeam, "python": self.python, "platform": self.platform, **self.dependencies}


@dataclass(frozen=True)
class Provenance:
    """Where a result comes from.

    Parameters
    ----------
    scenario : str
        Text of the scenario file; empty where there was none.
    overrides : tuple of str
        The ``key=value`` changes made to it, in order.
    sha256 : str
        Of the scenario with its changes: of what it says, not of how it is written.
    records : tuple of RecordFile
    command : str
        The command line; empty where gbeam was called from Python.
    environment : Environment or None
        None: the present one.
    date : str
        When the result was written, UTC, as ISO 8601 has it; empty: now, or what ``SOURCE_DATE_EPOCH`` says.
    """

    scenario: str = field(default="", repr=False)
    overrides: tuple[str, ...] = ()
    sha256: str = ""
    records: tuple[RecordFile, ...] = ()
    command: str = ""
    environment: Environment | None = None
    date: str = ""

    def stated(self) -> tuple[Provenance, Environment]:
        """Provenance with its date and its environment, which takes some time to find, and that."""
        environment = self.environment or present()
        return replace(self, environment=environment, date=self.date or _now()), environment


def _now() -> str:
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")  # of builds that must be the same again
    known = epoch.isdecimal() and len(epoch) < 12  # before the year 5139
    now = datetime.fromtimestamp(int(epoch), UTC) if known else datetime.now(UTC)
    return now.isoformat(timespec="seconds")


@cache
def present() -> Environment:
    """The present environment."""
    from importlib.metadata import PackageNotFoundError, requires, version

    import gbeam

    def of(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "missing"

    try:
        needed = requires("gbeam") or []
    except PackageNotFoundError:  # from a source tree that is not installed
        needed = []
    names = {re.split(r"[^\w.-]", each)[0] for each in needed if "extra ==" not in each} | {"jaxlib", "h5py", "numpy"}
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    dependencies = MappingProxyType({name: of(name) for name in sorted(names)})
    return Environment(gbeam.__version__, sys.version.split()[0], system, dependencies)
