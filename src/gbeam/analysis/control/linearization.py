"""State-space models about an operating point: A, B, C, D with names and units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from gbeam.analysis.control.outputs import (
    BASE_RATES,
    _gauged,
    coordinate_signals,
    input_signals,
    output_signals,
    outputs_of,
)
from gbeam.analysis.steady.frequency_errors import BY_RICHER, doubtful, pole_errors, unknown_errors
from gbeam.analysis.steady.stability import hub_of
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.drive import Drive, turning_of
from gbeam.analysis.system.linear import frozen, instabilities, linearize_system
from gbeam.analysis.system.rest import placed, undeformed
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.steady import SteadySystem
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.guards.quantities import AngularRate, Seconds
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.control import signal_names
from gbeam.mechanics.tree.one_body import moving_system
from gbeam.mechanics.tree.system import System
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.errors import direction_words
from gbeam.results.state_space import ACCURATE, Gauge, StateSpace, import_control


@typed
def linearize(
    structure: Structure | System,
    motion: Motion | None = None,
    time: Seconds = 0.0,
    *,
    rate: AngularRate | None = None,
    q: ArrayLike | None = None,
    qd: ArrayLike | None = None,
    gauges: Sequence[Gauge] = (),
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    at: Literal["rest", "start"] = "rest",
    loop: str = "open",
    name: str = "",
    progress: Progress = None,
) -> StateSpace:
    """State-space model of small departures from an operating point.

    Parameters
    ----------
    structure : Structure or System
    motion : Flight, Centrifuge or Hub
        Of the root of a structure, or of the ground of a system; either rests without one. A free hub has the torque as
        input; on any other base the root's acceleration (specific force where gravity acts, and then called so) and the
        angular acceleration are, in base axes. The components of each load on the beam are inputs too.
    time : float
        At which the motion is frozen, s.
    rate : float, optional
        A hub's steady rate in its place, rad/s.
    q, qd : (n,), optional
        Coordinates and rates to linearise at; by default the relative equilibrium. Elsewhere the beam accelerates, and
        the model is one of small departures from the motion that goes through this state.
    gauges : sequence of Gauge
        Where strain is measured: ``strain_1`` and so on.
    inputs, outputs : sequence of str, optional
        Those that are kept, by name. Of a system: efforts on coordinates (``hinge.angle``) and components of its forces
        (``thrust.force_x``); what is measured, ``joint.angle``, ``joint.angle_rate``, ``body.point.place_x``,
        ``velocity_x``, ``attitude_x``, ``acceleration_x``, ``spin_x``. By default the driven coordinates, all forces,
        and accelerations of the base and of prescribed coordinates (``base_acceleration_x``,
        ``axis.angle_acceleration``); coordinates, rates, places and strains.
    at : str
        Of a system: ``rest``, where it rests, or ``start``, the motion at its start.
    loop : str
        Of a system with controllers: ``open``, the plant alone; ``closed``, all of it from sample to sample, of several
        sample times over their common period, with its references as further inputs and the margins at every drive
        that is sampled once in it; or the name of a controller and such a drive, ``pointing: axis.angle``: the loop
        that is cut there, with negative feedback. Laws that are functions have their slopes where they ask for nothing:
        where the system rests, or else at no error. Errors of margins and poles are by the same laws around a richer
        system; a margin whose error exceeds one half is NaN, and a loop that grows has none.
    name : str
        Of the motion.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    StateSpace
        Outputs are displacement and acceleration of the tip, the root's moment, strains, displacement and acceleration
        of every other named point of the beam, and a free hub's angle and rate. States are the coordinates and their
        rates. Where the base's angular velocity acts to first order, that is about a turning base, its components are
        states too: the integrals of the angular acceleration.

    Raises
    ------
    InputError
        If the beam has no damping ratio, a gauge lies off the beam or at no point of a mesh, a rate is asked of a
        motion without a hub, or a time of a hub that swings; of a loop, if its controllers have no common period, or a
        law has no slope, such as a relay.
    ComputationError
        If there is no relative equilibrium.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> plant = gb.linearize(structure, gb.Hub(radius=0.5, inertia=2.0))
    >>> [each.name for each in plant.inputs]
    ['torque']
    >>> print(plant.frequency.round(2))
    [  36.56  183.55  229.04 1139.77 4243.13]
    """
    tell(progress, "equilibrium and slopes", 0.0)
    subject = subject_of(structure, motion)
    if not subject.body or structure is subject.system:  # signals of a system are named by its bodies
        if rate is not None:
            raise InputError(
                "rate", "is of a hub, and a system turns on its joints", "give a time, or a joint its rate"
            )
        system = subject.system
        drives = signal_names(system.controllers, "drive")
        if loop != "open" and not drives:
            raise InputError("loop", f"is {loop!r}, and the system has no controllers", "leave it out, or give it some")
        choice("loop", loop, ("open", "closed", *drives))
        system.require_damping("the state-space model")
        system, strained = _gauged(system, gauges)
        state = frozen(system, motion, time, at)
        options: Any = {"inputs": inputs, "outputs": outputs, "strained": strained, "name": name}
        if loop != "open":
            from gbeam.analysis.steady.loop_errors import JudgedLoops  # takes SciPy's linear algebra
            from gbeam.analysis.system.closed_loop import Loops

            loops, cut = Loops.from_state(state, **options), None if loop == "closed" else loop
            computed = loops.state_space(cut)
            tell(progress, BY_RICHER, 0.5)
            return JudgedLoops(state, loops, cut).judge(computed)
        plant = linearize_system(state, **options)
        tell(progress, BY_RICHER, 0.5)
        of_system, doubts = _poles(state, subject)
        if state.begins and state.point.yd.any():
            of_system["frame"] = "turning"
        return replace(plant, **of_system, warnings=plant.warnings + doubts)
    choice("loop", loop, ("open",))
    motion = Flight(z=0.0) if motion is None else motion
    subject = subject_of(structure, motion)
    subject.require_coordinates()
    structure.require_damping("the state-space model")
    for i, gauge in enumerate(gauges):
        if gauge.body:
            raise InputError(f"gauges[{i}].body", f"is {gauge.body!r}, and there is one structure", "leave it out")
    if rate is None:
        drive = subject.drive(time)
    else:
        hub_of(motion, "a rate", "leave it out and give a time", name)
        drive = Drive(subject.ground, time, turning_of(subject.system, subject.ground, None), rate)
    at_rest = q is None and qd is None
    coordinates = (None if values is None else np.asarray(values, dtype=float) for values in (q, qd))
    plant = _linearized(
        subject, placed(subject.system, drive, *coordinates), gauges, name, time, progress, at_rest=at_rest
    )
    return plant.select(inputs=inputs, outputs=outputs)


def _linearized(
    subject: Subject,
    state: SteadySystem,
    gauges: Sequence[Gauge],
    name: str,
    time: float,
    progress: Progress,
    *,
    at_rest: bool,
) -> StateSpace:
    """State-space model of one body in a state of its system, with the errors of its poles if it is `at_rest`."""
    structure, point, linear = subject.structure, state.point, state.linear
    motion: Any = subject.motion
    n, measured = len(point.y), outputs_of(structure, state, gauges)
    value, d, forces = measured.matrices(point)
    a, drive, output, feedthrough = linear._replace(inputs=forces).state_space(
        *np.split(d, len(linear.mass) * np.arange(1, 4), axis=1)
    )
    states, held = coordinate_signals(structure, measured.first_coordinate), measured.holding_inputs
    begun = np.concatenate([point.y, point.yd])
    if not measured.first_coordinate:
        # u = (a, ω, α, loads): ω becomes a state where it acts, fed by α.
        acts = [i for i in range(3, 6) if np.abs(drive[:, i]).max() > 1e-12 or np.abs(feedthrough[:, i]).max() > 1e-12]
        kept = [i for i in range(len(held)) if not 3 <= i < 6]
        fed = np.array([[float(j == i + 3) for j in kept] for i in acts]).reshape(-1, len(kept))
        m = len(acts)
        a = np.block([[a, drive[:, acts]], [np.zeros((m, 2 * n + m))]])
        output = np.concatenate([output, feedthrough[:, acts]], axis=1)
        drive, feedthrough = np.concatenate([drive[:, kept], fed]), feedthrough[:, kept]
        states += tuple(BASE_RATES[i - 3] for i in acts)
        begun, held = np.concatenate([begun, held[acts]]), held[kept]
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=subject.base(state))
    poles: dict[str, Any] = {}
    if at_rest:
        tell(progress, BY_RICHER, 0.5)
        poles, doubts = _poles(state, subject)
        warnings += doubts
    return StateSpace(
        a=a,
        b=drive,
        c=output,
        d=feedthrough,
        states=states,
        inputs=input_signals(structure, motion),
        outputs=output_signals(structure, gauges, motion),
        state=begun,
        input=held,
        output=value,
        model=structure.kind,
        motion=name,
        time=time,
        **poles,
        warnings=warnings,
        notes=notes_on({name: motion}),
    )


def _poles(state: SteadySystem, subject: Subject) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Fields of the poles about a steady state: frequencies (k,) Hz, their errors, and whether the frame turns.

    Besides, warnings of errors and of instability.
    """
    frequency, errors, doubts = np.zeros(0), unknown_errors(state.system, 0), tuple[str, ...]()
    turning = {"frame": "turning"} if state.whirl is not None and state.whirl.turning else {}
    if judged_bodies(state.system):
        frequency, errors = pole_errors(state)
        doubts = doubtful(errors) if errors.count_within(ACCURATE) == 0 else ()
    growing = (
        f"the operating point is not stable: {motion.kind} {direction_words(motion.direction)}, growing with "
        f"{motion.growth_rate:.4g} 1/s"
        for motion in instabilities(state, state.moving, subject.directions)
    )
    return {"frequency": frequency, "errors": errors, **turning}, (*doubts, *growing)


@typed
def nonlinear_system(structure: Structure, motion: Motion, *, gauges: Sequence[Gauge] = ()) -> Any:
    """Return the complete model as ``control.nlsys``: driven by the torque on a free hub, else by its base's motion.

    States are (y, ẏ) and, on a base that is not a free hub, the base's angular velocity. Inputs and outputs are those
    of :func:`gbeam.linearize`, not as departures but whole.

    Parameters
    ----------
    structure : Structure
    motion : Flight, Centrifuge or Hub
        Tells the kind of base only.
    gauges : sequence of Gauge

    Raises
    ------
    InputError
        If python-control is not installed.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> system = gb.nonlinear_system(structure, gb.Hub(radius=0.5, inertia=2.0))
    >>> system.nstates, system.input_labels
    (12, ['torque'])
    """
    control = import_control()

    structure.require_coordinates()
    system, _ = moving_system(structure, motion)
    outputs = outputs_of(structure, undeformed(system), gauges)
    states = coordinate_signals(structure, outputs.first_coordinate) + (() if outputs.first_coordinate else BASE_RATES)

    def update(t: float, x: Any, u: Any, params: Any) -> Any:
        return outputs.rates(np.asarray(x, dtype=float), np.asarray(u, dtype=float))[0]

    def measure(t: float, x: Any, u: Any, params: Any) -> Any:
        return outputs.rates(np.asarray(x, dtype=float), np.asarray(u, dtype=float))[1]

    return control.nlsys(
        update,
        measure,
        states=[signal.name for signal in states],
        inputs=[signal.name for signal in input_signals(structure, motion)],
        outputs=[signal.name for signal in output_signals(structure, gauges, motion)],
        name=structure.kind,
    )
