"""Numbers with their errors, for the comparison of two renderers. Plain Python: tests need no package.

    relMSE = mean over pixels and channels of  (I − R₁)(I − R₂) / (R² + 0.01)        R = (R₁ + R₂)/2

| symbol | meaning |
|---|---|
| I | an image |
| R₁, R₂ | two references, independent of I and of each other |
| z | difference of two means, divided by its standard error |
| α | probability of a false alarm, for all comparisons together |

The usual (I − R)² also holds the noise of the reference. In the product, the errors of R₁ and R₂ are independent and have
mean zero, so their product does too: the expectation is the squared error of I alone. The weight uses both references, which
leaves an error of second order in their noise.

Reference: F. Rousselle, C. Knaus, M. Zwicker, Adaptive Sampling and Reconstruction using Greedy Error Minimization (2011),
for relMSE and its constant 0.01.
"""

import math
from statistics import NormalDist, fmean, median, stdev

POWER = 0.9  # probability with which the smallest difference that is stated would have been found


def rel_mse(image, first, second):
    """relMSE of an image against two references; three sequences of the same length."""
    return fmean(
        (i - a) * (i - b) / ((0.5 * (a + b)) ** 2 + 0.01) for i, a, b in zip(image, first, second, strict=True)
    )


def mean_error(values):
    """The mean of independent values, and its standard error."""
    return fmean(values), stdev(values) / math.sqrt(len(values))


def t_quantile(p, dof):
    """Quantile of Student's t distribution: Abramowitz and Stegun, Handbook (1964), 26.7.5. For 31 or more degrees of
    freedom and p up to 1 − 10⁻⁶ its error is below 0.01 %."""
    if dof < 31:
        raise ValueError(f"{dof} degrees of freedom: the expansion needs 31")
    z = NormalDist().inv_cdf(p)
    terms = [
        z,
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
        (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160,
    ]
    return sum(term / dof**i for i, term in enumerate(terms))


def compared(ours, theirs, alpha):
    """Compares the means of two sets of independent values by a two-sided t test at level `alpha`.

    The degrees of freedom are those of the smaller set, which makes false alarms rarer than `alpha`. `found` is the smallest
    difference that the test finds with probability POWER, relative to the mean.
    """
    (a, s), (b, t) = mean_error(ours), mean_error(theirs)
    # images are stored in single precision
    error = math.hypot(s, t, 2**-23 * max(abs(a), abs(b)))
    limit = t_quantile(1 - alpha / 2, min(len(ours), len(theirs)) - 1)
    z = (a - b) / error if error > 0 else 0.0
    level = 0.5 * abs(a + b)
    return {
        "fredholm": a,
        "mitsuba": b,
        "relative": (a - b) / level if level > 0 else 0.0,
        "z": z,
        "limit": limit,
        "differs": abs(z) > limit,
        "found": (limit + NormalDist().inv_cdf(POWER)) * error / level if level > 0 else 0.0,
    }


def ns_per_path(rounds, paths):
    """Median over rounds of the CPU nanoseconds per path: slope between two commands, so that start-up drops out.

    Each round holds the seconds of a command with few paths and of one with many; `paths` are their numbers of paths.
    """
    return median((many - few) * 1e9 / (paths[1] - paths[0]) for few, many in rounds)
