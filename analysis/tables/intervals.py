"""How far a mean time can be trusted, and the ratio of two labels from the same steps: 95 % intervals.

A studentised, symmetric block bootstrap over steps; pipeline/stages/interval.hpp says why and has the formula (1). The
draws are the same there and here, so the intervals are too. With few blocks Student's t takes the bootstrap's place.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

BLOCK = 50  # steps
LEAST_BLOCKS, BOOTSTRAP_BLOCKS, MOST_BLOCKS = 5, 12, 1000
RESAMPLES = 1999
SEED = 0x9D5C0FB3A1E6
# Of Student's t with LEAST_BLOCKS - 1, ... degrees of freedom, the 97.5 % quantile; scipy has ten digits of them.
STUDENT = (2.776445105198, 2.570581835636, 2.446911851145, 2.364624251593, 2.306004135204, 2.262157162798,
           2.228138851986)


@dataclass(frozen=True)
class Interval:
    """value, and what holds the true one in 95 of 100 such runs; low and high are NaN with too few steps."""

    value: float
    low: float = np.nan
    high: float = np.nan

    @property
    def known(self):
        return bool(self.low <= self.high)

    def holds(self, value):
        return bool(self.low <= value <= self.high)


def mean(times):
    """The mean of times per step (n > 0), with its interval."""
    return _interval(blocks(times), blocks(np.ones(len(times))))


def ratio(times, others):
    """The mean of `times` over that of `others`, of the same steps, with its interval."""
    return _interval(blocks(times), blocks(others))


def of_blocks(a, b):
    """The ratio of two sums over the same blocks of steps (as `blocks` has them), with its interval."""
    return _interval(np.asarray(a, float), np.asarray(b, float))


def apart(mean, other):
    """The ratio of two means with intervals that come from different runs, with its interval: deviations add by
    squares."""
    value = mean.value / other.value
    if not (mean.known and other.known):
        return Interval(value)
    half = np.hypot(np.log(mean.high / mean.value), np.log(other.high / other.value))
    return Interval(value, float(value * np.exp(-half)), float(value * np.exp(half)))


def alike(ratio, floor=None):
    """Whether a ratio tells no difference: its interval holds 1, or lies within the noise floor (an Interval of a label
    with itself, either way round). False where the interval is not known."""
    if not ratio.known:
        return False
    return ratio.holds(1) or (floor is not None and floor.known and within(ratio, floor))


def within(ratio, floor):
    most = max(floor.high, 1 / floor.low)
    return 1 / most <= ratio.low and ratio.high <= most


def blocks(values):
    """Sums over blocks of steps, as float64; the last holds what is left over."""
    values = np.asarray(values, dtype=float)
    length = BLOCK * max(1, -(-(len(values) // BLOCK) // MOST_BLOCKS))
    count = max(1, len(values) // length)
    return np.add.reduceat(values, np.arange(count) * length)


@lru_cache(maxsize=8)
def draws(count):
    """The blocks of every resample: RESAMPLES x count numbers below `count`, by SplitMix64."""
    with np.errstate(over="ignore"):
        z = np.uint64(SEED) + np.arange(1, RESAMPLES * count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z ^= z >> np.uint64(31)
    chosen = ((z >> np.uint64(32)) * np.uint64(count)) >> np.uint64(32)
    return chosen.astype(np.intp).reshape(RESAMPLES, count)


def _interval(a, b):
    value = float(a.sum() / b.sum()) if b.sum() else np.nan
    if len(a) < LEAST_BLOCKS or not (a > 0).all() or not (b > 0).all():
        return Interval(value)
    theta, error = _estimate(a, b)
    half = float(_quantile(a, b, theta) * error) if error else 0.0
    return Interval(value, value * np.exp(-half), value * np.exp(half))


def _quantile(a, b, theta):
    """q of (1)."""
    if len(a) < BOOTSTRAP_BLOCKS:
        return STUDENT[len(a) - LEAST_BLOCKS]
    chosen = draws(len(a))
    others, errors = _estimate(a[chosen], b[chosen])
    off = np.abs(others - theta)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviations = np.where(off == 0, 0, off / errors)
    quantile = (RESAMPLES + 1) * 95 // 100 - 1
    return np.partition(deviations, quantile)[quantile]


def _estimate(a, b):
    """(theta, its standard error) of (1), over the last axis."""
    count = a.shape[-1]
    sum_a, sum_b = a.sum(axis=-1, keepdims=True), b.sum(axis=-1, keepdims=True)
    u = count * (a / sum_a - b / sum_b)
    return np.log(sum_a / sum_b)[..., 0], np.sqrt((u * u).sum(axis=-1) / (count * (count - 1)))
