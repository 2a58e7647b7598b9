"""Every public function refuses objects of the wrong type by the argument's name, and options that it does not have."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import fields as dataclass_fields
from dataclasses import replace
from decimal import Decimal
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis import Settings
from gbeam.guards import kind_of_argument

from .scenarios import FAST, FREE_HUB

RESULTS = {
    "Comparison", "Fit", "Modes", "Optimum", "Response", "Rest", "Sensitivity", "ShapedCommand", "StateSpace", "Study",
    "Sweep",
}  # fmt: skip
NO_FUNCTIONS = {
    "GbeamError",
    "ComputationError",
    "InputError",
    "SolidMesh",
    "SolidModel",
    "Structure",
    "machines",
}  # SolidMesh.read, its `reduced` and gb.assemble make them
PUBLIC = [name for name in gb.__all__ if name not in RESULTS | NO_FUNCTIONS]
WRONG: list[Any] = [
    object(), None, "nonsense", b"nonsense", 2 + 3j, [object()], ["nonsense"], {"nonsense": object()}, {1, 2}, gb.Beam,
    gb, np.array(["nonsense"]), lambda *_: object(),
]  # fmt: skip


def straight(x: Any) -> Any:
    return np.zeros((len(x), 3))


class Samples:
    """Arguments with which the public functions can be called."""

    def __init__(self, folder: Path) -> None:
        self.beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
        self.structure = gb.assemble(self.beam, "FOAM", axial=0, y=1, z=1)
        pressed = replace(self.beam, loads=[gb.Load(0.3, force=(-1.0, 0.0, 0.0))])
        self.column = gb.assemble(pressed, "FOAM", axial=0, y=1, z=1)
        self.flight = gb.Flight(z=gb.trapezoid(60.0, jerk=600.0, start=0.05, hold=0.2))
        self.still = gb.Flight(z=30.0)
        self.hub = gb.Hub(radius=0.5, rate=1.0)
        self.free_hub = gb.Hub(radius=0.5, inertia=200.0)
        self.settings = gb.ResponseSettings(duration=0.1, step=5e-3, estimate=False)
        self.centrifuge = gb.Centrifuge(
            self.still, arm=3.3, control_point=0.2, gravity=False, inverse="flat", start="idle"
        )
        self.responses = [
            gb.simulate(self.structure, motion, self.settings, name=name)
            for name, motion in {"flight": self.still, "machine": self.centrifuge}.items()
        ]
        self.fast, self.slew, self.data = folder / "fast.toml", folder / "hub.toml", folder / "data.csv"
        self.fast.write_text(FAST + "estimate = false\n", encoding="utf-8")
        self.slew.write_text(FREE_HUB + "estimate = false\n", encoding="utf-8")
        self.data.write_text("mode,frequency\n1,38\n2,180\n", encoding="utf-8")
        self.matrix = folder / "k.npy"
        np.save(self.matrix, np.eye(2))
        self.record = Path(__file__).parents[1] / "examples" / "data" / "f16_8g_turn.csv"
        self.case = gb.read_scenario(self.fast)
        self.brief = gb.Case.of_beam(
            "brief", self.beam, gb.Model("FOAM", y=1, z=1), {"flight": self.still}, self.settings
        )
        self.system = gb.linearize(self.structure, self.hub)
        self.bar = gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"end": (0.1, 0.0, 0.0)})
        self.law = (np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), -np.ones((1, 1)))
        self.hinge = gb.Joint("revolute", "bar", axes=[(0.0, 1.0, 0.0)])

    def calls(self) -> dict[str, tuple[tuple[Any, ...], dict[str, Any]]]:
        base = self.flight.base(0.0)
        origin = self.case.scenario
        columns = ("time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
        settings = {"duration": 0.1, "step": 5e-3, "estimate": False}
        beam = (0.3, self.beam.section, gb.Material(2700, 70e9, expansion=23e-6))
        return {
            "AxisLimit": ((1.0, 1.0, 1.0), {}),
            "Beam": (
                beam,
                {
                    "masses": [gb.PointMass(0.1, 0.1)],
                    "supports": [gb.Support(0.2, ["z"])],
                    "temperature": gb.Temperature(300.0, 293.15),
                    "loads": [],
                    "root": gb.Root(),
                    "damping_ratio": 0.01,
                    "points": [gb.Point("camera", 0.1)],
                    "rotary_inertia": True,
                    "line": gb.Line.of_pieces([0.3]),
                },
            ),
            "Case": (
                ("case", gb.System({"bar": self.bar}, {"hinge": self.hinge}), {}, self.settings),
                {"tracks": {}, "accept": {}, "sensors": {"bar.root": gb.Sensor()}, "read_from": origin,
                 "spans": {}},
            ),
            "Centrifuge": (
                (self.still,),
                {
                    "arm": 3.3, "control_point": 0.2, "gravity": False, "inverse": "flat", "start": "idle",
                    "limits": None, "idle": None, "smoothing": 0.0, "mounting": "upright", "turn": (0.0, 0.0, 0.1),
                    "spin_up": None, "spin_down": None, "clip": False, "ease": 1.0, "span": (0.0, 0.2),
                },
            ),
            "Choice": ((lambda mounting, width: self.centrifuge, ("upright",), (0.0,)), {"refined": True,
            "limited": True, "turns": (), "between": False}),
            "Feedback": (
                (self.law, ["hinge.angle"], ["hinge.angle"], 0.01),
                {"delay": 0.01, "limit": 5.0, "reference": 0.1, "state": None},
            ),
            "Flight": ((), {"x": 1.0, "y": 2.0, "z": 3.0, "scale": 1.25}),
            "Gauge": ((0.1,), {"y": 0.0, "z": 0.002, "along": (1.0, 0.0, 0.0), "body": ""}),
            "Hub": (
                (),
                {
                    "radius": 0.5, "rate": 1.0, "inertia": 2.0, "pointing": "outward",
                    "setting_angle": None, "turn": (0.0, 0.0, 1.0), "control_point": (0.1, 0.0, 0.0),
                    "gravity": (0.0, 0.0, -9.8), "stiffness": 0.0, "damping": 0.0, "standard": "a test",
                },
            ),
            "Initial": (("undeformed",), {"tip_velocity": {"z": 0.1}, "velocity": {"tip": {"y": 0.1}}}),
            "Line": ((0.3, straight), {"breaks": [0.1], "corners": [0.2], "turns": [[0.0, 0.0, 0.1]]}),
            "Load": ((0.1,), {"force": (0.0, 0.0, 1.0), "moment": (0.0, 1.0, 0.0), "distributed": None,
                              "distributed_moment": None, "follower": False}),
            "Joint": (
                ("revolute", "bar"),
                {
                    "on": "ground", "axes": [(0.0, 1.0, 0.0)], "at": (0.1, 0.0, 0.0), "turn": (0.0, 0.0, 0.2),
                    "initial": 0.1, "initial_rate": 0.2, "stiffness": 2.0, "ease": 0.1, "damping": 0.1,
                    "friction": 0.1, "stops": (-1.0, 1.0), "stop_stiffness": 10.0, "rate": None, "effort": 1.0,
                    "coupling": None,
                },
            ),
            "Place": (((0.1, 0.0, 0.0),), {"turn": (0.0, 0.0, 0.2)}),
            "PointForce": (("bar.end",), {"force": (0.0, 0.0, 1.0), "moment": (0.0, 1.0, 0.0), "follower": False}),
            "RigidBody": (
                (1.0, (1.0, 1.0, 1.0)),
                {"centre": (0.1, 0.0, 0.0), "points": {"end": gb.Place((0.1, 0.0, 0.0))}},
            ),
            "System": (
                ({"bar": self.bar}, {"hinge": self.hinge}),
                {"forces": {"push": gb.PointForce("bar.end")}, "gravity": (0.0, 0.0, -9.8), "controllers": {}},
            ),
            "MachineLimits": ((gb.AxisLimit(), gb.AxisLimit(), gb.AxisLimit()), {"inertia": 1.0, "power": 1.0}),
            "Material": (
                (2700.0, 70e9),
                {"yield_strength": 1e8, "fatigue_exponent": 5.0, "poissons_ratio": 0.3, "shear_modulus": 26e9,
                 "expansion": 23e-6},
            ),
            "Model": (
                ("exact", 1, 1, 1),
                {"shapes": "clamped-free", "automatic": False, "twist": 1, "shear_y": 1, "shear_z": 1},
            ),
            "Orthotropic": (
                (1900.0, (22e9, 22e9, 10e9), (0.15, 0.3, 0.3), (5e9, 3e9, 3e9), ((1, 0, 0), (0, 1, 0))),
                {"expansions": (16e-6, 16e-6, 55e-6)},
            ),
            "Point": (("camera", 0.1), {}),
            "Temperature": ((300.0, 293.15), {}),
            "Support": ((0.2,), {"holds": ["z"], "stiffness": {"ry": 5.0}, "damping": {"ry": 0.1}}),
            "PointMass": ((0.1, 0.1), {"inertia": (0.0, 0.0, 0.0), "offset": (0.0, 0.0, 0.0), "name": "body"}),
            "ResponseSettings": (
                (1.0,),
                {
                    "start": 0.0, "step": 0.1, "integrator": "newmark", "parameters": {}, "tolerance": 0.01,
                    "residual_from": None, "initial": "equilibrium", "estimate": True, "loads": True, "histories": 0.1,
                },
            ),
            "RigidSpecimen": (
                (1.0, (0.0, 0.0, 0.0), np.eye(3), [(0.1, 0.0, 0.0)]),
                {
                    "bolts": np.eye(3), "bolt_axis": (0.0, 0.0, 1.0), "spread_limit": 0.1, "points": {"lid": (0, 0, 1)},
                    "supports": (),
                },
            ),
            "Root": (
                (),
                {
                    "translation_x": 1e6, "translation_y": 1e6, "translation_z": 1e6,
                    "rotation_x": 1e3, "rotation_y": 1e3, "rotation_z": 1e3,
                },
            ),
            "Section": (("rectangle", {"width": (0.02,), "thickness": (0.004,)}), {"stations": (), "plate": False}),
            "Sine": ((1.0, 1.0, 0.0), {}),
            "SmoothStep": ((1.0, 1.0, 0.0), {}),
            "SplineProfile": ((1.0, [0.0] * 12), {"start": 0.0}),
            "Sum": (((gb.constant(1.0), gb.constant(2.0)),), {}),
            "assemble": (
                (self.beam, "FOAM", (0.1,)),
                {"axial": 0, "y": 1, "z": 1, "shapes": "clamped-free", "twist": 0, "shear_y": 0, "shear_z": 0},
            ),
            "balanced_truncation": ((self.system, 2), {}),
            "buckling_acceleration": ((self.structure,), {"time": 0.0, "upper": None, "progress": None}),
            "build_target": (
                (gb.vector(z=30.0),),
                {"span": (0.0, 1.0), "idle": None, "smoothing": 0.0, "gravity": False, "arm": 3.3, "clip": False,
                "leave_out": ()},
            ),
            "campbell": (
                (self.structure, self.hub),
                {"turning": None, "time": 0.0, "speeds": [0.0, 1.0],
                "start": 0.0, "end": None, "count": 3, "modes": 2, "orders": (1, 2),
                "name": "hub", "progress": None},
            ),
            "choice_of": ((self.centrifuge, (0.05,)), {"limited": False, "turns": "own"}),
            "axis_commands": ((self.centrifuge.over(0.0, 0.1), 0.01), {}),
            "compare": (
                tuple(self.responses),
                {
                    "point": None, "tolerance": 0.05, "tolerance_of": "peak", "accept": {"tip": 0.5},
                    "control": {"tip": 1.0},
                    "damage_at": "tip", "stress_at": "tip", "sensors": {"tip": gb.Sensor()},
                },
            ),
            "compare_models": ((self.brief,), {"kinds": ("FOAM",), "progress": None, "point": None}),
            "constant": ((1.0,), {}),
            "equilibrium_path": (
                (self.structure, self.flight, 0.2),
                {"vary": "motion", "upper": 0.5, "errors": False, "name": "", "progress": None},
            ),
            "critical_load": ((self.column, base), {"time": 0.0, "motion": None, "upper": None, "progress": None}),
            "critical_speed": (
                (self.structure, self.hub),
                {"turning": None, "time": 0.0, "upper": None, "name": "hub", "progress": None},
            ),
            "critical_speed_map": (
                (self.beam, gb.Model("FOAM", y=1), self.hub, [0.1], [0.2]),
                {"upper": None, "name": "hub", "progress": None},
            ),
            "describe": ((self.case,), {}),
            "fit": (
                (self.fast, self.data, ["beam.material.youngs_modulus"]),
                {
                    "bounds": None, "motion": "flight", "at": 0.0, "options": None, "starts": 1, "overrides": (),
                    "progress": None,
                },
            ),
            "linearize": (
                (self.structure, self.hub, 0.0),
                {
                    "rate": None, "q": None, "qd": None, "gauges": [gb.Gauge(0.1, z=0.002)], "name": "hub",
                    "inputs": None, "outputs": None, "at": "rest", "loop": "open", "progress": None,
                },
            ),
            "modal_truncation": ((self.system, 1), {}),
            "modes": (
                (self.structure, self.hub, 0.0),
                {"gyroscopic": True, "errors": False, "name": "hub", "progress": None},
            ),
            "nonlinear_system": ((self.structure, self.free_hub), {"gauges": [gb.Gauge(0.1, z=0.002)]}),
            "optimise": (
                (self.fast, "flight.tip.z", ["beam.section.width"]),
                {
                    "subject_to": (), "bounds": None, "verb": "static", "motion": "flight", "at": 0.0, "options": None,
                    "starts": 1, "overrides": (), "progress": None,
                },
            ),
            "place": (
                (self.structure, self.still, gb.choice_of(self.centrifuge, (0.0,), limited=False), self.settings,
                {"tip": 1.0}),
                {
                    "current": self.centrifuge, "names": ("flight", "machine"), "check": False, "along": "x",
                    "progress": None,
                },
            ),
            "plan": (
                ("machine", self.centrifuge.over(0.0, 0.1), "flight"),
                {
                    "specimen": self.structure, "tolerance": 0.05, "tolerance_of": "peak", "accept": {"tip": 0.5},
                    "title": "a", "progress": None,
                },
            ),
            "ImportedModel": (
                (),
                {
                    "mass": np.eye(3),
                    "stiffness": np.eye(3),
                    "nodes": [(0.1, 0, 0)],
                    "unknowns": [(0, 1), (0, 2), (0, 3)],
                    "numbers": [1],
                },
            ),
            "ModalTest": (
                ([20.0], [0.01], np.ones((1, 3, 1)), [(0.3, 0.0, 0.0)], [0.1]),
                {"numbers": [1]},
            ),
            "Sensor": (
                (),
                {"turn": (0.0, 0.0, 0.1), "frequency": 100.0, "damping_ratio": 0.7, "sensitivity": np.eye(3)},
            ),
            "read_matrix": ((self.matrix, "k"), {}),
            "read_sid": (
                (Path(__file__).parents[1] / "examples" / "data" / "strip.sid",),
                {"damping_ratio": 0.1, "points": {"tip": 2}, "kind": "arm", "supports": ()},
            ),
            "read_record": (
                (self.record, *columns),
                {
                    "time_unit": "s", "sample_rate": None, "quantity": "specific-force", "vehicle": "aircraft",
                    "turn": (0.0, 0.0, 0.1), "level": None, "span": (None, 0.1), "rest": (), "sections": None,
                    "section": None,
                },
            ),
            "read_scenario": ((self.fast, ["beam.length=250 mm"]), {}),
            "rerun": ((self.fast,), {"progress": None}),
            "sensitivity": (
                (self.fast, ["flight.tip.z"], ["beam.section.width"]),
                {"verb": "static", "motion": "flight", "at": 0.0, "options": None, "overrides": (), "progress": None},
            ),
            "shape_hub_command": (
                (self.slew,),
                {
                    "angle": 1.0, "rate": None, "distance": None, "duration": 2.0, "limit": 1e6, "robust": 0.0,
                    "check": "", "motion": "slew", "joint": None, "point": None,
                    "overrides": (), "progress": None,
                },
            ),
            "shape_command": (
                (gb.assemble(self.beam, "FOAM", y=1), self.free_hub),
                {
                    "angle": 1.0, "rate": None, "distance": None, "duration": 0.5, "limit": 1e6, "robust": 0.0,
                    "pieces": 12, "check": None, "point": None,
                    "progress": None,
                },
            ),
            "simulate": ((self.structure, self.still), {"name": "flight", "progress": None, **settings}),
            "simulate_batch": (
                ([(self.structure, self.still)],),
                {"together": 2, "one_structure": False, "progress": None, **settings},
            ),
            "plain_arm": (
                (),
                {
                    "radius": 3.3, "control_point": (0.1, 0.0, 0.0), "load": (1.0, 0.0, 0.0), "up": (0.0, 0.0, 1.0),
                    "level": 90.0, "onset": None, "ramp": 20.0, "dwell": 60.0, "down": 10.0, "gravity": True,
                    "standard": "a test",
                },
            ),
            "smoothed": ((gb.constant(1.0), 0.1), {}),
            "solve_equilibrium": ((self.structure, base), {"time": 0.0}),
            "static": ((self.structure, self.still), {"time": 0.0, "name": "flight", "progress": None}),
            "study": ((self.case,), {"progress": None}),
            "surface_gauges": ((self.beam, [0.1]), {}),
            "sweep": (
                (self.fast, {"beam.length": [0.29]}, ["flight.tip.z"]),
                {
                    "histories": (), "times": 11, "verb": "static", "motion": "flight", "at": 0.0, "options": None,
                    "overrides": (),
                    "samples": None, "sampler": None, "seed": None, "workers": 1, "scheduler": None, "store": None,
                    "resume": False, "confirmed": False, "progress": None,
                },
            ),
            "tabulated": (([0.0, 1.0], [1.0, 2.0]), {}),
            "trapezoid": ((1.0,), {"jerk": 1.0, "start": 0.0, "hold": 1.0}),
            "vector": ((), {"x": 1.0, "y": 2.0, "z": 3.0}),
        }  # fmt: skip

    @functools.cached_property
    def objects(self) -> dict[str, Any]:
        """An object of every class with methods that take quantities, by its name."""
        box = gb.RigidSpecimen.box(mass=1.0, size=(0.1, 0.2, 0.3), centre=(0.1, 0.0, 0.0))
        comparison = gb.compare(*self.responses)
        every = [
            self.beam, self.beam.section, self.case, self.centrifuge.over(0.0, 0.2), self.flight, self.hub, self.hinge,
            self.settings, self.structure, box, gb.Feedback(self.law, ["hinge.angle"], ["hinge.angle"], 0.01),
            gb.Line.of_pieces([0.3]), gb.Sensor(), gb.Sine(1.0, 1.0, 0.0), gb.SmoothStep(1.0, 1.0, 0.0),
            gb.SplineProfile(1.0, [0.0] * 12), gb.Sum((gb.constant(1.0), gb.constant(2.0))), comparison.load_difference,
            self.responses[0].errors, gb.System({"bar": self.bar}, {"hinge": self.hinge}),
        ]  # fmt: skip
        matrices = gb.Section.of_matrices(np.eye(6), np.diag([0.2, 0.2, 0.2, 2e-5, 1e-5, 1e-5]))
        return {type(each).__name__: each for each in every} | {"Section.matrices": matrices}


@pytest.fixture(scope="module")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Samples:
    return Samples(tmp_path_factory.mktemp("samples"))


def called(function: Callable[..., Any], *args: Any, **keywords: Any) -> Any:
    answer = function(*args, **keywords)
    return list(answer) if function is gb.simulate_batch else answer


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_function_refuses_objects_of_the_wrong_type(
    samples: Samples, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An InputError that names the argument; never what an attribute or an operator says that is not there."""
    monkeypatch.chdir(tmp_path)  # a sweep's store may have any name
    function = getattr(gb, name)
    args, keywords = samples.calls()[name]
    if name != "rerun":
        called(function, *args, **keywords)
    names = [each.name for each in signature(function).parameters.values() if each.kind is not Parameter.VAR_KEYWORD]
    left_out = {"acceleration", "torque", "settings", "conditioning", "provenance", "rates"}
    left_out |= {"tip_displacement", "displacement"}
    assert {*names[: len(args)], *keywords} | left_out >= {*names}, name
    problems = []
    for at in [*range(len(args)), *keywords]:
        refused = 0
        value = keywords[at] if isinstance(at, str) else args[at]
        for wrong in (each for each in WRONG if each is not None or value is not None):  # None for None is that call
            changed = list(args), dict(keywords)
            changed[isinstance(at, str)][at] = wrong  # type: ignore[index]
            argument = at if isinstance(at, str) else names[at]
            try:
                called(function, *changed[0], **changed[1])
            except gb.GbeamError as error:
                refused += isinstance(error, gb.InputError)
            except Exception as error:
                problems.append(f"{argument} = {wrong!r}: {type(error).__name__}: {error}")
        if not refused:
            problems.append(f"{argument}: nothing is refused")
    assert not problems, "\n".join(problems)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda g: gb.simulate(g.beam, g.still, duration=1.0), "structure is of type Beam; give a Structure (from g"),
        (lambda g: gb.simulate(g.structure, gb.Flight, duration=1.0), "motion is the class Flight itself; give a flig"),
        (lambda g: gb.modes("scenario.toml"), "structure is 'scenario.toml'; give a Structure (from gbeam.assemble)"),
        (lambda g: gb.Beam(0.3, "rectangle", g.beam.material), "section is 'rectangle'; give a Section"),
        (lambda g: replace(g.beam, masses=[gb.PointMass(0.1, 1), 0.2]), "masses[1] is 0.2; give a PointMass"),
        (lambda g: replace(g.beam, masses=gb.PointMass(0.1, 1)), "masses is of type PointMass; give a list of PointMa"),
        (lambda g: gb.Section.rectangle("wide", 0.004), "width is 'wide'; give a number in m"),
        (lambda g: gb.static(g.structure, g.still, time="noon"), "time is 'noon'; give a number"),
        (lambda g: gb.campbell(g.structure, g.hub, count=2.5), "count is 2.5; give a whole number"),
        (lambda g: gb.read_scenario(3), "path is 3; give a text or a path"),
        (lambda g: gb.compare(g.structure, g.structure), "flight is of type Structure; give a Response (from gbeam"),
        (lambda g: gb.axis_commands(g.centrifuge, sample=(1, 2)), "sample is (1, 2); give a number"),
        (lambda g: gb.sweep(g.fast, {"beam.length": 0.2}, ["tip.z"]), "--over beam.length is 0.2; give a list of numb"),
        (lambda g: gb.sweep(g.fast, ["beam.length=1,2"], {"tip": 3}), "measure is {'tip': 3}; give a list of texts or"),
        (lambda g: gb.fit(g.fast, g.data, "beam.length"), "free is 'beam.length'; give a list of texts"),
        (lambda g: gb.simulate(g.structure, g.still, duratoin=1.0), "keyword is 'duratoin'; did you mean 'duration'?"),
        (lambda g: gb.simulate(g.structure, g.still), "duration is missing; give the response's, s, or settings"),
        (lambda g: gb.simulate(g.structure, g.still, duration=1.0, parameters={"bta": 0.3}, integrator="newmark"),
         "parameters.bta does not belong to newmark; did you mean 'beta'?"),
        (lambda g: gb.simulate(g.structure, g.still, duration=1.0, parameters={"alpha": 0.3}, integrator="newmark"),
         "parameters.alpha does not belong to newmark; it takes beta, gamma"),
        (lambda g: gb.simulate(g.structure, g.still, duration=1.0, parameters={"alpha": 0.3}),
         'parameters.alpha does not belong to gauss; give integrator = "hht" with it'),
        (lambda g: gb.simulate(g.structure, g.still, duration=1.0, parameters={"bta": 0.3}),
         "parameters.bta does not belong to gauss; leave it out: it has no parameters"),
        (lambda g: gb.simulate(g.structure, g.still, duration=1.0, initial="undefrmed"),
         "initial is 'undefrmed'; did you mean 'undeformed'?"),
        (lambda g: gb.compare(*g.responses, accept={"tipp": 0.1}), "accept has 'tipp'; did you mean 'tip'?"),
        (lambda g: gb.compare(*g.responses, accept={"tip": (0.5, 2.0)}), "accept.tip is (0.5, 2.0); give a number"),
        (lambda g: replace(g.brief, accept={"spin": {"tolerance_off": "peak"}}),
         "motion.spin.accept.tolerance_off is no limit of acceptance; did you mean 'tolerance_of'?"),
        (lambda g: gb.sweep(g.fast, verb="mdoes"), "--verb is 'mdoes'; did you mean 'modes'?"),
        (lambda g: gb.sensitivity(g.fast, verb="mdoes"), "--verb is 'mdoes'; did you mean 'modes'?"),
        (lambda g: gb.optimise(g.fast, "tip.z", ["beam.length"], verb="mdoes"), "--verb is 'mdoes'; did you mean 'mod"),
        (lambda g: gb.sweep(g.slew, ["beam.length=1"], ["speed[0]"], verb="campbell", options={"too": 1.0}),
         "--too is no option of campbell; did you mean 'to'?"),
        (lambda g: gb.place(g.structure, g.still, gb.choice_of(g.centrifuge, (0.0,)), g.settings, {"tipp": 1.0},
         current=g.centrifuge), "measure names 'tipp'; did you mean 'tip'?"),
        (lambda g: g.responses[0].plot("tipp"),
         "what is 'tipp', which this result does not have; did you mean 'tip'? choose from tip, base"),
        (lambda g: gb.build_target(gb.vector(z=1.0), span=(1.0,), idle=None, smoothing=0, gravity=False),
         "span is (1.0,); give a list of 2 numbers"),
    ],
)  # fmt: skip
def test_what_is_said_of_them(samples: Samples, call: Callable[[Samples], Any], words: str) -> None:
    with pytest.raises(gb.InputError) as refused:
        call(samples)
    assert str(refused.value).startswith(words)


def as_arrays(value: Any) -> Any:
    """The value with every list of numbers as an array."""
    if isinstance(value, dict):
        return {key: as_arrays(each) for key, each in value.items()}
    if not isinstance(value, (list, tuple)):
        return value
    alike = value and all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in value)
    return np.array(value) if alike else type(value)(map(as_arrays, value))


@pytest.mark.parametrize("name", PUBLIC)
def test_arrays_stand_where_lists_of_numbers_do(
    samples: Samples, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what is made of either is equal, both ways."""
    monkeypatch.chdir(tmp_path)
    args, keywords = samples.calls()[name]
    if name == "rerun":
        return
    function = getattr(gb, name)
    first, second = called(function, *args, **keywords), called(function, *as_arrays(args), **as_arrays(keywords))
    if isinstance(function, type):
        assert first == second and second == first


def test_what_looks_like_a_number_is_one(samples: Samples) -> None:
    jnp = pytest.importorskip("jax.numpy")
    for seconds in (0, np.float32(0.0), np.int64(0), np.zeros(()), jnp.zeros(()), Decimal(0)):
        gb.static(samples.structure, samples.still, time=seconds)
    gb.campbell(samples.structure, samples.hub, speeds=np.linspace(0, 1, 3), orders=range(1, 3), count=np.int64(3))
    gb.Section.rectangle([0.02, jnp.array(0.02)], 0.004, stations=(0.0, 0.3))


def test_a_mistake_inside_is_not_blamed_on_an_argument(samples: Samples, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gbeam.analysis.steady.static.settled", None)
    with pytest.raises(TypeError, match="NoneType"):
        gb.static(samples.structure, samples.still, time=0.0)


def test_the_keywords_of_a_response_are_its_settings() -> None:
    """Type checkers know the keywords: those of the settings, whose quantities may be texts."""
    hints = get_type_hints(gb.ResponseSettings)
    fields = {each.name: hints[each.name] for each in dataclass_fields(gb.ResponseSettings)}
    read = {name for name in fields if kind_of_argument(gb.ResponseSettings, name, {})}
    assert get_type_hints(Settings) == {name: hint | str if name in read else hint for name, hint in fields.items()}
