"""A slice of the published figures, computed afresh: what takes a moment. The whole is `make validate`'s."""

from __future__ import annotations

import pytest

from validation.published import closed_forms, others, paper2009, paper2020, references, space_beams
from validation.table import AGREES, DIFFERS, Row

CHEAP = {
    "2020": paper2020.rows,
    "2009, Table 2": paper2009.table_2,
    "flap with a tip mass": references.flap_with_tip_mass,
    "Southwell": references.southwell,
    "integrators": references.schemes,
    "double taper": others.double_taper,
    "cable": others.cable,
    "after pulses": closed_forms.corner_and_pulse,
    "resonance": closed_forms.resonance,
    "hinged rigid blade": closed_forms.hinged_rigid_blade,
    "setting angle": closed_forms.setting_angle,
    "free hub": closed_forms.free_hub,
    "hanging chain": closed_forms.hanging_chain,
    "section forces": closed_forms.section_forces,
    "Princeton": space_beams.princeton,
    "laminates": space_beams.laminates,
    "Lee's frame": space_beams.lees_frame,
}


@pytest.mark.parametrize("name", CHEAP)
def test_rows_are_explained(name: str) -> None:
    rows: list[Row] = list(CHEAP[name]())
    assert any(row.verdict == AGREES for row in rows) or name == "2009, Table 2"
    assert not [row for row in rows if row.verdict == DIFFERS]


def test_table_2_of_2009_follows_with_its_own_pi() -> None:
    """Of fifteen printed frequencies fourteen are gbeam's over 2 × 3.14, one is a unit of the last digit off."""
    rows = [row for row in paper2009.table_2() if row.reference is not None]
    so = [row.reference in row.remark.split(" is ")[1] for row in rows if isinstance(row.reference, str)]
    assert (len(so), sum(so)) == (15, 14)
