"""Zhang 2020, example 4, over jerk and arm radius: how much a corner of the load makes the specimen vibrate.

Run it: python examples/jerk_study.py
"""

from gbeam import Beam, Material, Model, Section, assemble
from gbeam.analysis.jerk import jerk_study

G = 9.81
JERKS, ARMS = (1, 4, 8, 15), (1.5, 3.3, 7.6, 15)  # g/s, m
specimen = Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9))
structure = assemble(specimen, Model("FOAM", axial=1, y=1, z=3))

for law, told in (("from-rest", "start from rest, quasi-static"), ("flat", "corner to 10 g over 59.6 ms, flat")):
    study = jerk_study(structure, [j * G for j in JERKS], ARMS, law=law, level=10 * G, smoothing=0.0596)
    print(f"{told}: vibration of the tip in mm, simulated (less the law, %)")
    print("  g/s" + "".join(f"{f'R = {arm:g} m':>20}" for arm in ARMS))
    for jerk, sizes, errors in zip(JERKS, study.simulated, study.error, strict=True):
        cells = (f"{1e3 * size:.4f} ({100 * error:+.1f})" for size, error in zip(sizes, errors, strict=True))
        print(f"  {jerk:<3}" + "".join(f"{cell:>20}" for cell in cells))
    p, q = study.exponents
    print(f"  goes with j^{p:.2f} R^{q:.2f} where j and R are small\n")
