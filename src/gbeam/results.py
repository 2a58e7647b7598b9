"""What an analysis returns: frozen records of arrays and words. No model, solver or callable inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BaseHistory:
    """Motion of the root over time, base axes.

    Parameters
    ----------
    a_WO_B : (t, 3)
        Acceleration of the root, m/s²; specific force a − g where gravity acts.
    w_WB_B, al_WB_B : (t, 3)
        Angular velocity rad/s and acceleration rad/s².
    """

    a_WO_B: Floats
    w_WB_B: Floats
    al_WB_B: Floats


@dataclass(frozen=True)
class HubResult:
    """A hub turning about z: angle rad, rate rad/s, acceleration rad/s², torque N m (NaN where the rate is given)."""

    angle: Floats
    rate: Floats
    acceleration: Floats
    torque: Floats


@dataclass(frozen=True)
class AxesResult:
    """A three-axis centrifuge over time.

    Parameters
    ----------
    angle, rate, acceleration : (t, 3)
        Of axes 1, 2, 3; rad, rad/s, rad/s².
    wanted, achieved : (t, 3)
        Load at the control point, base axes, m/s²: what was asked, and what the axes make.
    held : (t,) bool
        Where the target is not the flight's load.
    episodes : tuple of (start s, end s, reason)
        The stretches of time in which it is not.
    """

    angle: Floats
    rate: Floats
    acceleration: Floats
    wanted: Floats
    achieved: Floats
    held: NDArray[np.bool_]
    episodes: tuple[tuple[float, float, str], ...]

    @property
    def tracking_error(self) -> Floats:
        """Size of achieved − wanted, (t,) m/s²."""
        return np.asarray(np.linalg.norm(self.achieved - self.wanted, axis=1))


@dataclass(frozen=True)
class Peaks:
    """Extremes of the tip's displacement at every step computed, along x, y, z.

    Parameters
    ----------
    max_abs, time_of_max : (3,)
        m, s.
    residual_amplitude : (3,)
        Half peak-to-peak from the residual's start to the end, m; NaN where none was asked for or reached.
    """

    max_abs: Floats
    time_of_max: Floats
    residual_amplitude: Floats


@dataclass(frozen=True)
class Response:
    """Response of the beam in one environment.

    Parameters
    ----------
    name : str
        The motion's name.
    environment : str
        flight, centrifuge or hub.
    model : str
        The model's kind.
    outcome : str
        done, diverged or not converged.
    message : str
        What happened and what to try, where the outcome is not done.
    warnings : tuple of str
    time : (t,) s
    stations : (s,) m, the last is the tip
    displacement : (t, s, 3)
        Relative to the base axes, m.
    q, qd : (t, n)
        Coordinates and their rates.
    base : BaseHistory
    peaks : Peaks
    integrator : str
    step : float
        s; NaN for adaptive steps.
    steps : int
    error_estimate : float
        Largest error of the tip's displacement, as a fraction of its largest size, estimated from a second run with
        another step; NaN where none was made.
    residual_from : float
        s; NaN where not given.
    hub : HubResult or None
    axes : AxesResult or None
    """

    name: str
    environment: str
    model: str
    outcome: str
    message: str
    warnings: tuple[str, ...]
    time: Floats
    stations: Floats
    displacement: Floats
    q: Floats
    qd: Floats
    base: BaseHistory
    peaks: Peaks
    integrator: str
    step: float
    steps: int
    error_estimate: float
    residual_from: float
    hub: HubResult | None = None
    axes: AxesResult | None = None

    @property
    def tip(self) -> Floats:
        """Displacement of the tip relative to the base axes, (t, 3) m."""
        return self.displacement[:, -1]


@dataclass(frozen=True)
class Comparison:
    """How a centrifuge's response differs from the flight's that it imitates, where its target is the flight's load.

    Parameters
    ----------
    flight, centrifuge : str
        Names of the motions.
    time : (t,) s
    difference : (t, 3)
        Tip displacement on the centrifuge less in flight, m.
    covered : (t,) bool
        Times compared: those at which the target was not held.
    max_difference, rms_difference : (3,)
        Over the covered times, m.
    peak_flight, peak_centrifuge : (3,)
        Largest displacement over the covered times, m.
    """

    flight: str
    centrifuge: str
    time: Floats
    difference: Floats
    covered: NDArray[np.bool_]
    max_difference: Floats
    rms_difference: Floats
    peak_flight: Floats
    peak_centrifuge: Floats

    @property
    def relative(self) -> Floats:
        """Largest difference over the flight's largest displacement, per axis, (3,); NaN without displacement."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.peak_flight > 0, self.max_difference / self.peak_flight, np.nan)

    @property
    def verdict(self) -> str:
        """One line that a person can quote."""
        if not self.covered.any():
            return f"{self.centrifuge} never carries {self.flight}'s load: the target was held all the time"
        main = int(np.argmax(self.peak_flight))
        axis, share = "xyz"[main], self.covered.mean()
        return (
            f"tip displacement along {axis} on {self.centrifuge} agrees with {self.flight} within "
            f"{self.relative[main]:.3g} of its peak ({1e3 * self.max_difference[main]:.4g} mm of "
            f"{1e3 * self.peak_flight[main]:.4g} mm), over {share:.0%} of the time"
        )


@dataclass(frozen=True)
class Study:
    """The responses of one beam in all environments of a scenario, and their comparisons."""

    title: str
    responses: dict[str, Response]
    comparisons: tuple[Comparison, ...]

    @property
    def outcome(self) -> str:
        """``done`` where every response is, else the first other outcome."""
        others = [r.outcome for r in self.responses.values() if r.outcome != "done"]
        return others[0] if others else "done"
