"""What independent renders of one scene say: how noisy they are, and whether two programs render the same picture."""
import math
from dataclasses import dataclass

import numpy as np

BLOCK = 30  # pixels along the side of a block, for comparing means
SLACK = 1e-4  # relative: how far two programs' means may be apart by rounding, where a lamp is seen without any noise


@dataclass
class Noise:
    """Mean over pixels and channels of the squared error / (mean^2 + 0.01), of one render; with and without the worst thousandth of
    pixels."""
    all: float
    trimmed: float


def without_worst(relative):
    per_pixel = relative.mean(axis=-1).ravel()
    worst = max(len(per_pixel) // 1000, 1)
    return Noise(float(per_pixel.mean()), float(np.sort(per_pixel)[:-worst].mean()))


def noise(pictures):
    """Variance, from pictures[seed, y, x, channel], relative to their own mean. A pixel with one bright dot counts for no more than
    the number of seeds, however bright the dot is; what is wrong with all of them alike does not count."""
    return without_worst(pictures.var(axis=0, ddof=1) / (pictures.mean(axis=0) ** 2 + 0.01))


def error(pictures, references):
    """Mean squared error, blur included, against the truth that two independent long renders are noisy views of: the product of
    the differences from both has no part of either's noise in its mean."""
    first, second = references
    squares = np.mean([(p - first) * (p - second) for p in pictures], axis=0)
    return without_worst(squares / ((0.5 * (first + second)) ** 2 + 0.01))


# --- means ---------------------------------------------------------------------------------

def beta_fraction(a, b, x):
    """The continued fraction of the incomplete beta function (Abramowitz & Stegun 1964, 26.5.8), by Lentz's method."""
    tiny = 1e-300
    c, d = 1.0, 1 / max(1 - (a + b) * x / (a + 1), tiny)
    result = d
    for m in range(1, 300):
        for factor in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1 + factor * d
            c = 1 + factor / c
            d = 1 / (d if abs(d) > tiny else tiny)
            c = c if abs(c) > tiny else tiny
            result *= d * c
        if abs(d * c - 1) < 1e-14:
            break
    return result


def two_sided_p(t, freedom):
    """Of Student's t."""
    if not math.isfinite(t):
        return 0.0
    a, b, x = freedom / 2, 0.5, freedom / (freedom + t * t)
    if x >= 1:
        return 1.0
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x))
    if x < (a + 1) / (a + b + 2):
        return front * beta_fraction(a, b, x) / a
    return 1 - front * beta_fraction(b, a, 1 - x) / b


def welch(first, second):
    """p of the hypothesis that two samples (along axis 0) have the same mean (Welch 1947), for each of their columns."""
    va, vb = first.var(axis=0, ddof=1) / len(first), second.var(axis=0, ddof=1) / len(second)
    mean_a, mean_b, total = first.mean(axis=0), second.mean(axis=0), va + vb
    difference = np.maximum(np.abs(mean_a - mean_b) - SLACK * np.abs(mean_b), 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(total > 0, difference / np.sqrt(total), np.where(difference == 0, 0, np.inf))
        freedom = np.where(total > 0, total**2 / (va**2 / (len(first) - 1) + vb**2 / (len(second) - 1)), 1)
    return np.vectorize(two_sided_p, otypes=[float])(t, freedom)


def blocks(pictures):
    """Means over squares of BLOCK pixels and over channels: pictures[seed, y, x, channel] to [seed, block]."""
    seeds, height, width, channels = pictures.shape
    rows, columns = height // BLOCK, width // BLOCK
    cut = pictures[:, :rows * BLOCK, :columns * BLOCK]
    return cut.reshape(seeds, rows, BLOCK, columns, BLOCK, channels).mean(axis=(2, 4, 5)).reshape(seeds, -1)


@dataclass
class Agreement:
    """How far two programs' means are apart, relative to the second's."""
    mean: float  # of the picture
    mean_error: float  # its standard error
    mean_p: float  # of all channels together, by Welch and Sidak
    block: float  # of the block that disagrees most surely, among those that are not black
    block_error: float
    block_p: float  # the smallest of all blocks, by Welch and Sidak

    @property
    def is_same(self):
        return min(self.mean_p, self.block_p) > 0.001


def sidak(p):
    """That the smallest of them is as small as it is (Sidak 1967)."""
    return -math.expm1(len(p) * math.log1p(-min(min(p), 1 - 1e-16)))


def agreement(first, second):
    a, b = first.mean(axis=(1, 2)), second.mean(axis=(1, 2))
    whole_a, whole_b = a.mean(axis=1), b.mean(axis=1)
    base = float(whole_b.mean())
    blocks_a, blocks_b = blocks(first), blocks(second)
    mean_a, mean_b = blocks_a.mean(axis=0), blocks_b.mean(axis=0)
    shown = mean_b > 0.02 * base
    blocks_a, blocks_b, mean_a, mean_b = blocks_a[:, shown], blocks_b[:, shown], mean_a[shown], mean_b[shown]
    p = welch(blocks_a, blocks_b)
    worst = int(np.argmin(p))
    error = math.sqrt(blocks_a[:, worst].var(ddof=1) / len(first) + blocks_b[:, worst].var(ddof=1) / len(second))
    return Agreement(mean=float(whole_a.mean()) / base - 1,
                     mean_error=math.sqrt(whole_a.var(ddof=1) / len(first) + whole_b.var(ddof=1) / len(second)) / base,
                     mean_p=sidak(welch(a, b)), block=float(mean_a[worst] / mean_b[worst] - 1),
                     block_error=float(error / mean_b[worst]), block_p=sidak(p))
