"""What to say where an estimated error is large: its main cause, and what helps."""

from __future__ import annotations

from collections.abc import Iterator

from gbeam.analysis.accuracy.beam_theory import Lacking
from gbeam.mechanics.structure import Structure

LIMIT = 0.01  # an error of a steady state above is warned of
BEYOND = "no model here goes beyond it"


def percent(share: float) -> str:
    """A share in percent: ``1.3 %``, ``110 %``."""
    return f"{100 * share:{'.0f' if share > 0.1 else '.2g'}} %"


def cause_and_cure(shapes: float, model: float, beam_theory: float, theory: str) -> tuple[str, str]:
    """The largest of the errors from too few shapes, of the model and of the beam theory, and what helps."""
    if beam_theory > max(shapes, model):
        return f"the theory of slender beams ({theory})", BEYOND
    if not shapes >= model:
        return "the model", 'check with model.kind = "exact"'
    return "too few shapes", "raise model.modes or leave them out"


def of_bodies(structure: Structure, lacking: Lacking, tip: float, limit: float) -> Iterator[str]:
    """Warn of bodies, off the axis that the tip lies on, that are elsewhere by more than a share of its displacement,
    m.
    """
    assert structure.source is not None
    for i, (body, moved) in enumerate(zip(structure.source.beam.masses, lacking.bodies, strict=False)):
        arm = float((body.offset[1] ** 2 + body.offset[2] ** 2) ** 0.5)
        if arm and moved > limit * tip and lacking.causes.get("twist", 0.0) > 0:
            share = f"{percent(moved / tip)} of the tip's displacement"
            yield (
                f"beam.masses[{i}] lies {1e3 * arm:.4g} mm off the axis: the beam twists under it, and it moves by an "
                f"estimated {1e3 * moved:.3g} mm more or less than computed, {share}; no model here has torsion"
            )
