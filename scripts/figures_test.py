"""make_figures.py --quick makes every figure, and its numbers say what they must. usage: figures_test.py ETENDUE"""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ETENDUE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "etendue"
MAKE_FIGURES = Path(__file__).resolve().parent / "make_figures.py"


def png_size(file):
    header = file.read_bytes()[:24]
    assert header[:8] == b"\x89PNG\r\n\x1a\n", file
    return struct.unpack(">II", header[16:24])


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="etendue-figures-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        environment = {name: value for name, value in os.environ.items() if name != "ETENDUE_SHARED"}
        subprocess.run([sys.executable, "-B", MAKE_FIGURES, "--quick", "--etendue", ETENDUE, "--out", folder.name],
                       check=True, env=environment, timeout=540)
        cls.sheets = json.loads((cls.folder / "figures.json").read_text())

    def numbers(self, sheet, picture):
        return self.sheets[sheet]["pictures"][picture]

    def test_every_sheet_is_there_in_its_size_and_on_the_page(self):
        self.assertEqual(list(self.sheets), ["depth", "envmap", "sampling", "focus", "lens"])
        page = (self.folder / "index.html").read_text()
        for name, sheet in self.sheets.items():
            size = (sheet["width"], sheet["height"])
            self.assertEqual(png_size(self.folder / f"{name}.png"), size)
            self.assertGreater((self.folder / f"{name}.png").stat().st_size, 20000, name)
            self.assertIn(f'<section id="{name}">', page)
        self.assertNotRegex(page, r'(src|href)="https?:', "the page stands for itself")
        self.assertEqual(page.count("data:image/jpeg;base64,"), len(self.sheets))

    def test_every_bounce_adds_light(self):
        means = [self.numbers("depth", f"-m {depth}")["mean"] for depth in (0, 1, 2, 3, 4, 5, 100)]
        for less, more in zip(means, means[1:]):
            self.assertGreater(more, less, means)
        self.assertGreater(means[5], 2 * means[0])

    def test_importance_sampling_has_less_variance_than_uniform_sampling(self):
        for thing in ("diffuse", "metal"):
            uniform, importance = (self.numbers("sampling", f"{thing}: {kind}") for kind in ("uniform", "importance"))
            self.assertEqual(uniform["samples_per_pixel"], importance["samples_per_pixel"])
            self.assertGreater(uniform["variance"], 10 * importance["variance"], thing)


if __name__ == "__main__":
    unittest.main()
