#!/usr/bin/python3 -B
"""Tests of what bench_peers.py concludes from renders, on pictures whose noise and means are known."""
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("peers: skipped, NumPy is missing")
    sys.exit(0)

from estimates import agreement, error, noise, two_sided_p, welch


def pictures(random, mean, deviation, seeds=6):
    return random.normal(mean, deviation, (seeds, 120, 150, 3))


class Estimates(unittest.TestCase):
    def setUp(self):
        self.random = np.random.RandomState(1)

    def test_students_t_is_as_tabled(self):
        for t, freedom, p in ((12.706, 1, 0.05), (2.776, 4, 0.05), (3.169, 10, 0.01), (1.96, 1e6, 0.05), (0, 5, 1)):
            self.assertAlmostEqual(two_sided_p(t, freedom), p, delta=5e-5)

    def test_p_of_equal_means_is_uniform(self):
        p = welch(self.random.normal(1, 0.1, (4, 4000)), self.random.normal(1, 0.3, (6, 4000)))
        for level in (0.02, 0.1, 0.5):
            self.assertAlmostEqual(np.mean(p < level), level, delta=4 * np.sqrt(level * (1 - level) / 4000) + 0.1 * level)

    def test_noise_is_relative_variance(self):
        found = noise(pictures(self.random, 0.5, 0.03))
        self.assertAlmostEqual(found.all, 0.0009 / 0.26, delta=0.01 * 0.0009 / 0.26)
        self.assertLess(found.trimmed, found.all)

    def test_trimming_leaves_fireflies_out(self):
        noisy = pictures(self.random, 0.5, 0.01)
        noisy[0, 0, :10] = 1000
        found = noise(noisy)
        self.assertGreater(found.all, 1e-3)
        self.assertLess(found.trimmed, 4e-4)

    def test_errors_do_not_saturate(self):
        truth = np.full((60, 60, 3), 0.5)
        dots = np.repeat(truth[None], 4, axis=0)
        dots[0, 30, 30] = 500
        self.assertLess(noise(dots).all, 4 / 3600)
        self.assertAlmostEqual(error(dots, [truth, truth]).all, 499.5**2 / 4 / 0.26 / 3600, delta=1e-3)

    def test_errors_count_blur_but_no_noise_of_the_references(self):
        references = pictures(self.random, 0.5, 0.01, 2)
        blurred = pictures(self.random, 0.53, 0.01)
        expected = (0.03**2 + 0.01**2) / 0.26
        self.assertAlmostEqual(error(blurred, references).all, expected, delta=0.02 * expected)

    def test_equal_pictures_agree(self):
        for _ in range(20):
            self.assertTrue(agreement(pictures(self.random, 0.5, 0.2), pictures(self.random, 0.5, 0.1, 4)).is_same)

    def test_one_percent_is_found(self):
        found = agreement(pictures(self.random, 0.505, 0.1), pictures(self.random, 0.5, 0.1))
        self.assertFalse(found.is_same)
        self.assertAlmostEqual(found.mean, 0.01, delta=4 * found.mean_error)

    def test_a_block_that_differs_is_found(self):
        one = pictures(self.random, 0.5, 0.1)
        other = pictures(self.random, 0.5, 0.1)
        other[:, 30:60, 60:90] *= 1.05
        found = agreement(one, other)
        self.assertLess(found.block_p, 1e-3)
        self.assertAlmostEqual(found.block, 1 / 1.05 - 1, delta=0.02)

    def test_rounding_is_no_difference(self):
        self.assertTrue(agreement(np.full((4, 60, 60, 3), 3.57142), np.full((4, 60, 60, 3), 3.571425)).is_same)


if __name__ == "__main__":
    unittest.main()
