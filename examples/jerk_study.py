"""Zhang 2020, example 4, over jerk and arm radius: how much a corner of the load makes the specimen vibrate.

The vibration at the tip is simulated and put beside the laws of jerk_laws.py. Run it: python examples/jerk_study.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
from jerk_laws import Floats, first_mode, flat_terms, from_rest_terms, hann_transform

from gbeam import (
    Beam,
    Centrifuge,
    Flight,
    InputError,
    Material,
    Section,
    Structure,
    assemble,
    simulate,
    smoothed,
    tabulated,
)
from gbeam.guards import positive
from gbeam.motion import Profile
from gbeam.results import Base

G = 9.81  # m/s², as the paper has it
LAWS = ("from-rest", "flat")
MOST = 0.5  # of the leading order: a correction that large is refused, since the order after it is not known
_SMALL = 0.1  # where the leading order's powers are looked for
_PERIODS = 6  # of the first mode, watched after the corner


@dataclass(frozen=True)
class JerkStudy:
    """Vibration of the tip over jerk and arm radius, m: simulated and by the law.

    Parameters
    ----------
    law : str
        from-rest or flat.
    jerks : (j,)
        m/s³.
    arms : (r,)
        m.
    simulated, leading, predicted : (j, r)
        m: by simulation, by the law's leading order, with its next order.
    correction : (j, r)
        Size of the next order's terms, summed, over the leading order.
    """

    law: str
    jerks: Floats
    arms: Floats
    simulated: Floats
    leading: Floats
    predicted: Floats
    correction: Floats

    @property
    def error(self) -> Floats:
        """Simulated over predicted, less one, (j, r)."""
        return self.simulated / self.predicted - 1

    @property
    def exponents(self) -> tuple[float, float]:
        """Powers of j and of R that the simulated vibration goes with where the correction is below a tenth.

        Least squares over all such points; NaN where they do not differ in both.
        """
        j, r = np.nonzero(self.correction < _SMALL)
        rows = np.stack([np.ones(len(j)), np.log(self.jerks[j]), np.log(self.arms[r])], axis=1)
        powers, _, rank, _ = np.linalg.lstsq(rows, np.log(self.simulated[j, r]), rcond=None)
        return (float(powers[1]), float(powers[2])) if rank == 3 else (np.nan, np.nan)


@dataclass(frozen=True)
class FromRest:
    """A specimen across a planar arm that starts from rest: R ω² = j t, the tangential acceleration ignored.

    z points inwards and x backwards along the arm's motion, so that α × gives the load along z a slope along x.
    """

    rate: Profile
    arm: float
    control_point: float
    kind = "arm"
    free = False

    def base(self, t: Floats) -> Base:
        """Motion of the root."""
        w, al = self.rate.derivatives(t)
        o, x = np.zeros_like(w), -self.control_point
        a = np.stack([-self.arm * al - w**2 * x, o, self.arm * w**2 - al * x], axis=-1)
        return Base(a, np.stack([o, w, o], axis=-1), np.stack([o, al, o], axis=-1))

    def corners(self, step: float) -> Floats:
        """Corners of the rate that steps of a length should not pass unseen."""
        return np.asarray(self.rate.corners(step))

    def over(self, start: float, end: float) -> Self:
        """Itself."""
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        """Nothing: the start is what is simulated."""
        return 0.0, 0.0


def jerk_study(
    structure: Structure,
    jerks: Sequence[float],
    arms: Sequence[float],
    *,
    law: str,
    level: float,
    control_point: float | None = None,
    smoothing: float | None = None,
) -> JerkStudy:
    """Simulate the vibration that a ramp of the load leaves at the tip, along z, and put the law beside it.

    Parameters
    ----------
    structure : Structure
        Undamped, of a linear model with bending along z.
    jerks : sequence of float
        m/s³.
    arms : sequence of float
        m.
    law : str
        ``from-rest``: the quasi-static inverse, watched on the ramp after the start. ``flat``: the yaw-compensated
        inverse, watched on the plateau after a ramp from half its level.
    level : float
        Of the plateau, m/s².
    control_point : float, optional
        From the root, m; by default mid-span.
    smoothing : float, optional
        Width of the kernel at the corner, s; needed for ``flat``.

    Raises
    ------
    InputError
        If the law is unknown, the width missing, a number impossible, the law's next order above half its leading one,
        or the ramp so short that its two corners cannot be told apart.

    Notes
    -----
    For 2020's specimen, 10 g and 60 ms the law holds from 1 to 15 g/s and from 1.5 to 15 m.
    """
    if law not in LAWS:
        raise InputError("law", f"is {law!r}", f"choose one of {', '.join(LAWS)}")
    if law == "flat" and not smoothing:
        raise InputError("smoothing", "is missing", "a flat inverse needs rounded corners: give a width such as 0.06 s")
    j, r = np.meshgrid(
        [positive("jerks", value, "m/s³") for value in jerks],
        [positive("arms", value, "m") for value in arms],
        indexing="ij",
    )
    at = structure.length / 2 if control_point is None else control_point
    frequency, c1, lever = first_mode(structure, at)
    period, width = 2 * np.pi / frequency, smoothing or 0.0
    if law == "from-rest":
        leading, terms = c1 * lever * 0.5 * np.sqrt(np.pi * j * frequency / r), from_rest_terms(j, r, frequency, lever)
    else:
        _refuse_short(float(j.max()), level, _PERIODS * period + width)
        jump = j * np.sqrt(r) / (2 * level**1.5)
        leading = c1 * lever * frequency**2 * jump * abs(hann_transform(frequency * width))
        terms = flat_terms(j, jump, level, width, frequency)
    correction = np.sum(np.abs(terms), axis=0)
    if correction.max() > MOST:
        worst = np.unravel_index(correction.argmax(), correction.shape)
        raise InputError(
            "jerks",
            f"hold {j[worst]:.4g} m/s³ at an arm of {r[worst]:.3g} m, where the law's next order is "
            f"{correction[worst]:.0%} of its leading one",
            f"give smaller jerks or arms: the law is known up to {MOST:.0%}",
        )

    def vibration(jerk: float, arm: float) -> float:
        if law == "from-rest":
            return from_rest(structure, jerk, arm, at)
        corner = 0.5 * level / jerk
        flight = Flight(z=tabulated([0.0, corner], [0.5 * level, level]))
        motion = Centrifuge(
            flight, arm=arm, control_point=at, inverse="flat", gravity=False, smoothing=width, start="idle"
        )
        return after_corner(structure, motion, corner, width)

    simulated = np.vectorize(vibration, otypes=[float])(j, r)
    predicted = leading * np.abs(1 + np.sum(terms, axis=0))
    return JerkStudy(law, j[:, 0], r[0], simulated, leading, predicted, correction)


def _refuse_short(jerk: float, level: float, needed: float) -> None:
    """Refuse a ramp over half the level within which the vibration of its two corners cannot be told apart."""
    ramp = 0.5 * level / jerk
    if ramp < needed:
        problem = f"reach {jerk:.3g} m/s³, which passes half the level in {ramp:.3g} s"
        fix = f"give {0.5 * level / needed:.3g} m/s³ or less: {_PERIODS} periods must pass between the corners"
        raise InputError("jerks", problem, fix)


def _run(structure: Structure, motion: object, start: float, duration: float, step: float) -> tuple[Floats, Floats]:
    """Times, and the tip's displacement along z."""
    how = {"integrator": "gauss", "estimate": False, "loads": False}  # of what else there is nothing is read
    response = simulate(structure, motion, start=start, duration=duration, step=step, **how)
    return response.time, response.tip[:, 2]


def _phasor(t: Floats, z: Floats, frequency: float, trend: tuple[float, ...]) -> complex:
    """Amplitude and phase, from t = 0, of the vibration at ω₁ beside a trend of powers of t, by least squares."""
    scale = t[-1]
    columns = [np.cos(frequency * t), np.sin(frequency * t), *((t / scale) ** power for power in trend)]
    parts, *_ = np.linalg.lstsq(np.stack(columns, axis=1), z, rcond=None)
    return complex(parts[0], -parts[1])


def from_rest(structure: Structure, jerk: float, arm: float, at: float) -> float:
    """Amplitude at the tip, m, of the vibration that a quasi-static start from rest leaves; SI."""
    frequency = first_mode(structure, at)[0]
    period = 2 * np.pi / frequency
    end = (2 + _PERIODS) * period
    # The square root begins vertically: knots graded towards zero, rounded over a thirtieth of a period.
    grid = end * np.linspace(0, 1, 2001) ** 2
    rate = smoothed(tabulated(grid, np.sqrt(jerk * grid / arm)), period / 30)
    motion = FromRest(rate, arm, at)
    t, z = _run(structure, motion, -period / 15, end * 0.95, period / 100)
    late = t > 2 * period
    # The beam follows the load, ∝ t, and the arm's acceleration, ∝ t^-½ with its second derivative.
    return abs(_phasor(t[late], z[late], frequency, (0, 1, -0.5, -2.5)))


def after_corner(structure: Structure, motion: Centrifuge, corner: float, width: float) -> float:
    """Amplitude at the tip, m, of the vibration that a corner of the load leaves, rounded by a kernel of that width, s.

    The end of a ramp, at the time `corner`, s; the ramp lasts six periods and two widths before.
    """
    frequency = first_mode(structure, float(motion.control_point))[0]
    period = 2 * np.pi / frequency
    watched = _PERIODS * period
    first, last = corner - width / 2, corner + width / 2
    start, end = first - watched, last + watched
    t, z = _run(structure, motion, start - width, end - start + width, period / 50)
    # The run starts with a corner of its own, from a load that stands still to the ramp: its vibration is left out.
    before, after = (_phasor(t[part], z[part], frequency, (0, 1, 2)) for part in ((t > start) & (t < first), t > last))
    return abs(after - before)


@cache
def studies() -> dict[str, JerkStudy]:
    """The specimen of 2020 under both laws, 1 to 15 g/s, arms of 1.5 to 15 m."""
    specimen = Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9), damping_ratio=0.0)
    structure = assemble(specimen, "FOAM", axial=1, y=1, z=3)
    jerks = [j * G for j in (1, 4, 8, 15)]
    return {
        law: jerk_study(structure, jerks, (1.5, 3.3, 7.6, 15), law=law, level=10 * G, smoothing=0.0596) for law in LAWS
    }


def main() -> None:
    """Print the tables."""
    names = {"from-rest": "start from rest, quasi-static", "flat": "corner to 10 g over 59.6 ms, flat"}
    for law, study in studies().items():
        print(f"{names[law]}: vibration of the tip in mm, simulated (less the law, %)")
        print("  g/s" + "".join(f"{f'R = {arm:g} m':>20}" for arm in study.arms))
        for jerk, sizes, errors in zip(study.jerks, study.simulated, study.error, strict=True):
            cells = (f"{1e3 * size:.4f} ({100 * error:+.1f})" for size, error in zip(sizes, errors, strict=True))
            print(f"  {jerk / G:<3.0f}" + "".join(f"{cell:>20}" for cell in cells))
        p, q = study.exponents
        print(f"  goes with j^{p:.2f} R^{q:.2f} where j and R are small\n")


if __name__ == "__main__":
    main()
