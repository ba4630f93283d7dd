"""How often the intervals of analysis/tables/intervals.py hold a ratio that is known: times made up for trials.

    scripts/python tests/interval_trials.py        # 2,000 trials each; prints one line for every kind of noise

What the noise is like was measured on padani (600 steps, three repeats, eight labels timed twice in one run, four
processors busy with other work). The logarithm of the ratio of a label with itself has a standard deviation of 0.013 to
0.06 (of cannon_sap 0.18), tails far from a bell curve (kurtosis 4 to 36) and an autocorrelation of -0.1 to -0.3 at one
step, 0.1 to 0.3 at two, 0.1 to 0.3 still at 100 (cannon_sap: -0.84, 0.86, 0.82): most of it is the alternating order of
the algorithms, which blocks of an even number of steps average out. What alternates not, of one label about its median
over 51 steps, has an autocorrelation of 0.0 to 0.9 at one step that is gone at 25. Hence here: a scene's load from step
to step, a disturbance that both labels share, an alternation of +-2 %, and noise of each label's own, an autoregression
of Student's t with 5 degrees of freedom.
"""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from analysis.tables import intervals  # noqa: E402

RATIO = 1.1


def autoregression(random, trials, steps, factor):
    """trials x steps of noise with standard deviation 1 and autocorrelation factor^k at k steps."""
    warm = 100
    fresh = random.standard_t(5, (steps + warm, trials)) / np.sqrt(5 / 3)
    noise = np.empty_like(fresh)
    noise[0] = fresh[0]
    for step in range(1, steps + warm):
        noise[step] = factor * noise[step - 1] + np.sqrt(1 - factor**2) * fresh[step]
    return noise[warm:].T


def times(random, trials, steps, factor, deviation=0.05):
    """Times of two labels over the same steps: (times, others), trials x steps each; their true ratio is RATIO."""
    load = 1 + 0.6 * np.sin(np.arange(steps) / 60) ** 2
    order = np.where(np.arange(steps) % 2, 0.02, -0.02)
    shared = np.exp(deviation * autoregression(random, trials, steps, 0.5))
    own = [1 + deviation * autoregression(random, trials, steps, factor) for _ in range(2)]
    return RATIO * load * shared * own[0] * (1 + order), load * shared * own[1] * (1 - order)


def coverage(trials, steps, factor, seed):
    """(the share of trials whose interval holds RATIO, the mean of high / low - 1)."""
    made = zip(*times(np.random.default_rng(seed), trials, steps, factor))
    found = [intervals.ratio(one, other) for one, other in made]
    return np.mean([one.holds(RATIO) for one in found]), np.mean([one.high / one.low - 1 for one in found])


if __name__ == "__main__":
    for steps in (250, 600, 2000):
        for factor in (0.0, 0.3, 0.5, 0.7, 0.9):
            share, width = coverage(2000, steps, factor, 1)
            print(f"{steps:5} steps, autocorrelation {factor}: holds it in {100 * share:.1f} % of 2000, width "
                  f"{100 * width:.2f} %")
