"""The registry of figures: which ones a result has, by name, and the functions that describe them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from typing import Any, get_args, get_origin

from gbeam.errors import InputError
from gbeam.figures import bodies, imitation, machine, records, response, steady, studies
from gbeam.figures.description import Figure
from gbeam.printable import closest
from gbeam.results.body_response import BodyResponse
from gbeam.results.cases import PROBABILITY, Sensitivity, Sweep
from gbeam.results.comparison import Comparison, MachinePlan
from gbeam.results.description import Description, RecordSummary
from gbeam.results.equilibrium import Critical, CriticalMap, EquilibriumPath, Rest
from gbeam.results.machine import AxesResult
from gbeam.results.modal import Campbell, Modes
from gbeam.results.placement import Placement
from gbeam.results.response import Response
from gbeam.results.result import Figured
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.solids import SolidStress, SpecimenLoads
from gbeam.results.state_space import StateSpace
from gbeam.results.study import ModelStudy, Study
from gbeam.results.system import joint_histories

Describe = Callable[[], Figure]
# Of kinds that always have the same.
_OF: dict[type[Figured[Any]], tuple[Callable[..., Figure], ...]] = {
    Modes: (steady.modes,),
    Campbell: (steady.campbell,),
    CriticalMap: (steady.critical_map,),
    EquilibriumPath: (steady.path,),
    StateSpace: (steady.poles,),
    Placement: (imitation.placement,),
    Fit: (studies.fit,),
    Optimum: (studies.optimum,),
    ShapedCommand: (studies.shaping, studies.robustness),
    SolidStress: (bodies.stress,),
    SpecimenLoads: (bodies.specimen,),
}


def figure_of(result: Any, what: str = "", title: str = "") -> Figure:
    """Describe one figure of a result: the one of that name, or the first that it has."""
    descriptions = figures_of(result, title)
    if not descriptions:
        raise InputError("result", "has nothing to draw", "print it")
    if what and what not in descriptions:
        guess = closest(what, descriptions)
        guess_words = f"did you mean {guess!r}? " if guess else ""
        fix = f"{guess_words}choose from {', '.join(descriptions)}"
        raise InputError("what", f"is {what!r}, which this result does not have", fix)
    return descriptions[what or next(iter(descriptions))]()


def figures_of(result: Any, title: str = "") -> dict[str, Describe]:
    """Return the functions that describe the figures of a result, or of several of one kind, by the figures' names."""
    match result:
        case Rest():
            return _of_rests((result,), title)
        case (Rest(), *_):
            return _of_rests(result, title)
        case (MachinePlan(), *_):
            return _by_motion({plan.name: figures_of(plan, title) for plan in result})
        case Study():
            return _of_study(result, title or result.title)
        case Response():
            return _of_tips(Study(title, {result.name or result.environment: result})) | _of_response(result, title)
        case ModelStudy():
            return {"models": partial(response.models, result, title)} if any(len(r.time) for r in result.rows) else {}
        case Comparison():
            return _of_comparison(result, title, "parts", "parts ")
        case MachinePlan():
            return _of_machine(result, result.axes, title)
        case Critical():
            return {"critical": partial(steady.critical, result, title)} if len(result.followed) else {}
        case Sweep():
            return _of_sweep(result, title)
        case Description():
            return _of_records(result.records, title or result.title)
        case Modes() if not len(result.frequency):
            return {}
        case Sensitivity():
            return {name: partial(studies.sensitivity, result, name, title) for name in result.measures}
    described = _OF.get(type(result))
    if described is None:
        return {}
    names = figure_names(type(result))
    return {name: partial(describe, result, title) for name, describe in zip(names, described, strict=True)}


def figure_names(kind: type[Figured[Any]]) -> tuple[str, ...]:
    """Names of the figures that results of a kind can have; none where they follow from what a result holds."""
    for ancestor in kind.__mro__:
        for base in vars(ancestor).get("__orig_bases__", ()):
            if get_origin(base) is Figured:
                return get_args(get_args(base)[0])
    raise TypeError(f"{kind.__name__} has no figures")


def _of_records(summaries: Mapping[str, RecordSummary], title: str) -> dict[str, Describe]:
    """Figures of the records that were read, and of each file of which only parts are flown, by the
    names of flights.
    """
    read = {name: summary for name, summary in summaries.items() if summary.as_read is not None}
    described: dict[str, Describe] = {}
    for name, summary in read.items():
        same_file = {flight: record for flight, record in read.items() if record.as_read is summary.as_read}
        if next(iter(same_file)) == name and any(record.is_part for record in same_file.values()):
            described[f"file {name}"] = partial(records.file, same_file, title)
    return described | {f"record {name}": partial(records.record, read[name], name, title) for name in read}


def _by_motion(figures_by_motion: Mapping[str, dict[str, Describe]]) -> dict[str, Describe]:
    """Figures of several results of one kind, each with the name of its motion."""
    figures: dict[str, Describe] = {}
    for name, described in figures_by_motion.items():
        figures |= {f"{kind} {name}": describe for kind, describe in described.items()}
    return figures


def _of_rests(rests: Sequence[Rest], title: str = "") -> dict[str, Describe]:
    """Figures of states of rest in several motions: one of all together, then the loads of each body that bends."""
    bending = [rest for rest in rests if rest.several or rest.specimen is None]
    described: dict[str, Describe] = {"static": partial(steady.static, bending, title)} if bending else {}
    for rest in bending:
        for name, body in rest.bodies.items():
            if body.loads is not None and body.bends:
                words = " ".join(filter(None, ("loads", name if len(rest.bodies) > 1 else "", rest.motion)))
                described[words] = partial(steady.loads_at_rest, rest, name, title)
    return described


def _of_sweep(result: Sweep, title: str) -> dict[str, Describe]:
    """Figures of a sweep: measures over at most two dimensions, probabilities over one, Sobol indices and histories."""
    described: dict[str, Describe] = {}
    few = len(result.dimensions) <= 2
    for name in result.measures:
        is_probability = name in result.statistics and PROBABILITY in result.statistics[name].names
        if is_probability and len(result.dimensions) == 2:
            described[name] = partial(studies.probability, result, name, title)
        elif few and not is_probability:
            described[name] = partial(studies.sweep, result, name, title)
    described |= {f"{name} indices": partial(studies.indices, result, name, title) for name in result.indices}
    return described | {f"{name} history": partial(studies.history, result, name, title) for name in result.histories}


def _of_machine(result: Response | MachinePlan, axes: AxesResult, title: str) -> dict[str, Describe]:
    """Figures of a machine: tracking of the load, and rate, acceleration and, if known, jerk of its axes."""
    quantities = ("rate", "acceleration", *(["jerk"] if axes.jerk is not None else []))
    return {
        "tracking": partial(machine.tracking, result, axes, title),
        **{f"axes_{quantity}": partial(machine.axes_of, result, axes, quantity, title) for quantity in quantities},
    }


def _of_response(result: Response, title: str) -> dict[str, Describe]:
    """Figures of a response, of the parts that it holds, by name; those of its tips are not among them."""
    described: dict[str, Describe] = {}
    free_hub = result.hub is not None and result.base is None  # the hub's figure has its coordinate
    joints = {} if free_hub else joint_histories(result)
    if result.several and (result.largest.any() or not joints):
        described["points"] = partial(response.points, result, title)
    if joints:
        described["coordinates"] = partial(response.coordinates, result, joints, title)
    base = next((body.base for body in result.bodies.values()), None) if free_hub else result.base
    if base is not None:
        described["base"] = partial(response.base, result, base, title)
    if result.readings is not None:
        described["sensors"] = partial(response.sensors, result, result.readings, title)
    if result.loop is not None:
        described["loop"] = partial(response.loop, result, result.loop, title)
    for name, body in result.bodies.items():
        body_figures = _of_body(result, name, body, title)
        described |= {_figure_name(kind, name, result.bodies): describe for kind, describe in body_figures.items()}
    if result.axes is not None:
        described |= _of_machine(result, result.axes, title)
    if result.hub is not None:
        described[result.environment] = partial(response.hub, result, result.hub, title)
    if result.invariants is not None:
        described["energy"] = partial(response.energy, result, result.invariants, title)
    return described


def _of_body(result: Response, name: str, body: BodyResponse, title: str) -> dict[str, Describe]:
    """Figures of one body of a response: loads of a rigid specimen; or loads of its root and supports, and stress of a
    mesh.
    """
    if body.specimen is not None:
        return {"specimen": partial(bodies.specimen, body.specimen, title)}
    described: dict[str, Describe] = {}
    if body.loads is not None:
        described["loads"] = partial(bodies.loads, result, name, title)
        if body.loads.support_force is not None:
            described["supports"] = partial(bodies.supports, result, name, title)
    if body.solid is not None:
        described["stress"] = partial(bodies.stress, body.solid, title)
    return described


def _figure_name(kind: str, body: str, names: Collection[str]) -> str:
    """Name of a figure of a body, with that of the body where there are several."""
    return f"{kind} {body}" if len(names) > 1 else kind


def _of_comparison(result: Comparison, title: str, main: str, side: str, end: str = "") -> dict[str, Describe]:
    """Figures of a comparison, `main` along the axis in which the tip moves most, `side` along others; and shock."""
    first, *further_axes = imitation.moved_axes(result)
    described: dict[str, Describe] = {f"{main}{end}": partial(imitation.parts, result, first, title)}
    described |= {f"{side}{'xyz'[i]}{end}": partial(imitation.parts, result, i, title) for i in further_axes}
    if result.shock is not None:
        described[f"shock{end}"] = partial(imitation.shock, result, result.shock, title)
    return described


def _of_study(study: Study, title: str) -> dict[str, Describe]:
    """Figures of a study: the tips, the sizes of the loads, every response, and the comparisons."""
    names, described = response.bodies(study), _of_tips(study)
    for body in names:
        with_loads = [
            run for run in study.responses.values() if body in run.bodies and run.bodies[body].loads is not None
        ]
        if len(with_loads) > 1:
            described[_figure_name("sizes", body, names)] = partial(response.sizes, study, body)
    described |= _by_motion({name: _of_response(run, title) for name, run in study.responses.items()})
    return described | _of_comparisons(study, title)


def _of_tips(study: Study) -> dict[str, Describe]:
    """Figures of the tip of every body, in all of a study's motions together; a rigid specimen has none."""
    names, described = response.bodies(study), dict[str, Describe]()
    for body in names:
        runs = [run for run in study.responses.values() if body in run.bodies]
        if any(run.bodies[body].specimen is None for run in runs):
            described[_figure_name("tip", body, names)] = partial(response.tip, study, body)
    return described


def _of_comparisons(study: Study, title: str) -> dict[str, Describe]:
    """Figures of a study's comparisons, by the names of their centrifuges."""
    described: dict[str, Describe] = {}
    for comparison in study.comparisons:
        pair_figures = _of_comparison(comparison, title, "comparison", "comparison_", f" {comparison.centrifuge}")
        has_parts = comparison.root or comparison.stations or comparison.load_difference
        at_tip = any(response.at_tip(comparison, body) for body in response.bodies(study))
        if at_tip and not has_parts:  # it is the difference that the tip's figure shows already
            pair_figures = {name: describe for name, describe in pair_figures.items() if name.startswith("shock")}
        described |= pair_figures
    return described
