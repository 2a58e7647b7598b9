"""Scene of the viewer, from the variables of a result's file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from gbeam.report.page.parts import Numbers, Ref, variables_under
from gbeam.report.words import number
from gbeam.results.result import Floats
from gbeam.results.solids import von_mises

Variables = Mapping[str, Any]
TIMES = 1500  # of bodies that have no outline of their own
SIGNS = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T  # of a box's corners
CORNERS = (SIGNS + 1) / 2
SURFACE = ("vertices", "triangles", "shapes", "stress", "sizes")
BEYOND = 1e-3  # of the largest stress that is judged: more is said
MESH = ("shapes", "sizes_real", "sizes_imag")  # of a surface in modes
GROUND = "ground_root_acceleration"
_PLACED = ("place", "attitude", GROUND)  # of points, and of the ground
LINE = (("rest", "place"), ("across", "across"))  # of a beam that is not straight, and where an outline has it
SUPPORT = ("name", "words", "rigid", "yielding", "place", "extents")
BASE = np.array([0.0, 0, 0, 1, 0, 0, 0, 0, 0, 0])  # frame of a body whose root is the origin and does not turn
NEAR = 1e-6  # of a body's size: what is nearer to its middle is on neither side of it
FAR = 4  # times their own size: bodies that go farther are followed
AMPLITUDE, TURN = 0.15, 0.6  # of a mode: of the length, of the largest displacement; rad, the largest rotation
PERIOD = 2.0  # s, in which a mode is shown
PHASES = np.linspace(0.0, PERIOD, 25)
WIDE, THICK = 0.03, 0.012  # of the length: of a body whose section is not known


def scene(motions: Mapping[str, str], variables: Variables, numbers: Numbers) -> dict[str, Any] | None:
    """Return the motions that can be shown, and the time at which the first one deflects most, or None if
    there are none.
    """
    motion_scenes = []
    for name, environment in motions.items():
        v = variables_under(f"motions/{name}/", variables)
        if "hangs_on" in v:
            moved = _at_once(v) if v["place"].ndim == 2 else _on_hub(v)
            motion_scenes.append(motion(name, environment, moved, numbers))
    if not motion_scenes:
        return None
    _, time, displacement = motion_scenes[0]
    start = float(time[(displacement[:, -1] ** 2).sum(axis=-1).argmax()])
    return {"motions": [header for header, *_ in motion_scenes], "start": start}


def _header(name: str, environment: str, parts: list[Any], time: Ref, largest: float) -> dict[str, Any]:
    """Header of every motion: its parts, the place of its times, and its largest deflection."""
    return {"name": name, "environment": environment, "parts": parts, "time": time, "largest": largest}


def _indices(time: Floats, chosen_times: Floats) -> Any:
    """Indices in `time` of the chosen times."""
    return np.searchsorted(time, chosen_times - 1e-12).clip(max=len(time) - 1)


def _surface(surface: Variables, stress: Floats | None, numbers: Numbers) -> tuple[dict[str, Any], Floats]:
    """Header of a surface in a few shapes, with its largest stress, and the displacement (t, 1, 3) of a vertex.

    The stress is the largest over time (`stress`) if known, or else of the vertices that are judged. The vertex is the
    one that moves farthest.
    """
    sizes = surface["sizes"][:: max(1, len(surface["sizes"]) // 100)]
    displacement = np.einsum("ts,sva->tva", sizes, surface["shapes"])
    by_vertex = von_mises(np.einsum("ts,sva->tva", sizes, surface["stress"])).max(axis=0)
    judged = surface["judged"].astype(bool)
    largest = float(by_vertex[judged].max(initial=0.0) if stress is None else np.max(stress))
    vertex = (displacement**2).sum(axis=-1).max(axis=0).argmax()
    header = {key: numbers.add(surface[key]) for key in SURFACE} | {"largest": largest}
    header["beyond"] = bool(by_vertex[~judged].max(initial=0.0) > (1 + BEYOND) * largest)
    return header, np.einsum("ts,sa->ta", surface["sizes"], surface["shapes"][:, vertex])[:, None]


def _load_header(v: Variables, index: Any, places: Floats, numbers: Numbers) -> dict[str, Any]:
    """Header of the loads around a specimen over `places` (p, 3): of the base and, if there is one, of the machine."""
    actual = v.get("load_actual")
    load = v.get(GROUND) if actual is None else actual
    header = {} if load is None else {"load": numbers.add(load[index]), "largestLoad": _longest(load)}
    if actual is None:
        return header
    time, place, turn = v["time"], v.get("control_place"), v.get("turn")
    header |= {
        "reference": numbers.add(v["load_reference"][index]),
        "controlPlace": [float(v["control_point"]), 0.0, 0.0] if place is None else np.ravel(place).tolist(),
        "extent": [places.min(axis=0).tolist(), places.max(axis=0).tolist()],
        "axes": numbers.add(v["axis_angle"][index]),
        "arm": float(v["arm"]),
        "span": [max(float(v["flight_from"]), float(time[0])), min(float(v["flight_to"]), float(time[-1]))],
    }
    return header if turn is None else header | {"turn": np.ravel(turn).tolist()}


def _beam(variables: Variables, index: Any, numbers: Numbers) -> dict[str, Any]:
    """Header of a beam in axes of its root, with its stress at the times of `index`."""
    get: Any = variables.get
    header: dict[str, Any] = {
        **shape(get("point"), get("outline_width"), get("outline_thickness"), get("outline_round")),
        **{key: get(f"outline_{name}").tolist() for key, name in LINE if get(f"outline_{name}") is not None},
        "bodies": []
        if get("body_mass") is None
        else np.column_stack([get("body_position"), get("body_mass")]).tolist(),
        "displacement": numbers.add(get("outline")),
    }
    if get("outline_twist") is not None:
        header["twist"] = numbers.add(get("outline_twist"))
    stress = get("stress")
    if stress is not None and np.isfinite(stress).all():
        largest = float(np.max(stress))
        header["stress"] = {"at": get("section").tolist(), "values": numbers.add(stress[index]), "largest": largest}
    return header


def _supports(held: Variables, around: Floats, times: Floats, numbers: Numbers) -> list[dict[str, Any]]:
    """Headers of the supports of a body, which has points `around` (p, 3), and how they move at some times."""
    low, high = around.min(axis=0), around.max(axis=0)
    columns: dict[str, Any] = {key: held[key].tolist() for key in SUPPORT}
    size = float(np.linalg.norm(high - low))
    columns["beyond"] = (held["place"] - (low + high) / 2 > NEAR * size).tolist()
    moved = held["displacement"].reshape(len(held["time"]), -1)
    displacement = np.stack([np.interp(times, held["time"], component) for component in moved.T], axis=1)
    by_support = np.moveaxis(displacement.reshape(len(times), -1, 3), 1, 0)
    columns["displacement"] = [numbers.add(values) for values in by_support]
    return [{**dict(zip(columns, row, strict=True)), "size": size} for row in zip(*columns.values(), strict=True)]


def motion(name: str, environment: str, v: Variables, numbers: Numbers) -> tuple[dict[str, Any], Floats, Floats]:
    """Header of the motion of bodies; its times (t,) and the deflection (t, 1, 3) of the body that deflects most, of
    bodies that are rigid the load of their ground.
    """
    time, beams = v["time"], [body for body in v["body"] if f"{body}_outline" in v]
    times = v[f"{beams[0]}_outline_time"] if beams else time[:: -(-len(time) // TIMES)]
    index = _indices(time, times)
    place, points = v["place"][index], list(v["point"])
    frames: dict[str, tuple[Any, Any, Floats]] = {
        "ground": (Rotation.identity(), np.zeros(3), np.zeros((len(times), 3)))
    }
    parts, corners, carrier = [], list[Floats](), dict[str, Any]()
    deflected = np.zeros((len(times), 1, 3))
    for k, body in enumerate(v["body"]):
        inner = variables_under(f"{body}_", v)
        root = points.index(f"{body}.root")
        attitude = v["attitude"][index, root]
        turn = Rotation.from_quat(np.roll(attitude, -1, axis=-1))
        origin = place[:, root]
        parent = v["hangs_on"][k]
        parent_turn, parent_place, offset = frames[parent.partition(".")[0]]
        if parent in points:
            bent = parent_turn.inv().apply(place[:, points.index(parent)] - parent_place) - v["place_at_rest"][k]
            offset = offset + parent_turn.apply(np.where(np.abs(bent) > 1e-9 * np.abs(place).max(), bent, 0.0))
        frames[body] = turn, origin, offset
        frame = np.concatenate([origin, attitude, offset], axis=-1)
        moved = bool(np.any(frame - BASE))
        part: dict[str, Any] = {"frame": numbers.add(frame)} if moved else {}
        reach = np.zeros((0, 3))
        if body in beams:
            part["beam"] = _beam(inner, index, numbers)
            farthest = (inner["outline"] ** 2).sum(axis=-1).max(axis=0).argmax()
            moved_farthest = inner["outline"][:, farthest, None]
            deflected = moved_farthest if _longest(moved_farthest) > _longest(deflected) else deflected
            reach = inner.get("outline_place", reach)  # of a straight one its points say where it is
            carrier |= _carrier(inner, v, index, numbers)
        elif "surface_vertices" in inner:
            surface = variables_under("surface_", inner)
            sizes = [np.interp(times, surface["time"], size) for size in surface["sizes"].T]
            surface["sizes"] = np.stack(sizes, axis=1)
            part["surface"], farthest = _surface(surface, inner.get("solid_von_mises"), numbers)
            deflected = farthest if _longest(farthest) > _longest(deflected) else deflected
            reach = surface["vertices"].min(axis=0) + CORNERS * np.ptp(surface["vertices"], axis=0)
        elif "specimen_corner_place" in inner:
            bolts = inner.get("specimen_bolt_place", reach)
            low, high = (pick(inner["specimen_corner_place"], axis=0) for pick in (np.min, np.max))
            part |= {"box": _box(high - low, (low + high) / 2, np.eye(3)), "points": bolts.tolist()}
            reach = np.concatenate([low + CORNERS * (high - low), bolts])
        else:
            other_points = [i for i, point in enumerate(points) if point.startswith(f"{body}.") and i != root]
            part["points"] = [turn[0].inv().apply(place[0, i] - origin[0]).tolist() for i in other_points]
            if "box" in v and np.isfinite(v["box"][k]).all():  # no variable where all are flexible
                size, centre, rotation = (v[key][k] for key in ("box", "box_centre", "box_rotation"))
                part["box"] = _box(size, centre, rotation)
                reach = centre + (SIGNS * size / 2) @ rotation.T
        held = variables_under("holder_", inner)
        if held:
            along = [[x, 0.0, 0.0] for x in part["beam"]["points"]] if body in beams else part.get("points", [])
            around = reach if len(reach) else np.array([[0.0, 0.0, 0.0], *along])
            part["supports"] = _supports(held, around, times, numbers)
        corners += [origin[:, None] + turn.apply(place_on_body)[:, None] for place_on_body in reach]
        parts.append(part | ({"joint": True} if v["joint_kind"][k] not in ("fixed", "free") else {}))
    middle, radius = _view(np.concatenate([place, *corners], axis=1))
    largest = max([_longest(deflected), *(_longest(v[f"{body}_outline"]) for body in beams)])
    header = _header(name, environment, parts, numbers.add(times), largest)
    header["length"] = max((_length(variables_under(f"{body}_", v)) for body in beams), default=2 * radius)
    if len(parts) > 1 or corners or moved:  # more than one straight beam on its base
        header |= {"middle": numbers.add(middle), "radiusShown": radius}
    at_start = np.concatenate([np.zeros((1, 3)), v["undeformed"], *(corner[0] for corner in corners)])
    header |= carrier | _load_header(v, index, at_start, numbers)
    if GROUND in v and not deflected.any():
        deflected = v[GROUND][index, None]
    return header, times, deflected


def _length(beam: Variables) -> float:
    """Length of a beam, of one on a line the largest distance from its root."""
    return float(beam["point"][-1]) if "outline_place" not in beam else _longest(beam["outline_place"])


def _carrier(inner: Variables, v: Variables, index: Any, numbers: Numbers) -> dict[str, Any]:
    """Header of how the frame that carries a beam turns: by its attitude in flight, or with a hub."""
    header: dict[str, Any] = {"attitude": numbers.add(inner["attitude"])} if "attitude" in inner else {}
    if "hub_radius" in inner:
        header |= {"radius": float(inner["hub_radius"]), "mounting": np.ravel(inner["hub_mounting"]).tolist()}
        header["angle"] = numbers.add(v["hub_angle"][index])
    if "arm_root" in inner:
        header["place"] = inner["arm_root"].tolist()
    return header


def _box(size: Floats, centre: Floats, rotation: Floats) -> dict[str, Any]:
    return {"size": size.tolist(), "centre": centre.tolist(), "rotation": np.ravel(rotation).tolist()}


def _view(place: Floats) -> tuple[Floats, float]:
    """Centre (1, 3) and radius of the view of points (t, p, 3). The centre follows them, (t, 3), if they go far."""
    low, high = place.min(axis=(0, 1)), place.max(axis=(0, 1))
    centre = (place.min(axis=1) + place.max(axis=1)) / 2
    size = float(np.linalg.norm(place - centre[:, None], axis=-1).max())
    whole_size = float(np.linalg.norm(high - low)) / 2
    if whole_size > FAR * size > 0:
        return centre, 1.05 * size
    return (low + high)[None] / 2, 1.05 * whole_size or 1.0


def shape(points: Floats, width: Floats, thickness: Floats, is_round: Any) -> dict[str, Any]:
    """Header of a beam's shape: points along its axis, and the extents of its section."""
    return {
        "points": np.asarray(points).tolist(),
        "width": np.asarray(width).tolist(),
        "thickness": np.asarray(thickness).tolist(),
        "round": bool(is_round),
    }


def _at_once(v: Variables) -> Variables:
    """Return the variables of a system at rest as those of one time."""
    return {**v, "time": np.zeros(1), **{name: v[name][None] for name in _PLACED if name in v}}


def _on_hub(v: Variables) -> Variables:
    """Return the variables of a body on a free hub as those of the body alone, in root axes that turn with it.

    Other variables are returned as they are.
    """
    bodies = [body for body in v["body"] if f"{body}_hub_radius" in v]
    if not bodies or GROUND in v:
        return v
    (body,), times = bodies, len(v["time"])
    joint = {"hangs_on": ["ground"], "joint_kind": ["fixed"], "undeformed": np.zeros((1, 3))}
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (times, 1, 1))
    placed = {"point": [f"{body}.root"], "place": np.zeros((times, 1, 3)), "attitude": upright}
    return {**v, "body": bodies, **joint, **placed, GROUND: v[f"{body}_root_acceleration"]}


def _in_mode(surface: Mapping[str, Any], k: int) -> float:
    """Largest displacement of a surface in a mode, in the size of its shape."""
    return _longest(np.abs(np.einsum("s,sva->va", _complex(surface, "sizes")[k], surface["shapes"])))


def _complex(v: Mapping[str, Any], name: str) -> Any:
    return v[f"{name}_real"] + 1j * v[f"{name}_imag"]


def shapes(facts: Mapping[str, Any], v: Variables, numbers: Numbers) -> dict[str, Any]:
    """Return every mode of a system as a motion of one period."""
    v = {name: variable for name, variable in v.items() if name != GROUND}
    for body in v["body"]:
        v |= _line(v, body)
    labels = [f"{i}: {number(mode['frequency'])} Hz, {mode['direction']}" for i, mode in enumerate(facts["modes"], 1)]
    motions = []
    beams = [body for body in v["body"] if f"{body}_outline" in v]
    roots = [list(v["point"]).index(f"{body}.root") for body in v["body"]]
    rest = Rotation.from_quat(np.roll(v["attitude"], -1, axis=-1))
    meshes = {
        body: {key: v[f"{body}_surface_{key}"] for key in MESH} for body in v["body"] if f"{body}_surface_vertices" in v
    }
    _, radius = _view(np.concatenate([v["place"], *(_surroundings(v, body) for body in v["body"])])[None])

    def of_mode(name: str, k: int) -> Any:
        return _complex(v, name)[k]

    for k, label in enumerate(labels):
        sizes = [np.abs(of_mode("point_shape", k)).max()]
        sizes += [np.abs(of_mode(f"{body}_outline_shape", k)).max() for body in beams]
        sizes += [_in_mode(mesh, k) for mesh in meshes.values()]
        twists = {body: of_mode(f"{body}_outline_twist", k) for body in beams if f"{body}_outline_twist_real" in v}
        turn = max(np.abs(turns).max() for turns in (of_mode("point_turn", k)[roots], *twists.values()))
        amplitude = _amplitude(2 * radius, float(max(sizes)), float(turn))
        attitudes = [Rotation.from_rotvec(amplitude * turns) * rest for turns in _swung(of_mode("point_turn", k))]
        modes = {
            **v,
            "time": PHASES,
            "place": v["place"] + amplitude * _swung(of_mode("point_shape", k)),
            "attitude": np.stack([np.roll(attitude.as_quat(), 1, axis=-1) for attitude in attitudes]),
        }
        for body in beams:
            modes[f"{body}_outline_time"] = PHASES
            modes[f"{body}_outline"] = v[f"{body}_outline"] + amplitude * _swung(of_mode(f"{body}_outline_shape", k))
        for body in v["body"]:
            if f"{body}_holder_place" in v:
                modes[f"{body}_holder_time"] = PHASES
                moved = _swung(of_mode(f"{body}_holder_shape", k))
                modes[f"{body}_holder_displacement"] = v[f"{body}_holder_displacement"] + amplitude * moved
        for body, twist in twists.items():
            modes[f"{body}_outline_twist"] = amplitude * _swung(twist)
        for body, mesh in meshes.items():
            modes[f"{body}_surface_time"] = PHASES
            modes[f"{body}_surface_sizes"] = amplitude * _swung(_complex(mesh, "sizes")[k])
        motions.append(_mode(label, motion(label, label, modes, numbers)[0]))
    return {"labels": labels, "motions": motions}


def _line(v: Variables, body: str) -> Variables:
    """Variables of an outline for a body that has neither one nor a surface, such as one by matrices.

    The outline is a strip through its stations.
    """
    x = v.get(f"{body}_station", np.zeros(0))
    if f"{body}_outline" in v or f"{body}_surface_vertices" in v or not len(x) or np.any(np.diff(x, prepend=0.0) <= 0):
        return {}
    width = np.full(len(x) + 1, WIDE * x[-1])
    outline = {"outline_width": width, "outline_thickness": THICK / WIDE * width, "outline_round": False}
    for part in ("shape_real", "shape_imag"):
        outline[f"outline_{part}"] = np.pad(v[f"{body}_{part}"], ((0, 0), (1, 0), (0, 0)))
    outline |= {"point": np.append(0.0, x), "outline": np.zeros((1, len(x) + 1, 3))}
    return {f"{body}_{name}": values for name, values in outline.items()}


def _surroundings(v: Variables, body: str) -> Floats:
    """Points (p, 3) around a body at rest, in axes of the ground: the corners of its surface's box, or its outline."""
    if f"{body}_surface_vertices" in v:
        low, size = v[f"{body}_surface_vertices"].min(axis=0), np.ptp(v[f"{body}_surface_vertices"], axis=0)
        places = low + CORNERS * size
    elif f"{body}_outline_place" in v:
        places = v[f"{body}_outline_place"]
    else:
        return np.zeros((0, 3))
    root = list(v["point"]).index(f"{body}.root")
    return v["place"][root] + Rotation.from_quat(np.roll(v["attitude"][root], -1)).apply(places)


def _amplitude(length: float, largest: float, turn: float) -> float:
    """Factor of a shape whose largest displacement and rotation are these, so that it is seen and does not turn far."""
    return min(AMPLITUDE * length / (largest or 1.0), TURN / turn if turn else np.inf)


def _swung(shape: Any) -> Floats:
    """Real motion (t, ...) over a period of complex shapes."""
    phase = np.exp(2j * np.pi * PHASES / PERIOD).reshape(-1, *[1] * np.ndim(shape))
    return np.asarray((phase * shape).real)


def _mode(label: str, motion: dict[str, Any]) -> dict[str, Any]:
    return motion | {"name": label, "environment": label, "relative": True, "period": PERIOD}


def _longest(vectors: Floats) -> float:
    return float(np.sqrt((vectors**2).sum(axis=-1).max()))
