"""A beam by a fuller theory, as linear models: Timoshenko's shear and rotary inertia, Saint-Venant's twist.

No model here has them. These two, the slender beam and the thick one on the same shapes, say what that leaves out.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.mechanics.assembly import hold
from gbeam.mechanics.beam_terms import heat_of, load_work, particles_of, sections_of
from gbeam.mechanics.enrichment import Enrichment, enrichment, own_families
from gbeam.mechanics.equations.held import held_inertia
from gbeam.mechanics.equations.linear import LoadTerms, coefficients, damping_matrix
from gbeam.mechanics.equations.virtual_work import LoadWork
from gbeam.mechanics.fields.adapted import springs_for_shapes
from gbeam.mechanics.fields.basis import Families, Quadrature
from gbeam.mechanics.fields.strains import STRAINS, StrainField, shaped_strains, strain_field
from gbeam.mechanics.structure import Structure
from gbeam.structure.beam import Beam
from gbeam.structure.matrices import condensed

ZONE = 0.9  # of one term's length: what several terms leave of it


def stiffening(beam: Beam, x: Floats, curvatures: Floats) -> tuple[Floats, Floats]:
    """Factors (p,) on EI_y and EI_z at x (p,), m: a strip is stiffer where, as a plate, it cannot bend across.

    `curvatures` (2, p) are its own, 1/m.
    """
    if beam.material is None:  # what its matrices say is all that is known
        return np.ones(len(x)), np.ones(len(x))
    ratio, (width, thickness) = float(beam.material.ratio), beam.section.at(x).extents()
    plate_gain = ratio**2 / (1 - ratio**2)
    share = [
        flatness(ratio, x, across, through, curvature) * np.maximum(1 - (through / across) ** 2, 0)
        for across, through, curvature in ((width, thickness, curvatures[0]), (thickness, width, curvatures[1]))
    ]
    plate_factor = 1 / (1 - ratio**2) if beam.section.plate else 1.0
    return (1 + plate_gain * share[0]) / plate_factor, 1 + plate_gain * share[1]


def flatness(ratio: float, x: Floats, across: Floats, through: Floats, curvature: Floats) -> Floats:
    """Flatness of sections (p,), from 0 (free to bend across) to 1 (as in a plate), at x, m, from the clamp.

    Sections are `across` m wide and `through` m thick. Near the clamp, where c = c' = 0, the shape c across solves
    b⁴/720 c'''' − (1 − ν) b²/6 c'' + c = −ν w''; a `curvature`, 1/m, adds the stretch's (1 − ν²) (b² w''/h)²/60 c
    (Searle, 1907).
    """
    mean = (1 - ratio) / 6
    root = np.sqrt(mean**2 - 4 / 720)
    slow_rate, fast_rate = np.sqrt(360 * (mean + root)), np.sqrt(360 * (mean - root))
    scaled_x = x / (ZONE * across)
    free_share = (slow_rate * np.exp(-fast_rate * scaled_x) - fast_rate * np.exp(-slow_rate * scaled_x)) / (
        slow_rate - fast_rate
    )
    searle = (1 - ratio**2) * (across**2 * curvature / through) ** 2 / 60
    return 1 - (1 - free_share) / (1 + searle)


NEW = 1e-4  # of a vector's length in energy: less of it is nothing that the others have not
LEVELS = 2  # of Krylov's sequence
# Lengths over radius of gyration from which a direction counts as stiff in shear: its first ten modes change by less
# than 1e-3, and modes of the section itself, of shear and rotary inertia, are so high that rounding hides the low ones.
SLENDEREST = 1500.0
CHUNK = 64  # loaded points whose second derivatives are held at a time
SLENDER, SHEAR, TWIST = (0, 4, 5), (1, 2), (3,)  # strains: stretch, shear along y and z, twist, curvatures


class Theory(NamedTuple):
    """A beam by slender and by thick theory, with the structure's coordinates first.

    The thick one has n coordinates: `columns` of shear and of twist, `curvature` (2, g, n) at the nodes and
    displacements of `bodies` (b, 3, n) per coordinate. `rigidity` (2, g) N m³ is EI_y and EI_z times the nodes'
    weights.
    """

    slender: Structure
    thick: Structure
    columns: dict[str, slice]
    curvature: Floats
    rigidity: Floats
    node: Floats
    bodies: Floats
    beam: Beam

    def plate(self, q: Floats) -> Floats:
        """Stiffness (n, n) that the strip has beyond the model's, by the largest curvatures at coordinates (t, n)."""
        bent = np.abs(np.einsum("agi,ti->atg", self.curvature, q)).max(axis=1)
        factor = np.stack(stiffening(self.beam, self.node, bent))
        weighted = ((factor - 1) * self.rigidity)[..., None] * self.curvature
        return np.asarray(np.einsum("agi,agj->ij", self.curvature, weighted))

    @property
    def exact(self) -> Theory:
        """Both theories without truncation, for answers that are bent far."""
        slender, thick = (_untruncated(beam) for beam in (self.slender, self.thick))
        return self._replace(slender=slender, thick=thick)

    def variants(self, plate: Floats) -> tuple[Structure, Structure]:
        """The thick beam, and the thick beam with the additional stiffness `plate` (n, n)."""
        c = self.thick.coefficients
        return self.thick, replace(self.thick, coefficients=replace(c, stiffness=c.stiffness + plate))


def _untruncated(structure: Structure) -> Structure:
    """Return a structure, and what its supports hold, without truncation."""
    grip = structure.grip
    if grip is not None:
        grip = replace(grip, free=_untruncated(grip.free))
    return replace(structure, kind="exact", linear=False, grip=grip)


@lru_cache(maxsize=4)  # keyed by values, as enrichment is
def theory_of(structure: Structure, hung: tuple[int, ...] = ()) -> Theory:
    """A structure's beam, which it must have, by both theories; other bodies hang on the stations `hung` (indices)."""
    rich = enrichment(structure)
    assert isinstance(rich, Enrichment)
    families = own_families(structure, rich.beam, rich.rule)
    return _Parts(structure, rich.beam, rich.rule, hung).theory(families)


class _Parts:
    """Stiffness, points and motions of a beam: unknowns (m,) are six strains at every node, then the springs."""

    def __init__(self, structure: Structure, beam: Beam, rule: Quadrature, hung: tuple[int, ...] = ()) -> None:
        """Prepare strains, stiffnesses and points of a beam. `hung` are the stations where bodies hang."""
        self.structure, self.beam, self.rule = structure, beam, rule
        x, section = rule.node, beam.section.at(rule.node)
        strained = [strain for strain, count in zip(STRAINS, structure.counts, strict=True) if count]
        self.modelled = tuple({*SLENDER, *strained})
        springs = np.array([*springs_for_shapes(beam).values()], dtype=float)
        self.springs = np.array([*beam.root.springs.values()], dtype=float)
        nodal = np.stack(beam.stiffnesses(x)) * rule.weight
        self.stiffness = np.concatenate([nodal.ravel(), springs])
        self.families = np.append(np.repeat(np.arange(6), len(x)), [SLENDER[0]] * len(springs))
        gyration = np.sqrt(np.stack([section.inertia_z, section.inertia_y]) / section.area)
        slender = beam.length > SLENDEREST * gyration.max(axis=1)
        stiff = [strain for strain, thin in zip(SHEAR, slender, strict=True) if thin and strain not in self.modelled]
        # Without its torsion constant a section does not twist.
        self.known = ~np.isnan(self.stiffness) & ~np.isin(self.families, stiff)
        self.coupling = None if beam.material is not None else beam.section.matrices(x)[0] * rule.weight[:, None, None]
        # Indices of points: nodes, bodies, loads at a place, stations.
        loaded = [load.at for load in beam.loads if load.at is not None]
        self.first_load = len(x) + len(beam.masses)
        self.first_station = self.first_load + len(loaded)
        supports = [int(np.argmin(np.abs(structure.stations - support.at))) for support in beam.held_places.values()]
        self.hung = [self.first_station + k for k in {*hung, *supports}]
        self.points = np.concatenate([x, [body.at for body in beam.masses], loaded, structure.stations])
        self.cumulative, self.at_nodes = rule.cumulative(self.points), rule.cumulative(x)
        self.place, self.axes = beam.at_rest(self.points)
        self.move, self.turn = beam.root.directions()

    def field(self, strains: Floats) -> StrainField:
        """Strain field of shapes with the strains (m, n)."""
        nodal, root = np.split(strains, [6 * len(self.rule.node)])
        shaped = nodal.reshape(6, -1, strains.shape[1])
        return strain_field(self.rule, self.points, shaped, self.move @ root, self.turn @ root, self.beam.line)

    def pulled(self, force: Floats, moment: Floats) -> Floats:
        """Generalised forces (m, k) on the strains, of k cases of forces and moments (3, points, k) at the points."""
        force_outboard, axes = self.cumulative.T @ force, self.axes[: len(self.rule.node)]
        # The axis turns with its sections.
        force_moment = np.cross(axes[:, :, 0].T[..., None], force_outboard, axis=0)
        moment_outboard = self.cumulative.T @ moment + self.at_nodes.T @ force_moment
        root_moment = (moment + np.cross(self.place.T[..., None], force, axis=0)).sum(axis=1)
        springs = self.move.T @ force.sum(axis=1) + self.turn.T @ root_moment
        inward = [
            np.einsum("gba,bgk->agk", axes, resultant).reshape(-1, force.shape[-1])
            for resultant in (force_outboard, moment_outboard)
        ]
        return np.concatenate([*inward, springs])

    def answers(self, coordinates: Floats) -> Floats:
        """Strains (m, k) of the thick beam under static loads.

        The loads are the inertia forces of shapes with strains (m, n), unit accelerations, the beam's loads and forces
        where bodies hang. On each further level they are the inertia forces of the last answers.
        """
        station, mass, offset = particles_of(self.beam, self.rule, rotary=True)
        arm = np.einsum("pab,pb->ap", self.axes[station], offset)[..., None]
        selection = station == np.arange(len(self.points))[:, None]  # (points, particles)

        def inertia(move: Floats, turn: Floats) -> Floats:
            force = mass[:, None] * (move[:, station] + np.cross(turn[:, station], arm, axis=0))
            return self.pulled(selection @ force, selection @ np.cross(arm, force, axis=0))

        def inertia_of(strains: Floats) -> Floats:
            moved, turned = self.field(strains).jacobians(np.zeros(strains.shape[1]))
            return inertia(np.moveaxis(moved, 0, 1), np.moveaxis(turned, 0, 1))

        zeros = np.zeros((3, len(self.points), 3))
        unit = zeros + np.eye(3)[:, None]  # unit vectors along x, y and z at every point
        place = self.place.T[..., None]
        loads = [inertia_of(coordinates), inertia(unit, zeros), inertia(np.cross(unit, place, axis=0), unit)]
        acting = [np.arange(len(self.points)) == k for k in self.hung]  # weights of the points, of each load
        if self.beam.loads:
            work, points = self.work(self.field(coordinates), None)
            for load in range(len(self.beam.loads)):
                acting.append(np.bincount(points, work.weight * (work.load == load), len(self.points)))
        for weights in acting:
            vectors = weights[:, None] * unit
            loads += [self.pulled(vectors, zeros), self.pulled(zeros, vectors)]
        answers = [self.answer(np.concatenate(loads, axis=1))]
        for _ in range(LEVELS - 1):
            answers.append(self.answer(inertia_of(answers[-1])))
        return np.concatenate(answers, axis=1)

    def answer(self, forces: Floats) -> Floats:
        """Strains (m, k) under generalised forces (m, k)."""
        with np.errstate(divide="ignore"):
            uncoupled = np.where(self.known, 1 / self.stiffness, 0.0)[:, None] * forces
        if self.coupling is None:
            return np.asarray(uncoupled)
        return self._nodal_products(np.asarray(np.linalg.inv(self.coupling)), forces, uncoupled)

    def scaled(self, strains: Floats, *, back: bool = False) -> Floats:
        """Scale strains (m, k) so that their energy is half their square; `back` reverses it."""
        root = np.sqrt(np.where(self.known, self.stiffness, 1.0))[:, None]
        uncoupled = strains / root if back else strains * root
        if self.coupling is None:
            return np.asarray(uncoupled)
        upper = np.swapaxes(np.linalg.cholesky(self.coupling), 1, 2)
        return self._nodal_products(np.linalg.inv(upper) if back else upper, strains, uncoupled)

    def _nodal_products(self, matrices: Floats, strains: Floats, springs: Floats) -> Floats:
        """Products (m, k) of matrices (g, 6, 6) and nodal strains, with the root springs' rows of `springs` (m, k)."""
        nodes, count = len(self.rule.node), strains.shape[1]
        nodal = np.einsum("gab,bgk->agk", matrices, strains[: 6 * nodes].reshape(6, nodes, count))
        return np.concatenate([nodal.reshape(6 * nodes, count), springs[6 * nodes :]])

    def work(self, field: StrainField, heat: Floats | None) -> tuple[LoadWork, Any]:
        """The loads on a field, and the points where they act."""
        return load_work(self.beam, field, self.rule, self.first_load, heat)

    def theory(self, families: Families) -> Theory:
        """Models of both theories, slender and thick. Their shapes are the structure's own `families` and what the
        static answers add.
        """
        strains = self.shaped(families)
        answers = self.answers(strains)
        strain_blocks = [np.concatenate([strains, self.others(answers, self.modelled, strains)], axis=1)]
        missing_families = (tuple(set(family) - set(self.modelled)) for family in (SHEAR, TWIST))
        strain_blocks += [self.others(answers, family) for family in missing_families]
        block_ends = np.cumsum([0, *(block.shape[1] for block in strain_blocks)]).tolist()
        thick, slender = np.concatenate(strain_blocks, axis=1), strain_blocks[0]
        nodes = len(self.rule.node)
        offset = np.array([body.offset for body in self.beam.masses]).reshape(-1, 3)
        _, about_y, about_z = self.beam.rigidities(self.rule.node)
        models = self.model(slender, rotary=self.beam.rotary_inertia), self.model(thick, rotary=True)
        grip, dependents = models[1].grip, 0
        if grip is not None:
            thick, dependents = thick @ grip.basis, len(grip.dependents)
        bodies = self.field(thick)[nodes : nodes + len(self.beam.masses)]
        return Theory(
            *models,
            {
                "shear": slice(block_ends[1] - dependents, block_ends[2] - dependents),
                "twist": slice(block_ends[2] - dependents, block_ends[3] - dependents),
            },
            thick[4 * nodes : 6 * nodes].reshape(2, nodes, -1),
            np.stack([about_y, about_z]) * self.rule.weight,
            self.rule.node,
            bodies.points(slice(None), offset).slopes(np.zeros(thick.shape[1])),
            self.beam,
        )

    def shaped(self, families: Families) -> Floats:
        """Strains (m, n) of unit coordinates: of shapes of the families, then of the root's springs."""
        nodal = shaped_strains(self.rule, families)
        strains = nodal.reshape(-1, nodal.shape[2])
        springs = self.move.shape[1]
        padded = np.zeros((len(self.stiffness), strains.shape[1] + springs))
        padded[: len(strains), : strains.shape[1]] = strains
        padded[len(strains) :, strains.shape[1] :] = np.eye(springs)
        return padded

    def others(self, answers: Floats, families: tuple[int, ...], coordinates: Floats | None = None) -> Floats:
        """Strains (m, l), orthonormal in energy, that span the parts of `answers` in some families (0 to 5).

        Parts along the `coordinates` (m, n), if given, are removed before.
        """
        in_families = (np.isin(self.families, families) & self.known)[:, None]
        basis = (
            np.zeros((len(in_families), 0))
            if coordinates is None
            else np.linalg.qr(self.scaled(in_families * coordinates))[0]
        )
        lengths = np.linalg.norm(self.scaled(self.known[:, None] * answers), axis=0)
        count = basis.shape[1]
        for vector, length in zip(self.scaled(in_families * answers).T, lengths, strict=True):
            residual = vector - basis @ (basis.T @ vector)
            residual = residual - basis @ (basis.T @ residual)
            if np.linalg.norm(residual) > NEW * length:
                basis = np.concatenate([basis, (residual / np.linalg.norm(residual))[:, None]], axis=1)
        return np.where(in_families, self.scaled(basis[:, count:], back=True), 0.0)

    def energy(self, strains: Floats) -> Floats:
        """Stiffness (n, n) of shapes with strains (m, n). Strains without shapes are free: they carry no force."""
        if self.coupling is None:
            stiffness = self.stiffness.copy()
            stiffness[len(stiffness) - len(self.springs) :] = self.springs
            return np.asarray(strains.T @ (np.where(self.known, stiffness, 0.0)[:, None] * strains))
        nodal, root = np.split(strains, [6 * len(self.rule.node)])
        nodal = nodal.reshape(6, -1, strains.shape[1])
        strained = [k for k in range(6) if nodal[k].any()]
        forces = np.einsum("gab,bgj->agj", condensed(self.coupling, strained), nodal[strained])
        springs = root.T @ (self.stiffness[-len(root) :, None] * root) if len(root) else 0.0
        return np.asarray(np.einsum("agi,agj->ij", nodal[strained], forces) + springs)

    def heat(self, strains: Floats) -> Floats | None:
        """Forces (n,) of a rise of the temperature by 1 K on shapes with the strains (m, n), or None without any."""
        nodes = len(self.rule.node)
        return heat_of(self.beam, self.rule, strains[: 6 * nodes].reshape(6, nodes, -1))

    def model(self, strains: Floats, *, rotary: bool) -> Structure:
        """Linear structure whose shapes have the strains (m, n), with rotary inertia if `rotary`, held at its supports.

        Its coordinates are fewer where supports hold it rigidly.
        """
        field, stiffness, grip = self.field(strains), self.energy(strains), self.structure.grip
        heat, build = self.heat(strains), partial(self._build, rotary=rotary)
        if grip is None:
            return build(field, stiffness, None, heat, ())
        stations, shapes = self.structure.stations, strains.shape[1]
        return hold(
            self.beam, self.rule, field, stiffness, heat, build, stations, self.first_station, shapes, grip.dependents
        )

    def _build(
        self,
        field: StrainField,
        stiffness: Floats,
        damping: Floats | None,
        heat: Floats | None,
        dependents: tuple[int, ...],
        *,
        rotary: bool,
    ) -> Structure:
        """Linear structure of a field with its stiffness, its damping (n, n), by default that of its modes, and the
        forces of a rise of its temperature by 1 K.
        """
        structure, beam, rest = self.structure, self.beam, np.zeros(len(stiffness))
        station, mass, offset = particles_of(beam, self.rule, rotary=rotary)
        inertia = held_inertia(field.points(station, offset), mass)
        places, geometric = inertia.expand(rest)
        work, loaded, loads = None, np.zeros(0, int), None
        if structure.history is not None:
            work, loaded = self.work(field, heat)
            loads = _load_terms(work, field, loaded, len(structure.history.profiles))
        c = coefficients(mass, places, stiffness, geometric=geometric, loads=loads)
        ratio: Any = beam.damping_ratio
        if isinstance(ratio, tuple):
            ratio = (*ratio, *[ratio[-1]] * (len(stiffness) - len(ratio)))
        if damping is None:
            damping = damping_matrix(0.0 if ratio is None else ratio, c.mass, c.stiffness)
        return replace(
            structure,
            kind="FOAM",
            linear=True,
            hub_force=True,
            mass=mass,
            places=places,
            station_places=field.points(slice(self.first_station, None)).expand_rest(),
            coefficients=c.damped(damping),
            grip=None,
            inertia=inertia,
            field=field,
            first_station=self.first_station,
            sections=sections_of(
                beam, structure.stations, self.cumulative, (mass, station), loaded, self.first_station
            ),
            work=work,
            source=None,
            warnings=(),
        )


def _load_terms(work: LoadWork, field: StrainField, at: Floats, count: int) -> LoadTerms:
    """Generalised forces of `count` loads on the points `at` to first order, summed over CHUNK points at a time."""
    parts = list[LoadTerms]()
    for chunk in np.array_split(np.arange(len(at)), -(-len(at) // CHUNK)):
        heat = None if parts else work.heat
        acting = LoadWork(field[at[chunk]], work.load[chunk], work.weight[chunk], work.follower[chunk], heat)
        parts.append(acting.linearise(count, np.zeros(field.size)))
    return LoadTerms(sum(part.constant for part in parts), sum(part.slope for part in parts))
