"""Zhang 2020, example 4, over jerk and arm radius: what a corner of the load makes the specimen vibrate.

Run it: python examples/jerk_study.py
"""

from gbeam import Beam, Material, Model, Section, assemble
from gbeam.analysis.jerk import jerk_study

G = 9.81
specimen = Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9))
structure = assemble(specimen, Model("FOAM", axial=1, y=1, z=3))

for law, jerks in (("from-rest", [1 * G, 4 * G]), ("flat", [2 * G, 4 * G])):
    study = jerk_study(structure, jerks, [3.3, 7.6], law=law, level=10 * G, smoothing=0.0596)
    print(f"{law}: amplitude at the tip, mm (the law's)")
    for i, jerk in enumerate(study.jerks):
        print(f"  {jerk / G:g} g/s", end="")
        for arm, found, law_says in zip(study.arms, study.simulated[i], study.predicted[i], strict=True):
            print(f"   R = {arm:g} m: {1e3 * found:.4f} ({1e3 * law_says:.4f})", end="")
        print()
