"""Criteria of acceptance: every criterion declared once, for scenarios, checks, words and documents.

The schema of scenarios reads it, so that importing it loads no NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypedDict, get_args, get_type_hints

from gbeam.constants import ToleranceOf
from gbeam.errors import InputError, placing_within
from gbeam.printable import advise
from gbeam.results.declared import declared, internal, quantity

if TYPE_CHECKING:
    from gbeam.results.accounting import Accounting, PeakPair
    from gbeam.results.measures import Fatigue, Shock

Limit = float | tuple[float, float]
Value = tuple[float, str]  # and where it occurs
Share = float | str  # text such as "2 %"
Band = Share | tuple[Share, Share] | list[Share]  # a limit either way, or the least and the largest, such as "3 dB"
STRESS_AT = "stress_at"
_AtPoint = Literal["damage_at", "stress_at"]
AT_POINTS: tuple[_AtPoint, ...] = get_args(_AtPoint)  # settings that name a point with a stress
OF_RESPONSES = ("point", "control", *AT_POINTS)  # settings of what responds
STRESS, DISPLACEMENT = "a stress", "a displacement"  # that not every specimen has
PASS, NOT_ACCEPTED, NOT_DECIDED = "PASS", "NOT ACCEPTED", "NOT DECIDED"  # the verdicts
EXCEEDED = f"{NOT_ACCEPTED}, machine limits exceeded"  # state of a run or a plan that keeps the limits of acceptance
BROKEN = "limits exceeded"  # outcome of a plan, a placement or a search
VALID = "valid"  # state of a scenario that is checked
GOOD = ("done", VALID, PASS)  # states of which nothing is to be said


class Judged:
    """An imitation that limits of acceptance decide about."""

    peaks: Mapping[str, PeakPair]
    accounting: Accounting
    accept: Mapping[str, Limit]
    shock: Shock | None = None
    fatigue: Fatigue | None = None
    whole: tuple[float, float] | None = None
    point: str = ""  # that counts as the tip, where it is another
    with_response = True

    @declared("", "PASS, NOT ACCEPTED or NOT DECIDED, and why", role="fact")
    def verdict(self) -> str:
        raise NotImplementedError

    @declared("", "at most six sentences on what the verdict rests on", role="fact", name=None)
    def findings(self) -> tuple[str, ...]:
        raise NotImplementedError

    @declared("s", "time of the flight that is judged", "ends", name=None)
    def span(self) -> tuple[float, float]:
        return self.accounting.span

    @declared("s", "time of the whole flight", "ends", name="whole", key="whole")
    def whole_span(self) -> tuple[float, float]:
        return self.whole or self.accounting.span

    @property
    def part(self) -> str:
        """The part of the flight that was run, ``0 to 6 of 15.99 s``, or empty where all of it was."""
        from gbeam.results.result import part_words

        return "" if self.whole is None else part_words(self.accounting.span, self.whole)

    @property
    def figures(self) -> dict[str, float]:
        """Value of every criterion that can be judged, by its name."""
        rules = (rule for rule in RULES.values() if self.with_response or not rule.response)
        return {rule.name: rule.governing_value(self, rule.bounds(rule.usual))[0] for rule in rules}

    @declared("", "limits that can be judged", "criterion", role="rows", name="criterion_")
    def criteria(self) -> tuple[Criterion, ...]:
        criteria = []
        for name, rule in RULES.items():
            if name in self.accept and name not in self.not_judged:
                limit = self.accept[name]
                value, where = rule.governing_value(self, rule.bounds(limit))
                criteria.append(Criterion(name, limit, value, where, self.point))
        return tuple(criteria)

    @declared("", "limits that need a response, where there is none", role="fact", name=None)
    def not_judged(self) -> tuple[str, ...]:
        return tuple(name for name in self.accept if RULES[name].response and not self.with_response)

    @declared("", "whether every limit is kept: true, false, or empty where there is none", role="fact", key=None,
              name="accepted")  # fmt: skip
    def acceptance(self) -> str:
        return {PASS: "true", NOT_ACCEPTED: "false"}.get(self.decision, self.decision)

    @declared("", "whether every limit that can be judged is kept", role="fact", name=None)
    def accepted(self) -> bool | None:
        """True if every limit that can be judged is kept, or None where there is none, or that is not decided."""
        return {PASS: True, NOT_ACCEPTED: False}.get(self.decision)

    @property
    def decision(self) -> str:
        """PASS; NOT ACCEPTED where a limit is not kept; else NOT DECIDED where a value is not known, or empty where
        none can be judged.
        """
        verdicts = [criterion.passed for criterion in self.criteria]
        if False in verdicts:
            return NOT_ACCEPTED
        if None in verdicts:
            return NOT_DECIDED
        return PASS if verdicts else ""

    @property
    def refusal(self) -> str:
        """The limits that are not kept, or else those whose values are not known, in words, or empty where accepted."""
        verdict = {NOT_ACCEPTED: False, NOT_DECIDED: None}.get(self.decision, 0)
        return ", ".join(str(criterion) for criterion in self.criteria if criterion.passed is verdict)


def state_of(
    outcome: str, imitations: Sequence[Judged], *, exceeded: bool = False, verdicts: Sequence[bool | None] = ()
) -> str:
    """Return the verdict on an answer, or its outcome where nothing is decided. Only :data:`GOOD` ones are good.

    `exceeded` is True if a limit of a machine is. `verdicts` are those on other limits, None where there is none.
    """
    if outcome not in ("done", BROKEN):
        return outcome
    decisions = [imitation.decision for imitation in imitations]
    if False in verdicts or NOT_ACCEPTED in decisions:
        return NOT_ACCEPTED
    if NOT_DECIDED in decisions:
        return NOT_DECIDED
    if exceeded or outcome == BROKEN:
        return EXCEEDED
    # A part of a flight, or one of which some limits are not judged, passes nothing.
    passed = any(imitation.accepted and not imitation.not_judged and not imitation.part for imitation in imitations)
    state = PASS if passed or True in verdicts else "done"
    main_peaks = [imitation.accounting.main for imitation in imitations]
    missed = any(peak is not None and peak.reason for peak in main_peaks)
    return f"{state}, largest peak missed" if missed else state


@dataclass(frozen=True)
class Rule:
    """A quantity that a limit of acceptance is set on, and how a value is held against the limit."""

    words: str  # description for the reference of scenarios
    # most: a share whose size may be at most the limit; least: one that may be no smaller; level, ratio: machine over
    # flight, which may be at most the limit and no less than its reciprocal, or lies between two; levels are written
    # in decibels
    kind: Literal["most", "least", "level", "ratio"]
    usual: float  # a limit as an example
    # values of an imitation, each with where it occurs; the worst of them is judged
    values: Callable[[Judged], Iterator[Value]]
    response: bool = True  # whether it needs the responses; the others follow from what the machine does alone
    needs: str = ""  # quantity that not every specimen has
    name: str = ""  # key of the limit

    @property
    def band(self) -> bool:
        """True if a limit is one of the ratio of machine to flight, either way."""
        return self.kind in ("level", "ratio")

    def checked(self, limit: object) -> Limit:
        """Return a limit as a float, or as the least and the largest ratio; InputError if it is not possible."""
        from gbeam.guards.checks import positive

        if not self.band or not isinstance(limit, (tuple, list)):
            size = positive(self.name, limit, "(a ratio)" if self.band else "(a share)")
            if self.kind == "least" and size > 1:
                raise InputError(self.name, f"is {100 * size:g} %, more than all of it", 'give "100 %" or less')
            if self.band and size <= 1:
                self._refuse(f"is {size:g}, and not above 1")
            return float(size)
        if len(limit) != 2:
            self._refuse(f"has {len(limit)} entries")
        low, high = (float(positive(self.name, end, "(a ratio)")) for end in limit)
        if not low < 1 < high:
            self._refuse(f"is {low:g} to {high:g}, without 1 in between")
        return low, high

    def _refuse(self, problem: str) -> None:
        example = '"3 dB", or ["-1.5 dB", "3 dB"]' if self.kind == "level" else "2, or [0.5, 2]"
        fix = f"give the largest ratio of machine to flight, either way, or the least and the largest: {example}"
        raise InputError(self.name, problem, fix)

    def bounds(self, limit: Limit) -> tuple[float, float]:
        """Least and largest value that a limit allows."""
        if isinstance(limit, tuple):
            return limit
        if self.kind == "least":
            return limit, math.inf
        return (1 / limit, limit) if self.band else (-limit, limit)

    def governing_value(self, judged: Judged, bounds: tuple[float, float]) -> Value:
        """Return the value nearest to its bound or furthest beyond it, and where; NaN, and why, if none is known."""
        values = [*self.values(judged), (math.nan, "")]
        finite_values = (value for value in values if not math.isnan(value[0]))
        return max(finite_values, key=lambda value: self.use(value[0], bounds), default=values[0])

    def use(self, value: float, bounds: tuple[float, float]) -> float:
        """Return the share of its bounds that a value uses: 1 on a bound, more beyond it."""
        low, high = bounds
        if self.kind == "least":
            return low / value if value > 0 else math.inf
        if not self.band:
            return abs(value) / high
        if not value > 0:
            return math.inf
        return math.log(value) / math.log(high if value > 1 else low)

    def write(self, value: float) -> str:
        """Write a value with its unit: dB of a level, % of a share, none of a ratio."""
        if not math.isfinite(value):
            return "unknown"
        if self.kind == "level":
            return f"{_decibels(value):+.3g} dB" if value > 0 else "nothing"
        return f"{value:.3g}" if self.kind == "ratio" else f"{100 * value:.3g} %"

    def limit_written(self, limit: Limit) -> str:
        """Write a limit, or the least and the largest value, with the unit."""
        if not isinstance(limit, tuple):
            if not self.band:
                return f"limit {self.write(limit)}{' or more' if self.kind == 'least' else ''}"
            if self.kind == "level":
                return f"limit ±{_decibels(limit):.3g} dB"
        return f"limit {' to '.join(self.write(end) for end in self.bounds(limit))}"


@dataclass(frozen=True)
class Criterion:
    """One of the limits that decide whether a machine's imitation is accepted."""

    name: str = quantity("", "what a limit of acceptance is on", note="docs/verdict.md, Pass or fail")
    limit: Limit = quantity("", "the limit, as given", name=None)
    value: float = quantity("", "its value", note="NaN where it is not known, which decides nothing")
    where: str = quantity("", "where and when that is", note="empty where it belongs to the whole flight", default="")
    point: str = internal("", "the point that counts as the tip, where it is another", default="")

    @declared("", "least value that is accepted", name="least_allowed", key=None)
    def least(self) -> float:
        return self.bounds[0]

    @declared("", "largest value that is accepted; infinite where any is", name="most_allowed", key=None)
    def most(self) -> float:
        return self.bounds[1]

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and largest value that is accepted."""
        return RULES[self.name].bounds(self.limit)

    @declared("", "whether the value is within its bounds; None where it is not known", name=None)
    def passed(self) -> bool | None:
        low, high = self.bounds
        return None if math.isnan(self.value) else bool(low <= self.value <= high)

    @property
    def words(self) -> str:
        """The quantity that the limit is on."""
        if self.name == "tip" and self.point:
            return self.point
        return in_words(self.name)

    @property
    def use(self) -> float:
        """Share of the limit that is used: 1 on it, more beyond it."""
        return RULES[self.name].use(self.value, self.bounds)

    @property
    def value_words(self) -> str:
        """The value in words."""
        return self.number + " of the time" * (self.name == "followed")

    @property
    def number(self) -> str:
        """Value, with as many digits as show on which side of its limit it lies."""
        rule, percentage = RULES[self.name], 100 * self.value
        if rule.band or not math.isfinite(percentage):
            return rule.write(self.value)
        sign = "+" if rule.kind == "most" and self.name != "peaks" else ""
        if abs(percentage) < 0.05 and self.passed and self.bounds[1] >= 1e-3:
            return "under 0.1 %"
        low, high = self.bounds
        least_digits = 0 if abs(percentage) >= 10 else 1
        for digits in range(least_digits, least_digits + 8):
            text = f"{percentage:{sign}.{digits}f}"
            if (low <= float(text) / 100 <= high) == self.passed:
                return f"{text} %"
        return f"{percentage:{sign}g} %"

    @property
    def limit_written(self) -> str:
        """The limit in words, ``limit 2 %``; of a followed share the least."""
        return RULES[self.name].limit_written(self.limit)

    @property
    def brief(self) -> str:
        """The value and the limit on its side, without where and when that is."""
        rule, nearest = RULES[self.name], self.bounds[self.value > 1]
        limit = f"limit {rule.write(nearest)}" if rule.band else self.limit_written
        where = f" {self.where}" if math.isinf(self.value) else ""
        return f"{self.words} {self.value_words}{where} ({limit})"

    def __str__(self) -> str:
        where = f" {self.where}" if self.where else ""
        return f"{self.words} {self.value_words}{where} ({self.limit_written})"


def in_words(name: str) -> str:
    """Return the quantity of a limit in words."""
    return _SAID.get(name, name.replace("_", " "))


_SAID = {"peaks": "error of peaks", "srs": "shock spectrum", "spread": "spread of the load"}


def judging(accept: Mapping[str, Any], *, response: bool = True) -> dict[str, Any]:
    """Return keyword arguments of :func:`gbeam.compare` from `accept`, or without a response of :func:`gbeam.plan`."""
    keywords: dict[str, Any] = {"accept": {}}
    for name, value in accept.items():
        if name not in SETTINGS:
            keywords["accept"][name] = value
        elif response or name not in OF_RESPONSES:
            keywords[name] = value
    return keywords


def refuse_unknown(table: str, limits: Iterable[str]) -> None:
    """InputError unless every name is a limit of acceptance or one of their settings."""
    for name in limits:
        if name not in Acceptance.__annotations__:
            raise InputError(f"{table}.{name}", "is no limit of acceptance", advise(name, Acceptance.__annotations__))


def refuse_lacking(table: str, limits: Iterable[str], lacking: Mapping[str, str]) -> None:
    """InputError for a limit on a quantity that the specimen lacks. `lacking` says by quantity why it lacks it."""
    for name in limits:
        rule = RULES.get(name)
        if rule is not None and rule.needs in lacking:
            alternatives = ", ".join(
                alternative.name for alternative in RULES.values() if alternative.needs not in lacking
            )
            raise InputError(
                f"{table}.{name}", f"is of {rule.needs}, and {lacking[rule.needs]}", f"choose from {alternatives}"
            )


def checked_limits(accept: Mapping[str, object] | None) -> dict[str, Limit]:
    """Return limits by name, as floats; InputError for an unknown name or an impossible limit."""
    limits = {}
    for name, limit in ({} if accept is None else accept).items():
        if name not in RULES:
            raise InputError("accept", f"has {name!r}", advise(name, RULES, listed="choose from"))
        with placing_within("accept"):
            limits[name] = RULES[name].checked(limit)
    return limits


def _decibels(ratio: float) -> float:
    return 20 * math.log10(ratio)


def _change(name: str) -> Callable[[Judged], Iterator[Value]]:
    """Return a function that yields the relative change of a peak from flight to machine, and where that is."""

    def values(judged: Judged) -> Iterator[Value]:
        if name in judged.peaks:
            pair = judged.peaks[name]
            if pair.flight == 0 < pair.machine:
                from gbeam.results.accounting import UNITS

                yield math.inf, f"as flight has none and the machine makes {pair.machine:.4g} {UNITS[name]}"
                return
            change = 0.0 if pair.machine == pair.flight else pair.ratio - 1
            yield change, f"at {pair.place_machine} at {pair.time_machine:.2f} s" if pair.place_machine else ""

    return values


def _stress(judged: Judged) -> Iterator[Value]:
    return _change(STRESS_AT if STRESS_AT in judged.peaks else "stress")(judged)


def _peaks(judged: Judged) -> Iterator[Value]:
    yield 0.0, ""  # there may be none
    for peak in judged.accounting.peaks:
        yield peak.error, f"at {peak.time:.2f} s"


def _spread(judged: Judged) -> Iterator[Value]:
    if not judged.accounting.peaks:
        yield 0.0, ""
    for peak in judged.accounting.peaks:
        for end, spread in zip(("root", "tip"), peak.spread, strict=True):
            yield spread, f"at the {end} at {peak.time_machine:.2f} s"


def _followed_share(judged: Judged) -> Iterator[Value]:
    yield judged.accounting.followed_share, ""


def _srs(judged: Judged) -> Iterator[Value]:
    if judged.shock is not None:
        for extreme in judged.shock.extremes:
            yield extreme.ratio, str(extreme)


def _damage(judged: Judged) -> Iterator[Value]:
    yield (math.nan, "") if judged.fatigue is None else (judged.fatigue.damage_ratio, judged.fatigue.place)


# fmt: off
class Limits(TypedDict, total=False):
    """Limits of acceptance by name, as :func:`gbeam.compare` takes them."""

    tip: Annotated[Share, Rule(
        "largest change of the tip's peak displacement", "most", 0.02, _change("tip"), needs=DISPLACEMENT
    )]
    root_force: Annotated[Share, Rule(
        "largest change of the peak force at the root", "most", 0.05, _change("root_force")
    )]
    root_moment: Annotated[Share, Rule(
        "largest change of the peak moment at the root", "most", 0.05, _change("root_moment")
    )]
    stress: Annotated[Share, Rule(
        "largest change of the peak stress, anywhere or at stress_at", "most", 0.05, _stress, needs=STRESS
    )]
    largest_load: Annotated[Share, Rule(
        "largest change of the largest load anywhere on the specimen, which is that of the machine's whole run, "
        "spin-up and spin-down included",
        "most", 0.1, _change("largest_load"), response=False,
    )]
    peaks: Annotated[Share, Rule(
        "largest error of any peak of the flight's load above idle, as a vector", "most", 0.03, _peaks, response=False
    )]
    spread: Annotated[Share, Rule(
        "largest difference of the load at the root or the tip from the control point's at these peaks",
        "most", 0.1, _spread, response=False,
    )]
    followed: Annotated[Share, Rule(
        "least share of the flight's time that must be followed", "least", 0.7, _followed_share, response=False
    )]
    srs: Annotated[Band, Rule(
        "shock response spectra of the tip, or of control points: largest ratio of machine and flight, either way, "
        "at any frequency along any axis; or the least and the largest of machine to flight, such as "
        "[-1.5 dB, 3 dB]",
        "level", 10 ** (3 / 20), _srs,
    )]
    damage: Annotated[Band, Rule(
        "fatigue damage of the root, of a solid where its stress is largest, or at damage_at: largest ratio of "
        "machine and flight, either way; or the least and the largest of machine to flight, such as [0.5, 2]",
        "ratio", 2.0, _damage, needs=STRESS,
    )]
# fmt: on


class Acceptance(Limits, total=False):
    """Limits of acceptance and their settings, as a case has them for one centrifuge."""

    tolerance: Share
    tolerance_of: ToleranceOf
    point: str
    control: Mapping[str, float]
    damage_at: str
    stress_at: str


RULES: dict[str, Rule] = {
    name: replace(get_args(hint)[1], name=name) for name, hint in get_type_hints(Limits, include_extras=True).items()
}
SETTINGS = tuple(name for name in Acceptance.__annotations__ if name not in RULES)  # beside the limits
# Kinds of quantity of limits, and of the tolerance that may stand beside them.
KINDS_OF_LIMITS = {name: "amplitude ratio" if rule.kind == "level" else "ratio" for name, rule in RULES.items()}
KINDS_OF_LIMITS["tolerance"] = "ratio"
