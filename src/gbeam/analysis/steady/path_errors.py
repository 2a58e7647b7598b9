"""Errors of equilibrium paths, by paths of richer models."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from gbeam.analysis.accuracy.estimate import LIMIT, error_warning, percent
from gbeam.analysis.steady.frequency_errors import RicherModels
from gbeam.analysis.system.load_path import FollowedPath, Loading, follow
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.tree.system import System
from gbeam.numerics.continuation import CurvePoint
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import BRANCH_POINT
from gbeam.results.errors import ErrorEstimate

FARTHER = 1.02  # of a path's length, to which richer models are followed
SEEN = 0.05  # share of its size by which a richer model's path, read by a spline, may bend within a step
FINE = 16  # parts of each step of a richer model's path, with which a path is compared


def judged(
    followed: FollowedPath, upper: float, progress: Progress = None
) -> tuple[ErrorEstimate, list[ErrorEstimate], tuple[str, ...]]:
    """Errors of a path and of its critical points by paths of richer models, and warnings where they exceed 1 %.

    NaN, with a warning, where a richer model's path was not followed as far.
    """
    loading, unknown = followed.loading, [ErrorEstimate() for _ in followed.critical]
    richer = RicherModels(loading.start, near=False)
    end, count = FARTHER * followed.points[-1].length, 5 if richer.theories else 2
    number = itertools.count()

    def path_of(system: System) -> Trace:
        """Path of a richer model."""
        other, done = Loading.of(system, loading.drive, loading.varied), next(number)

        def report(at: CurvePoint) -> None:
            share = (done + min(at.length / end, 1.0)) / count
            tell(progress, "errors, by paths of richer models", min((1 + share) / 2, 1.0))

        other_path = follow(other, upper, lambda at: 1 - at.length / end, report, SEEN, beyond=True)
        if other_path.ended:
            raise ComputationError("not converged", other_path.ended)
        return Trace.of(other_path)

    try:
        path, exact = Trace.of(followed), path_of(richer.exact.model)
        same = exact if richer.same is richer.exact else path_of(richer.same.model)
        systems, plates = richer.systems_by_theory(loading.system) if richer.theories else ([], {})
        different = systems if any(plate.any() for plate in plates.values()) else systems[:2]
        models = [path_of(model) for model in different]
        rough = None if richer.rough is None else path_of(richer.rough.model)
    except (ComputationError, np.linalg.LinAlgError) as error:
        return ErrorEstimate(), unknown, (f"the error of the path is not known: of a richer model {error}",)

    def estimated(difference: Callable[[Trace, Trace], float]) -> ErrorEstimate:
        """Errors by a measure of the difference of two paths."""
        model = richer.model_share(difference(same, exact))
        estimate = ErrorEstimate(0.0, difference(path, same), model, total=difference(path, exact))
        if models:
            slender, *thick = models
            estimate = estimate.adding(beam_theory=max(difference(slender, other) for other in thick))
        return estimate if rough is None else estimate.adding(mesh=difference(path, rough))

    along = estimated(Trace.distance)
    kinds = [kind for kind, _ in path.critical]
    shares = [estimated(partial(Trace.difference_at, kind, kinds[:k].count(kind))) for k, kind in enumerate(kinds)]
    doubts = list[str]()
    worst = ErrorEstimate.from_largest([along, *shares])
    if worst.total > LIMIT:
        doubts.append(error_warning("the path", percent(worst.total), worst, ""))
    first = min((factor for _, factor in path.critical), default=math.inf)
    for model, other in [
        ("the exact model", exact),
        *(("a beam with shear and twist", thick) for thick in models[1:2]),
    ]:
        earlier = [factor for factor in other.factors(BRANCH_POINT) if factor < (1 - LIMIT) * first]
        if earlier:
            doubts.append(f"{model} leaves this path at a factor of {earlier[0]:.4g}, where it buckles")
            break
    return along, shares, tuple(doubts)


@dataclass(frozen=True)
class Trace:
    """Load factors and displacements along a path that was followed, (s, 1 + 3 p), its length, and kinds and factors of
    its critical points.
    """

    values: Floats
    length: Floats
    critical: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, followed: FollowedPath) -> Trace:
        """Values along a path."""
        factor = [at.value for at in followed.points]
        length = [at.length for at in followed.points]
        values = np.column_stack([factor, followed.moved.reshape(len(factor), -1)])
        return cls(values, np.array(length), tuple((kind, factor[k]) for kind, k in followed.critical))

    def distance(self, other: Trace) -> float:
        """Largest distance of its points from another path, as a share of its largest factor or displacement."""
        from scipy.interpolate import CubicSpline

        count = len(other.length)
        fine = np.interp(np.linspace(0, count - 1, FINE * (count - 1) + 1), np.arange(count), other.length)
        size = np.abs(self.values).max(axis=0)
        size[1:] = size[1:].max()
        curve = CubicSpline(other.length, other.values / size)(fine)
        chord = np.diff(curve, axis=0)
        farthest = 0.0
        for point in self.values / size:
            along = ((point - curve[:-1]) * chord).sum(axis=1) / (chord**2).sum(axis=1)
            nearest = curve[:-1] + np.clip(along, 0.0, 1.0)[:, None] * chord
            farthest = max(farthest, float(np.linalg.norm(nearest - point, axis=1).min()))
        return farthest

    def factors(self, kind: str) -> list[float]:
        """Load factors at critical points of a kind, in turn."""
        return [factor for name, factor in self.critical if name == kind]

    @staticmethod
    def difference_at(kind: str, k: int, one: Trace, other: Trace) -> float:
        """Difference of the factors at the k-th critical points of a kind of two paths, as a share of the first path's
        largest; infinite where one has fewer.
        """
        factors = one.factors(kind)[k:], other.factors(kind)[k:]
        largest = max(abs(factor) for _, factor in one.critical)
        return abs(factors[0][0] - factors[1][0]) / largest if all(factors) else math.inf
