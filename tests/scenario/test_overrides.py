"""--set key=value."""

from __future__ import annotations

import pytest

from gbeam.scenario import ScenarioError, build, loads


def test_values(text: str) -> None:
    changes = [
        "beam.length=250 mm",
        "beam.masses[0].mass=0.2 kg",
        "model.kind=exact",
        'title="quoted"',
        "motion.spin.arm = 7.6",
        "motion.spin.gravity=true",
        "beam.damping_ratio=[0.01, 0.02, 0.03]",
        "beam.section={ shape = 'circle', diameter = '5 mm' }",
        "response.tolerance=1e-4",
        "motion.other.kind=hub",
        "motion.other.radius=0",
        "motion.other.rate={ profile = 'constant', level = '60 rpm' }",
    ]
    scenario = loads(text, overrides=changes)
    assert (scenario.beam.length, scenario.beam.masses[0].mass) == (0.25, 0.2)
    assert (scenario.model.kind, scenario.title) == ("exact", "quoted")
    assert scenario.motion["spin"].model_dump()["arm"] == 7.6
    assert scenario.motion["spin"].model_dump()["gravity"] is True
    assert scenario.beam.damping_ratio == (0.01, 0.02, 0.03)
    assert scenario.beam.section.shape == "circle"
    assert scenario.response.tolerance == 1e-4
    assert scenario.motion["other"].kind == "hub"
    assert [change.text for change in scenario.source.overrides] == changes  # type: ignore[union-attr]


def test_the_last_one_holds(text: str) -> None:
    assert loads(text, overrides=["beam.length=1 m", "beam.length=2 m"]).beam.length == 2.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("beam.length=20 kg", 'beam.length: "20 kg" is a mass\n    = expected a length, such as "20 mm"'),
        ("beam.lenth=20 mm", "beam.lenth: unknown key\n    = did you mean 'length'?"),
        ("motoin.spin.arm=2", "motoin: unknown key\n    = did you mean 'motion'?"),
        (
            "motion.spin.control_point=310 mm",
            "motion.spin.control_point: 310 mm is beyond the tip\n    = give 0 to 300 mm from the root",
        ),
        ("motion.x.kind=hub", "motion.x: radius is missing\n    = add radius"),
        ("title=2024-01-01 00:00:00 x", None),
        ("title=2024-01-01", None),
        ("beam.masses={}", "beam.masses: a table is not a list"),
        ("beam.length", "is not key=value\n    = write it such as"),
        ("beam..length=1", "is not key=value"),
        ("beam.masses[1].at=1", "beam.masses has 1 entry\n    = the first is [0]"),
        ("beam.masses.at=1", "beam.masses is a list"),
        ("beam.length.x=1", "beam.length is not a table"),
        ("beam[0]=1", "beam is not a list"),
        ("response.stations[0]=1", "response.stations has 0 entries"),
    ],
)
def test_errors_name_the_override(change: str, message: str | None, text: str) -> None:
    if message is None:
        assert loads(text, overrides=[change]).title == change.removeprefix("title=")
        return
    with pytest.raises(ScenarioError) as caught:
        loads(text, "s.toml", [change])
    first = caught.value.diagnostics[0]
    assert str(first).startswith(f"--set {change}: {message}")
    assert first.line is None and first.override == change


def test_an_error_in_the_file_that_an_override_provokes_stays_in_the_file(text: str) -> None:
    with pytest.raises(
        ScenarioError,
        match=r"s.toml:7:19: beam.masses\[0\].at: is 0.2 m, beyond the tip\n.*\n.*\n.*0 to 0.18 m",
    ):
        build(loads(text, "s.toml", ["beam.length=180 mm"]))


def test_an_override_that_the_objects_refuse_is_named(text: str) -> None:
    change = "beam.masses[0].at=310 mm"
    with pytest.raises(ScenarioError) as caught:
        build(loads(text, "s.toml", [change]))
    words = "beam.masses[0].at: is 0.31 m, beyond the tip\n    = give 0 to 0.3 m from the root"
    assert str(caught.value) == f"--set {change}: {words}"


def test_all_refused_overrides_at_once(text: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(text, overrides=["x", "beam.length=1 m", "title.x=1"])
    assert [diagnostic.override for diagnostic in caught.value.diagnostics] == ["x", "title.x=1"]
