"""Values have no state: public objects pickle, copy and compare equal before and after every public function."""

from __future__ import annotations

import copy
import pickle
from contextlib import suppress
from dataclasses import is_dataclass, replace
from inspect import signature
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest

import gbeam as gb

from .solids.bodies import block, solid
from .test_arguments import PUBLIC, Samples, called


@pytest.fixture(scope="module")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Samples:
    return Samples(tmp_path_factory.mktemp("samples"))


def state(value: Any, path: str = "") -> dict[str, bytes]:
    """All that a value holds, by its path: every attribute, also one that is no field, and every array to its bits."""
    if isinstance(value, np.ndarray):
        return {path: value.tobytes() + str((value.shape, value.dtype)).encode()}
    if isinstance(value, (list, tuple)):
        inside = {f"[{i}]": each for i, each in enumerate(value)}
    elif isinstance(value, dict):
        inside = {f"[{key}]": each for key, each in value.items()}
    elif type(value).__module__.startswith("gbeam") and hasattr(value, "__dict__"):
        inside = {f".{name}": each for name, each in vars(value).items()}
    else:
        return {path: repr(value).encode()}
    return {path: type(value).__name__.encode()} | {
        at: each for name, part in inside.items() for at, each in state(part, path + name).items()
    }


def values(*some: Any) -> list[Any]:
    """The records and other dataclasses among some values, and in lists, tuples and dictionaries of these."""
    inside = [list(each.values()) if isinstance(each, dict) else each for each in some]
    nested = [part for each in inside if isinstance(each, (list, tuple)) for part in values(*each)]
    return [each for each in inside if is_dataclass(each) and not isinstance(each, type)] + nested


@pytest.mark.parametrize("name", [name for name in PUBLIC if name != "rerun"])  # which takes a file, not a value
def test_no_public_function_changes_what_it_is_given(
    samples: Samples, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its arguments keep every attribute; they and its answer are pickled and copied, and stay equal to the copies."""
    monkeypatch.chdir(tmp_path)
    args, keywords = samples.calls()[name]
    before, copies = state((args, keywords)), [copy.deepcopy(each) for each in values(args, keywords)]
    answer = called(getattr(gb, name), *args, **keywords)
    assert state((args, keywords)) == before
    assert values(args, keywords) == copies
    for each in values(args, keywords, answer):
        if isinstance(each, gb.Choice) and name == "Choice":
            continue  # the caller's own function in it decides
        whole = state(each)
        assert copy.deepcopy(each) == each and pickle.loads(pickle.dumps(each)) == each, type(each)
        assert repr(each) and state(each) == whole


def test_results_stay_what_they_are_when_they_are_shown(samples: Samples, tmp_path: Path) -> None:
    for result in (*samples.responses, gb.study(samples.case), gb.compare(*samples.responses)):
        before = state(result)
        result.to_xarray()
        result.plot()
        result.save(tmp_path / "result.nc")
        result.report(tmp_path / "result.html") if not isinstance(result, gb.Comparison) else None
        assert state(result) == before


def test_what_is_made_of_equal_values_is_equal(samples: Samples, tmp_path: Path) -> None:
    """Made twice, after all else was done with the first; and another number makes another value."""
    again = Samples(tmp_path)
    names = [name for name, value in vars(samples).items() if values(value) and name != "case"]
    assert {"beam", "structure", "column", "centrifuge", "free_hub", "settings", "responses", "system"} <= {*names}
    for name in names:
        assert getattr(again, name) == getattr(samples, name), name
    assert replace(again.case, provenance=None) == replace(samples.case, provenance=None)  # of two files
    assert hash(again.structure) == hash(samples.structure) and hash(again.beam) == hash(samples.beam)


def test_a_case_is_shown_on_one_line(samples: Samples) -> None:
    named = replace(samples.case, title="a panel")
    assert repr(named) == "Case('a panel', FOAM, {flight: flight, spin: centrifuge}, 0.5 s)"


@pytest.mark.parametrize("name", [name for name in PUBLIC if isinstance(getattr(gb, name), type)])
def test_objects_are_shown_on_one_short_line(samples: Samples, name: str) -> None:
    args, keywords = samples.calls()[name]
    text = repr(getattr(gb, name)(*args, **keywords))
    assert text.startswith(f"{name}(") and "\n" not in text and len(text) < 320


def test_objects_are_shown_by_what_is_not_as_by_default(samples: Samples) -> None:
    strip = "Section(shape='rectangle', width=0.02, thickness=0.004)"
    assert repr(samples.beam.section) == strip
    assert (
        repr(samples.beam) == f"Beam(length=0.3, section={strip}, material={samples.beam.metal!r}, damping_ratio=0.01)"
    )
    assert repr(gb.tabulated(np.arange(9.0), np.zeros(9))) == "PiecewiseLinear(times=<9 numbers>, values=<9 numbers>)"
    assert repr(gb.SmoothStep(1.0, 2.0)) == "SmoothStep(level=1, duration=2)"
    shown: list[str] = []
    jax.grad(lambda level: shown.append(repr(gb.SmoothStep(level, 2.0))) or level)(1.0)
    assert shown == ["SmoothStep(level=traced, duration=2)"]


def test_another_number_makes_another_value(samples: Samples) -> None:
    response = samples.responses[0]
    assert replace(response, step=0.5 * response.step) != response != samples.responses[1]
    moved = response.place.copy()
    moved[-1, -1, -1] += 1e-12
    assert replace(response, place=moved) != response
    body = replace(response.body, displacement=response.displacement + 1e-12)
    assert replace(response, bodies={"beam": body}) != response
    thicker = replace(samples.beam, section=gb.Section.rectangle(0.02, 0.0041))
    assert thicker != samples.beam and gb.assemble(thicker, "FOAM", axial=0, y=1, z=1) != samples.structure
    assert gb.Load(0.1, force=np.array([0.0, 0.0, 1.0])) == gb.Load(0.1, force=np.array([0.0, 0.0, 1.0]))
    assert gb.Load(0.1, force=np.array([0.0, 0.0, 1.0])) != gb.Load(0.1, force=np.array([0.0, 0.0, 2.0]))


@pytest.mark.parametrize("kind", ["TLAM", "SFOAM", "CFOAM", "exact"])
def test_a_structure_of_every_model_keeps_its_fields_alone(samples: Samples, kind: str) -> None:
    structure = gb.assemble(samples.beam, kind, axial=int(kind in ("CFOAM", "exact")), y=0, z=2)
    before = state(structure)
    gb.simulate(structure, samples.still, duration=0.05, step=5e-3)
    gb.modes(structure, samples.hub)
    gb.static(structure, samples.still)
    assert state(structure) == before


def test_a_machine_keeps_its_fields_alone(samples: Samples) -> None:
    """Planned, with or without a span: nothing is written into it when its motion is needed."""
    options: dict[str, Any] = {"arm": 3.3, "control_point": 0.2, "gravity": False, "start": "idle"}
    machine = gb.Centrifuge(samples.flight, idle=5.0, **options)
    waiting = machine.over(0.0, 0.3, ahead=False)
    before = state((machine, waiting))
    first, second = waiting.extent, waiting.axes(0.2)
    waiting.usage()
    gb.simulate(samples.structure, machine, duration=0.3, step=5e-3, estimate=False)
    assert state((machine, waiting)) == before and (waiting.extent, waiting.axes(0.2)) == (first, second)
    prepared = machine.over(0.0, 0.3)
    assert prepared == machine.over(0.0, 0.3) == pickle.loads(pickle.dumps(prepared)) != waiting


def kept(before: Any, calls: list[Any]) -> None:
    """No call changes a value; the value and all answers are pickled and copied, and stay equal to the copies."""
    whole, other = state(before), copy.deepcopy(before)
    answers = [call() for call in calls]
    assert state(before) == whole and before == other
    for each in (before, *answers):
        inside = state(each)
        assert copy.deepcopy(each) == each and pickle.loads(pickle.dumps(each)) == each, type(each)
        assert repr(each) and state(each) == inside


def test_a_system_with_a_controller_keeps_its_fields_alone(samples: Samples) -> None:
    law = gb.Feedback(samples.law, ["hinge.angle"], ["hinge.angle"], 0.01)
    joints = {"hinge": replace(samples.hinge, stiffness={"angle": 5.0}), "root": gb.Joint("fixed", "panel", "bar.end")}
    bodies = {"bar": samples.bar, "panel": samples.structure}
    system = gb.System(bodies, joints, controllers={"law": law})
    settings = gb.ResponseSettings(duration=0.05, step=5e-3, integrator="gauss")
    case = gb.Case("swing", system, {"flight": samples.still}, settings)
    kept(
        system,
        [
            lambda: gb.simulate(system, samples.still, settings),
            lambda: gb.static(system, samples.still),
            lambda: gb.modes(system, samples.still),
            lambda: gb.linearize(system, inputs=["hinge.angle"]),
            lambda: gb.study(case),
        ],
    )


def test_a_solid_and_a_specimen_keep_their_fields_alone(samples: Samples) -> None:
    mesh = solid(block("hexahedron20", (3, 1, 1), (0.1, 0.01, 0.01)))
    model = mesh.reduced(modes=2, damping_ratio=0.01)
    kept(mesh, [lambda: mesh.reduced(modes=2, damping_ratio=0.01)])
    kept(
        model,
        [
            lambda: model.stress(gb.static(model.structure, samples.still)),
            lambda: gb.simulate(model.structure, samples.still, samples.settings),
            lambda: gb.modes(model.structure),
        ],
    )
    box = gb.RigidSpecimen.box(1.0, (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
    kept(box, [lambda: box.loads(samples.flight, 0.3, sample=0.01)])


def test_what_is_asked_of_a_public_object_changes_nothing(samples: Samples, tmp_path: Path) -> None:
    """All its properties, and its methods that take nothing, or times and coordinates."""
    classes = [each for name, each in vars(gb).items() if name in PUBLIC and isinstance(each, type)]
    objects = [kind(*args, **keywords) for kind in classes for args, keywords in [samples.calls()[kind.__name__]]]
    objects += [samples.structure, *samples.responses, samples.system, gb.study(samples.case)]
    at = {"t": 0.05, "time": 0.05, "times": [0.0, 0.05], "start": 0.0, "end": 0.1, "step": 0.01, "x": np.array([0.1])}
    known = at | {"path": tmp_path / "result.nc", "q": np.zeros(samples.structure.size)}
    asked = 0
    for each in objects:
        before, other = state(each), copy.deepcopy(each)
        for name in (name for name in dir(type(each)) if not name.startswith("_")):
            with suppress(gb.InputError):  # of what this one does not have
                value = getattr(each, name)
                asked += 1
                if callable(value):
                    needed = {p.name for p in signature(value).parameters.values() if p.default is p.empty}
                    if needed <= known.keys():
                        value(**{key: known[key] for key in needed})
        assert state(each) == before and each == other, type(each)
    assert len(objects) > 35 and asked > 300
