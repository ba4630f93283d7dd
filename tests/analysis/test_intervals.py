"""Intervals of means and ratios: that they hold what they should, and that both programs compute the same."""

import interval_trials
import numpy as np
import pytest
from scipy import stats

from analysis.tables import intervals
from analysis.tables.intervals import Interval

SEED = 20261129


@pytest.mark.parametrize("factor", [0.0, 0.5])
def test_the_interval_holds_a_known_ratio_in_19_of_20_trials(factor):
    # 300 trials of 95 to 96 % give 285 to 288 +- 3.8; plain percentiles of 12 blocks hold it in 89 %, 267.
    share, _ = interval_trials.coverage(300, 600, factor, SEED)
    assert 0.92 <= share <= 0.985, f"seed {SEED}"


def test_few_blocks_hold_it_as_often_and_are_never_wild():
    # 250 steps are five blocks: the bootstrap's interval was up to ten times as wide as its ratio.
    made = zip(*interval_trials.times(np.random.default_rng(SEED), 300, 250, 0.5))
    found = [intervals.ratio(one, other) for one, other in made]
    assert 0.90 <= np.mean([one.holds(interval_trials.RATIO) for one in found]) <= 0.985, f"seed {SEED}"
    assert max(one.high / one.low for one in found) < 1.25, f"seed {SEED}"


def test_quantiles_are_students():
    assert len(intervals.STUDENT) == intervals.BOOTSTRAP_BLOCKS - intervals.LEAST_BLOCKS
    freedom = np.arange(intervals.LEAST_BLOCKS - 1, intervals.BOOTSTRAP_BLOCKS - 1)
    np.testing.assert_allclose(stats.t.cdf(intervals.STUDENT, freedom), 0.975, rtol=1e-12)


def test_plain_percentiles_would_not():
    """The reason why the bootstrap is studentised."""
    times, others = interval_trials.times(np.random.default_rng(SEED), 300, 600, 0.5)
    held = 0
    for one, other in zip(times, others):
        a, b = intervals.blocks(one), intervals.blocks(other)
        chosen = intervals.draws(len(a))
        low, high = np.quantile(a[chosen].sum(1) / b[chosen].sum(1), (0.025, 0.975))
        held += low <= interval_trials.RATIO <= high
    assert held / 300 < 0.92, f"seed {SEED}"


def test_noise_is_made_as_it_was_measured():
    noise = interval_trials.autoregression(np.random.default_rng(SEED), 200, 600, 0.5)
    assert noise.std() == pytest.approx(1, rel=0.02)
    assert np.mean(noise[:, 1:] * noise[:, :-1]) == pytest.approx(0.5, abs=0.03)
    assert np.mean(noise[:, 3:] * noise[:, :-3]) == pytest.approx(0.125, abs=0.03)


def test_the_last_block_holds_what_is_left_over():
    np.testing.assert_array_equal(intervals.blocks(np.ones(330)), [50, 50, 50, 50, 50, 80])
    np.testing.assert_array_equal(intervals.blocks(np.ones(30)), [30])
    many = intervals.blocks(np.ones(60_000))
    assert len(many) == 600 and set(many) == {100}


def test_too_few_steps_have_no_interval():
    assert not intervals.mean(np.arange(1, 200)).known
    assert intervals.mean(np.arange(1, 400)).known


@pytest.mark.parametrize(
    ("ratio", "floor", "alike"),
    [
        (Interval(1.1, 1.05, 1.15), None, False),
        (Interval(1.1, 0.99, 1.2), None, True),  # holds 1
        (Interval(1.01, 1.005, 1.015), Interval(1, 0.98, 1.01), True),  # within the floor, which has no sign
        (Interval(0.985, 0.982, 0.99), Interval(1, 0.999, 1.02), True),
        (Interval(1.01, 1.005, 1.03), Interval(1, 0.98, 1.01), False),  # sticks out of it
        (Interval(1.0), None, False),  # nothing is known
        (Interval(1.01, 1.005, 1.015), Interval(1), False),
    ],
)
def test_alike_is_what_holds_one_or_lies_within_the_floor(ratio, floor, alike):
    assert intervals.alike(ratio, floor) == alike
