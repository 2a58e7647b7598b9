"""A study in one netCDF file, which xarray, MATLAB and h5py open.

The root says what was computed and from what; ``motions/NAME`` holds the response in one environment and
``comparisons/NAME`` what a centrifuge's response is compared with. Variables are SI and carry ``units``,
``long_name`` and, for vectors, the ``frame`` of their components.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np
import xarray as xr

from gbeam.errors import InputError
from gbeam.io.netcdf_machine import machine_variables, variable
from gbeam.results.comparison import Comparison
from gbeam.results.response import Response, Study

_AXIS = ("axis", ["x", "y", "z"])


@dataclass(frozen=True)
class Provenance:
    """Where a result came from.

    Parameters
    ----------
    scenario : str
        Text of the scenario file.
    overrides : sequence of str
        The ``key=value`` changes made to it, in order.
    command : str
        The command line.
    """

    scenario: str = ""
    overrides: Sequence[str] = ()
    command: str = ""


def write(study: Study, path: str | os.PathLike[str], provenance: Provenance = Provenance()) -> None:
    """Write a study to a netCDF file, whole or not at all.

    Parameters
    ----------
    study : Study
    path : path
        Replaced if it exists.
    provenance : Provenance

    Raises
    ------
    OSError
        If it cannot be written.
    """
    final = Path(path)
    # Beside the file, so that the renaming is one step on the same disk.
    handle, name = tempfile.mkstemp(prefix=f".{final.name}-", suffix=".nc", dir=final.parent)
    os.close(handle)
    try:
        as_tree(study, provenance).to_netcdf(name, engine="h5netcdf")
        # mkstemp's files are for their owner only; a result is as readable as any other new file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, final)
    except BaseException:
        os.unlink(name)
        raise


def read(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read a file that :func:`write` wrote, into memory.

    Parameters
    ----------
    path : path

    Returns
    -------
    xarray.DataTree
        For example ``tree["motions/flight"]["displacement"].sel(axis="z")``.

    Raises
    ------
    InputError
        If there is no such file, or it is not netCDF.
    """
    try:
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()
    except OSError as error:
        reason = error.strerror or "not a netCDF-4 file"
        raise InputError(str(path), f"cannot be read ({reason})", "give a result.nc written by gbeam run") from None


def as_tree(study: Study, provenance: Provenance = Provenance()) -> xr.DataTree:
    """Return a study in its xarray form; `write` stores this.

    Parameters
    ----------
    study : Study
    provenance : Provenance

    Returns
    -------
    xarray.DataTree
    """
    # The text is a variable: an HDF5 attribute ends at 64 KiB, and a scenario may hold long tables.
    root = xr.Dataset({"scenario": ((), provenance.scenario, {"long_name": "text of the scenario file"})})
    root.attrs = {
        "title": study.title,
        "outcome": study.outcome,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "gbeam_version": version("gbeam"),
        "jax_version": version("jax"),
        "command": provenance.command,
        "overrides": "\n".join(provenance.overrides),
    }
    for name, failed in study.failures.items():
        root.attrs[f"failure_{name}"] = f"{failed.outcome}: {failed.message}"
    groups = {"/": root}
    groups |= {f"/motions/{name}": _response(it) for name, it in study.responses.items()}
    groups |= {f"/comparisons/{it.centrifuge}": _comparison(it) for it in study.comparisons}
    return xr.DataTree.from_dict(groups)


def _response(it: Response) -> xr.Dataset:
    t, ta = ("time",), ("time", "axis")
    v = variable
    # A rotation shape's coordinate is an angle and a strain shape's a strain: only projected fields' are lengths.
    length = "1" if it.model == "exact" else "m"
    rate = f"{length} s-1".removeprefix("1 ")
    data = {
        "displacement": v(("time", "station", "axis"), it.displacement, "m", "displacement relative to the base axes"),
        "coordinates": v(("time", "coordinate"), it.q, length, "generalised coordinates of the beam"),
        "coordinate_rates": v(("time", "coordinate"), it.qd, rate, "rates of the generalised coordinates"),
        "root_acceleration": v(
            ta, it.base.a_WO_B, "m s-2", "acceleration of the root; specific force where gravity acts"
        ),
        "angular_velocity": v(ta, it.base.w_WB_B, "rad s-1", "angular velocity of the base"),
        "angular_acceleration": v(ta, it.base.alpha_WB_B, "rad s-2", "angular acceleration of the base"),
        "tip_max_abs": v(("axis",), it.peaks.max_abs, "m", "largest displacement of the tip at any step computed"),
        "tip_time_of_max": v(("axis",), it.peaks.time_of_max, "s", "time of that displacement"),
        "tip_residual_amplitude": v(
            ("axis",), it.peaks.residual_amplitude, "m", "half peak-to-peak of the tip from residual_from on"
        ),
    }
    coords = {
        "time": v(t, it.time, "s", "time"),
        "station": v(("station",), it.stations, "m", "position along the beam from the root"),
        "coordinate": v(("coordinate",), np.arange(it.q.shape[1]), "1", "axial, along y, along z"),
        "axis": _AXIS,
    }
    if it.loads is not None:
        section, tsa = ("section",), ("time", "section", "axis")
        coords["section"] = v(section, it.loads.stations, "m", "position of the section along the beam from the root")
        axes = "S: axes of the deformed section"
        data |= {
            "section_force": v(tsa, it.loads.section_force, "N", "axial force and shear", frame=axes),
            "section_moment": v(tsa, it.loads.section_moment, "N m", "torque and bending moments", frame=axes),
            "stress": v(("time", "section"), it.loads.stress, "Pa", "largest normal stress at the outer fibre"),
            "acceleration": v(
                tsa, it.loads.acceleration, "m s-2", "acceleration in the world, base axes; specific force with gravity"
            ),
        }
        if it.loads.beam_torque is not None:
            data["beam_torque"] = v(
                t, it.loads.beam_torque, "N m", "torque about the hub's axis that the beam asks for"
            )
        if it.loads.drive_torque is not None:
            data["drive_torque"] = v(t, it.loads.drive_torque, "N m", "the same with the hub's own inertia")
    if it.hub is not None:
        turn = {
            "hub_angle": ("rad", it.hub.angle),
            "hub_rate": ("rad s-1", it.hub.rate),
            "hub_acceleration": ("rad s-2", it.hub.acceleration),
            "hub_torque": ("N m", it.hub.torque),
        }
        data |= {name: v(t, x, unit, f"{name.replace('_', ' ')} about z") for name, (unit, x) in turn.items()}
    if it.axes is not None:
        coords["machine_axis"] = v(("machine_axis",), [1, 2, 3], "1", "axis of the centrifuge")
        data |= machine_variables(it.axes)
    described = xr.Dataset(data, coords)
    described.attrs = {
        "environment": it.environment,
        "model": it.model,
        "outcome": it.outcome,
        "message": it.message,
        "warnings": "\n".join(it.warnings),
        "integrator": it.integrator,
        "step": it.step,
        "steps": it.steps,
        "error_estimate": it.error_estimate,
        "residual_from": it.residual_from,
    }
    return described


def _comparison(it: Comparison) -> xr.Dataset:
    v = variable
    across = "over the times at which the target was not held"
    data = {
        "difference": v(("time", "axis"), it.difference, "m", f"tip displacement, {it.centrifuge} less {it.flight}"),
        "covered": v(
            ("time",),
            it.covered.astype(np.int8),
            "1",
            "whether the time is compared",
            flag_values=np.array([0, 1], dtype=np.int8),
            flag_meanings="held compared",
        ),
        "max_difference": v(("axis",), it.max_difference, "m", f"largest difference {across}"),
        "rms_difference": v(("axis",), it.rms_difference, "m", f"root mean square difference {across}"),
        "peak_flight": v(("axis",), it.peak_flight, "m", f"largest displacement in {it.flight} {across}"),
        "peak_centrifuge": v(("axis",), it.peak_centrifuge, "m", f"largest displacement on {it.centrifuge} {across}"),
    }
    coords = {"time": v(("time",), it.time, "s", "time"), "axis": _AXIS}
    if it.stations is not None:
        split, ta = it.stations, ("time", "axis")
        how = f"Butterworth 4th order, zero phase, {split.cutoff:.6g} Hz"
        for where, trend, rest in (
            (it.flight, split.trend_flight, split.vibration_flight),
            (it.centrifuge, split.trend_centrifuge, split.vibration_centrifuge),
        ):
            place = "flight" if where == it.flight else "centrifuge"
            data[f"trend_{place}"] = v(ta, trend, "m", f"tip displacement in {where} below the cut-off", method=how)
            data[f"vibration_{place}"] = v(ta, rest, "m", f"tip displacement in {where} above the cut-off", method=how)
        coords["station"] = v(("station",), split.stations, "m", "position along the beam from the root")
        for place, sizes in (
            ("flight", split.flight),
            ("centrifuge", split.centrifuge),
            ("difference", split.difference),
        ):
            for name, told in (("peak", "largest"), ("rms", "root mean square"), ("residual", "residual vibration")):
                values = getattr(sizes, name)
                data[f"station_{name}_{place}"] = v(("station", "axis"), values, "m", f"{told} displacement, {place}")
    if it.mismatch is not None:
        data["mismatch_gradient"] = v(
            ("time", "axis"), it.mismatch.gradient, "s-2", "mismatch acceleration per distance from the control point"
        )
    if it.shock is not None:
        coords["frequency"] = v(("frequency",), it.shock.frequency, "Hz", "frequency of the oscillators")
        for place, values in (("flight", it.shock.flight), ("centrifuge", it.shock.centrifuge)):
            name = f"shock response spectrum of the tip, Q = {it.shock.quality:g}"
            data[f"shock_{place}"] = v(("frequency", "axis"), values, "m s-2", name)
    described = xr.Dataset(data, coords)
    described.attrs = {"flight": it.flight, "centrifuge": it.centrifuge, "verdict": it.verdict}
    return described
