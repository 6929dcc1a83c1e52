"""The scene file: defaults, checks, and reading back what is written."""

import pytest

from pinwheel_engines import Scene, SceneError
from pinwheel_engines.scene import smallest_convex_radius_m
from tests import scenes


def test_defaults_are_the_papers():
    scene = Scene.from_toml('name = "x"')
    assert scene.gear.lobes == 15
    assert scene.gear.pitch_radius_m == pytest.approx(0.064, rel=1e-15)
    assert scene.mass.wheel.moment_kg_m2 == 1.57538e-4
    assert scene.solver.sample_times_s().size == 6001


@pytest.mark.parametrize("text", scenes.ALL.values(), ids=scenes.ALL)
def test_written_scene_reads_back_unchanged(text):
    scene = Scene.from_toml('name = "a \\"quoted\\" \\\\ näme"\n' + text)
    assert Scene.from_toml(scene.to_toml()) == scene


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[gear]\nbacklash = 0.1", ["gear.backlash", "unknown"]),
        ("[gear]\nwheels = 2.0", ["gear.wheels", "whole number"]),
        ("[gear]\nwheels = true", ["gear.wheels", "number"]),
        ("[gear]\nshortening = 1.0", ["gear.shortening", "between 0 and 1"]),
        ("[gear]\nexternal_sleeve_radius_m = 0.014", ["undercut", "0.013122"]),
        ("[gear]\nhole_radius_m = 0.006", ["gear.hole_radius_m", "larger"]),
        ("[solver]\nstep_s = nan", ["solver.step_s", "finite"]),
        ("[solver]\nduration_s = -1", ["solver.duration_s", "greater than 0"]),
        ("[mass]\nwheel = { mass_kg = 1.0 }", ["mass.wheel.moment_kg_m2", "missing"]),
        ("[mass]\nwheel = 3", ["mass.wheel", "table"]),
        ('[drive]\nstart = "slowly"', ["drive.start", "kinematic"]),
        ("[drive]\nstart = 1", ["drive.start", "quotes"]),
        ("gear = [", ["TOML"]),
    ],
)
def test_faults_name_key_and_remedy(text, words):
    with pytest.raises(SceneError) as caught:
        Scene.from_toml(text)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_missing_file_is_a_scene_error(tmp_path):
    with pytest.raises(SceneError, match=r"nowhere\.toml"):
        Scene.load(tmp_path / "nowhere.toml")


def test_smallest_convex_radius_has_the_closed_form():
    # R sqrt(27 (1 - m^2) (zk - 1)/(zk + 1)^3), where the minimum lies between tip and pit.
    assert smallest_convex_radius_m(Scene.from_toml("").gear) == pytest.approx(13.12258e-3, rel=1e-6)


def test_samples_end_at_the_end():
    times = scenes.scene(duration_s=2.5e-4).solver.sample_times_s()
    assert times.tolist() == [0.0, 1e-4, 2e-4, 2.5e-4]
    assert scenes.scene(duration_s=3e-4).solver.sample_times_s().tolist() == [0.0, 1e-4, 2e-4, 3e-4]


def test_load_ramps_up():
    drive = Scene.from_toml("[drive]\nload_ramp_s = 0.02").drive
    assert [drive.load_n_m(t) for t in (-1.0, 0.0, 0.01, 0.02, 1.0)] == [0.0, 0.0, 11.0, 22.0, 22.0]


CHANGES = """[drive]
load_changes = [
  { time_s = 0.1, output_torque_n_m = 44.0 },
  { time_s = 0.2, output_torque_n_m = -22, ramp_s = 0.1 },
  { time_s = 0.3, output_torque_n_m = 0.0 },
]
"""


def test_load_changes():
    scene = Scene.from_toml(CHANGES)
    drive = scene.drive
    # At a jump the load is what it jumps to; the piece that ends keeps its own.
    assert [drive.load_n_m(t) for t in (0.0, 0.1, 0.2, 0.25, 0.3, 9.0)] == pytest.approx([22.0, 44.0, 44.0, 11.0, 0.0, 0.0])
    assert drive.load_piece(0.05).load_n_m(0.1) == 22.0
    # 0.2 + 0.1 is more than 0.3 by a rounding: one break.
    assert drive.load_breaks_s == [0.1, 0.2, 0.3]
    assert drive.largest_load_n_m == 44.0
    assert Scene.from_toml(scene.to_toml()) == scene
    tables = "[[drive.load_changes]]\ntime_s = 0.1\noutput_torque_n_m = 44.0\n"
    assert Scene.from_toml(tables).drive.load_changes == drive.load_changes[:1]
    assert Scene.from_toml("[drive]\nload_ramp_s = 0.02").drive.load_breaks_s == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ("3", ["drive.load_changes", "list of tables"]),
        ("[{ time_s = 0.1 }]", ["drive.load_changes[0].output_torque_n_m", "missing"]),
        ("[{ time_s = 0.0, output_torque_n_m = 1 }]", ["drive.load_changes[0].time_s", "later"]),
        ("[{ time_s = 0.1, output_torque_n_m = nan }]", ["drive.load_changes[0].output_torque_n_m", "finite"]),
        ("[{ time_s = 0.1, output_torque_n_m = 1, ramp = 1 }]", ["drive.load_changes[0].ramp"]),
        (
            "[{ time_s = 0.2, output_torque_n_m = 1 }, { time_s = 0.1, output_torque_n_m = 2 }]",
            ["drive.load_changes[1].time_s", "order"],
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = 1, ramp_s = 0.2 }, { time_s = 0.2, output_torque_n_m = 2 }]",
            ["drive.load_changes[1].time_s", "ramp"],
        ),
    ],
)
def test_load_changes_that_are_wrong(changes, words):
    with pytest.raises(SceneError) as caught:
        Scene.from_toml(f"[drive]\nload_changes = {changes}\n")
    for word in words:
        assert word in str(caught.value)
