"""Response over time in one environment: posed as equations, initial state and steps, and run."""

from __future__ import annotations

from functools import partial
from typing import Any, Unpack

from gbeam.analysis.response.posed import Posed, pose, poses, prepared
from gbeam.analysis.response.record import response_of
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings, Settings
from gbeam.analysis.response.stepping import enough, run_plan
from gbeam.analysis.steady.subject import Subject
from gbeam.arrays.namespace import holds_jax
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress, tell
from gbeam.results.errors import StepErrors
from gbeam.results.response import Response


@typed
def simulate(
    structure: Structure | System,
    motion: Motion | None = None,
    settings: ResponseSettings | None = None,
    *,
    name: str = "",
    progress: Progress = None,
    **options: Unpack[Settings],
) -> Response:
    """Compute the response of a beam in one environment, or of a system of bodies.

    It starts in relative equilibrium with the base's motion at the start (a free hub at rest). What floats starts
    undeformed. ``initial`` of the settings may say otherwise: ``"undeformed"``, ``"relief"``, or an :class:`Initial`
    state. A machine's run covers its whole motion on the flight's clock: spin-up comes before `start`, and spin-down
    after the duration, in whole steps of the results' grid. The step, the error and the peaks are those of the flight's
    times.

    Parameters
    ----------
    structure : Structure or System
        From :func:`gbeam.assemble`, or a tree of bodies.
    motion : Flight, Centrifuge or Hub
        Of the root of a structure; of the ground of a system, which rests without one.
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate(structure, motion, duration=10.0)``.
    name : str
        For the result.
    progress : callable or bool, optional
        Called with what is being done and the fraction done; True shows a bar.

    Returns
    -------
    Response
        With the loads of every body that deforms, and momentum and energy on a ground at rest. The outcome is ``done``,
        ``diverged`` (the displacement left what the model can mean, the beam lost its stability, or the efforts of a
        controller are not finite), ``not converged`` (Newton's method failed) or ``law failed`` (a controller's law
        raised an error or gave no efforts); what was computed until then is kept. Where JAX traces the
        structure or the motion, its arrays are traced: their derivatives are those of the discrete solution; there is
        no error estimate, a step that fails leaves NaN, and gauss fits no steps to modes that are traced.

    Raises
    ------
    InputError
        If the integrator cannot run this model, the beam has no damping ratio, settings are given twice, there are too
        many steps, a traced run has no step, or a controller's law answers one sample in two ways.
    ComputationError
        If there is no relative equilibrium to start from, or a controller's law fails at its first sample.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(structure, turn, duration=6.0)
    >>> response.outcome
    'done'
    >>> print(f"{1e3 * response.peaks.max_abs[2]:.3f} mm, error {response.error_estimate:.0e}")
    2.302 mm, error 1e-02
    """
    settings = settings_of(settings, options)
    subject = prepared(structure, motion, settings)
    if subject.system.holds_jax or holds_jax(motion):
        if settings.step is None:
            raise InputError("step", "is automatic, and a traced run has no numbers to choose it by", "give a step, s")
        posed = pose(subject, settings, settings.duration / max(1, round(settings.duration / settings.step)))
        run, errors = Run(posed.integrated(posed.result_step, posed.commands), posed.result_step, posed), StepErrors()
    else:
        run, errors = _answered(subject, settings, progress)
    return response_of(run, errors, name, progress)


def _answered(subject: Subject, settings: ResponseSettings, progress: Progress) -> tuple[Run, StepErrors]:
    """Run that counts, of those that the settings need, and the errors of its steps."""
    for posed in poses(subject, settings):
        run, errors = run_plan(posed.plan(), partial(_run, posed, progress))
        if enough(run, errors, settings):
            break
    return run, errors


def _run(posed: Posed, progress: Progress, step: float, words: str) -> Run:
    """Run a problem by steps of a length, s, telling its progress as `words`."""
    return Run.by_steps(posed, step, partial(tell, progress, words))


def settings_of(settings: ResponseSettings | None, options: Settings) -> ResponseSettings:
    """Return the settings given as an object, or by keywords. An InputError says that both or neither are given."""
    for name in options:
        choice("keyword", name, Settings.__annotations__)
    if settings is not None:
        if options:
            raise InputError(next(iter(options)), "is given beside settings", "give one of them")
        return settings
    if "duration" not in options:
        raise InputError("duration", "is missing", "give the response's, s, or settings")
    return ResponseSettings(**dict[str, Any](options))  # which reads texts
