"""What the words of the thesis's statements mean, in numbers.

Fixed before any result of the playground, box or falling scene was looked at, from the size of things alone: obstacles of
1 to 7 m, a hero 3 m long and 1.2 m thick (radius 0.6 m), facets of 0.2 to 0.5 m, judged in the thesis by a person who drives the
hero with keys and watches it change colour, some 400 pixels of screen to an obstacle of 6 m, one pixel to 1.5 cm. A change
of a number here is a change of what the report claims: tests pin them.
"""

# Lengths, metres along the path of the hero.
BISECTION_M = 2e-6
"""What is no difference at all: the pipeline finds an algorithm's contact to 1e-6 m, the exact one to 1e-9 m."""
EXACT_M = 0.05
"""'exact'; beyond it an answer is visibly 'early' or 'late': 3 pixels, 1 % of an obstacle, are not seen as a gap."""
SAME_M = 0.1
"""Two algorithms report 'at the same place': they are compared from memory after a key was pressed, not side by side."""
SLIGHT_M = 0.3
"""'slightly', the limit of a 'good' contact: half the hero's radius, about one facet; seen, but one must look for it."""
TOO_EARLY_M = 0.6
"""'too early': the gap is as wide as the hero's radius, 40 pixels; nobody would call that a contact."""
MIDDLE_M = 0.5
"""'in the middle': the hero's centre within this of the target's; the ring's hole has a radius of 2.5 m, the knot's 1 m."""

# Shares of passes or of samples, 1.
NEARLY_ALL = 0.9
"""'does not', 'reports the middle', 'sees the middle': one exception in ten looks like clumsy driving."""
MOST = 0.5
"""'either too early or blind', 'late or blind', 'misses': more than half, else the other outcome would be the rule."""
NOTICED = 1 / 3
"""'is early': at least every third touching pass, and more than are late. Not half: half of the passes go through the middle
along an axis, where box and round body begin at the same point, which nobody driving by hand hits."""
RARE = 0.1
"""'flickers' is more often than this, 'good' and 'slightly' have exceptions up to this: rarer than one in ten is an accident."""
POOR_ERROR = 1 / 3
"""'poor': the error (FP + FN) / (TP + FP + FN) over samples; every third colour seen near the obstacle is wrong."""
PRACTICALLY = 0.05
"""'practically as': different answers in at most one of 20 samples at which either of the two reports."""
COINCIDE = 0.05
"""'nearly coincide', of two curves of hits: mean distance against mean height; 5 % is some line widths in a printed graph."""

# Shapes.
THIN = 1 / 3
"""A box is a slab when its least side is at most this share of its greatest."""
PARALLEL = 0.999
"""Cosine from which directions count as parallel (2.6 degrees)."""

# Times.
ABOUT = 0.2
"""'about n times': within this share of n."""
WITHIN = 0.25
"""'within 25 %': the slower at most 1.25 times the faster. The statement's own number."""
FOLLOWS = 0.5
"""'follows': Pearson's correlation from here; below it less than a quarter of the variance is explained."""
SQUARE = (1.7, 2.3)
"""'grows with the square': the exponent fitted to median time against number of bodies rounds to 2, with room for set-up time."""
SQUARE_FROM = 10
"""Numbers of bodies below this are left out of that fit: the clock and the per-body work weigh more than the pairs."""
