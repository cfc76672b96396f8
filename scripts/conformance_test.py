#!/usr/bin/python3 -B
"""conformance.py accepts right pictures and refuses wrong ones. Its command is tried on a suite of one scene and a stand-in
for etendue that hands out a picture made here."""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from conformance import compare

SCRIPT = Path(__file__).resolve().parent / "conformance.py"
SIDE, SAMPLES, MEAN, VARIANCE = 48, 868, 0.5, 0.25
REFERENCE, VARIANCES = (np.full((SIDE, SIDE, 3), value) for value in (MEAN, VARIANCE))
STANDARD_ERROR = math.sqrt(VARIANCE / SAMPLES)


def noisy(mean, seed=1):
    """A picture of SAMPLES samples a pixel; what is grey stays grey."""
    return mean + np.random.default_rng(seed).normal(0, STANDARD_ERROR, (SIDE, SIDE, 1)) * np.ones(3)


def write_exr(file, pixels):
    out = oiio.ImageOutput.create(str(file))
    out.open(str(file), oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT))
    out.write_image(pixels.astype(np.float32))
    out.close()


class Protocol(unittest.TestCase):
    def test_p_is_two_sided_and_counts_standard_errors(self):
        for sign in (-1, 1):
            agreement = compare(REFERENCE + sign * 1.959964 * STANDARD_ERROR, REFERENCE, VARIANCES, SAMPLES)
            self.assertAlmostEqual(agreement.p[0, 0, 1], 0.05, delta=1e-5)  # Y, whose weights add up to 1
            self.assertAlmostEqual(agreement.deviation[0, 0, 1], sign * 1.959964, delta=1e-4)

    def test_level_is_shared_among_the_pixels(self):
        self.assertAlmostEqual((1 - compare(REFERENCE, REFERENCE, VARIANCES, SAMPLES).alpha) ** SIDE ** 2, 0.99, delta=1e-9)

    def test_variance_has_a_floor(self):
        agreement = compare(REFERENCE + 0.01, REFERENCE, 0 * VARIANCES, 100)
        self.assertAlmostEqual(agreement.deviation[0, 0, 1], 10, delta=1e-3)

    def test_right_pictures_agree(self):
        for seed in range(20):
            agreement = compare(noisy(MEAN, seed), REFERENCE, VARIANCES, SAMPLES)
            self.assertGreater(agreement.share, 0.999)
            self.assertLess(abs(agreement.bias), 4)

    def test_one_percent_more_light_shows_in_the_bias(self):
        self.assertGreater(compare(noisy(1.01 * MEAN), REFERENCE, VARIANCES, SAMPLES).bias, 10)
        self.assertLess(compare(noisy(0.99 * MEAN), REFERENCE, VARIANCES, SAMPLES).bias, -10)

    def test_a_wrong_pixel_disagrees(self):
        for wrong in (MEAN + 6 * STANDARD_ERROR, math.nan, math.inf):
            image = REFERENCE.copy()
            image[7, 5] = wrong
            self.assertAlmostEqual(compare(image, REFERENCE, VARIANCES, SAMPLES).share, 1 - 1 / SIDE ** 2, delta=1e-9)


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="etendue-conformance-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        scenes = self.folder / "suite/tests/scenes/grey"
        (scenes / "refs").mkdir(parents=True)
        (scenes / "test_grey_path.xml").touch()
        (scenes / "test_no_reference_path.xml").touch()
        write_exr(scenes / "refs/test_grey_ref_rgb.exr", REFERENCE)
        write_exr(scenes / "refs/test_grey_ref_rgb_var.exr", VARIANCES)

    def stand_in(self, script):
        file = self.folder / "etendue"
        file.write_text(f"#!/bin/sh\n[ $1 = render ] || exit 0\nfor output; do :; done\n{script}\n")
        file.chmod(0o755)
        return file

    def run_it(self, etendue, *arguments):
        environment = {name: value for name, value in os.environ.items() if name != "ETENDUE_SHARED"}
        return subprocess.run([SCRIPT, "--etendue", etendue, "--out", self.folder / "out", *arguments], env=environment,
                              capture_output=True, text=True, timeout=60)

    def run_on(self, *pictures):
        """One picture for each seed from 1 on."""
        for seed, picture in enumerate(pictures, 1):
            write_exr(self.folder / f"{seed}.exr", picture)
        etendue = self.stand_in(f'cp {self.folder}/$6.exr "$output"')  # render SCENE -s N --seed SEED
        return self.run_it(etendue, self.folder / "suite", "--seeds", ",".join(str(i + 1) for i in range(len(pictures))))

    def numbers(self):
        return json.loads((self.folder / "out/conformance.json").read_text())

    def test_right_pictures_pass(self):
        result = self.run_on(noisy(MEAN, 1), noisy(MEAN, 2))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"(?m)^grey_path +pass +100\.00 +100\.00 ")
        self.assertIn("1 of 1 scenes pass with seeds 1, 2", result.stdout)
        self.assertEqual([r["passed"] for r in self.numbers()["grey_path"]], [True, True])
        page = (self.folder / "out/index.html").read_text()
        self.assertEqual(page.count("data:image/png;base64,"), 3)
        self.assertNotRegex(page, r'(src|href)="https?:', "the page stands for itself")

    def test_one_wrong_picture_fails(self):
        for wrong_pixels, code in ((5, 0), (6, 1)):  # 0.25 % of the pixels are 5.76
            wrong = REFERENCE.copy()
            wrong[0, :wrong_pixels] = 0
            result = self.run_on(noisy(MEAN), wrong)
            self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"(?m)^grey_path +FAIL ")
        self.assertIn("0 of 1 scenes pass", result.stdout)
        self.assertEqual([r["passed"] for r in self.numbers()["grey_path"]], [True, False])

    def test_a_picture_that_cannot_be_rendered_fails_and_says_why(self):
        result = self.run_it(self.stand_in("echo 'what went wrong' >&2; exit 3"), self.folder / "suite")
        self.assertEqual(result.returncode, 1)
        self.assertIn("seed 1: what went wrong", result.stdout)
        self.assertIn("what went wrong", (self.folder / "out/index.html").read_text())

    def test_a_picture_of_another_size_fails_and_says_why(self):
        result = self.run_on(REFERENCE[:24])
        self.assertEqual(result.returncode, 1)
        self.assertIn("48 x 24 pixels, the reference has 48 x 48", result.stdout)

    def test_without_a_suite_it_is_skipped(self):
        result = self.run_it(self.stand_in("exit 1"))
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stdout, r"\Aconformance: skipped, .*\n\Z")

    def test_a_suite_without_such_scenes_is_a_mistake(self):
        result = self.run_it(self.stand_in("exit 1"), self.folder / "suite", "--only", "glass")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no scene with a reference and glass in its name", result.stderr)


if __name__ == "__main__":
    unittest.main()
