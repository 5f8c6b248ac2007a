"""Tests of estimates.py: python3 -m unittest discover -s benches/peers"""

import math
import random
import unittest
from statistics import fmean

from estimates import POWER, compared, mean_error, ns_per_path, rel_mse, t_quantile


class RelMse(unittest.TestCase):
    """relMSE of noisy images with the known truth L, noise s L of each image, and noise r L of each reference."""

    def setUp(self):
        rng = random.Random(1)
        self.truth = [rng.uniform(0.05, 2.0) for _ in range(4000)]
        self.noisy = lambda s: [v * (1 + rng.gauss(0, s)) for v in self.truth]

    def values(self, of):
        """Mean and error over forty images of noise 0.1, against references of noise 0.05."""
        return mean_error([of(self.noisy(0.1), self.noisy(0.05), self.noisy(0.05)) for _ in range(40)])

    def test_the_noise_of_the_references_drops_out(self):
        right = fmean((0.1 * v) ** 2 / (v * v + 0.01) for v in self.truth)
        mean, error = self.values(rel_mse)
        self.assertLess(error, 0.01 * right)
        self.assertLess(abs(mean - right), 4 * error)
        # the same against one reference: too large by a quarter, and the test notices
        mean, error = self.values(lambda i, a, _: rel_mse(i, a, a))
        self.assertGreater(mean - right, 10 * error)

    def test_the_truth_has_none(self):
        a, b = self.noisy(0.05), self.noisy(0.05)
        self.assertLess(abs(rel_mse(self.truth, a, b)), 0.1 * rel_mse(self.truth, a, a))

    def test_a_wrong_image_has_its_squared_bias(self):
        wrong = [1.1 * v for v in self.truth]
        right = fmean((0.1 * v) ** 2 / (v * v + 0.01) for v in self.truth)
        self.assertAlmostEqual(rel_mse(wrong, self.truth, self.truth), right)


class Comparison(unittest.TestCase):
    def test_quantiles_are_those_of_tables(self):
        for p, dof, t in [(0.9995, 40, 3.5510), (0.9995, 60, 3.4602), (0.9995, 120, 3.3735), (0.999999, 31, 5.8286)]:
            self.assertLess(abs(t_quantile(p, dof) / t - 1), 1e-4, (p, dof))
        with self.assertRaises(ValueError):
            t_quantile(0.9995, 7)

    def test_alarms_are_as_rare_and_differences_as_visible_as_stated(self):
        rng = random.Random(2)
        draw = lambda mean: [rng.gauss(mean, 1.0) for _ in range(32)]
        n = 2000
        false = sum(compared(draw(100), draw(100), 0.05)["differs"] for _ in range(n)) / n
        self.assertLess(abs(false - 0.05), 4 * math.sqrt(0.05 * 0.95 / n))
        # the error of one pair varies by an eighth
        shift = 100 * fmean(compared(draw(100), draw(100), 0.05)["found"] for _ in range(100))
        found = sum(compared(draw(100 + shift), draw(100), 0.05)["differs"] for _ in range(n)) / n
        self.assertLess(abs(found - POWER), 0.03)

    def test_nothing_agrees_with_nothing(self):
        self.assertFalse(compared([0.0] * 32, [0.0] * 32, 1e-6)["differs"])
        self.assertTrue(compared([0.0] * 32, [1e-9] * 32, 1e-6)["differs"])


class Slope(unittest.TestCase):
    def test_the_start_drops_out(self):
        rounds = [(1.5 + 10, 5.5 + 10), (1.5, 5.5), (1.5, 500.0)]
        self.assertAlmostEqual(ns_per_path(rounds, (1_000_000, 5_000_000)), 1000.0)


if __name__ == "__main__":
    unittest.main()
