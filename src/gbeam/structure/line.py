"""The reference line of a beam at rest: how it curves, turns at corners, and how the sections twist along it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.quantities import Angle, OfKind, Position, Positions, Quantity

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Curvature = Callable[[Floats], Floats]
PANEL = np.pi / 2  # rad by which the line may turn in one panel of a quadrature
MOST = 400.0  # rad in all
_KNOTS, _DEGREE = 33, 7  # of the splines that hold a curve's curvatures between two points
_EXACT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
NEAR = 1e-9  # of the length
_BACK = 1e-6  # of the sum of two directions: they are opposite


@dataclass(frozen=True)
class Piece:
    """A piece of a line that turns evenly: straight, an arc, a helix; without length a corner."""

    length: Annotated[Position, "length of arc; 0, or left out, is a corner"] = 0.0
    twist: Annotated[Angle, "turn of its end against its beginning about the line itself"] = 0.0
    turn_y: Annotated[Angle, "turn about the section's y, towards -z"] = 0.0
    turn_z: Annotated[Angle, "turn about the section's z, towards +y"] = 0.0


@typed
@dataclass(frozen=True, eq=False)
class Line(Value):
    """Reference line of a beam that is not straight at rest, from the root at the origin of the base axes.

    Positions along it, of sections, bodies, loads and points, are lengths of arc. The section's axes are those of the
    base at the root, unless a corner there turns them; along the line they turn by R' = R [κ]× with the curvatures κ
    in axes of the section: twist about x, which is the line's tangent, and curvatures about y and z.

    Parameters
    ----------
    length : float
        m.
    curvature : callable
        From positions (p,) m to (p, 3): twist and curvatures about y and z, 1/m.
    breaks : sequence of float
        Positions between which the curvatures are smooth, m.
    corners : sequence of float
        Positions of corners, m; one at 0 turns the root's section.
    turns : array_like
        (corners, 3) rotation vectors of the corners, axes of the section before them, rad.

    Raises
    ------
    InputError
        If a value is not finite, a corner or a break lies off the line, or the line turns by more than 64 turns.

    Examples
    --------
    A quarter of a circle of 50 mm, by its curvature and by its turn:

    >>> import numpy as np
    >>> bow = gb.Line(0.05 * np.pi / 2, lambda x: np.stack([0 * x, 0 * x, 20 + 0 * x], axis=1))
    >>> bow.places([bow.length])[0].round(6)
    array([[0.05, 0.05, 0.  ]])
    >>> gb.Line.of_pieces([0.05 * np.pi / 2], turn_z=np.pi / 2).places([bow.length])[0].round(6)
    array([[0.05, 0.05, 0.  ]])
    """

    length: Annotated[float, OfKind("length")]
    curvature: Curvature
    breaks: Annotated[Numbers, Quantity("length")] = ()
    corners: Annotated[Numbers, Quantity("length")] = ()
    turns: Annotated[ArrayLike, Quantity("angle")] = ()

    def __post_init__(self) -> None:
        """Check the corners and breaks, and try the curvature at 64 positions."""
        length = float(positive("length", self.length, "m"))
        corners = tuple(float(corner) for corner in self.corners)
        turns = np.asarray(self.turns, dtype=float)
        if turns.shape != (len(corners), 3) and (corners or turns.size):
            raise InputError("turns", f"are an array {turns.shape}", f"give ({len(corners)}, 3), a vector per corner")
        if not np.isfinite(turns).all():
            raise InputError("turns", "are not finite", "give finite angles, rad")
        for i, corner in enumerate(corners):
            if not 0 <= corner < length:
                raise InputError(f"corners[{i}]", f"is at {corner:g} m", f"give a place from 0 to before {length:g} m")
        breaks = tuple(sorted({float(position) for position in self.breaks} | {*corners}))
        if breaks and not (breaks[0] >= 0 and breaks[-1] <= length * (1 + NEAR)):
            raise InputError("breaks", f"reach from {breaks[0]:g} to {breaks[-1]:g} m", f"give 0 to {length:g} m")
        vectors = tuple(tuple(turn.tolist()) for turn in turns.reshape(-1, 3))
        for name, value in (("length", length), ("corners", corners), ("breaks", breaks), ("turns", vectors)):
            object.__setattr__(self, name, value)
        middle = np.linspace(0, length, 65)[:-1] + length / 128
        try:
            values = np.asarray(self.curvature(middle), dtype=float)
        except (TypeError, ValueError) as error:
            fix = "give a function of positions (p,) m that returns (p, 3), 1/m"
            raise InputError("curvature", f"fails with {error}", fix) from None
        if values.shape != (64, 3) or not np.isfinite(values).all():
            problem = f"gives an array {values.shape} at 64 positions" if values.shape != (64, 3) else "is not finite"
            raise InputError("curvature", problem, "return (p, 3): twist and curvatures about y and z, 1/m")
        if (angle := float(np.linalg.norm(values, axis=1).mean()) * length) > MOST:
            raise InputError("curvature", f"turns the line by {angle:.3g} rad", f"give {MOST:g} rad at most")

    @classmethod
    @typed
    def of_pieces(
        cls,
        lengths: Annotated[ArrayLike, Quantity("length")],
        *,
        twist: Annotated[ArrayLike, Quantity("angle")] = 0.0,
        turn_y: Annotated[ArrayLike, Quantity("angle")] = 0.0,
        turn_z: Annotated[ArrayLike, Quantity("angle")] = 0.0,
    ) -> Line:
        """Build a line of pieces that turn evenly: straight ones, arcs, helices, and corners, which have no length.

        Parameters
        ----------
        lengths : array_like
            m, piece by piece; 0 is a corner, at the first place of the root.
        twist, turn_y, turn_z : array_like
            Rotation vector of each piece, from its beginning to its end, in axes of its section, rad: about its
            tangent, about y (a bend towards −z) and about z (towards +y); numbers, or one per piece.

        Raises
        ------
        InputError
            If a value is not finite, a length negative, or nothing has a length.
        """
        size = np.atleast_1d(np.asarray(lengths, dtype=float))
        try:
            angles = (twist, turn_y, turn_z)
            turns = np.stack([np.broadcast_to(np.asarray(angle, float), size.shape) for angle in angles])
        except ValueError:
            raise InputError("twist", "and turns are not one for each piece", f"give {len(size)}, or one") from None
        for i, length in enumerate(size):
            positive(f"lengths[{i}]", float(length), "m", zero=True)
        if not size.sum() > 0:
            raise InputError("lengths", "are all zero", "give one piece a length")
        if not np.isfinite(turns).all():
            raise InputError("twist", "or a turn is not finite", "give finite angles, rad")
        ends, real = np.cumsum(size), size > 0  # pieces without length are corners
        edges = np.append(0.0, ends[real])
        is_corner = ~real & turns.any(axis=0)
        rates = turns.T[real] / size[real, None]
        corners = tuple(ends[is_corner])
        return cls(float(edges[-1]), Even(edges, rates), tuple(edges[1:-1]), corners, turns.T[is_corner])

    @classmethod
    @typed
    def of_points(
        cls,
        points: Annotated[ArrayLike, Quantity("length")],
        twist: Annotated[ArrayLike, Quantity("angle")] = 0.0,
        *,
        smooth: bool = True,
    ) -> Line:
        """Build a line through points: a smooth curve, or straight pieces with corners.

        Parameters
        ----------
        points : array_like
            (k, 3) places at rest, base axes, m; the first is the root, at the origin.
        twist : array_like
            Angle of the section about the line at each point, linear between them, rad; a number at all. Without it
            the section does not turn about the tangent; at the root it turns from x to the tangent by the shortest way.
        smooth : bool
            Whether a cubic spline goes through the points.

        Raises
        ------
        InputError
            If there are less than two points, two neighbours are one, the first is not the origin, or the line turns
            back onto itself.

        Examples
        --------
        A wing swept by 30 degrees and washed out by 5:

        >>> import numpy as np
        >>> tip = [np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0]
        >>> swept = gb.Line.of_points([[0.0, 0.0, 0.0], tip], twist=[0.0, np.radians(5)])
        >>> swept.length, swept.places([1.0])[0].round(4)
        (1.0, array([[0.866, 0.5  , 0.   ]]))
        """
        places = np.asarray(points, dtype=float)
        if places.ndim != 2 or places.shape[1] != 3 or len(places) < 2 or not np.isfinite(places).all():
            raise InputError(
                "points", f"are an array {places.shape}", "give two or more finite places of three numbers, m"
            )
        if places[0].any():
            raise InputError("points[0]", f"is {places[0].tolist()} m", "begin at the root, the origin: [0, 0, 0]")
        size = np.linalg.norm(np.diff(places, axis=0), axis=1)
        if not (size > NEAR * size.sum()).all():
            i = int(np.argmin(size))
            raise InputError(f"points[{i + 1}]", f"is where points[{i}] is", "leave one of them out")
        angles = np.asarray(twist, dtype=float)
        if angles.shape not in ((), (len(places),)) or not np.isfinite(angles).all():
            raise InputError("twist", f"is an array {angles.shape}", f"give one finite angle, or {len(places)}, rad")
        angles = np.broadcast_to(angles, len(places))
        directions = np.diff(places, axis=0) / size[:, None]
        reversals = np.flatnonzero(np.linalg.norm(directions[1:] + directions[:-1], axis=1) < _BACK)
        if reversals.size:
            raise InputError(f"points[{reversals[0] + 2}]", "turns the line back onto itself", "give a point beside it")
        if smooth and len(places) > 2:
            return _curve(places, size, angles)
        from scipy.spatial.transform import Rotation

        axes, lengths, turns = Rotation.identity(), [], []
        for i, (direction, length) in enumerate(zip(directions, size, strict=True)):
            corner = _shortest(f"points[{i + 1}]", directions[i - 1] if i else np.array([1.0, 0.0, 0.0]), direction)
            section_axes = corner * axes * (Rotation.from_rotvec([angles[0], 0, 0]) if i == 0 else Rotation.identity())
            lengths += [0.0, length]
            turns += [(axes.inv() * section_axes).as_rotvec(), np.array([angles[i + 1] - angles[i], 0.0, 0.0])]
            axes = section_axes * Rotation.from_rotvec(turns[-1])
        twists, about_y, about_z = np.array(turns).T
        return cls.of_pieces(lengths, twist=twists, turn_y=about_y, turn_z=about_z)

    @property
    def panels(self) -> tuple[float, ...]:
        """Positions, m, between which the curvatures are smooth and the line turns by a quarter at most."""
        edges, positions = sorted({0.0, *self.breaks, self.length}), set(self.breaks)
        for low, high in pairwise(edges):
            middle = low + (high - low) * (np.arange(16) + 0.5) / 16
            turn = np.linalg.norm(self.curvature(middle), axis=1).mean() * (high - low)
            positions |= set(np.linspace(low, high, 1 + max(1, math.ceil(turn / PANEL - NEAR)))[1:-1].tolist())
        return tuple(sorted(positions))

    def places(self, x: Positions) -> tuple[Floats, Floats]:
        """Places at rest (p, 3), m, base axes, and axes of the sections in columns (p, 3, 3), at positions `x` (p,), m.

        A corner turns all beyond it; one at the root turns the root, too.
        """
        positions = np.atleast_1d(np.asarray(x, dtype=float))
        place, axes = np.zeros((len(positions), 3)), np.zeros((len(positions), 3, 3))
        if not positions.size:  # of no bodies, as every response asks
            return place, axes
        from scipy.integrate import solve_ivp  # these take longer to import than a straight beam to compute
        from scipy.spatial.transform import Rotation

        state, edges = np.append(np.zeros(3), np.eye(3).ravel()), sorted({0.0, *self.breaks, self.length})

        def change(x: float, y: Floats) -> Floats:
            """Derivatives r' = R e₁ and R' = R [κ]×."""
            rotation = y[3:].reshape(3, 3)
            turning = np.cross(np.eye(3), np.asarray(self.curvature(np.array([x])))[0])  # [κ]×
            return np.append(rotation[:, 0], (rotation @ turning).ravel())

        for low, high in pairwise(edges):
            for corner, turn in zip(self.corners, np.asarray(self.turns), strict=True):
                if abs(corner - low) <= NEAR * self.length:
                    turned = state[3:].reshape(3, 3) @ Rotation.from_rotvec(turn).as_matrix()
                    state = np.append(state[:3], turned.ravel())
            inside = (positions <= high) & ((positions > low) | (low == 0.0))
            if high == self.length:
                inside |= positions > high
            wanted, index = np.unique(np.clip(positions[inside], low, high), return_inverse=True)
            stops = np.unique([low, *wanted, high])
            solved = solve_ivp(change, (low, high), state, t_eval=stops, **_EXACT).y.T
            states = solved[np.searchsorted(stops, wanted)][index]
            place[inside], axes[inside] = states[:, :3], states[:, 3:].reshape(-1, 3, 3)
            state = solved[-1]
        return place, axes


@dataclass(frozen=True, eq=False)
class Even(Value):
    """Curvatures (k, 3) that are constant between edges (k + 1,) m."""

    edges: Floats
    rates: Floats

    def __call__(self, x: Floats) -> Floats:
        """Curvatures at positions."""
        return self.rates[np.searchsorted(self.edges[1:-1], x, side="left")]


@dataclass(frozen=True, eq=False)
class Splines(Value):
    """Curvatures by a spline between each two edges (k + 1,) m: knots (k, m) and coefficients (k, n, 3)."""

    edges: Floats
    knots: Floats
    coefficients: Floats

    def __call__(self, x: Floats) -> Floats:
        """Curvatures (p, 3), 1/m, at positions x (p,), m, by the spline of each position's piece."""
        x = np.asarray(x, dtype=float)
        piece, out = np.searchsorted(self.edges[1:-1], x, side="left"), np.zeros((len(x), 3))
        from scipy.interpolate import BSpline

        for k in np.unique(piece):
            spline = BSpline(self.knots[k], self.coefficients[k], _DEGREE)
            out[piece == k] = spline(x[piece == k])
        return out


def _shortest(where: str, before: Floats, after: Floats) -> Rotation:
    """Smallest rotation from one direction to another. InputError, with the place `where`, if they are opposite."""
    from scipy.spatial.transform import Rotation

    axis, cosine = np.cross(before, after), float(before @ after)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        if cosine < 0:
            raise InputError(where, "turns the line back onto itself", "give a point beside it")
        return Rotation.identity()
    return Rotation.from_rotvec(axis / sine * math.atan2(sine, cosine))


def _curve(points: Floats, chords: Floats, twist: Floats) -> Line:
    """Line along the cubic spline through points (k, 3), m, which lie `chords` (k − 1,), m, apart.

    At each point the sections are turned by `twist` (k,), rad, against a frame that does not turn about the line.
    """
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline, make_interp_spline
    from scipy.spatial.transform import Rotation

    curve = CubicSpline(np.append(0.0, np.cumsum(chords)), points)
    slope, bend = curve.derivative(), curve.derivative(2)

    def tangent(u: float) -> tuple[Any, Any, Any]:
        """du/ds, tangent and curvature vector t × t'."""
        first = slope(u)
        rate = 1 / np.linalg.norm(first)
        return rate, first * rate, np.cross(first, bend(u)) * rate**3

    def change(u: float, y: Floats) -> Floats:
        """Derivatives by u of the arc length and of a frame that does not turn about the line."""
        rate, _, turning = tangent(u)
        return np.append(1.0, np.cross(turning, y[1:].reshape(3, 3), axisb=0, axisc=0).ravel()) / rate

    first = _shortest("points[1]", np.array([1.0, 0.0, 0.0]), tangent(0.0)[1])
    edges, knots, coefficients, state = [0.0], [], [], np.append(0.0, first.as_matrix().ravel())
    for low, high, start, end in zip(curve.x, curve.x[1:], twist, twist[1:], strict=False):
        # Places where the splines hold the curvatures are denser at the ends, as polynomials want them.
        u = low + (high - low) * (1 - np.cos(np.pi * np.arange(_KNOTS) / (_KNOTS - 1))) / 2
        states = solve_ivp(change, (low, high), state, t_eval=u, **_EXACT).y.T
        state, s = states[-1], states[:, 0]
        rate = (end - start) / (s[-1] - s[0])
        angle = start + rate * (s - s[0])
        bends = [axes.reshape(3, 3).T @ tangent(parameter)[2] for axes, parameter in zip(states[:, 1:], u, strict=True)]
        _, y, z = np.array(bends).T
        c, n = np.cos(angle), np.sin(angle)
        spline: Any = make_interp_spline(s, np.stack([rate + 0 * s, c * y + n * z, c * z - n * y], axis=1), _DEGREE)
        edges.append(float(s[-1]))
        knots.append(spline.t)
        coefficients.append(spline.c)
    root = (first * Rotation.from_rotvec([twist[0], 0, 0])).as_rotvec()
    curvature = Splines(np.array(edges), np.array(knots), np.array(coefficients))
    corners = ((0.0,), root[None]) if root.any() else ((), ())
    return Line(edges[-1], curvature, tuple(edges[1:-1]), *corners)
