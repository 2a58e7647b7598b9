"""Published tables that rows and tests share, each with where it was read. "Independent" numbers were computed outside
this project with formulations written for the purpose: quadrature, transcendental equations, finite elements.
"""

from __future__ import annotations

# --- 2009, Table 2 (p. 62): kind, rate in rad/s: printed Hz, and true by independent eigenvalues
TABLE_2 = {
    ("FOAM", 0.0): ([0.4635, 2.9047, 8.1332, 15.9377, 26.3462], [0.46326, 2.90320, 8.12903, 15.92965, 26.33286]),
    ("TLAM", 1.0): ([0.4353, 2.9003, 8.1316, 15.9369, 26.3457], [0.43506, 2.89883, 8.12747, 15.92886, 26.33238]),
    ("FOAM", 1.0): ([0.4714, 2.9308, 8.1618, 15.9682, 26.3776], [0.47111, 2.92934, 8.15767, 15.96005, 26.36425]),
}
# TLAM's critical speed, rad/s (p. 62, 66): tip mass in kg: printed, independent
CRITICAL_2009 = {0.0: (2.91, 2.9107), 0.1: (2.60, 2.6043), 0.5: (1.91, 1.9365)}

# --- the 2009 hub-beam by an elastica in tangent angles (Galerkin), computed outside this project
# rad/s or N m, kg: the elastica's peak and residual, m; errors of peak and residual, %, of FOAM, then of CFOAM
SLEWS = {
    (2.8, 0.0): (0.20433, 8.54e-4, 0.03, 0.0, 0.06, 0.4),
    (2.8, 0.1): (0.24754, 7.18e-4, 0.03, -0.3, 0.09, -2.8),
    (2.8, 0.5): (0.40969, 1.96e-3, 0.09, -0.4, 0.29, -5.5),
    (3.0, 0.0): (0.21708, 7.91e-4, 0.03, 0.1, 0.07, 1.0),
    (3.0, 0.1): (0.26276, 1.04e-3, 0.04, -0.2, 0.10, -1.8),
    (3.0, 0.5): (0.43380, 2.85e-3, 0.10, -0.3, 0.33, -3.9),
    (5.0, 0.0): (0.33242, 8.22e-4, 0.06, 0.1, 0.19, 3.3),
    (5.0, 0.1): (0.39450, 1.66e-3, 0.09, 0.0, 0.28, -1.0),
    (5.0, 0.5): (0.63572, 4.51e-3, 0.20, 0.0, 0.78, 0.0),
}
TORQUES = {
    (50.0, 0.0): (0.26961, 0.0246, 0.02, -0.5, -0.07, -3.8),
    (50.0, 0.1): (0.35208, 0.1228, 0.07, 0.0, 0.20, 0.4),
    (50.0, 0.5): (0.59384, 0.2441, 0.18, 0.0, 0.38, 0.6),
    (100.0, 0.0): (0.54819, 0.0746, 0.10, -1.2, -0.18, -9.7),
    (100.0, 0.1): (0.67994, 0.2296, 0.27, 0.3, 0.86, 2.3),
    (100.0, 0.5): (1.17474, 0.4529, 0.75, 0.6, 1.58, 4.7),
    (200.0, 0.0): (1.12747, 0.3050, 0.58, -1.4, 0.53, -14.2),
    (200.0, 0.1): (1.28835, 0.2747, 0.90, 2.8, 2.00, 27.9),
    (200.0, 0.5): (2.25654, 0.5715, 2.84, 8.5, 6.45, 73.4),
    (400.0, 0.0): (1.96617, 0.4713, 2.10, 4.1, 4.92, 42.3),
    (400.0, 0.1): (2.44375, 0.8549, 3.27, -4.4, 8.02, -99.9),
    (400.0, 0.5): (3.97840, 2.2485, 9.30, 4.6, 35.6, -89.7),
}
# Exudyn 1.13.6, 16 ANCFCable2D elements, 5 ms (32 elements, 1 ms: 0.01 % of the peak):
# slew in rad/s, tip mass in kg: peak and residual, m
EXUDYN_SLEWS = {
    (2.8, 0.0): (0.20434, 0.000855),
    (3.0, 0.0): (0.21709, 0.000793),
    (5.0, 0.0): (0.33246, 0.000828),
    (5.0, 0.5): (0.63578, 0.00451),
}
# torque in N m, tip mass in kg: peak and residual, m, hub's angle at 20 s, rad
EXUDYN_TORQUES = {(200.0, 0.0): (1.12747, 0.30501, 13.19169), (200.0, 0.5): (2.25654, 0.57162, 11.4703)}

# --- flap at hub radius 0, Wright, Smith, Thresher and Wang 1982, J. Appl. Mech. 49(1) 197-202; via Bir 2009 AIAA
#     2009-1035, Table 3a, read in SMI-Lab-Inha/pyBModes, tests/fem/test_rotating_uniform_blade.py (977b3d8)
# γ = Ω √(mL⁴/EI): published, independent, both over √(EI/(mL⁴)); published ones are in places rounded twice
UNIFORM_FLAP = {
    0: ([3.516, 22.035, 61.697], [3.516015, 22.034492, 61.697214]),
    1: ([3.682, 22.181, 61.842], [3.681647, 22.181011, 61.841763]),
    2: ([4.137, 22.615, 62.273], [4.13732, 22.614922, 62.273184]),
    3: ([4.797, 23.32, 62.985], [4.797279, 23.320264, 62.984967]),
    6: ([7.36, 26.809, 66.684], [7.360373, 26.809082, 66.683914]),
    10: ([11.202, 33.64, 74.649], [11.202328, 33.640366, 74.649295]),
    12: ([13.17, 37.603, 79.615], [13.17015, 37.603112, 79.614478]),
}
# with a tip mass m_t = mL, via Bir 2010 NREL/CP-500-47953, Table 5, test_rotating_blade_with_tip_mass.py there
TIP_MASS_FLAP = {
    0: ([1.557, 16.25], [1.5573, 16.25009]),
    2: ([2.67, 18.19], [2.66964, 18.19097]),
    5: ([5.522, 26.04], [5.52185, 26.04153]),
    10: ([10.49, 43.45], [10.48644, 43.45172]),
    12: ([12.48, 50.86], [12.48137, 50.85939]),
}
# d(ω²)/d(Ω²) of flap at Ω = 0: a list said to hold to 1e-5, and what three methods find (test_rotating_beams)
SOUTHWELL_LISTED = [1.19333, 6.47744, 17.85944]
SOUTHWELL = [1.193336374, 6.478224864, 17.859519880]

# --- Hamza Cherif and Houmat, 24th ICAS 2004, Table 2 (slenderness 70), read in octave-user/mboct-fem-pkg,
#     inst/fem_tests_060.tst (b0fc510): γ: flap 1, chord 1
SLENDERNESS_70 = {
    2: (4.1373, 3.6195),
    4: (5.5850, 3.888),
    6: (7.3603, 4.2393),
    8: (9.2568, 4.6105),
    10: (11.2023, 4.97),
    50: (51.0805, 7.3362),
}

# --- straight blade of Epps and Chandra 1996, J. Am. Helicopter Soc. 41:29, modelled by Hodges, Shang and Cesnik 1995,
#     read in byuflowlab/GXBeam.jl, test/examples/rotating.jl (8541187)
# rpm: flap 1 to 3 measured without sweep; flap 1 to 4 of Euler and Bernoulli's beam (independent), Hz
BLADE = {
    0: ([1.4, 10.3, 27.7], [1.49, 9.32, 26.1, 51.14]),
    500: ([10.2, 25.2, 47.0], [9.19, 23.84, 44.55, 72.61]),
    750: ([14.8, 36.1, 62.9], [13.55, 34.0, 59.49, 91.81]),
}

# degrees of sweep of the outer 6 of 37.5 in, rpm: frequencies out of the plane measured, Hz; the last three of 750 rpm
# of the same experiments, in what GXBeam's test takes for its fourth to sixth modes
SWEPT = {
    15: {0: [1.8, 10.2, 27.2], 500: [10.1, 25.2, 44.4], 750: [14.4, 34.8, 55.9, 87.5, 120.1, 147.3]},
    30: {0: [1.7, 10.4, 26.6], 500: [10.2, 23.7, 39.3], 750: [14.9, 30.7, 48.6, 83.7, 122.6, 166.2]},
    45: {0: [1.6, 10.4, 24.8], 500: [10.2, 21.6, 35.1], 750: [14.7, 26.1, 44.8, 78.8, 117.7, 162.0]},
}

# --- inextensible elastica under a dead tip force (own quadrature; Mattiasson's table of 1981)
# F L²/EI: 1 − x/L, y/L and slope of the tip, rad
ELASTICA = {
    1: (0.056433, 0.301721, 0.461352),
    2: (0.160642, 0.493457, 0.78175),
    3: (0.25442, 0.603253, 0.986017),
    5: (0.387628, 0.713792, 1.215368),
    10: (0.554996, 0.810609, 1.430286),
}

# --- Newmark 1959; Hilber, Hughes and Taylor 1977; Chung and Hulbert 1993: an undamped oscillator
# h/T: relative period elongation, algorithmic damping ratio; spectral radius at infinity
SCHEMES_THEORY = {
    "Newmark": ({0.01: (0.0003289, 0), 0.05: (0.0081712, 0), 0.1: (0.032075, 0), 0.2: (0.12003, 0)}, 1.0),
    "HHT -0.1": (
        {0.01: (0.00041268, 2.507e-6), 0.05: (0.010202, 0.0002997), 0.1: (0.039506, 0.002106), 0.2: (0.14243, 0.01113)},
        0.81818,
    ),
    "generalised-α 0.9": (
        {0.01: (0.000333, 1.807e-8), 0.05: (0.0082729, 2.222e-6), 0.1: (0.032472, 1.692e-5), 0.2: (0.12149, 0.0001145)},
        0.90007,
    ),
    "generalised-α 0.5": (
        {0.01: (0.00049318, 4.584e-6), 0.05: (0.012157, 0.000545), 0.1: (0.046715, 0.00378), 0.2: (0.16536, 0.01951)},
        0.50008,
    ),
}
