"""Random trees of bodies: any kind of body on any kind of joint, held, driven and asked in any way."""

from __future__ import annotations

from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fuzz.cases import ROOT, Random
from fuzz.scenarios import toml
from gbeam.mechanics import JOINT_KINDS, SLIDES
from gbeam.mechanics import MODEL_KINDS as MODELS

CELLS, SIZE = (4, 2, 1), (0.2, 0.04, 0.01)
METAL = {"density": "2700 kg/m^3", "youngs_modulus": "70 GPa", "poissons_ratio": 0.3}
_OUTSIDE = ("matrices", "modal-test", "solid", "standard-input-data")


def grown(chosen: Random) -> dict[str, bytes]:
    """Files of a scenario, which is named ``tree.toml``, of one to three bodies."""
    files: dict[str, bytes] = {}
    bodies: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    points = ["ground"]
    for k in range(chosen.randint(1, 3)):
        kind = chosen.choice(("rigid", "beam", "beam", "outside"))
        bodies[f"b{k}"] = _BODIES[kind](chosen, files)
        joints[f"j{k}"] = _joint(chosen, f"b{k}", chosen.choice(points))
        points += [f"b{k}.{name}" for name in _carrying(bodies[f"b{k}"])]
    tree: dict[str, Any] = {"title": "A tree", "bodies": bodies, "joints": joints}
    tree |= _around(chosen)
    if chosen.random() < 0.3:
        across = {axis: f"{chosen.uniform(-1, 1):.3g} N" for axis in chosen.sample("xyz", 2)}
        tree["forces"] = {"push": {"on": chosen.choice(points[1:]), "force": across, "follower": chosen.random() < 0.5}}
    if (driven := _drives(joints)) and chosen.random() < 0.3:
        tree["controllers"] = {"loop": _controller(chosen, *chosen.choice(driven))}
    step = chosen.choice(("1 ms", "1 ms", "auto"))
    tree["response"] = {"duration": "0.2 s", "step": step, "estimate": chosen.random() < 0.7}
    return files | {"tree.toml": toml(tree).encode()}


def _around(chosen: Random) -> dict[str, Any]:
    """Gravity on a ground at rest, or a motion that carries all."""
    up = {"profile": "smooth-step", "level": "2 g", "duration": "0.1 s"}
    motions: tuple[dict[str, Any], ...] = (
        {"flight": {"kind": "flight", "acceleration": {chosen.choice("xyz"): up}}},
        {"hub": {"kind": "hub", "radius": "0.2 m", "rate": up | {"level": "60 rpm"}}},
    )
    if chosen.random() < 0.4:
        return {"motion": chosen.choice(motions)}
    down = chosen.choice(([0, 0, "-1 g"], ["-1 g", 0, 0], [0, "1 g", 0], [0, 0, 0]))
    return {"system": {"gravity": down}}


def _rigid(chosen: Random, files: dict[str, bytes]) -> dict[str, Any]:
    far = {"at": [0, f"{chosen.uniform(0, 0.2):.2g} m", "0.1 m"], "turn": [0, f"{chosen.uniform(0, 90):.2g} deg", 0]}
    mass = chosen.choice((0.1, 2.0, 30.0))
    inertia = [f"{share * mass:.3g} kg m^2" for share in (0.01, 0.01, 0.012)]
    body: dict[str, Any] = {"kind": "rigid", "mass": f"{mass} kg", "inertia": inertia}
    if chosen.random() < 0.5:
        body["centre"] = ["0.1 m", 0, f"{chosen.uniform(-0.1, 0.1):.2g} m"]
    return body | {"points": {"far": far, "near": ["0.3 m", 0, 0]}}


def _beam(chosen: Random, files: dict[str, bytes]) -> dict[str, Any]:
    kind = chosen.choice([each for each in MODELS if each != "SFOAM"])
    modes = {"axial": chosen.randint(0, 1), "y": chosen.randint(0, 2), "z": chosen.randint(1, 2)}
    if chosen.random() < 0.4:
        modes |= {"twist": 1} | ({"shear_z": 1} if chosen.random() < 0.5 else {})
    strip = {"shape": "rectangle", "width": "40 mm", "thickness": "4 mm"}
    shape = chosen.choice((strip, {"shape": "tube", "diameter": "20 mm", "wall": "2 mm"}))
    beam: dict[str, Any] = {
        "kind": "beam", "length": "0.5 m", "section": shape, "material": METAL, "damping_ratio": 0.01,
        "model": {"kind": kind, "modes": modes},
    }  # fmt: skip
    if chosen.random() < 0.3:
        beam["masses"] = [{"at": "0.4 m", "mass": "0.1 kg", "offset": [0, "20 mm", 0]}]
    if chosen.random() < 0.3:
        beam["points"] = [{"name": "half", "at": "0.25 m"}]
    if chosen.random() < 0.2:
        beam["loads"] = [{"at": "0.5 m", "force": {"z": "1 N"}, "follower": chosen.random() < 0.5}]
    return beam


def _outside(chosen: Random, files: dict[str, bytes]) -> dict[str, Any]:
    match chosen.choice(_OUTSIDE):
        case "solid":
            files["block.inp"] = _written()
            return {
                "mesh": "block.inp", "unit": "m", "clamp": "wall", "modes": 3, "damping_ratio": 0.01,
                "material": METAL, "interfaces": {"face": "face"},
            }  # fmt: skip
        case "matrices":
            files["chain.npz"] = chain()
            return {
                "matrices": "chain.npz", "damping_ratio": 0.01, "modes": 3, "clamp": [0],
                "points": {"end": 2}, "interfaces": ["end"],
            }  # fmt: skip
        case "modal-test":
            return {
                "kind": "modal-test", "frequency": ["12 Hz", "60 Hz"], "damping_ratio": "2 %", "masses": "0.2 kg",
                "nodes": [["0.2 m", 0, 0], ["0.4 m", 0, 0]], "modal_mass": "0.218 kg",
                "shapes": [[[0, 0, 0.3], [0, 0, 1]], [[0, 0, 1], [0, 0, -0.3]]], "points": {"end": 1},
            }  # fmt: skip
    files["strip.sid"] = (ROOT / "examples" / "data" / "strip.sid").read_bytes()
    return {"standard_input_data": "strip.sid", "damping_ratio": "1 %"}


_BODIES = {"rigid": _rigid, "beam": _beam, "outside": _outside}


def _carrying(body: dict[str, Any]) -> list[str]:
    """Points on which other bodies may hang."""
    named = list(body["points"]) if body.get("kind") == "rigid" else []
    named += ["tip", *(each["name"] for each in body.get("points", ()))] if body.get("kind") == "beam" else []
    named += list(body.get("interfaces", ()))
    return ["root", *named]


def _joint(chosen: Random, body: str, on: str) -> dict[str, Any]:
    kind = chosen.choice(list(JOINT_KINDS))
    joint: dict[str, Any] = {"kind": kind, "body": body, "on": on}
    if axes := JOINT_KINDS[kind].axes:
        joint["axes"] = [[0, 1, 0], [0, 0, 1]][:axes] if chosen.random() < 0.7 else [[1, 0, 0], [0, 1, 0]][:axes]
    if chosen.random() < 0.3:
        joint["turn"] = [0, f"{chosen.uniform(-90, 90):.2g} deg", 0]
    if chosen.random() < 0.3:
        joint["at"] = [0, 0, "50 mm"]
    told: dict[str, dict[str, Any]] = {}
    prescribed = chosen.random() < 0.25
    for name in JOINT_KINDS[kind].names_in("stiffness"):
        if kind == "fixed" and chosen.random() < 0.6:
            continue
        slides = name in SLIDES
        spring = kind == "fixed" or (not prescribed and chosen.random() < 0.5)
        if spring:
            told.setdefault("stiffness", {})[name] = "20 kN/m" if slides else "60 N m/rad"
        if spring and chosen.random() < 0.2:
            told.setdefault("ease", {})[name] = "2 mm" if slides else "3 deg"
        if chosen.random() < 0.2:
            told.setdefault("initial", {})[name] = "3 mm" if slides else "6 deg"
        if not prescribed and chosen.random() < 0.15:
            told.setdefault("stops", {})[name] = ["-5 mm", "5 mm"] if slides else ["-10 deg", "10 deg"]
            told.setdefault("stop_stiffness", {})[name] = "1e5 N/m" if slides else "1e3 N m/rad"
    rates = [
        each for each in JOINT_KINDS[kind].names_in("rate") if kind != "fixed" or each in told.get("stiffness", {})
    ]
    for name in rates:
        slides = name in SLIDES
        smooth = {"profile": "smooth-step", "level": "0.2 m/s" if slides else "90 deg/s", "duration": "0.1 s"}
        if prescribed and kind != "fixed":
            told.setdefault("rate", {})[name] = smooth if chosen.random() < 0.6 else ("0.1 m/s" if slides else "5 rpm")
            continue
        if chosen.random() < 0.3:
            told.setdefault("damping", {})[name] = "30 N s/m" if slides else "0.2 N m s/rad"
        if chosen.random() < 0.15:
            told.setdefault("friction", {})[name] = "1 N" if slides else "0.1 N m"
        if chosen.random() < 0.15:
            told.setdefault("initial_rate", {})[name] = "0.1 m/s" if slides else "20 deg/s"
        if chosen.random() < 0.2:
            told.setdefault("effort", {})[name] = smooth | {"level": "2 N" if slides else "0.5 N m"}
    for key, values in told.items():
        joint[key] = next(iter(values.values())) if len(JOINT_KINDS[kind].names_in(key)) == 1 else values
    return joint


def _drives(joints: dict[str, Any]) -> list[tuple[str, list[str]]]:
    """Coordinates that a controller may drive, and what measures them."""
    free: list[tuple[str, list[str]]] = []
    for name, joint in joints.items():
        kind = JOINT_KINDS[joint["kind"]]
        if "rate" not in joint and kind.axes:
            free += [(f"{name}.{each}", [f"{name}.{each}", f"{name}.{each}_rate"]) for each in kind.names]
        elif "rate" not in joint and kind.turns:
            free.append((f"{name}.wz", [f"{joint['body']}.root.attitude_z", f"{joint['body']}.root.spin_z"]))
    return free


def _controller(chosen: Random, drive: str, measured: list[str]) -> dict[str, Any]:
    law = [{"kind": "gains", "gains": [[0.5, 0.1]]}]
    more = {"delay": "5 ms", "limit": [0.5], "reference": [0.1, 0]}
    controller = {"measure": measured, "drive": [drive], "law": law, "sample": "5 ms"}
    return controller | {key: value for key, value in more.items() if chosen.random() < 0.4}


@cache
def block() -> Any:
    """A mesh of a block of hexahedra, held at one end, whose other end carries."""
    import meshio

    along = [np.linspace(0, length, count + 1) for length, count in zip(SIZE, CELLS, strict=True)]
    nodes = np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)
    counts = [count + 1 for count in CELLS]
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    first = np.stack(np.meshgrid(*map(np.arange, CELLS), indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.ravel_multi_index(tuple(np.moveaxis(first[:, None] + corners, -1, 0)), counts)
    sets = {"wall": np.flatnonzero(nodes[:, 0] == 0), "face": np.flatnonzero(nodes[:, 0] == SIZE[0])}
    return meshio.Mesh(nodes, [("hexahedron", cells)], point_sets=sets)


@cache
def _written() -> bytes:
    with TemporaryDirectory() as folder:
        block().write(file := Path(folder, "block.inp"))
        return file.read_bytes()


@cache
def chain() -> bytes:
    """Matrices of a steel rod of Euler and Bernoulli, two elements long."""
    length, area, inertia = 0.2, 1e-4, 1e-9
    stiff, mass = np.zeros((18, 18)), np.zeros((18, 18))
    bend_k = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    bend_m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
    for first in (0, 6):
        for way, k, m in ((0, 210e9 * area, 7850 * area), (3, 80e9 * 2 * inertia, 7850 * 2 * inertia)):
            at = np.ix_([first + way, first + way + 6], [first + way, first + way + 6])
            stiff[at] += k / length * np.array([[1, -1], [-1, 1]])
            mass[at] += m * length / 6 * np.array([[2, 1], [1, 2]])
        for across, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):
            scale = np.array([1, sign * length, 1, sign * length])
            rows = np.array([across, turn, across + 6, turn + 6]) + first
            stiff[np.ix_(rows, rows)] += 210e9 * inertia / length**3 * bend_k * np.outer(scale, scale)
            mass[np.ix_(rows, rows)] += 7850 * area * length * bend_m * np.outer(scale, scale)
    file = BytesIO()
    np.savez(file, K=stiff, M=mass, nodes=np.array([[0.0, 0, 0], [length, 0, 0], [2 * length, 0, 0]]))
    return file.getvalue()
