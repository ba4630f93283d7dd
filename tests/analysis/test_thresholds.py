"""The numbers behind words such as 'slightly': fixed before the results were looked at, changed only on purpose."""

from analysis.tables import thresholds

FIXED = {
    "BISECTION_M": 2e-6, "EXACT_M": 0.05, "SAME_M": 0.1, "SLIGHT_M": 0.3, "TOO_EARLY_M": 0.6, "MIDDLE_M": 0.5,
    "NEARLY_ALL": 0.9, "MOST": 0.5, "NOTICED": 1 / 3, "RARE": 0.1, "POOR_ERROR": 1 / 3, "PRACTICALLY": 0.05,
    "COINCIDE": 0.05, "THIN": 1 / 3, "PARALLEL": 0.999, "ABOUT": 0.2, "WITHIN": 0.25, "FOLLOWS": 0.5,
    "SQUARE": (1.7, 2.3), "SQUARE_FROM": 10,
    "NEAR": 0.2, "HIGH_ERROR": 0.2, "NEARLY_AS": 0.1, "MARKEDLY": 1.5, "COMPARABLE": 1.5, "VERY_ALIKE": 0.8,
}  # fmt: skip


def test_thresholds_are_those_fixed_before_the_results():
    assert {name: value for name, value in vars(thresholds).items() if name.isupper()} == FIXED


def test_lengths_are_in_order():
    names = ("BISECTION_M", "EXACT_M", "SAME_M", "SLIGHT_M", "TOO_EARLY_M")
    lengths = [getattr(thresholds, name) for name in names]
    assert lengths == sorted(lengths)
