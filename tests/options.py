"""Options that mypy refuses: it is an error where one of these ``ignore`` is not needed."""

from __future__ import annotations

import numpy as np

import gbeam as gb
from gbeam.analysis import Settings
from gbeam.results import Limits


def respond(structure: gb.Structure, motion: gb.Flight) -> None:
    """The first call is right; the others are misspelt or of a wrong type."""
    gb.simulate(structure, motion, duration=10.0, step=1e-3, parameters={"beta": 0.3}, initial="undeformed")
    gb.simulate(structure, motion, duration="10 s", step="1 ms", tolerance="0.5 %")
    gb.simulate(structure, motion, duratoin=10.0)  # type: ignore[call-arg]
    gb.simulate(structure, motion, duration=[10.0])  # type: ignore[arg-type]
    gb.simulate_batch([(structure, motion)], duration=1.0, stpe=0.1)  # type: ignore[call-arg]
    gb.static(structure, motoin=motion)  # type: ignore[call-arg]
    gb.ResponseSettings(1.0, integrator="rk4")  # type: ignore[arg-type]
    gb.ResponseSettings(1.0, parameters={"bta": 0.3})  # type: ignore[dict-item]
    gb.ResponseSettings(1.0, initial="undefrmed")  # type: ignore[arg-type]
    gb.Initial("equilibirum")  # type: ignore[arg-type]
    gb.Initial(tip_displacement={"z": 2e-3}, tip_velocity={"y": 0.1})
    gb.Initial(tip_displacement={"x": 2e-3})  # type: ignore[dict-item]
    gb.Initial(tip_velocity={"w": 2e-3})  # type: ignore[dict-item]


def choose(beam: gb.Beam, flight: gb.Flight, case: gb.Case) -> None:
    """Names of another kind are refused where they are misspelt."""
    gb.assemble(beam, "FOAM", z=3)
    gb.assemble(beam, "FOMA", z=3)  # type: ignore[arg-type]
    gb.Model("exact", z=3, shapes="adaptive")  # type: ignore[arg-type]
    gb.Hub(radius=0.5, pointing="outwards")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, inverse="quasistatic")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, mounting="down")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, start="yawed")  # type: ignore[arg-type]
    gb.linearize(gb.assemble(beam, "FOAM", z=3), flight, at="begin")  # type: ignore[arg-type]
    gb.compare_models(case, ["FOAM", "FOMA"])  # type: ignore[list-item]
    gb.Section.of("rectangle", width=0.02, thickness=0.004)
    gb.Section.of("rectangel", width=0.02, thickness=0.004)  # type: ignore[arg-type]
    gb.Section.of("rectangle", widht=0.02, thickness=0.004)  # type: ignore[call-arg]
    gb.Joint("revolute", "panel", axes=[(0, 1, 0)])
    gb.Joint("revolut", "panel", axes=[(0, 1, 0)])  # type: ignore[arg-type]
    gb.Joint("fixed", "panel", stiffness={"rx": 5e3}, stops={"rx": (-0.1, 0.1)}, coupling={"x-rx": -2e4})
    gb.Joint("fixed", "panel", stiffness={"xr": 5e3})  # type: ignore[dict-item]
    gb.Joint("spherical", "panel", initial={"rx": 0.1}, rate={"wx": gb.SmoothStep(1.0, 2.0), "wy": 0, "wz": 0})
    gb.Joint("spherical", "panel", initial={"wx": 0.1})  # type: ignore[dict-item]
    gb.Joint("revolute", "panel", axes=[(0, 1, 0)], effort=gb.Sine(1.0, 2.0), stiffness=20.0)


def imitate(case: gb.Case, flight: gb.Response, spun: gb.Response, machine: gb.Centrifuge) -> None:
    """Limits of acceptance and their settings, and how a place is judged."""
    gb.compare(flight, spun, accept={"tip": 0.02, "srs": (0.7, 1.5), "damage": 2.0}, tolerance_of="instant")
    gb.compare(flight, spun, accept={"tip": "2 %", "srs": "3 dB", "damage": [0.5, 2.0]})
    gb.compare(flight, spun, accept={"tipp": 0.02})  # type: ignore[arg-type]
    gb.compare(flight, spun, accept={"tip": (0.5, 2.0)})  # type: ignore[arg-type]
    gb.compare(flight, spun, tolerance_of="moment")  # type: ignore[arg-type]
    gb.plan("machine", machine, accept={"peaks": 0.03})
    gb.plan("machine", machine, accept={"peak": 0.03})  # type: ignore[arg-type]
    of_case = case.title, case.system, case.motions, case.response
    gb.Case(*of_case, accept={"machine": {"tip": 0.02, "tolerance_of": "peak", "control": {"tip": 1.0}}})
    gb.Case(*of_case, accept={"machine": {"tipp": 0.02}})  # type: ignore[typeddict-unknown-key]
    gb.Case(*of_case, accept={"machine": {"tolerance_of": "moment"}})  # type: ignore[typeddict-item]
    placed = case.subject, machine.flight, gb.choice_of(machine, turns="any"), gb.ResponseSettings(1.0)
    gb.place(*placed, {"tip": 1.0, "root-moment": 0.5}, current=machine)
    gb.place(*placed, {"root_moment": 0.5}, current=machine)  # type: ignore[dict-item]
    print(gb.machines["large-15m"].limits, gb.machines["large-15"])  # type: ignore[index]
    gb.choice_of(machine, turns="right")  # type: ignore[arg-type]


def study(case: gb.Case) -> None:
    """Verbs and their options."""
    gb.sweep(case, {"beam.length": [0.3]}, verb="campbell", sampler="latin", options={"to": "60 rpm", "modes": 4})
    gb.sweep(case, {"beam.length": [0.3]}, verb="rnu")  # type: ignore[arg-type]
    gb.sweep(case, {"beam.length": [0.3]}, sampler="sobel")  # type: ignore[arg-type]
    gb.sweep(case, {"beam.length": [0.3]}, verb="campbell", options={"too": 6.0})  # type: ignore[arg-type]
    gb.sweep(case, {"beam.length": [0.3]}, options={"vary": "speed"})  # type: ignore[arg-type]
    gb.sensitivity(case, ["modes[0].frequency"], verb="mode")  # type: ignore[arg-type]
    gb.sensitivity(case, options={"gyroscopc": True})  # type: ignore[arg-type]
    gb.optimise(case, "modes[0].frequency", ["beam.length"], verb="mode")  # type: ignore[arg-type]
    gb.fit(case, "modes.csv", ["beam.length"], options={"gyroscopc": True})  # type: ignore[arg-type]


def import_models(model: gb.ImportedModel, of: gb.Material) -> None:
    """Loads of geometric stiffness, and springs between links."""
    model.reduced(modes=2, damping_ratio=0.01, geometric={"w_xx": [[1.0]]})
    model.reduced(modes=2, damping_ratio=0.01, geometric={"wxx": [[1.0]]})  # type: ignore[dict-item]
    gb.SolidMesh.read("a.msh", materials=of, clamp="a", springs={"k": {"between": ["b"], "stiffness": {"rz": 5.0}}})
    gb.SolidMesh.read("a.msh", materials=of, clamp="a", springs={"k": {"betwen": ["b"]}})  # type: ignore[typeddict-item, typeddict-unknown-key]
    gb.SolidMesh.read(
        "a.msh",
        materials=of,
        clamp="a",
        springs={"k": {"between": ["b"], "stiffness": {"zz": 5.0}}},  # type: ignore[dict-item]
    )
    gb.read_record("a.csv", time="t", x="x", y="y", z="z", unit="g", quantity="velocity")  # type: ignore[arg-type]


def draw(
    response: gb.Response, comparison: gb.Comparison, structure: gb.Structure, system: gb.StateSpace, study: gb.Study
) -> None:
    """Figures by their names, which each kind of result has of its own."""
    response.plot().figure.savefig("tip.png")
    response.plot("axes_rate", title="The rates of the axes")
    comparison.plot("parts y")
    comparison.plot("part y")  # type: ignore[arg-type]
    gb.static(structure).plot("loads")
    gb.modes(structure).plot("modes")
    gb.modes(structure).plot("mode")  # type: ignore[arg-type]
    system.plot("pole")  # type: ignore[arg-type]
    study.plot("base flight")


def kept(structure: gb.Structure, flight: gb.Response, spun: gb.Response, path: str) -> float:
    """Variables keep the types of what they hold; vectors are lists, tuples or arrays; a file is one kind of case."""
    accept: Limits = {"tip": 0.02}
    settings: Settings = {"duration": 6.0, "integrator": "gauss"}
    gb.compare(flight, spun, accept=accept)
    gb.simulate(structure, gb.Flight(z=9.81), **settings)
    gb.static(structure, acceleration=np.array([0, 0, 9.81]))
    gb.Sum([gb.constant(1.0), gb.Sine(1.0, 2.0)])
    gb.PointMass(0.1, 0.1, offset=[0, 0, 0.01])
    gb.Joint("revolute", "panel", axes=np.array([[0, 1, 0]]), at=np.zeros(3))
    gb.campbell(structure, gb.Hub(radius=0.5), speeds=np.linspace(0, 5, 3), orders=np.arange(1, 3))
    case = gb.read_scenario(path)
    size: float = gb.study(case).responses["flight"].peaks.max_size
    return size
