"""Answers to the cases in numbers that can be compared; ``python -m tests.former.answers`` records them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

import gbeam as gb
from tests.former.cases import COUNT, Former, case

RECORD = Path(__file__).parents[1] / "data" / "former" / "answers.jsonl"
Answers = dict[str, Any]  # words, and lists of numbers: those of "errors" are stated errors


def answers(seed: int) -> Answers:
    """Answers to the case of a seed."""
    of = case(seed)
    how = {"seed": seed, "specimen": of.kind, "model": of.structure.kind, "question": of.question}
    response = gb.simulate(of.structure, of.motion, of.settings)
    how |= {"motion": response.environment, "outcome": response.outcome, "integrator": response.integrator}
    return how | {"steps": response.steps} | _of_response(response) | _of_question(of)


def _of_response(response: gb.Response) -> Answers:
    """Tip and its peaks, m; peaks of the root's loads, N and N m, and of stress, Pa; errors of all three."""
    peaks, count = response.peaks, len(response.time)
    instants = np.asarray(response.tip)[[count // 3, 2 * count // 3, count - 1]]
    numbers = {"tip": instants.ravel(), "tip_peaks": [*peaks.max_abs, peaks.max_size]}
    if response.specimen is not None:
        numbers["root"] = [response.specimen.force_max, response.specimen.moment_max]
    elif (loads := peaks.loads) is not None:
        numbers["root"] = [loads.root_force.size.value, loads.root_moment.size.value]
        stress = np.ravel(loads.tension.value), np.ravel(loads.compression.value)
        if np.isfinite(stress).all():
            numbers["stress"] = [stress[0].max(initial=0.0), stress[1].min(initial=0.0)]
    errors = response.errors
    stated = [errors.displacement.total, errors.loads.total, errors.stress.total]
    return {name: _numbers(values) for name, values in numbers.items()} | {"errors": _numbers(stated)}


def _of_question(of: Former) -> Answers:
    """Answer to the further question: deflection, m; frequencies, Hz; or critical rate, rad/s."""
    try:
        if of.question == "static":
            rest = gb.static(of.structure, of.motion)
            return {"static": _numbers(rest.tip)}
        if of.question == "modes":
            modes = gb.modes(of.structure, of.motion)
            return {"frequency": _numbers(modes.frequency[:4]), "frequency_errors": _numbers(modes.error_estimate[:4])}
        if of.question == "campbell":
            lines = gb.campbell(of.structure, of.motion, count=4, modes=3)
            return {"frequency": _numbers(lines.frequency[-1]), "frequency_errors": _numbers(lines.error_estimate[-1])}
        critical = gb.critical_speed(of.structure, of.motion)
        return {"found": critical.outcome, "critical": _numbers([critical.value])}
    except gb.GbeamError as error:
        return {"refused": type(error).__name__}


def _numbers(values: Any) -> list[float | None]:
    """Numbers that JSON has; None where one is not known."""
    return [float(value) if math.isfinite(value) else None for value in np.ravel(np.asarray(values, dtype=float))]


def recorded() -> list[Answers]:
    """The answers of all seeds, as they were."""
    return [json.loads(line) for line in RECORD.read_text(encoding="utf-8").splitlines()]


if __name__ == "__main__":
    RECORD.parent.mkdir(parents=True, exist_ok=True)
    RECORD.write_text("".join(json.dumps(answers(seed)) + "\n" for seed in range(COUNT)), encoding="utf-8")
