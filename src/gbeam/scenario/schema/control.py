"""[controllers.NAME]: sampled controllers in the loop of a system of bodies."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, model_validator

from gbeam.guards.limits import ENTRIES
from gbeam.scenario.schema.fields import Duration, File, Quantity, Ratio, Table, Time, optional, refuse, wrong

_Rate = Annotated[float, Quantity("angular rate", "positive")]
_Rows = tuple[tuple[Ratio, ...], ...]
_SI = "in SI units of effort and measurement"


class Gains(Table):
    """State feedback: every effort is a sum of gains times errors."""

    kind: Literal["gains"] = Field(description="kind of the law")
    gains: _Rows = Field(min_length=1, description=f"a row for every effort, a gain for every measurement, {_SI}")


class PID(Table):
    """Proportional, integral and derivative gain of one error."""

    kind: Literal["pid"] = Field(description="kind of the law")
    kp: Ratio = Field(default=0.0, description=f"proportional gain, {_SI}")
    ki: Ratio = Field(default=0.0, description=f"integral gain, {_SI} s")
    kd: Ratio = Field(default=0.0, description=f"derivative gain, {_SI}/s")
    smoothing: Duration | None = optional("time constant of the filter of the derivative: needed with kd")

    @model_validator(mode="after")
    def _filtered(self) -> PID:
        if self.kd and self.smoothing is None:
            refuse([((), wrong("smoothing is missing", 'a derivative needs a filter: smoothing = "50 ms"'))])
        return self


class LeadLag(Table):
    """Lead or lag: gain (1 + s/zero)/(1 + s/pole) of one error."""

    kind: Literal["lead-lag"] = Field(description="kind of the law")
    gain: Ratio = Field(description=f"gain at rest, {_SI}")
    zero: _Rate = Field(description="zero, such as 1 Hz")
    pole: _Rate = Field(description="pole: above the zero a lead, below it a lag")


class Notch(Table):
    """A notch at a vibration: a gain of one but near its frequency."""

    kind: Literal["notch"] = Field(description="kind of the law")
    frequency: _Rate = Field(description="of the notch, such as 4.2 Hz")
    depth: Ratio = Field(description="gain at the frequency, such as 0.1")
    damping: Annotated[float, Quantity("ratio", "positive")] = Field(description="half the width over the frequency")


class Matrices(Table):
    """A law with states of its own: x' = A x + B e, efforts = C x + D e, by rows or from a file."""

    kind: Literal["state-space"] = Field(description="kind of the law")
    file: File | None = optional(
        "file of matrices A, B, C, D: .npz, .mat or .json, relative to the scenario's folder; with dt, Ts "
        "or step, s, above zero it is in discrete time, and then the only law"
    )
    a: _Rows | None = optional("A, by rows, in continuous time")
    b: _Rows | None = optional("B, by rows: a column for every measurement")
    c: _Rows | None = optional("C, by rows: a row for every effort")
    d: _Rows | None = optional("D, by rows")

    @model_validator(mode="after")
    def _one_way(self) -> Matrices:
        matrices = [name for name in "abcd" if getattr(self, name) is not None]
        if self.file is not None and matrices:
            refuse([((matrices[0],), wrong("is given beside file", "give the matrices or their file", mark="key"))])
        if self.file is None and len(matrices) < 4:
            lacking = next(name for name in "abcd" if name not in matrices)
            refuse([((), wrong(f"{lacking} is missing", 'give a, b, c and d, or file = "controller.mat"'))])
        return self


Law = Annotated[Gains | PID | LeadLag | Notch | Matrices, Discriminator("kind")]


class Controller(Table):
    """A controller that samples measurements and holds its efforts; its laws act on reference less measurement."""

    measure: tuple[str, ...] = Field(
        min_length=1,
        max_length=ENTRIES,
        description='what is sampled: "joint.angle", "joint.angle_rate", "body.point.place_x", velocity_x, '
        "attitude_x (rotation vector, rad), acceleration_x, spin_x, of a section of a beam force_x, moment_y",
    )
    drive: tuple[str, ...] = Field(
        min_length=1, max_length=ENTRIES, description='efforts: "joint.angle", "force.force_x", "force.moment_z"'
    )
    law: tuple[Law, ...] = Field(min_length=1, description="laws one after the other: [{ kind, ... }, ...]")
    sample: Duration = Field(description="time between samples")
    delay: Time = Field(default=0.0, description="time from a sample until its efforts act")
    limit: tuple[Annotated[float, Quantity("ratio", "positive")], ...] | None = optional(
        "largest size of every effort, N or N m: [20]"
    )
    reference: tuple[Ratio, ...] | None = optional("aim of every measurement, in SI units; zero unless given: [0.5, 0]")
