#!/usr/bin/python3 -B
"""Renders the scenes of Mitsuba's render tests and tests every pixel against the references that come with them.

SUITE is a folder laid out as Mitsuba's: tests/scenes/FOLDER/NAME_INTEGRATOR.xml, with the mean and the variance of a sample
beside it in refs/NAME_ref_rgb.exr and refs/NAME_ref_rgb_var.exr; scenes without these are left out. Without an argument it is
conformance/mitsuba in the folder that ETENDUE_SHARED names. Writes OUT/index.html, OUT/conformance.json, and the pictures
below OUT/pictures. Needs NumPy and OpenImageIO's module (Debian: python3-numpy, python3-openimageio), which come with the
system's Python.
"""
import argparse
import base64
import html
import json
import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from make_figures import ROOT, STYLE

try:
    import numpy as np
    import OpenImageIO as oiio
except ImportError as error:
    sys.exit(f"conformance.py: Python's module {error.name} is missing; scripts/install-dependencies.sh installs it.")

RENDER_TIMEOUT = 600  # seconds, for one picture
NEEDED_SHARE = 0.9975
VARIANCE_FLOOR = 1e-4
XYZ_FROM_RGB = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])


# --- the test ------------------------------------------------------------------------------

@dataclass
class Agreement:
    """How well a picture agrees with its reference; the arrays are height x width x 3 (X, Y, Z)."""
    p: np.ndarray  # of each pixel-channel, two-sided
    deviation: np.ndarray  # image - reference, in standard errors
    alpha: float  # a pixel-channel disagrees where p is not above it
    bias: float  # mean of image - mean of reference, in standard errors of the mean: the channel where it is farthest from 0

    @property
    def share(self):
        """Of the pixel-channels, those that agree. One that is not a number does not."""
        return float((self.p > self.alpha).mean())


def compare(image, reference, variance, samples):
    """z-test of each pixel-channel in XYZ, on a level shared among the pixels (Sidak 1967) so that one picture in a hundred
    of the right ones has a pixel that disagrees. `variance` is that of one sample; image and reference are RGB, as it is."""
    pixels = reference.shape[0] * reference.shape[1]
    difference = (image - reference) @ XYZ_FROM_RGB.T
    squared_error = np.maximum(variance @ XYZ_FROM_RGB.T, VARIANCE_FLOOR) / samples
    deviation = difference / np.sqrt(squared_error)
    bias = difference.sum(axis=(0, 1)) / np.sqrt(squared_error.sum(axis=(0, 1)))
    return Agreement(p=np.vectorize(math.erfc)(np.abs(deviation) / math.sqrt(2)), deviation=deviation,
                     alpha=1 - 0.99 ** (1 / pixels), bias=float(bias[np.argmax(np.abs(bias))]))


# --- rendering -----------------------------------------------------------------------------

@dataclass
class Scene:
    file: Path
    reference: Path

    @property
    def name(self):
        return self.file.stem.removeprefix("test_")

    @property
    def variance(self):
        return self.reference.with_name(self.reference.stem + "_var.exr")


@dataclass
class Result:
    """One picture of a scene. Where there is none to compare, `message` says why."""
    seed: int
    seconds: float
    image: np.ndarray = None
    agreement: Agreement = None
    message: str = ""

    @property
    def share(self):
        return self.agreement.share if self.agreement else 0.0

    @property
    def passed(self):
        return self.share >= NEEDED_SHARE


def find_scenes(suite):
    scenes = []
    for file in sorted(suite.glob("tests/scenes/*/*.xml")):
        scene = Scene(file, file.parent / "refs" / f"{file.stem.rpartition('_')[0]}_ref_rgb.exr")
        if scene.reference.exists() and scene.variance.exists():
            scenes.append(scene)
    return scenes


def read_rgb(file):
    picture = oiio.ImageInput.open(str(file))
    if picture is None:
        raise SystemExit(f"conformance.py: {file} cannot be read: {oiio.geterror()}")
    pixels = np.asarray(picture.read_image(oiio.FLOAT), dtype=np.float64)
    picture.close()
    return pixels[..., :3]


def render(etendue, scene, seed, budget, file):
    """Renders `budget` samples in all, as many in each pixel, and compares."""
    reference = read_rgb(scene.reference)
    height, width, _ = reference.shape
    samples = max(1, budget // (width * height))
    file.unlink(missing_ok=True)
    start = time.monotonic()
    try:
        run = subprocess.run([etendue, "render", scene.file, "-s", str(samples), "--seed", str(seed), "-q", "-o", file],
                             capture_output=True, text=True, timeout=RENDER_TIMEOUT)
    except subprocess.TimeoutExpired:
        return Result(seed, RENDER_TIMEOUT, message=f"stopped after {RENDER_TIMEOUT} s")
    result = Result(seed, time.monotonic() - start)
    if run.returncode != 0:
        said = run.stderr.strip().splitlines()
        result.message = said[-1] if said else f"etendue ended with {run.returncode}"
        return result
    result.image = read_rgb(file)
    if result.image.shape != reference.shape:
        result.message = f"{result.image.shape[1]} x {result.image.shape[0]} pixels, the reference has {width} x {height}"
    else:
        result.agreement = compare(result.image, reference, read_rgb(scene.variance), samples)
    return result


# --- the table -----------------------------------------------------------------------------

def verdict(results):
    return "pass" if all(result.passed for result in results) else "FAIL"


def shares(results):
    return " ".join(f"{100 * result.share:6.2f}" for result in results)


def biases(results):
    return " ".join(f"{result.agreement.bias:+5.1f}" if result.agreement else "    –" for result in results)


def messages(results):
    return [f"seed {result.seed}: {result.message}" for result in results if result.message]


def table_row(name, result, share, bias, seconds, seeds):
    return f"{name:<32}{result:<6}{share:>{max(7 * seeds, 9)}}  {bias:>{max(6 * seeds, 9)}}  {seconds:>7}"


def print_row(scene, results):
    seconds = sum(result.seconds for result in results)
    print(table_row(scene.name, verdict(results), shares(results), biases(results), f"{seconds:.1f}", len(results)), flush=True)
    for message in messages(results):
        print(f"  {message}", flush=True)


# --- the page ------------------------------------------------------------------------------

PAPER, ABOVE, BELOW, NOT_A_NUMBER = (np.array(color) for color in ((0.95, 0.95, 0.93), (0.78, 0.10, 0.08), (0.08, 0.25, 0.75),
                                                                   (0.0, 0.0, 0.0)))
PAGE_STYLE = STYLE + """
.three { display: grid; grid-template-columns: repeat(3, 1fr); gap: 1rem } figure { margin: 0 }
.wide { grid-template-columns: 1fr }
.three img { image-rendering: pixelated; border-radius: 0 } figcaption { color: var(--soft); font-size: .85rem }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1.5rem 0; font-size: .9rem }
td, th { text-align: left; padding: .15rem 1.4rem .15rem 0; border-bottom: 1px solid var(--line) }
td.number { text-align: right; white-space: pre } .fail { color: #d03020; font-weight: 600 }
.key { display: inline-block; width: 12rem; height: .8rem; border: 1px solid var(--line); vertical-align: middle;
  background: linear-gradient(90deg, rgb(20 64 191), rgb(242 242 237), rgb(199 26 20)) }
"""


def exposure(reference):
    """The factor that shows all but the brightest 2 % of the pixels as they are."""
    brightness = reference.max(axis=2)
    return 0.9 / (np.percentile(brightness, 98) or brightness.max() or 1.0)


def as_seen(rgb, factor):
    """Encoded for a screen (IEC 61966-2-1)."""
    light = np.clip(np.nan_to_num(rgb * factor), 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def p_map(agreement):
    """Of each pixel the channel with the smallest p: paper for 1, the full colour from alpha down, evenly in log p."""
    channel = np.argmin(agreement.p, axis=2)[..., None]  # of a NaN, if there is one
    p, deviation = (np.take_along_axis(values, channel, axis=2) for values in (agreement.p, agreement.deviation))
    strength = np.clip(np.log(np.maximum(p, 1e-300)) / math.log(agreement.alpha), 0, 1)
    color = PAPER + strength * (np.where(deviation > 0, ABOVE, BELOW) - PAPER)
    return np.where(np.isnan(p), NOT_A_NUMBER, color)


def png_uri(picture, file):
    """Writes a picture of values from 0 to 1 and returns it as a data URI, so that the page is one file."""
    height, width, channels = picture.shape
    out = oiio.ImageOutput.create(str(file))
    if not out.open(str(file), oiio.ImageSpec(width, height, channels, oiio.UINT8)):
        raise SystemExit(f"conformance.py: {file} cannot be written: {out.geterror()}")
    out.write_image(np.round(255 * picture).astype(np.uint8))
    out.close()
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def figure(picture, file, caption):
    return (f'<figure><img src="{png_uri(picture, file)}" width="{picture.shape[1]}" height="{picture.shape[0]}" '
            f'alt="{html.escape(caption)}"><figcaption>{html.escape(caption)}</figcaption></figure>')


def means(values):
    return " ".join(f"{value:.4g}" for value in values.mean(axis=(0, 1)))


def figures(scene, result, pictures):
    """Image, reference and p-values beside each other, or wide ones below each other."""
    reference = read_rgb(scene.reference)
    wide = " wide" if reference.shape[1] > 3 * reference.shape[0] else ""
    factor = exposure(reference)
    stem = pictures / scene.name
    return f"""<div class="three{wide}">
{figure(as_seen(result.image, factor), Path(f"{stem}-image.png"), f"Etendue, seed {result.seed}: mean {means(result.image)}")}
{figure(as_seen(reference, factor), Path(f"{stem}-reference.png"), f"Reference: mean {means(reference)}")}
{figure(p_map(result.agreement), Path(f"{stem}-p.png"), f"p-values, the smallest is {result.agreement.p.min():.2g}")}
</div>"""


def section(scene, results, pictures):
    worst = min(results, key=lambda result: (result.agreement is None, result.share))
    height, width, _ = read_rgb(scene.reference).shape
    facts = [f"seed {r.seed}: {100 * r.share:.2f} % agree, bias {r.agreement.bias:+.2f} σ, {r.seconds:.1f} s"
             for r in results if r.agreement]
    failed = verdict(results) == "FAIL"
    return f"""<section id="{scene.name}"><h2>{scene.name}{' <span class="fail">FAIL</span>' if failed else ''}</h2>
<p class="soft">{html.escape("; ".join([f"{width} × {height} pixels", *facts, *messages(results)]))}</p>
{figures(scene, worst, pictures) if worst.agreement else ''}</section>
"""


def page_row(scene, results):
    result = verdict(results)
    return (f'<tr><td><a href="#{scene.name}">{scene.name}</a></td><td class="{result.lower()}">{result}</td>'
            f'<td class="number">{shares(results)}</td><td class="number">{biases(results)}</td>'
            f'<td class="number">{sum(r.seconds for r in results):.1f}</td></tr>\n')


def write_page(tested, out, summary, budget, version):
    rows = "".join(page_row(scene, results) for scene, results in tested)
    sections = "".join(section(scene, results, out / "pictures") for scene, results in tested)
    (out / "index.html").write_text(f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Etendue: conformance</title><style>{PAGE_STYLE}</style></head><body>
<h1>Conformance</h1>
<p class="soft">Scenes of Mitsuba's render tests, rendered by {html.escape(version)} with {budget:,} samples a picture, against the
references of that suite. {html.escape(summary)}.</p>
<p>A pixel-channel (X, Y or Z) agrees where its difference from the reference is explained by the noise that the reference's
variance predicts; a picture passes when {100 * NEEDED_SHARE:g} % of them do. The bias is the difference of the means of the two
pictures in units of its standard error, of the channel where it is largest. Within ±3 it is chance; in a scene with next to
no noise, a difference that no eye can see is more. Image and reference are exposed alike. The third picture shows p of each
pixel's worst channel on a logarithmic scale; in the full colours it disagrees:</p>
<p>too dark <span class="key"></span> too bright</p>
<table><tr><th>scene</th><th></th><th>agreeing, %</th><th>bias, σ</th><th>seconds</th></tr>
{rows}</table>
{sections}</body></html>
""", encoding="utf-8")


def write_numbers(tested, file):
    numbers = {scene.name: [{"seed": r.seed, "passed": r.passed, "share": r.share, "seconds": r.seconds, "message": r.message,
                             "bias": r.agreement.bias if r.agreement else None} for r in results] for scene, results in tested}
    file.write_text(json.dumps(numbers, indent=2) + "\n")


# --- the command ---------------------------------------------------------------------------

def seed_list(text):
    return [int(seed) for seed in text.split(",")]


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("suite", metavar="SUITE", type=Path, nargs="?", help="the folder that holds tests/scenes")
    parser.add_argument("--seeds", type=seed_list, default=[1], help="seeds, as in 1,2,3; every scene has to pass with each")
    parser.add_argument("--only", metavar="NAME", default="", help="only scenes with NAME in their folder's or own name")
    parser.add_argument("--budget", type=int, default=2_000_000, help="samples in a picture (default: %(default)s)")
    parser.add_argument("--etendue", type=Path, default=ROOT / "build/release/apps/cli/etendue", help="the command to use")
    parser.add_argument("--out", type=Path, default=ROOT / "out/conformance", help="the folder to write into")
    options = parser.parse_args()
    if not os.access(options.etendue, os.X_OK):
        parser.error(f"{options.etendue} is missing; `make conformance` builds it.")
    return options


def find_suite(options):
    """The folder with the scenes, or None where nobody named one that is there."""
    if options.suite:
        return options.suite
    shared = os.environ.get("ETENDUE_SHARED")
    suite = Path(shared) / "conformance/mitsuba" if shared else None
    return suite if suite and suite.is_dir() else None


def main():
    options = parse_options()
    suite = find_suite(options)
    if suite is None:
        print("conformance: skipped, there are no scenes. They are SUITE, or conformance/mitsuba where ETENDUE_SHARED points.")
        return 0
    scenes = [scene for scene in find_scenes(suite) if options.only in str(scene.file.relative_to(suite))]
    if not scenes:
        print(f"conformance.py: {suite} has no scene with a reference{f' and {options.only} in its name' * bool(options.only)}.",
              file=sys.stderr)
        return 1

    pictures = options.out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    seeds = len(options.seeds)
    print(table_row("scene", "", "agree, %", "bias, σ", "seconds", seeds), flush=True)
    tested = []
    for scene in scenes:
        results = [render(options.etendue, scene, seed, options.budget, pictures / f"{scene.name}-{seed}.exr")
                   for seed in options.seeds]
        print_row(scene, results)
        tested.append((scene, results))

    passed = sum(verdict(results) == "pass" for _, results in tested)
    names = f"seed{'s' * (seeds > 1)} {', '.join(map(str, options.seeds))}"
    summary = f"{passed} of {len(tested)} scenes pass with {names}, in {time.monotonic() - start:.0f} s"
    version = subprocess.run([options.etendue, "--version"], capture_output=True, text=True).stdout.strip()
    write_page(tested, options.out, summary, options.budget, version)
    write_numbers(tested, options.out / "conformance.json")
    print(f"{summary}: {options.out / 'index.html'}")
    return 0 if passed == len(tested) else 1


if __name__ == "__main__":
    sys.exit(main())
