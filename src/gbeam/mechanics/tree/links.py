"""Links: bodies with the joints that hold them, and the springs, dampers, friction and stops of these."""

from __future__ import annotations

import math
from itertools import accumulate

from gbeam.arrays.namespace import Array, concatenated, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.tree.bodies import Body
from gbeam.mechanics.tree.steps import Step

SLIP = 1e-3  # rad/s or m/s: rate at which friction has 0.76 of its size
SLIPS = f"{1e3 * SLIP:g} mm/s", f"{math.degrees(SLIP):.3g} °/s"  # in words, along and about
STUCK = 3 * SLIP  # rate below which friction has less than 0.995 of its size


@record
class Holder:
    """Springs and stops on the values (h,) of a joint (:meth:`Step.held_values`), dampers and friction on their rates.

    The springs have no force at the values `ease`. The stops begin at `low` and `high` and have the
    stiffness `stop`. `coupling` (h, h) is the stiffness between values, or None. Friction is smooth below rates of the
    size `slip`.
    """

    stiffness: Array
    ease: Array
    damping: Array
    friction: Array
    low: Array
    high: Array
    stop: Array
    coupling: Array | None = None
    slip: float = static(default=SLIP)

    @property
    def bends(self) -> bool:
        """True if a force changes its slope abruptly, as friction does near rest and a stop where it is met."""
        return bool((self.friction > 0).any() or (self.stop > 0).any())

    @property
    def holds(self) -> bool:
        """True if there is any force, apart from the coupling's."""
        return any((values != 0).any() for values in (self.stiffness, self.damping, self.friction, self.stop))

    def forces(self, values: Array, rates: Array) -> tuple[Array, Array]:
        """Forces (..., h) of springs and stops on the values, and of dampers and friction on the rates."""
        xp = namespace(values, rates, self.stiffness)
        pull = self.stiffness * (values - self.ease) + self.stop * self._excess(values)
        if self.coupling is not None:
            pull = pull + (values - self.ease) @ self.coupling
        return pull, self.damping * rates + self.friction * xp.tanh(rates / self.slip)

    def stored(self, values: Array) -> Array:
        """Energy (...) of the springs and stops, J."""
        moved = values - self.ease
        pull = self.stiffness * moved if self.coupling is None else self.stiffness * moved + moved @ self.coupling
        return (pull * moved + self.stop * self._excess(values) ** 2).sum(axis=-1) / 2

    def _excess(self, q: Array) -> Array:
        """Signed distance (..., h) of values beyond their stops, zero between these."""
        xp = namespace(q, self.low)
        return xp.maximum(q - self.high, 0.0) - xp.maximum(self.low - q, 0.0)


@record
class Link:
    """A body with the joint that holds it: a chain of steps from point `on` (index) of body `parent`, −1 for the
    ground, and its springs, which act unless it is `loose`. A body's root is the point after its others, or −1.
    """

    steps: tuple[Step, ...]
    holder: Holder
    body: Body
    parent: int = static()
    on: int = static()
    loose: bool = static()

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of coordinates of each step, and of the body."""
        return (*(step.size for step in self.steps), self.body.size)

    @property
    def idle(self) -> int:
        """Number of steps before the first with coordinates."""
        return next((k for k, step in enumerate(self.steps) if step.size), len(self.steps))

    def stored(self, q: list[Array], qd: list[Array]) -> Array:
        """Energy (...) of the joint's springs and stops, J, by coordinates of its steps and rates."""
        return self.holder.stored(self.spring_values(q, qd)[0])

    def spring_values(self, q: list[Array], qd: list[Array]) -> tuple[Array, Array]:
        """Values (..., h) on which the joint's springs act, and their rates, by coordinates and rates of its steps."""
        values, rates = zip(*self._values_by_step(q, qd), strict=True)
        return concatenated(values), concatenated(rates)

    def holding(self, q: list[Array], qd: list[Array]) -> list[Array]:
        """Forces (..., k) of springs, dampers, friction and stops on the coordinates of each step."""
        by_step = self._values_by_step(q, qd)
        values, rates = (concatenated(list(parts)) for parts in zip(*by_step, strict=True))
        pull, drag = self.holder.forces(values, rates)
        sizes = [part.shape[-1] for part, _ in by_step]
        spans = [slice(end - size, end) for end, size in zip(accumulate(sizes), sizes, strict=True)]
        steps = zip(self.steps, q, spans, strict=True)
        return [step.coordinate_forces(values, pull[..., span], drag[..., span]) for step, values, span in steps]

    def _values_by_step(self, q: list[Array], qd: list[Array]) -> list[tuple[Array, Array]]:
        """Values and rates, as :meth:`held_values`, of each step."""
        return [step.spring_values(*state) for step, *state in zip(self.steps, q, qd, strict=True)]
