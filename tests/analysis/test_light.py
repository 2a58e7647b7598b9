"""Linear models on a prescribed base never import JAX, whatever is asked of them."""

from __future__ import annotations

import subprocess
import sys

EVERYTHING = """
import sys
import numpy as np
import gbeam as gb

beam = gb.Beam(8.0, gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10),
               [gb.PointMass(8.0, 0.1)], 0.01)
model = gb.assemble(beam, "FOAM", axial=1, y=2)
hub = gb.Hub(radius=0.5, rate=gb.SmoothStep(3.0, 2.0))
assert abs(2 * np.pi * gb.modes(model).frequency[0] - 2.6043) < 1e-3
assert gb.static(model, acceleration=(0.0, 1.0, 0.0)).tip[1] < 0
assert gb.campbell(model, hub, speeds=np.linspace(0, 3, 4)).frequency.shape[1] == 3
assert gb.critical_speed(model, hub, upper=5.0).value is None
assert gb.linearize(model, hub, 2.0).a.shape[0] > 6
response = gb.simulate(model, hub, duration=4.0)
assert response.outcome == "done" and response.loads is not None
print("jax" in sys.modules)
"""


def test_statics_modes_stability_plants_and_responses_import_no_jax() -> None:
    ran = subprocess.run([sys.executable, "-c", EVERYTHING], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == "False\n"
