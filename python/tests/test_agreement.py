"""Comparison of two laws: it detects a difference, and distinguishes it from a tie between two points."""

import numpy as np
import pytest

from pinwheel_engines import ContactLaw, Unsupported
from pinwheel_engines.agreement import compare, tie_m
from pinwheel_engines.layout import Kinematics
from tests import scenes


@pytest.mark.parametrize("name", ["paper", "friction", "backlash", "points"])
def test_one_law_agrees_with_itself(name):
    scene = scenes.scene(scenes.ALL[name])
    plain = scenes.PlainLaw(scene)
    agreement = compare(scene, plain.pointer, 50, seed=1)
    assert agreement.states == 50
    assert agreement.loaded > 30
    assert agreement.largest_n > 10.0
    assert agreement.worst_over_rounding < 0.5
    assert agreement.ambiguous == 0


def test_a_law_that_is_off_is_seen():
    scene = scenes.scene()
    stiffer = scenes.PlainLaw(scenes.scene("[contact]\nstiffness_multiplier = 0.0100000001"))
    agreement = compare(scene, stiffer.pointer, 50, seed=1)
    assert agreement.worst_over_rounding > 100.0
    assert 1e-9 < agreement.worst_relative < 1e-7


def test_a_law_that_numpy_does_not_know_is_refused():
    pointer = scenes.PlainLaw(scenes.scene()).pointer
    with pytest.raises(Unsupported):
        compare(scenes.scene('[contact]\nlaw = "constant"'), pointer, 5, seed=1)


def test_ties_between_points():
    # One disc at rest in the ideal mesh, its hole's points symmetric about the line through the pin.
    scene = scenes.scene(scenes.POINTS)
    law = ContactLaw(scene)
    angles, rates = Kinematics(scene.gear).ideal(scene)
    angles[2:4] += 1e-4
    state = Kinematics(scene.gear).states(angles, rates)
    gap = law.nearest_gap_m(state)
    assert 0.0 <= gap < 1e-4
    # Far from a tie for a state taken at random.
    assert law.nearest_gap_m(scenes.random_states(scene, 1, seed=3)[0]) > tie_m(scene)
    assert np.isfinite(gap)
