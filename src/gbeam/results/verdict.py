"""The verdict on an imitation in words: a headline of three numbers, and at most six sentences below it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gbeam.printable import level_words
from gbeam.results.accounting import NotFollowed, PeakPair, change, in_g, metres, percent
from gbeam.results.criteria import NOT_ACCEPTED, NOT_DECIDED, Criterion, Judged, in_words

WORDS = 25  # of a headline, at most
_TIMES, _APART, _BRIEF = 3.0, 5e-4, 0.005  # a ratio is said as such from here on; shares alike; stretches to omit, s
_IDLE = "below idle"


class Worded(Judged):
    """An imitation whose verdict is said in words."""

    @property
    def words(self) -> Verdict:
        """The verdict as words are made of it."""
        raise NotImplementedError

    @property
    def verdict(self) -> str:
        """PASS, NOT ACCEPTED or NOT DECIDED, and why, in one line about the whole flight that a person can quote."""
        return self.words.headline

    @property
    def findings(self) -> tuple[str, ...]:
        """At most six sentences: largest load, peaks, time followed, tip, root, and what the machine could not do."""
        return self.words.findings


@dataclass(frozen=True)
class Verdict:
    """An imitation that is judged, as the words on it need it."""

    judged: Judged
    point: str = "tip"  # point that counts as the tip
    margins: tuple[float, float] | None = None  # least margins on yield in flight and on the machine
    exceeded: str = ""  # limits of the machine that are exceeded
    scale: float | None = None  # level factor of the flight's loads

    @property
    def headline(self) -> str:
        """The decision and its reason in one line, with three numbers where as many are known."""
        judged = self.judged
        decision, intro, reason, worst_words = self._decided
        numbers = {
            "largest_load": self._loads(with_flight=not judged.criteria),
            "followed": f"followed {self._followed} of the time",
        }
        figures = [words for name, words in numbers.items() if words and not (worst_words and worst_words.name == name)]
        # A criterion that is told has a number of its own.
        count = 1 if worst_words is not None and worst_words.passed is not None else 2
        flight = level_words("the flight", self.scale)
        if judged.whole is not None:
            decision += f" for a part of {flight}"
        elif self.scale:
            decision += f" for {flight}"
        main_peak = judged.accounting.main
        missed = "largest peak missed" if main_peak is not None and main_peak.reason else ""
        return _shortened(decision, intro, reason, figures[:count], missed)

    @property
    def _decided(self) -> tuple[str, str, str, Criterion | None]:
        """The decision, what introduces its reason, the reason, and the criterion that it is about."""
        judged, criteria = self.judged, self.judged.criteria
        if judged.decision == NOT_ACCEPTED:
            missed = [criterion for criterion in criteria if criterion.passed is False]
            worst_criterion = max(missed, key=lambda criterion: criterion.use)
            unkept = [criterion for criterion in criteria if criterion.passed is not True]
            return NOT_ACCEPTED, "" if len(unkept) == 1 else "worst of all: ", worst_criterion.brief, worst_criterion
        if judged.decision == NOT_DECIDED:
            unknown = next(criterion for criterion in criteria if criterion.passed is not True)
            return NOT_DECIDED, "", f"{unknown.words} is not known ({unknown.limit_written})", unknown
        if self.exceeded:
            return NOT_ACCEPTED, "", f"the machine exceeds its limits, {self.exceeded}", None
        if judged.not_judged:
            if not criteria:
                return "Machine alone, no limit judged", "", "", None
            worst_criterion = max(criteria, key=lambda criterion: criterion.use)
            return "Machine alone, no limit missed", "", worst_criterion.brief, worst_criterion
        if not criteria:
            return judged.decision or "No limits set", "", "", None
        nearest = max(criteria, key=lambda criterion: criterion.use)
        intro = "" if len(criteria) == 1 else "all limits are kept, the nearest: "
        return judged.decision or "No limits set", intro, nearest.brief, nearest

    @property
    def findings(self) -> tuple[str, ...]:
        """At most six sentences: largest load, peaks, time followed, tip, root, and what the machine could not do."""
        sentences = (
            self._load(), self._peaks(), self._time(), self._tip(), self._root(), self._machine(), self._specimen()
        )  # fmt: skip
        return tuple(filter(None, sentences))

    @property
    def _followed(self) -> str:
        followed = next((criterion for criterion in self.judged.criteria if criterion.name == "followed"), None)
        return followed.number if followed else f"{100 * self.judged.accounting.followed_share:.0f} %"

    def _loads(self, *, with_flight: bool) -> str:
        """The machine's largest load, or its largest peak where that is not known; and the flight's, if asked for."""
        load, main = self.judged.peaks.get("largest_load", PeakPair()), self.judged.accounting.main
        if math.isfinite(load.machine):
            flight, machine, quantity = load.flight, load.machine, "load"
        elif main is not None:
            flight, machine, quantity = main.load, main.reproduced, "peak"
        else:
            return ""
        words = f"largest {quantity} {in_g(machine)}"
        return f"{words} (flight {in_g(flight)})" if with_flight else words

    def _limit(self, *names: str, otherwise: str = "no limit set") -> str:
        """Limit of the first of these criteria, whether it is missed, and those of the others that are missed."""
        limits = {criterion.name: criterion for criterion in self.judged.criteria if criterion.name in names}
        first = limits.pop(names[0], None)
        words = f"({otherwise})" if first is None else f"({_with_miss(first)})"
        other_limits = [criterion for criterion in limits.values() if criterion.passed is not True]
        return words + "".join(f"; missed: {criterion}" for criterion in other_limits)

    def _load(self) -> str:
        load = self.judged.peaks.get("largest_load", PeakPair())
        if not math.isfinite(load.machine):
            return ""
        place = f" at {load.place_machine}" if load.place_machine else ""
        return (
            f"Largest load: {in_g(load.machine)}{place} at {load.time_machine:.2f} s, {_comparison(load, in_g)} "
            f"{self._limit('largest_load', 'spread')}."
        )

    def _peaks(self) -> str:
        accounting = self.judged.accounting
        peaks, above_idle = accounting.peaks, f" above {in_g(accounting.idle)} (idle)" if accounting.idle else ""
        if not peaks:
            return f"Peaks: the flight has none{above_idle}."
        count = f"{len(peaks) - len(accounting.missed)} of {len(peaks)}{above_idle} reproduced"
        main, worst_peak = accounting.main, max(peaks, key=lambda peak: peak.error)
        name = "the worst"
        if main is not None and main.reason:
            name, worst_peak = "the largest", main
        size = f"{percent(worst_peak.error)} off" if worst_peak.error >= _APART else "within 0.1 %"
        limit = self._limit("peaks", otherwise=f"tolerance {percent(accounting.tolerance)}")
        reason = f"; {_because(worst_peak.reason)}" if worst_peak.reason else ""
        load = f"{in_g(worst_peak.load)} at {worst_peak.time:.2f} s"
        peak = load if len(peaks) == 1 else f"{name}, {load},"
        return f"Peaks: {count}; {peak} is {size} {limit.removesuffix(')')}{reason})."

    def _time(self) -> str:
        accounting = self.judged.accounting
        limit, shares = self._limit("followed"), accounting.shares
        rest = [f"{percent(share)} {reason}" for reason, share in shares.items() if share >= _BRIEF][:2]
        reasons = f"; {' and '.join(rest)}" if rest else ""
        part = f" from {self.judged.part}, the part that was run," if self.judged.part else ""
        return f"Followed: {self._followed} of the time{part} {limit}{reasons}."

    def _tip(self) -> str:
        if "tip" not in self.judged.peaks:
            return ""
        tip, name = self.judged.peaks["tip"], self.point[:1].upper() + self.point[1:]
        limit = self._limit("tip", "srs")
        return f"{name}: {metres(tip.machine)} at {tip.time_machine:.2f} s, {_comparison(tip, metres)} {limit}."

    def _root(self) -> str:
        limited = {criterion.name for criterion in self.judged.criteria}
        name = "root_force" if "root_force" in limited and "root_moment" not in limited else "root_moment"
        pair, unit = self.judged.peaks.get(name, PeakPair()), "N" if name == "root_force" else "N m"
        if not math.isfinite(pair.ratio):
            return ""
        limit = self._limit(name, "root_force", "root_moment", "stress", "damage")
        yielding = ""
        if self.margins is not None:
            places = [
                name for name, margin in zip(("in flight", "on the machine"), self.margins, strict=True) if margin < 0
            ]
            yielding = f"; ABOVE YIELD {' and '.join(places)}" if places else ""
        quantity = name.replace("root_", "")
        compared = _comparison(pair, lambda size: f"{size:.4g} {unit}")
        return f"Root: {quantity} {pair.machine:.4g} {unit}, {compared} {limit}{yielding}."

    def _specimen(self) -> str:
        """Sentence on the limits that a plan does not judge, in place of those on tip and root."""
        pending = self.judged.not_judged
        limits = "limit" if len(pending) == 1 else "limits"
        return f"Specimen: `gbeam run` judges its {limits}, {_listed(pending)}." if pending else ""

    def _machine(self) -> str:
        """Sentence on the longest stretch that the machine cannot follow above idle, or else below it."""
        if self.exceeded:
            return f"Machine: it exceeds {self.exceeded}."
        stretches = self.judged.accounting.not_followed

        def length(stretch: NotFollowed) -> float:
            return stretch.end - stretch.start

        above_idle = [stretch for stretch in stretches if stretch.reason != _IDLE and length(stretch) > _BRIEF]
        longest = max(above_idle or stretches, key=length, default=None)
        if longest is None:
            return ""
        span = f"from {longest.start:.2f} to {longest.end:.2f} s"
        if longest.reason == _IDLE:
            return f"Machine: it cannot go below idle, {in_g(self.judged.accounting.idle)}, longest {span}."
        return f"Machine: it cannot follow {in_g(longest.flight_peak)} {span} ({_because(longest.reason)})."


def _because(reason: str) -> str:
    """Words for why a load is not followed: limits are used up."""
    return f"used up: {reason}" if reason.startswith(("axis", "arm")) else reason


def _shortened(start: str, intro: str, reason: str, context: list[str], remark: str) -> str:
    """Headline of at most :data:`WORDS` words: without the last of the context, all of it, the intro, or the remark."""
    shorter = [(intro, context[:count], remark) for count in range(len(context), -1, -1)]
    for first, words, last in (*shorter, ("", [], remark), ("", [], "")):
        parts = [f"{first}{reason}", ", ".join(words), last]
        line = f"{start}: {'; '.join(filter(None, parts))}"
        if len(line.split()) <= WORDS:
            break
    return line


_NAMED = 2  # limits that are named one by one


def _listed(names: Sequence[str]) -> str:
    """Words for limits, ``tip and root moment``; of many the first and how many more."""
    words = [in_words(name) for name in names]
    first_words, remaining = words[:_NAMED], len(words) - _NAMED
    return f"{', '.join(first_words)} and {remaining} more" if remaining > 0 else " and ".join(first_words)


def _with_miss(criterion: Criterion) -> str:
    missed = {False: ", missed", None: ", not known", True: ""}[criterion.passed]
    return criterion.limit_written + missed


def _comparison(pair: PeakPair, write: Callable[[float], str]) -> str:
    """Words for the machine's size of a quantity beside the flight's."""
    if not math.isfinite(pair.ratio):
        return "in flight none"
    flight = f"the flight's {write(pair.flight)}"
    if abs(pair.ratio - 1) < _APART:
        return f"within 0.1 % of {flight}"
    if pair.ratio >= _TIMES:
        return f"{change(pair.ratio)} {flight}"
    size = change(pair.ratio).lstrip("+-−")
    return f"{size} {'above' if pair.ratio > 1 else 'below'} {flight}"
