"""Settings of a response over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, TypedDict

from gbeam.analysis.system.initial import Initial, begun
from gbeam.arrays.tree import Value
from gbeam.constants import Integrator, Parameter, State
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import implausible, refuse_traced
from gbeam.guards.limits import STEPS, refuse_more
from gbeam.guards.quantities import Factor, Quantity, Seconds, Time

FINE = 1e-4
KEPT = 50_000  # samples of each history that a file holds, unless the settings say how often: 36 MB of the F-16 example
NO_LOADS = "no loads are computed, nor whether the material yields: the settings say loads = false"


class Settings(TypedDict, total=False):
    """Keywords of :class:`ResponseSettings`, as :func:`gbeam.simulate` takes them. Quantities may be text."""

    duration: Annotated[float | str, Quantity("time")]
    start: Annotated[float | str, Quantity("time")]
    step: Annotated[float | str | None, Quantity("time")]
    integrator: Integrator
    parameters: Mapping[Parameter, float]
    tolerance: Annotated[float | str, Quantity("ratio")]
    residual_from: Annotated[float | str | None, Quantity("time")]
    initial: Initial | State
    estimate: bool
    loads: bool
    histories: Annotated[float | str | None, Quantity("time")]


@typed
@dataclass(frozen=True, eq=False)
class ResponseSettings(Value):
    """Settings of a response over time.

    Raises
    ------
    InputError
        If duration, start, step or tolerance is impossible, there are too many steps, or the estimate has no loads.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=392.0, start=0.1, hold=0.2))
    >>> settings = gb.ResponseSettings(duration=1.0, integrator="newmark", tolerance=0.001)
    >>> gb.simulate(structure, turn, settings).integrator
    'newmark'
    """

    duration: Annotated[
        Annotated[float, Quantity("time", "positive", "duration")], "length of what is computed over time"
    ]
    start: Annotated[float, Quantity("time"), "initial time"] = 0.0
    step: Annotated[
        Annotated[float, Quantity("time", "positive", "step")] | None, "time step; an automatic one where left out"
    ] = None
    integrator: Annotated[
        Integrator,
        "time integrator: gauss, of fourth order; or newmark, the papers' method, hht or generalized-alpha, of second "
        "order, which need more steps",
    ] = "gauss"
    parameters: Annotated[Mapping[Parameter, float], "the integrator's own: beta and gamma; alpha; rho_inf"] = field(
        default_factory=dict
    )
    tolerance: Annotated[
        Factor,
        "largest total error, of displacement, root loads and stress, without a warning; an automatic step aims at a "
        "third of it, and at 1e-4 at most",
    ] = 1e-2
    residual_from: Annotated[Time | None, "time from which the residual vibration is measured"] = None
    initial: Annotated[
        Initial | State,
        'state at the start, or its name, such as "undeformed"; the relative equilibrium if left out',
    ] = field(default_factory=Initial)
    estimate: Annotated[
        bool,
        "whether the error is estimated; false: a given step is run once, and the result says that no error is known; "
        "an automatic one, which nothing but its own error can choose, is found from several runs all the same, and "
        "only shapes and model are not judged",
    ] = True
    loads: Annotated[
        bool,
        "whether what the sections carry, and the outline for pictures, are computed; the estimate is of loads, too, "
        "and an automatic step follows the root's in any case",
    ] = True
    histories: Annotated[
        Annotated[float, Quantity("time", "positive")] | None,
        "time between the samples of histories in the result file, such as 10 ms, as near as the steps allow; left out "
        "it keeps those of the results' steps, up to 50,000 of a motion, else every second, third and so on. Peaks are "
        "of all steps, and of a system so is xarray",
    ] = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "initial", self.begin)
        for name in ("duration", "start", "step"):
            refuse_traced(name, getattr(self, name), "the number of steps follows from it")
        if self.estimate and not self.loads:
            raise InputError(
                "loads", "is false, and the error is estimated of them too", "give estimate = False as well"
            )
        if self.step is not None:
            fix = f"give {self.duration / STEPS:.2g} s or more"
            refuse_more("step", "steps", self.duration / self.step, STEPS, 500.0, fix)

    @property
    def begin(self) -> Initial:
        """The initial state, as an object also if it was given by name."""
        return begun(self.initial)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of implausible settings, and of results and errors that are not computed."""
        step = () if self.step is None else implausible("response.step", "step", self.step)
        left_out = tuple(filter(None, (self.not_estimated, "" if self.loads else NO_LOADS)))
        return (*implausible("response.duration", "duration", self.duration), *step, *left_out)

    @property
    def not_estimated(self) -> str:
        """Sentence about the errors that are not estimated, or "" if all are."""
        lacking = "shapes and models are not judged" if self.step is None else "no error is estimated"
        return "" if self.estimate else f"{lacking}: the settings say estimate = false"

    def kept_every(self, samples: int, step: Seconds) -> int:
        """Number n if every n-th of the `samples` of a history, `step` s apart, goes into a file: all or fewer, unless
        the settings say how often.
        """
        wanted = -(-samples // KEPT) if self.histories is None else round(self.histories / step)
        return max(1, wanted)

    @property
    def aim(self) -> float:
        """Error of the tip's history that an automatic step aims at: a third of the tolerance, at most 1e-4."""
        return min(self.tolerance / 3, FINE)

    @property
    def aim_of_peaks(self) -> float:
        """Error of peaks of tip and root moment that an automatic step aims at: tolerance / 10, at most 1e-4."""
        return min(self.tolerance / 10, FINE)
