"""Sweeps: figures of many cases of one scenario, as arrays over the values that vary."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.constants import Sampler, Verb
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import WRITTEN, kinds
from gbeam.guards.limits import HISTORY_BYTES, WORKERS, refuse_more
from gbeam.guards.quantities import Seconds
from gbeam.progress import tell
from gbeam.questions import Options
from gbeam.results.cases import Sweep
from gbeam.studies.cases import Cases, read_cases
from gbeam.studies.evaluate import Function, Inquiry, Row, Task, may_share, width
from gbeam.studies.figures import HISTORY, TIMES, check_figures, usual_figures
from gbeam.studies.journal import Journal, identity, open_journal
from gbeam.studies.start import NO_HISTORIES, OverTime, Start, go_on, start
from gbeam.studies.statistics import indices, statistics
from gbeam.studies.template import template_of
from gbeam.studies.workers import KEPT, on_scheduler, processes, serially

MANY = 100_000  # cases beyond which a sweep is begun only when that is confirmed
_LONGEST = 256  # cases in a batch
Progress = Callable[[int, int, int], None] | bool | None


@kinds(over=WRITTEN, options=WRITTEN)
@typed
def sweep(
    scenario: str | os.PathLike[str] | Case,
    over: Mapping[str, Any] | Sequence[str] = (),
    measure: Sequence[str] | Mapping[str, Function] = (),
    *,
    histories: Sequence[str] = (),
    times: int = TIMES,
    verb: Verb | None = None,
    motion: str | None = None,
    at: Seconds | None = None,
    options: Options | None = None,
    overrides: Sequence[str] = (),
    samples: int | None = None,
    sampler: Sampler | None = None,
    seed: int | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    store: str | os.PathLike[str] | None = None,
    resume: bool = False,
    confirmed: bool = False,
    progress: Progress = None,
) -> Sweep:
    """Compute figures of many cases of one scenario. What is not given is what the scenario's [sweep] says.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or a case, of :func:`gbeam.read_scenario` or made in Python.
    over : mapping of str to values, or sequence of str
        What varies: values by the key's path, ``{"motion.centrifuge.arm": ["1 m", "3.3 m"]}``, numbers in SI; or texts
        such as ``"motion.centrifuge.arm=1 m:12 m:12"`` (a range: from, to, how many), ``"model.kind=FOAM, exact"`` (a
        list) or ``"beam.damping_ratio=uniform(0.5 %, 2 %)"`` (normal, lognormal, uniform or triangular).
    measure : sequence of str, or mapping of str to callable
        Figures of the verb's JSON by the end of their path, such as ``tip.z.max_abs`` or ``verdict.tip``; or functions
        of a :class:`gbeam.Case` that return a number, by name. Of run by default what the verdict of a centrifuge
        is on (its limits of acceptance, or the largest load), the largest of tip and root moment, the share of the
        flight that is followed, and whether it is accepted.
    histories : sequence of str
        Histories over time as further measures, of what :meth:`Response.signal` reads: ``flight.tip.z``,
        ``flight.strip.root_moment.y``.
        Where samples are drawn, their quantiles at every time are the bands that the response stays in.
    times : int
        At which histories are given, spread evenly over the response of the first case; 501 by default.
    verb : str
        run (the default), static, modes, critical-speed, plan or place.
    motion : str, optional
        Which motion, for a verb that answers for one.
    at : float, optional
        Time at which that motion is frozen, s; the start of the response by default.
    options : mapping of str to values, optional
        Options of the verb by their names on its command line, such as ``{"turning": "base.angle", "to": "60 rpm"}``.
    overrides : sequence of str
        Changes of the scenario that all cases share, such as ``beam.length=250 mm``.
    samples : int, optional
        Of what is drawn, 64 by default: distributions in `over`, and those that stand in the scenario in place of a
        value, ``youngs_modulus = { normal = ["70 GPa", "2 GPa"] }``.
    sampler : str
        sobol (the default), latin or random; or saltelli, which makes samples × (d + 2) cases of d distributions, and
        gives Sobol indices.
    seed : int
        The same seed draws the same samples.
    workers : int
        Processes of this machine; measures that are functions have to be at the top level of a module.
    scheduler : str, optional
        Address of a Dask scheduler, whose workers compute instead.
    store : path, optional
        Folder in which every case is kept as soon as it is done.
    resume : bool
        Whether to take from the store what is done.
    confirmed : bool
        Whether more than 100,000 cases are meant.
    progress : callable or bool, optional
        Called with the number of cases done, of those that failed among them, and of all; True shows a bar.

    Returns
    -------
    Sweep
        A case that fails is recorded as such; the rest goes on.

    Raises
    ------
    InputError
        If the scenario, what varies or a measure is wrong, no case is possible, or the store is another sweep's or in
        use.
    ComputationError
        If the scheduler is lost; the store keeps what is done.

    Examples
    --------
    >>> moduli = ["beam.material.youngs_modulus=60 GPa, 70 GPa, 80 GPa"]
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sweep(hub, moduli, ["modes[0].frequency"], verb="modes")
    >>> answer
    Sweep of modes over 3 beam.material.youngs_modulus: 3 done; modes[0].frequency
      note: motion.slew: gravity is left out; on a test arm give gravity = [0, 0, "-1 g"], in hub axes
    """
    template = template_of(scenario, overrides, distributions=True)
    settings = template.sweep
    over, measure, histories = over or settings.over, measure or settings.measure, histories or settings.history
    verb, sampler = verb or settings.verb, sampler or settings.sampler
    samples = settings.samples if samples is None else samples
    seed = settings.seed if seed is None else seed
    if not (measure or histories):
        measure = usual_figures(template, verb, judged=True)
    names = tuple(measure)
    if not (names or histories):
        fix = 'name figures: --measure "tip.z.max_abs, verdict.tip"; list prints all'
        raise InputError("--measure", "is missing", fix)
    over_time = _over_time(tuple(histories), times, verb)
    if not 1 <= workers <= WORKERS:
        raise InputError("--workers", f"is {workers}", f"give 1 to {WORKERS}; a --scheduler has any number")
    cases = read_cases(_texts(over), samples, sampler, seed, template.distributions)
    size = len(over_time.names) * over_time.count * len(cases)
    refuse_more("--times", "values of histories", size, HISTORY_BYTES // 8, 8.0, "give fewer times, or fewer cases")
    if not isinstance(measure, Mapping):
        check_figures(verb, names)
    functions = tuple(measure.values()) if isinstance(measure, Mapping) else ()
    share = not functions and may_share(verb, [variation.path for variation in cases.variations])
    inquiry = Inquiry(template, verb, motion, at, options or {}, functions=functions, together=share)
    sweep_identity = {} if store is None else identity(inquiry, cases, names, [over_time.names, over_time.count])
    journal, done = open_journal(store, resume, sweep_identity)
    stored = {row.case for row in done}
    missing_cases = [number for number in range(len(cases)) if number not in stored] if stored else range(len(cases))
    several = workers > 1 and scheduler is None and len(missing_cases) > 1
    with processes(workers, functions) if several else nullcontext() as pool:
        if journal is not None and done:
            begun = go_on(inquiry, cases, missing_cases, done, journal.figures, over_time)
        else:
            begun = start(inquiry, cases, missing_cases, names, over_time)
        inquiry = begun.inquiry
        _confirm(len(missing_cases), begun.seconds / workers, confirmed)
        tried = {row.case for row in begun.rows}
        remaining = len(missing_cases) - len(tried)
        size = int(min(_LONGEST, KEPT / max(begun.seconds, 1e-4), remaining / (4 * workers)))
        tasks = ((number, cases.overrides(number)) for number in missing_cases if number not in tried)
        batches = _batches(tasks, max(1, size // width(inquiry)) * width(inquiry))
        if scheduler is not None:
            computed = on_scheduler(inquiry, batches, scheduler)
        else:
            computed = serially(inquiry, batches) if pool is None else pool.rows(inquiry, batches)
        rows = [*done, *begun.rows]
        if journal is None:
            rows += _collected(computed, rows, len(cases), progress)
        else:
            journal.figures = begun.figures
            with journal.writing(resume=resume):
                journal.add(begun.rows)
                rows += _collected(computed, rows, len(cases), progress, journal)
    answer = assemble_sweep(
        template.title([variation.path for variation in cases.variations]), cases, names, begun, rows, seed
    )
    warnings = () if journal is None else journal.warnings
    return replace(answer, warnings=warnings, notes=template.notes, provenance=template.provenance)


def _over_time(histories: tuple[str, ...], times: int, verb: str) -> OverTime:
    """Histories to measure at a number of times. InputError unless the verb has them."""
    if not histories:
        return NO_HISTORIES
    if verb != "run":
        raise InputError(HISTORY, f"stands with --verb {verb}, which has no history", "leave --verb out")
    if times < 2:
        raise InputError("--times", f"is {times}", "give two or more")
    return OverTime(histories, times)


def _texts(over: Mapping[str, Any] | Sequence[str]) -> list[str]:
    """Variations as texts ``PATH=VALUES``."""
    if not isinstance(over, Mapping):
        return list(over)
    return [f"{path}={values if isinstance(values, str) else _listed(path, values)}" for path, values in over.items()]


def _listed(path: str, values: Iterable[Any]) -> str:
    """Values as text, with commas between them."""
    try:
        return ", ".join(value if isinstance(value, str) else repr(np.asarray(value).item()) for value in values)
    except (TypeError, ValueError):
        fix = "give a list of numbers or texts, or a range as a text, 1 m:12 m:12"
        raise InputError("--over", f"{path} is {values!r}", fix) from None


def _confirm(count: int, seconds: float, confirmed: bool) -> None:
    if count > MANY and not confirmed:
        raise InputError(
            "--over",
            f"makes {count:.4g} cases, which take about {duration(count * seconds)} here",
            "vary less, draw samples instead, or confirm with --yes",
        )


def duration(seconds: float) -> str:
    """Return a duration as text in s, min, h, days or years, with two digits."""
    for size, unit in ((365.25 * 86400, "years"), (86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.2g} {unit}" if seconds < 100 * size else f"{seconds / size:.0f} {unit}"
    return f"{seconds:.2g} s"


def _batches(tasks: Iterator[Task], size: int) -> Iterator[list[Task]]:
    while batch := list(islice(tasks, size)):
        yield batch


def _collected(
    batches: Iterator[list[Row]],
    rows_before: Sequence[Row],
    count: int,
    progress: Progress,
    journal: Journal | None = None,
) -> list[Row]:
    """Rows of all batches. Each batch is written to the journal and reported before the next one is awaited."""
    rows: list[Row] = []
    failed = sum(row.failed for row in rows_before)
    tell(progress, len(rows_before), failed, count)
    for batch in batches:
        if journal is not None:
            journal.add(batch)
        rows += batch
        failed += sum(row.failed for row in batch)
        tell(progress, len(rows_before) + len(rows), failed, count)
    return rows


def assemble_sweep(
    title: str, cases: Cases, names: Sequence[str], begun: Start, rows: Iterable[Row], seed: int
) -> Sweep:
    """Return the sweep of rows in any order. Cases without a row are pending."""
    inquiry = begun.inquiry
    values = np.full((inquiry.width, len(cases)), math.nan)
    outcome = np.full(len(cases), "pending", dtype=object)
    message = np.full(len(cases), "", dtype=object)
    for row in rows:
        values[:, row.case] = row.values
        outcome[row.case], message[row.case] = row.outcome, row.message
    shape, times = cases.shape, len(inquiry.times)
    measures = {name: values[k].reshape(shape) for k, name in enumerate(names)}
    over_time = values[len(names) :].reshape(len(inquiry.histories), times, *shape)
    histories = {history.name: np.moveaxis(over_time[k], 0, -1) for k, history in enumerate(inquiry.histories)}
    answer = Sweep(
        title=title,
        verb=inquiry.verb,
        parameters=tuple(varied.parameter(begun.example.unit(varied.path)) for varied in cases.variations),
        measures=measures,
        units=dict(zip(names, begun.units, strict=True))
        | {history.name: history.unit for history in inquiry.histories},
        outcome=outcome.reshape(shape),
        message=message.reshape(shape),
        histories=histories,
        time=inquiry.times,
    )
    return with_statistics(answer, cases, dict(zip(names, begun.truths, strict=True)), seed) if cases.drawn else answer


def with_statistics(sweep: Sweep, cases: Cases, truths: Mapping[str, bool], seed: int) -> Sweep:
    """Return the sweep with statistics over its samples, which are the last dimension of its measures."""
    independent = slice(cases.independent)
    # Figures of cases that were cut off are left out, such as the peak before a run diverged.
    computed = sweep.computed
    measures = {name: np.where(computed, values, math.nan) for name, values in sweep.measures.items()}
    histories = {name: np.where(computed[..., None], values, math.nan) for name, values in sweep.histories.items()}
    estimates = {name: statistics(values[..., independent], truth=truths[name]) for name, values in measures.items()}
    estimates |= {
        name: statistics(np.swapaxes(values[..., independent, :], -1, -2)) for name, values in histories.items()
    }
    sobol = {}
    if cases.sampler == "saltelli":
        paths = [variation.path for variation in cases.drawn]
        sobol = {name: indices(values, paths, seed) for name, values in measures.items()}
    return replace(sweep, statistics=estimates, indices=sobol)
