"""[motion.NAME]: bases, and how well a centrifuge must reproduce its flight."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictBool, Tag, create_model, model_validator

from gbeam.constants import InverseName, MachineName, Mounting, Pointing, Start, ToleranceOf
from gbeam.results.criteria import RULES
from gbeam.scenario.schema.arm import Arm
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    Acceleration,
    ControlPoint,
    Duration,
    Length,
    Position,
    Quantity,
    Table,
    Time,
    Turn3,
    Vector,
    by_name,
    missing_one_of,
    optional,
    refuse,
    wrong,
)
from gbeam.scenario.schema.profile import AccelerationProfile, RateProfile, RecordOrPart, TorqueProfile

Share = Annotated[float, Quantity("ratio", "positive")]
Ratio = Annotated[float, Quantity("ratio", "positive")]
Level = Annotated[float, Quantity("amplitude ratio", "positive")]
Ratios = Annotated[Annotated[Ratio, Tag("one")] | Annotated[tuple[Ratio, Ratio], Tag("list")], ONE_OR_LIST]
_Leak = Annotated[float, Quantity("ratio")]
_Reading = tuple[_Leak, _Leak, _Leak]
Levels = Annotated[Annotated[Level, Tag("one")] | Annotated[tuple[Level, Level], Tag("list")], ONE_OR_LIST]
_TYPES: dict[str, Any] = {"most": Share, "least": Share, "ratio": Ratios, "level": Levels}
_FIELDS: dict[str, Any] = {rule.name: (_TYPES[rule.kind] | None, optional(rule.words)) for rule in RULES.values()}
_Limits = create_model("_Limits", __base__=Table, **_FIELDS)


class Sensor(Table):
    """An accelerometer of three axes: a mass on a spring along each, of which the deflection is read."""

    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0),
        description="rotation vector of its axes in the base axes, of a system in those of its point: [x, y, z]",
    )
    frequency: Annotated[float, Quantity("frequency", "positive")] | None = optional(
        "natural frequency of the spring, or the cut-off of a filter of second order; without one it reads the "
        "acceleration itself"
    )
    damping_ratio: Ratio = Field(default=0.7, description="of the spring; 0.7 gives the widest flat range")
    sensitivity: tuple[_Reading, _Reading, _Reading] | None = optional(
        "rows with the reading of each axis for a unit along each: one on the diagonal, and beside it what leaks from "
        "the others"
    )


class Accept(_Limits):  # type: ignore[misc, valid-type]
    """Limits of the differences from flight; one that is not kept ends in exit status 1."""

    tolerance: Share | None = optional(
        "difference from the flight's load within which it counts as followed, and of a peak from its own size within "
        "which that counts as reproduced, as a share; 5 % if left out"
    )
    tolerance_of: ToleranceOf | None = optional(
        "what tolerance is a share of. peak: the flight's largest load, as where it is left out; instant: "
        "its load at each time"
    )
    point: str | None = optional(
        'point whose displacement is that of the tip, and whose spectra srs is of: "camera", or of a '
        'system "arm.tip"; left out, the tip, and of a system the point that moves farthest in flight'
    )
    control: dict[str, Share] = by_name(
        "weights of control points by the names of points: srs is of the weighted mean of the spectra "
        "there, in place of the tip's"
    )
    damage_at: str | None = optional(
        "point whose fatigue damage is that of damage; left out, the root of a beam, and of a solid where "
        "its von Mises stress is largest, of several materials that whose stress ranges most in flight"
    )
    stress_at: str | None = optional(
        "point whose stress is that of stress, of a solid von Mises', of a beam the normal stress; left out, the "
        "largest anywhere"
    )

    @property
    def limits(self) -> dict[str, Any]:
        """Values that are given, by name."""
        return {name: value for name, value in self if value not in (None, {})}


class Components(Vector):
    """An acceleration by components in base axes; those left out are zero."""

    x: AccelerationProfile | None = optional("profile of the component along the beam")
    y: AccelerationProfile | None = optional("profile of the component along the width")
    z: AccelerationProfile | None = optional("profile of the component through the thickness")


class Flight(Table):
    """The root accelerates as recorded or prescribed, and the axes do not turn."""

    kind: Literal["flight"] = Field(description="kind of the motion")
    record: RecordOrPart | None = optional(
        "a measured record: { file, time, x, y, z, unit }, or { of, from, to, section }, another part of that of "
        "another flight; or acceleration"
    )
    acceleration: Components | None = optional("profiles: { x, y, z }, those left out zero; or record")
    smoothing: Time = Field(default=0.0, description="width of the kernel that rounds the corners; 0 leaves them sharp")
    scale: Ratio = Field(
        default=1.0,
        description="level factor of a test, such as 1.25: accelerations are flown so many times as large, gravity in "
        "a specific force included, and limits hold for these; body rates are flown as they are recorded",
    )

    @model_validator(mode="after")
    def _one_source(self) -> Flight:
        if self.record is None and self.acceleration is None:
            refuse([missing_one_of("record", "acceleration")])
        if self.record is not None and self.acceleration is not None:
            hint = "keep record or acceleration, not both"
            refuse([(("acceleration",), wrong("is given beside record", hint, mark="key"))])
        return self


class AxisLimit(Table):
    """Limits of one axis of the machine."""

    rate: Annotated[float, Quantity("angular rate", "positive")] | None = optional("largest rate, of either sign")
    acceleration: Annotated[float, Quantity("angular acceleration", "positive")] | None = optional(
        "largest acceleration, of either sign"
    )
    jerk: Annotated[float, Quantity("angular jerk", "positive")] | None = optional("largest jerk, of either sign")


class Limits(Table):
    """Limits of the machine; exceeding one ends in exit status 1 unless allowed."""

    axis1: AxisLimit = Field(default_factory=AxisLimit, description="the arm: { rate, acceleration, jerk }")
    axis2: AxisLimit = Field(
        default_factory=AxisLimit, description="yaw at the arm's end: { rate, acceleration, jerk }"
    )
    axis3: AxisLimit = Field(default_factory=AxisLimit, description="roll about the beam: { rate, acceleration, jerk }")
    inertia: Annotated[float, Quantity("moment of inertia", "positive")] | None = optional(
        "moment of inertia of all that turns about axis 1; gives the arm's power"
    )
    power: Annotated[float, Quantity("power", "positive")] | None = optional(
        "largest power that speeds the arm up or brakes it; needs inertia"
    )


class Commands(Table):
    """The axis motions as the machine's controller takes them."""

    sample: Duration = Field(description="sample time of the controller")


class Centrifuge(Table):
    """A three-axis centrifuge that gives the control point the load of a flight."""

    kind: Literal["centrifuge"] = Field(description="kind of the motion")
    tracks: str = Field(description="NAME of the flight motion that it imitates")
    machine: MachineName | None = optional(
        "an example machine, which gives arm, idle and limits where they are left out"
    )
    arm: Length | None = optional("radius from the main axis to the control point; or machine")
    control_point: ControlPoint = Field(
        description="point of the specimen that feels the flight's load, from the root: along x, or [x, y, z]"
    )
    inverse: InverseName = Field(
        default="planned",
        description="how the axis motions are found. planned: the least tracking error within the limits, to 1 % of "
        "the load or a warning; the others do not know the limits. quasi-static: the arm's tangential acceleration is "
        "ignored; flat: yaw makes up for it; exact: size and direction of the load both right, to 1e-7 of it or a "
        "warning",
    )
    gravity: StrictBool = Field(
        description="true if the target is specific force, of which gravity is a part on the machine; "
        "false if it is acceleration"
    )
    idle: Annotated[float, Quantity("acceleration", "positive")] | None = optional(
        "load below which the target is held up to this magnitude"
    )
    clip: StrictBool = Field(
        default=False, description="true to carry on with a held target where the gimbals cannot reach; idle implies it"
    )
    smoothing: Time = Field(
        default=0.0, description="width of the kernel that rounds the target's corners; 0 leaves them sharp"
    )
    ease: Annotated[float, Quantity("ratio", "positive")] | None = optional(
        "of planned: weight of gentle motion of the axes beside the tracking error, times the usual one; "
        "with less, quick loads are followed better, and the axes move more"
    )
    start: Start = Field(
        default="rest",
        description="how the machine's motion begins and ends. rest: it spins up from standstill before the flight "
        "and down to it after the flight, the arm's tangential acceleration ignored; pre-yawed: the same with axis 2 "
        "turned across the arm at standstill, so that the load has its right direction all the way; idle: it begins "
        "and ends in the state that it has at the flight's first and last time, which the commands' header gives",
    )
    spin_up: Duration | None = optional(
        "time from standstill to the flight's first time, such as 10 s; left out, one within the limits "
        "in which the arm turns once or more"
    )
    spin_down: Duration | None = optional("time from the flight's last time to standstill; left out, likewise")
    mounting: Mounting = Field(
        default="upright",
        description="which of the two ways the specimen sits in the gimbals. Under a load across it, its tip points "
        "along the arm's motion (upright) or against it (inverted): docs/mounting.svg",
    )
    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0),
        description="which way round the specimen sits in the gimbals: rotation vector of its axes, whose x lies along "
        "axis 3 where it is zero",
    )
    limits: Limits = Field(
        default_factory=Limits, description="what the machine can do: { axis1, axis2, axis3, inertia, power }"
    )
    commands: Commands | None = optional("axis motions for the controller: { sample }")
    accept: Accept | None = optional("how well it must reproduce the flight: { tip, peaks }")

    @property
    def along(self) -> float:
        """The control point along x, m."""
        return self.control_point[0] if isinstance(self.control_point, tuple) else self.control_point

    @property
    def limits_of_acceptance(self) -> dict[str, Any]:
        """Limits of [accept] by name; empty without the table."""
        return {} if self.accept is None else self.accept.limits

    @model_validator(mode="after")
    def _some_arm(self) -> Centrifuge:
        if self.arm is None and self.machine is None:
            hint = 'add arm = "3.3 m": radius from the main axis to the control point'
            refuse([((), wrong("arm is missing", hint, mark="key"))])
        return self


class Hub(Table):
    """A rigid hub that turns about z, the beam on its rim: with a prescribed rate, or free under a torque."""

    kind: Literal["hub"] = Field(description="kind of the motion")
    radius: Position = Field(description="from the hub's axis to the beam's root")
    rate: RateProfile | None = optional("profile of the hub's rate; or inertia and torque")
    inertia: Annotated[float, Quantity("moment of inertia", "positive")] | None = optional(
        "moment of inertia of the hub about its axis; beside a rate it gives the torque of the drive"
    )
    torque: TorqueProfile | None = optional("profile of the torque on the hub; needs inertia")
    stiffness: Annotated[float, Quantity("rotational stiffness", "zero or more")] | None = optional(
        "torsional spring from a free hub to the ground, at ease at the hub's initial angle"
    )
    damping: Annotated[float, Quantity("rotational damping", "zero or more")] | None = optional(
        "torsional damper from a free hub to the ground"
    )
    pointing: Pointing = Field(default="outward", description="from the root away from the hub's axis, or towards it")
    setting_angle: Annotated[float, Quantity("angle")] | None = optional(
        "turn of the section about the beam; at 0, or left out, its y axis lies in the plane of rotation"
    )
    gravity: tuple[Acceleration, Acceleration, Acceleration] | None = optional(
        'acceleration of free fall [x, y, z] in hub axes at hub angle zero, such as [0, 0, "-1 g"]: '
        "x to the root, z the hub's axis; it keeps its direction as the hub turns"
    )

    @model_validator(mode="after")
    def _one_drive(self) -> Hub:
        if self.rate is None and self.torque is None:
            refuse([missing_one_of("rate", "torque")])
        return self


Motion = Annotated[Flight | Centrifuge | Hub | Arm, Discriminator("kind")]
