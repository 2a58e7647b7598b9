"""The problem to integrate: the equations of a model in one environment, and the state they start from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from gbeam.analysis.steady.equilibrium import solve_equilibrium
from gbeam.analysis.system.point import solve_start
from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import Value, each_leaf
from gbeam.arrays.types import Numbers
from gbeam.constants import Across, State
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, finite
from gbeam.integrate.equations import LinearEquations, NonlinearEquations
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.parts import Base

STATE_WORDS: dict[State, str] = {
    "equilibrium": "in relative equilibrium",
    "undeformed": "undeformed",
    "relief": "in inertia relief",
}
_ITERATIONS = 60


@typed
@dataclass(frozen=True, eq=False)
class Initial(Value):
    """The state of the beam, relative to its base, in which a response begins; a machine's with its spin-up.

    What is given of the displacement takes the place of the equilibrium; what is not given of the velocity is zero.

    Parameters
    ----------
    state : str
        ``equilibrium``: at rest in the relative equilibrium with the base's motion and the loads then, a free hub at
        rest. The bodies of a system are bent as where joints hold what they move; what floats, held by nothing but a
        free joint without springs and prescribed rates, is undeformed. The springs of a clamp are bent, too, unless
        the joint says where they begin; those at the root of a body that deforms let it go at once.
        ``undeformed``: straight and at rest. ``relief``: inertia relief, bent as what is accelerated by the forces
        at the start is bent by its inertia, so that they shake no body.
    acceleration : (3,), optional
        Released from the static deflection under this acceleration of the root, or specific force, base axes, m/s²,
        and under the loads then.
    tip_displacement : mapping of str to float, optional
        By ``y`` and ``z``: released from the shape of least strain energy with this displacement of the tip, m, which
        is that of a static force at the tip.
    tip_velocity : mapping of str to float, optional
        By ``y`` and ``z``: velocity of the tip relative to the base, m/s, the beam moving in the same shape.

    Raises
    ------
    InputError
        If a value is impossible, or two displacements are given.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> drawn = gb.Initial(tip_displacement={"z": 2e-3})
    >>> response = gb.simulate(structure, gb.Flight(z=0.0), duration=0.5, initial=drawn)
    >>> print(f"{1e3 * response.displacement[0, -1, 2]:.3f} mm")
    2.000 mm
    """

    state: State = "equilibrium"
    acceleration: Numbers | None = None
    tip_displacement: Mapping[Across, float] | None = None
    tip_velocity: Mapping[Across, float] | None = None

    def __post_init__(self) -> None:
        choice("state", self.state, STATE_WORDS)
        displaced = [name for name in ("acceleration", "tip_displacement") if getattr(self, name) is not None]
        if displaced and self.state != "equilibrium":
            raise InputError(displaced[0], f'is given beside state = "{self.state}"', "keep one of them")
        if len(displaced) > 1:
            raise InputError(displaced[1], f"is given beside {displaced[0]}", "keep one of them")
        if self.acceleration is not None:
            if np.shape(self.acceleration) != (3,) or not np.isfinite(np.asarray(self.acceleration, dtype=float)).all():
                fix = "give three finite components, x, y and z"
                raise InputError("acceleration", f"is {self.acceleration!r}", fix)
            object.__setattr__(self, "acceleration", tuple(float(each) for each in self.acceleration))
        for name in ("tip_displacement", "tip_velocity"):
            for axis, value in (getattr(self, name) or {}).items():
                choice(name, axis, get_args(Across))
                finite(f"{name}.{axis}", value)

    @property
    def settled(self) -> bool:
        """True if it is the relative equilibrium at rest."""
        return self == Initial()

    def __str__(self) -> str:
        if self.acceleration is not None:
            words = f"in the static deflection under ({', '.join(f'{a:.4g}' for a in self.acceleration)}) m/s²"
        elif self.tip_displacement:
            words = f"with its tip displaced by {_components(self.tip_displacement, 1e3, 'mm')}, as by a force there"
        else:
            words = STATE_WORDS[self.state]
        speed = f"its tip moving at {_components(self.tip_velocity, 1.0, 'm/s')}" if self.tip_velocity else "at rest"
        return f"begins {words}, {speed}"


def _components(values: Mapping[Across, float], size: float, unit: str) -> str:
    return ", ".join(f"{axis} {size * value:.4g} {unit}" for axis, value in values.items())


def begun(initial: Initial | State) -> Initial:
    """The initial state, or that which a name stands for; InputError if it is neither."""
    if isinstance(initial, Initial):
        return initial
    choice("initial", initial, STATE_WORDS)
    return Initial(initial)


def initial_state(structure: Structure, base: Base | None, time: float, initial: Initial) -> tuple[Array, Array, bool]:
    """Coordinates and rates (n,) at the start; False if they belong to an equilibrium that is not stable, else True."""
    q, stable = np.zeros(structure.size), True
    if initial.acceleration is not None:
        q, stable = solve_equilibrium(structure, Base(np.asarray(initial.acceleration), *np.zeros((2, 3))), time)
    elif initial.tip_displacement:
        q = _displaced(structure, initial.tip_displacement)
    elif initial.state != "undeformed" and base is not None:
        q, stable = solve_equilibrium(structure, base, time)
    return q, _moving(structure, q, initial.tip_velocity or {}), stable


def _axes(structure: Structure, place: str, values: Mapping[Across, float]) -> tuple[tuple[int, ...], Array]:
    """Numbers of the axes of the tip's displacement or velocity, and its values (k,); InputError without shapes."""
    axes = tuple("xyz".index(axis) for axis in values)
    for axis in set(axes) & set(structure.axes_without_shapes):
        where, fix = f"response.initial.{place}.{'xyz'[axis]}", f"give model.modes.{'xyz'[axis]} = 1 or more"
        raise InputError(where, "is along a direction without shapes", fix)
    return axes, np.asarray([*values.values()], dtype=float)


def _displaced(structure: Structure, values: Mapping[Across, float]) -> Array:
    """Coordinates (n,) of least strain energy with a displacement of the tip, by Newton's method with multipliers."""
    axes, wanted = _axes(structure, "tip_displacement", values)
    if structure.traced:
        from gbeam.mechanics.equations.compiled import displaced

        return displaced(structure, axes, wanted)
    q = np.zeros(structure.size)
    for _ in range(_ITERATIONS):
        coefficients, elastic = structure.about(q)
        left = wanted - structure.tip(q)[..., axes]
        change = _constrained(coefficients.stiffness, -elastic, structure.station_slopes(q)[-1, axes], left)
        q = q + change
        if np.abs(change).max() <= 1e-12 * np.abs(q).max():
            return q
    wanted_words = _components(values, 1e3, "mm")
    raise ComputationError("not converged", f"no shape of the beam has its tip displaced by {wanted_words}; give less")


def _moving(structure: Structure, q: Array, values: Mapping[Across, float]) -> Array:
    """Rates (n,) with a velocity of the tip, in the shape of least strain energy; zero without values."""
    if not values:
        return 0.0 * q
    axes, wanted = _axes(structure, "tip_velocity", values)
    slopes = structure.station_slopes(q)[-1, axes]
    return _constrained(structure.coefficients.stiffness, 0.0 * q, slopes, wanted)


def _constrained(stiffness: Array, force: Array, slopes: Array, value: Array) -> Array:
    """Solve K x = f + Jᵀ λ with J x = v for x (n,)."""
    solve = namespace(stiffness, force, slopes).linalg.solve
    unconstrained, shapes = solve(stiffness, force), solve(stiffness, slopes.T)
    return unconstrained + shapes @ solve(slopes @ shapes, value - slopes @ unconstrained)


EQUILIBRIUM = Initial()


@dataclass(frozen=True)
class Problem:
    """Equations and initial state (n,) for the integrator; the beam's coordinates are from `first` on; `stable` is
    False if they start from an equilibrium that is not stable.
    """

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    first: int
    stable: bool


def problem_of(structure: Structure, motion: Motion, start: float, initial: Initial = EQUILIBRIUM) -> Problem:
    """Pose the equations of a structure in a motion, from an initial state at the `start`, s."""
    hub: Any = motion if motion.free else None

    def drive(t: Array) -> tuple[Any, Any]:
        return driven(structure, motion, t)

    q, qd, stable = start_of(structure, motion, start, initial)
    if hub is None and structure.linear:
        c = structure.coefficients
        terms = c.terms

        def features(inputs: tuple[Base, Any]) -> Array:
            now, loads = inputs
            return c.features(now.a_WO_B, now.w_WB_B, now.alpha_WB_B, loads)

        # No derivative is taken through the modes: those of equal frequencies have none.
        rest = None if any(map(is_jax, (c.mass, c.damping, c.stiffness))) else (c.damping, c.stiffness)
        equations = LinearEquations(c.mass, lambda x: terms.at(features(x)), drive, terms, features, rest)
        return Problem(equations, q, qd, 0, stable)
    residual = structure.residual(hub)
    if hub is not None:
        q, qd = (namespace(x).append(0.0, x) for x in (q, qd))
    idle = None if hub is None else each_leaf(lambda leaf: np.zeros(np.shape(leaf)), drive(np.array([start])))
    return Problem(NonlinearEquations(residual, drive, idle=idle), q, qd, residual.first, stable)


def driven(structure: Structure, motion: Any, t: Array) -> tuple[Any, Any]:
    """Inputs of the equations at times (t,): motion of the root, or torque on a free hub, and components of loads."""
    of_root = motion.torque(t) if motion.free else motion.base(t)
    return of_root, None if structure.history is None else structure.history(t)


def start_of(structure: Structure, motion: Any, start: float, initial: Initial) -> tuple[Array, Array, bool]:
    """Coordinates and rates (n,) of the beam at the start, and its stability, as in `initial_state`."""
    if motion.free and initial.state == "relief":
        residual, still = structure.residual(motion), np.zeros(1 + structure.size)
        inputs = each_leaf(lambda leaf: leaf[0], driven(structure, motion, np.array([start])))
        bent = np.arange(len(still)) >= residual.first
        q, _, adrift = solve_start(residual, still, still, inputs, bent=bent, accelerated=~bent)
        if adrift >= 0:
            problem = 'no place was found in which the beam rests on its hub; begin with initial = "undeformed"'
            raise ComputationError("no equilibrium", problem)
        q = q[residual.first :]
        return q, _moving(structure, q, initial.tip_velocity or {}), True
    if motion.free:
        loaded, zero = motion.mount.gravity is not None or structure.history is not None, np.zeros(())
        return initial_state(structure, motion.mount.base(zero, zero, zero) if loaded else None, start, initial)
    base = motion.base(np.array([start]))
    return initial_state(structure, each_leaf(lambda x: x[0], base), start, initial)
