"""The equations of a linear model on any root, by its moments of mass.

Its first and second moments of mass, S = S0 + S1 q + ½ q S2 q and J = J0 + J1 q + ½ q J2 q, and the momentum h_i =
h0_i + B_ji q_j of its coordinates about the root, are the constant coefficients of its equations on a moving root.
Lagrange's equations of these energies keep momentum and energy.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gbeam.arrays.namespace import Array, is_traced, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.equations.contraction import Contraction, Reach, contraction
from gbeam.mechanics.equations.dalembert import Demanding
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.fields.products import cross, times, turned, turned_back

THIN = 1e-9  # of the largest moment of inertia: less is none


@record
class Moments(Demanding):
    """Equations of a body whose energies end at second order in its coordinates: TLAM, FOAM, particles, modes of a
    mesh.

    Modes of a solid may carry nearly all of its inertia. Where its root is free to move against such a mode, the
    kinetic energy, cut off at second order, may be negative once the body is bent. `carried` = C0ᵀR0⁻¹C0 prevents that,
    with C q̇ the momentum of deforming and R the inertia of the body about its root: the kinetic energy has
    ½ q̇ᵀ(CᵀR⁻¹C − C0ᵀR0⁻¹C0) q̇ more, which is of third order in q and q̇. It is then that of the rigid motion with all
    momentum and of vibration about it, and positive wherever R is.

    By a `contraction` the wrench at the root has those components alone that a tree asks for.

    Without `hub_force` the root does not feel the rates of the coordinates: so is SFOAM as printed, 2009 (32), which
    conserves nothing.
    """

    coefficients: Coefficients
    carried: Array | None = None
    contraction: Contraction | None = None
    hub_force: bool = static(default=True)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.coefficients.size

    def strain_energy(self, q: Array) -> Array:
        """U, J, at coordinates (..., n)."""
        return ((q @ self.coefficients.stiffness) * q).sum(axis=-1) / 2

    def elastic(self, q: Array) -> Array:
        """Forces of the strain energy on the coordinates (..., n)."""
        return self.coefficients.elastic(q)

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        """Mass kg, and its first moment (..., 3) kg m about the root, its axes."""
        return self.coefficients.rigid[0], self._moments(q, 0 * q)[0]

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces that a motion demands, less those of the loads: on the coordinates (..., n), and force, N, and moment,
        N m, at the root (..., 3).
        """
        if self.contraction is not None:
            return self._contracted_forces(self.contraction, q, qd, qdd, a, w, alpha, loads)
        c = self.coefficients
        # Force at the root: d/dt of the momentum m v + ω × S + Ṡ; moment: d/dt of J ω + h, about the moving root.
        S, Si, Sd, J, Ji, h, hi = self._moments(q, qd)
        felt = qd if self.hub_force else 0 * qd  # rates that the root feels
        Sdd = turned(Si, qdd) + turned(times(c.k_a, felt), qd)
        hd = turned(hi, qdd) + turned(times(c.k_al, felt), qd)
        force = c.rigid[0] * a + cross(alpha, S) + Sdd
        force = force + cross(w, cross(w, S) + 2 * turned(Si, felt))
        swelling = (w[..., None, None, :] @ Ji)[..., 0, :]  # ∂(J ω)/∂q
        moment = cross(S, a) + turned(J, alpha) + turned(swelling, felt) + hd
        moment = moment + cross(w, turned(J, w) + h)
        generalised = qdd @ c.mass + qd @ c.damping + c.elastic(q)
        generalised = generalised + turned_back(Si, a) + turned_back(hi, alpha)
        generalised = generalised + turned_back(times(c.gyroscopic, qd) - 0.5 * swelling, w)
        if self.carried is not None:  # the mean motion v, ω that has the momentum of deforming, R (v, ω) = (Ṡ, h)
            mean_v, mean_w = _mean_motion(c.rigid[0], S, J, Sd, h)
            swelling = (mean_w[..., None, None, :] @ Ji)[..., 0, :]
            push, spin = Sdd - cross(mean_w, Sd), hd - cross(Sd, mean_v) - turned(swelling, qd)
            vd, wd = _mean_motion(c.rigid[0], S, J, push, spin)
            generalised = (
                generalised - qdd @ self.carried + turned_back(Si, vd + cross(mean_v, mean_w)) + turned_back(hi, wd)
            )
            generalised = generalised + turned_back(times(c.gyroscopic, qd) + 0.5 * swelling, mean_w)
        if loads is not None and c.loads is not None:
            forces = c.loads.generalised(q, loads)
            force, moment, generalised = (
                force - forces[..., :3],
                moment - forces[..., 3:6],
                generalised - forces[..., 6:],
            )
        if not self.hub_force and np.any(qd):
            return generalised, *self.demanded(q, 0 * qd, qdd, a, w, alpha, loads)[1:]
        return generalised, force, moment

    def contracted(self, reach: Reach) -> Moments:
        """Contract the coefficients with what the root can do; return these equations where that is no faster."""
        if self.carried is not None:
            return self
        constants = contraction(self.coefficients, reach, felt=self.hub_force)
        return self if constants is None else replace(self, contraction=constants)

    def _contracted_forces(
        self,
        constants: Contraction,
        q: Array,
        qd: Array,
        qdd: Array,
        a: Array,
        w: Array,
        alpha: Array,
        loads: Array | None,
    ) -> tuple[Array, Array, Array]:
        """Forces as :meth:`demanded` returns them, by contracted `constants`."""
        c = self.coefficients
        generalised, rows = constants.demanded(q, qd, qdd, a, w, alpha)
        if c.bending is not None:
            generalised = generalised + c.bending.forces(q)
        if loads is not None and c.loads is not None:
            forces = c.loads.generalised(q, loads)
            generalised, rows = generalised - forces[..., 6:], rows - forces[..., :6] @ constants.loads
        wrench = rows @ constants.places
        return generalised, wrench[..., :3], wrench[..., 3:]

    def _moments(self, q: Array, qd: Array) -> tuple[Array, ...]:
        """Moments S, ∂S/∂q, Ṡ and J, ∂J/∂q, the angular momentum h = Σ h_i q̇_i, and the h_i, at `q` and `qd`."""
        c = self.coefficients
        Si = -c.f_a + times(c.k_a, q)
        S = c.rigid[1:4] + turned((Si - c.f_a) / 2, q)
        Ji = 2 * c.f_ww - times(2 * c.k_ww, q)
        J = c.second_moment + times(c.f_ww, q) + namespace(Ji, q).einsum("...abi,...i->...ab", Ji, q) / 2
        hi = -c.f_al + times(c.k_al, q)
        Sd, h = turned(Si, qd), turned(hi, qd)
        return S, Si, Sd, J, Ji, h, hi


def carried_inertia(c: Coefficients) -> Array | None:
    """Inertia (n, n) of the mean rigid motion that has the momentum of deforming, C₀ᵀ R₀⁻¹ C₀ at q = 0.

    None where the particles lie on a line: the rigid body's inertia R₀ is singular there.
    """
    mass, S, J = c.rigid[0], c.rigid[1:4], c.second_moment
    if not is_traced(J):
        smallest, _, largest = np.linalg.eigvalsh(_central_inertia(mass, S, J))
        if not smallest > THIN * largest:
            return None
    v, w = _mean_motion(mass, S, J, c.f_a.T, c.f_al.T)
    return c.f_a.T @ v.T + c.f_al.T @ w.T


def _central_inertia(mass: Array, S: Array, J: Array) -> Array:
    """Moments of inertia (..., 3, 3) about the centre of mass, by the first moment S and J about the root."""
    square = (S * S).sum(axis=-1)[..., None, None] * np.eye(3)
    return J - (square - S[..., :, None] * S[..., None, :]) / mass


def _mean_motion(mass: Array, S: Array, J: Array, push: Array, spin: Array) -> tuple[Array, Array]:
    """Velocity and angular velocity (..., 3) at its root of a rigid body with a given momentum.

    The body has `mass` and, about the root, the moments S and J. `push` is its momentum, `spin` the angular momentum
    about the root.
    """
    centre, inertia = S / mass, _central_inertia(mass, S, J)
    x, y, z = (inertia[..., k, :] for k in range(3))  # rows; the inverse is by their vector products
    at_centre, yz = spin - cross(centre, push), cross(y, z)
    w = at_centre[..., :1] * yz + at_centre[..., 1:2] * cross(z, x) + at_centre[..., 2:] * cross(x, y)
    w = w / (x * yz).sum(axis=-1, keepdims=True)
    return push / mass - cross(w, centre), w
