"""What the words of the thesis's statements mean, in numbers.

Fixed before any result of the playground, box or falling scene was looked at, from the size of things alone: obstacles
of 1 to 7 m, a hero 3 m long and 1.2 m thick (radius 0.6 m), facets of 0.2 to 0.5 m, judged in the thesis by a person
who drives the hero with keys and watches it change colour, some 400 pixels of screen to an obstacle of 6 m, 1 pixel to
1.5 cm. A change of a number here is a change of what the report claims: tests pin them.
"""

# Lengths, metres along the path of the hero.

# What is no difference at all: the pipeline finds an algorithm's contact to 1e-6 m, the exact one to 1e-9 m.
BISECTION_M = 2e-6
# "exact"; beyond it an answer is visibly "early" or "late": 3 pixels, 1 % of an obstacle, are not seen as a gap.
EXACT_M = 0.05
# Two algorithms report "at the same place": compared from memory after a key was pressed, not side by side.
SAME_M = 0.1
# "slightly", and the limit of a "good" contact: half the hero's radius, about one facet; seen by who looks for it.
SLIGHT_M = 0.3
# "too early": the gap is as wide as the hero's radius, 40 pixels; nobody would call that a contact.
TOO_EARLY_M = 0.6
# "the middle": the hero's centre this near to the target's; the ring's hole has a radius of 2.5 m, the knot's of 1 m.
MIDDLE_M = 0.5

# Shares of passes or of samples, 1.

# "sees the middle", "reports the middle", "misses a capsule through a slab": one exception in ten is clumsy driving.
NEARLY_ALL = 0.9
# "either too early or blind", "late or blind", "misses": more than half, else the other outcome would be the rule.
MOST = 0.5
# "is early": at least every third touching pass, and more than are late. Not half: half of the passes go through the
# middle along an axis, where box and round body begin at the same point, which nobody driving by hand hits.
NOTICED = 1 / 3
# "flickers" is more often than this; "good" and "slightly" have exceptions up to this: one in ten is an accident.
RARE = 0.1
# "poor": the error (FP + FN) / (TP + FP + FN) over samples; every third colour seen near the obstacle is wrong.
POOR_ERROR = 1 / 3
# "practically as": different answers in at most one of 20 samples at which either of the two reports.
PRACTICALLY = 0.05
# "nearly coincide", of two curves of hits: mean distance against mean height; some line widths of a printed graph.
COINCIDE = 0.05

# Shapes.

# A box is a slab when its least side is at most this share of its greatest.
THIN = 1 / 3
# Cosine from which directions count as parallel (2.6 degrees).
PARALLEL = 0.999

# Times.

# "about n times": within this share of n.
ABOUT = 0.2
# "within 25 %": the slower at most 1.25 times the faster. The statement's own number.
WITHIN = 0.25
# "follow": Pearson's correlation from here; below it less than a quarter of the variance is explained.
FOLLOWS = 0.5
# "grow with the square": the exponent fitted to median time against number of bodies is 2, with room for set-up time.
SQUARE = (1.7, 2.3)
# Fewer bodies are left out of that fit: the clock and the work per body weigh more than the pairs.
SQUARE_FROM = 10

# Conclusions: section 5.4 and chapter 6, statements (30) and on.

# A clause that fails is a near miss when what was measured is this near to what was needed, as a share of it, or when
# one pass or sample more or less would have decided otherwise.
NEAR = 0.2
# "high accuracy", "excellent accuracy": at most every fifth colour seen near an obstacle is wrong. Between this and
# POOR_ERROR an answer is neither high nor poor.
HIGH_ERROR = 0.2
# "nearly as accurate as": its error is at most this much greater; one answer in ten is an accident, as RARE.
NEARLY_AS = 0.1
# "markedly faster", "noticeably faster": half as long again, 1.5 times; less is not seen on a curve of 500 steps.
MARKEDLY = 1.5
# "comparable", of counts: the larger at most half as many again as the smaller.
COMPARABLE = 1.5
# "very similar", of the shapes of two curves: Pearson's correlation from here; 64 % of the variance is shared.
VERY_ALIKE = 0.8
