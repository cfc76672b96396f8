#!/usr/bin/env python3
"""Renders the figures that show what Etendue's settings do: labelled contact sheets and a page that holds them all.

Needs only Python's standard library, the etendue command and oiiotool (Debian: openimageio-tools, fonts-dejavu-core).
Where ETENDUE_SHARED names a folder with the course's scenes, it makes the figures of those, too. Writes OUT/index.html,
OUT/SHEET.png, OUT/figures.json with what was measured, and the single pictures below OUT/pictures.
"""
import argparse
import base64
import html
import json
import os
import re
import shlex
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@dataclass
class Picture:
    """One cell of a sheet: `command` is what follows `etendue` but for the output; the lines go under it."""
    label: str
    note: str
    command: list = field(default_factory=list)
    measure: str = ""  # "mean": its mean radiance; "variance": that against the row's last picture
    numbers: dict = field(default_factory=dict)
    file: Path = None


@dataclass
class Sheet:
    name: str
    title: str
    text: str  # what there is to see, for the page
    columns: int
    pictures: list
    size: tuple = (400, 300)  # of a picture on the sheet


class Quality:
    """How much work goes into a picture: --quick divides its sides and its samples."""

    def __init__(self, quick):
        self.side, self.samples = (2.5, 16) if quick else (1, 1)

    def resolution(self, size):
        return ["-r", *(str(round(n / self.side)) for n in size)]

    def spp(self, count):
        return ["-s", str(max(2, count // self.samples))]


# --- what is rendered ----------------------------------------------------------------------

def depth_sheet(name, where, scene, camera, quality, size):
    seen = ["emitted light only", "+ light that bounced once", "+ twice: the mirror shows the room",
            "+ 3 times: light focused by the glass", "+ 4 times: the glass, seen in the mirror", "+ 5 times",
            "+ up to 100 times"]
    pictures = [Picture(f"-m {depth}", note, ["render", scene, *camera, *quality.resolution(size), *quality.spp(160),
                                             "-m", str(depth)], "mean")
                for depth, note in zip([0, 1, 2, 3, 4, 5, 100], seen)]
    return Sheet(name, f"Depth: what each bounce adds ({where})",
                 "Every picture contains the light of the one before it. At depth 1 mirror and glass show nothing but "
                 "the lamp; the mirror shows the room from 2 on; at 3 light has gone through the glass sphere and "
                 "gathers on the floor; at 4 it has come back to the mirror.", 4, pictures, size)


def envmap_sheet(name, where, environment):
    command = ["envmap", environment]
    return Sheet(name, f"Environment map: where its light is ({where})",
                 "Left, the map. In the middle, the cumulative probabilities that directions are drawn with: red for the "
                 "rows from top to bottom, green for the columns within their row; where green jumps from black to full "
                 "within a few columns, nearly all light of that row is there. Right, the resulting density per "
                 "steradian: black for none, pale yellow for that of uniform directions or more.", 3,
                 [Picture("The map", "as seen on a screen", command),
                  Picture("--debug", "cumulative: red rows, green columns", command + ["--debug"]),
                  Picture("--pdf", "density; pale: that of uniform or more", command + ["--pdf"])], (512, 256))


def sampling_sheet(name, where, scenes, environment, camera, quality, size):
    pictures = []
    for object_name, scene in scenes:
        common = ["render", scene, "-e", environment, *camera, *quality.resolution(size), "-m", "1"]
        noisy = common + ["-s", "4", "-l", "64"]
        pictures += [Picture(f"{object_name}: uniform", "", noisy + ["--env-sampling", "uniform"], "variance"),
                     Picture(f"{object_name}: importance", "", noisy, "variance"),
                     Picture(f"{object_name}: converged", "", common + quality.spp(128) + ["-l", "16"])]
    return Sheet(name, f"Sampling the environment map: 4 x 64 samples ({where})",
                 "Direct light by 4 camera samples a pixel with 64 samples of the map each. Uniform directions waste most of "
                 "them; importance sampling draws directions in proportion to the light that comes from them. The variance "
                 "is measured: the mean squared difference from the converged picture, relative to its square. The noise is "
                 "what the render itself estimates, the relative standard error averaged over the pixels; where samples "
                 "find a small, strong light next to never, they cannot know what they miss, and the estimate is too low.",
                 3, pictures, size)


LENS_TEXT = " What lies at the focal distance is sharp; everything else spreads over a disc that grows with the lens."


def focus_sheet(name, where, scene, camera, quality, size):
    pictures = [Picture(f"-d {distance}", f"lens radius 0.05, focused at {distance} m",
                        ["render", scene, *camera, *quality.resolution(size), *quality.spp(128), "-b", "0.05", "-d",
                         str(distance)]) for distance in (1, 3, 5, 7)]
    return Sheet(name, f"Focal distance ({where})",
                 "The same lens of radius 0.05, focused at 1, 3, 5 and 7." + LENS_TEXT, 2, pictures, size)


def lens_sheet(name, where, scene, camera, quality, size):
    pictures = [Picture(f"-b {radius}", f"lens radius {radius}, focused at 4 m",
                        ["render", scene, *camera, *quality.resolution(size), *quality.spp(128), "-b", str(radius),
                         "-d", "4"]) for radius in (0.01, 0.03, 0.05, 0.07)]
    return Sheet(name, f"Lens radius ({where})",
                 "Focused at 4, with lenses of radius 0.01, 0.03, 0.05 and 0.07." + LENS_TEXT, 2, pictures, size)


def knots_under_the_sky(folder):
    """The knot without its lamps, once of gold and once, without its CGL technique, of the diffuse colour it falls back to."""
    text = (ROOT / "scenes/knot.dae").read_text()
    unlit, lamps = re.subn(r"<instance_light[^>]*/>", "", text)
    diffuse, metals = re.subn(r'<technique profile="CGL"><microfacet>.*?</technique>', "", unlit)
    if (lamps, metals) != (3, 1):
        raise SystemExit("make_figures.py: scenes/knot.dae is not as expected: three lamps, one metal.")
    scenes = []
    for name, content in (("diffuse", diffuse), ("metal", unlit)):
        scenes.append((name, folder / f"knot-{name}.dae"))
        scenes[-1][1].write_text(content)
    return scenes


def own_sheets(folder, quality):
    sky, file_camera = ROOT / "scenes/sky.hdr", ["--camera-placement", "file"]
    garden, in_garden = ROOT / "scenes/garden.dae", ["-e", ROOT / "scenes/sky.hdr", *file_camera]
    size, where = (400, 300), "Etendue's scenes"
    return [depth_sheet("depth", where, ROOT / "scenes/cornell-spheres.dae", file_camera, quality, size),
            envmap_sheet("envmap", where, sky),
            sampling_sheet("sampling", where, knots_under_the_sky(folder), sky, file_camera + ["--exposure", "-0.5"],
                           quality, size),
            focus_sheet("focus", where, garden, in_garden, quality, size),
            lens_sheet("lens", where, garden, in_garden, quality, size)]


def course_sheets(shared, quality):
    scenes, museum = shared / "scenes/cs184", shared / "envmaps/museum.exr"
    size, where = (480, 360), "the course's scenes"
    bunnies = [("diffuse", scenes / "bunny_unlit.dae"), ("metal", scenes / "bunny_microfacet_cu_unlit.dae")]
    return [depth_sheet("course-depth", where, scenes / "CBspheres.dae", [], quality, size),
            envmap_sheet("course-envmap", where, museum),
            sampling_sheet("course-sampling", where, bunnies, museum, [], quality, size),
            focus_sheet("course-focus", where, scenes / "CBspheres.dae", [], quality, size),
            lens_sheet("course-lens", where, scenes / "CBspheres.dae", [], quality, size)]


# --- rendering and measuring ---------------------------------------------------------------

def run(*command):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(f"make_figures.py: {shlex.join(map(str, command))} failed:\n{result.stderr.strip()}")
    return result.stdout


def render(etendue, picture, stem):
    """Makes picture.file, a PNG, and fills in what is known of it."""
    picture.file = stem.with_suffix(".png")
    if picture.command[0] == "envmap":
        make_envmap_picture(etendue, picture, stem)
        return
    stats = stem.with_suffix(".json")
    run(etendue, *picture.command, "-q", "-o", picture.file, "-o", stem.with_suffix(".exr"), "--stats", stats)
    picture.numbers = {key: json.loads(stats.read_text())[key] for key in ("noise", "samples_per_pixel", "cpu_seconds")}


def make_envmap_picture(etendue, picture, stem):
    mode = picture.command[2] if len(picture.command) > 2 else None
    if mode == "--debug":
        run(etendue, *picture.command, picture.file)
    elif mode == "--pdf":
        run(etendue, *picture.command, stem.with_suffix(".exr"))
        run("oiiotool", stem.with_suffix(".exr"), "--ch", "0", "--mulc", "12.566", "--clamp:min=0:max=1", "--colormap", "inferno",
            "-d", "uint8", "-o", picture.file)
    else:
        run("oiiotool", picture.command[1], "--ch", "R,G,B", "--powc", "0.4545", "-d", "uint8", "-o", picture.file)


def difference(etendue, picture, reference):
    """(mean of the picture, its relative mean squared error) by `etendue diff`."""
    table = run(etendue, "diff", picture.file.with_suffix(".exr"), reference.file.with_suffix(".exr"))
    return tuple(float(re.search(rf"^{name} +(\S+)$", table, re.MULTILINE)[1]) for name in ("mean of A", "relative MSE"))


def measure(etendue, sheet):
    """Compares the pictures of each row of a sheet with its last and writes what was found under them."""
    for first in range(0, len(sheet.pictures), sheet.columns):
        row = sheet.pictures[first:first + sheet.columns]
        for picture in row:
            if picture.measure:
                picture.numbers["mean"], picture.numbers["variance"] = difference(etendue, picture, row[-1])
            if picture.measure == "mean":
                picture.note += f"; mean {picture.numbers['mean']:.3f}"
        if row[0].measure == "variance":
            note_variances(*row)


def note_variances(uniform, importance, converged):
    ratio = uniform.numbers["variance"] / importance.numbers["variance"]
    for picture, times in (uniform, f" ({ratio:.3g} x)"), (importance, ""):
        picture.note = f"variance {picture.numbers['variance']:.3g}{times}, own estimate of the noise {percent(picture)}"
    converged.note = f"{converged.numbers['samples_per_pixel']:.0f} samples a pixel, noise {percent(converged)}"


def percent(picture):
    return f"{100 * picture.numbers['noise']:.2g} %"


# --- contact sheets ------------------------------------------------------------------------

MARGIN, GAP, TITLE_HEIGHT, CAPTION_HEIGHT = 28, 16, 64, 56
PAPER, INK, GREY = "0.98,0.98,0.97", "0.10,0.10,0.12", "0.40,0.40,0.43"


def text(x, y, size, content, color=INK, font="DejaVuSans"):
    """oiiotool's words for a line of text with its baseline at y. Its fonts know ASCII only."""
    return [f"--text:x={x}:y={y}:size={size}:color={color}:font={font}", content]


def sheet_size(sheet):
    rows = -(-len(sheet.pictures) // sheet.columns)
    return (2 * MARGIN + sheet.columns * (sheet.size[0] + GAP) - GAP,
            MARGIN + TITLE_HEIGHT + rows * (sheet.size[1] + CAPTION_HEIGHT) + MARGIN // 2)


def compose(sheet, file):
    """Writes the sheet: title, pictures row by row, two lines under each."""
    width, height = sheet_size(sheet)
    w, h = sheet.size
    words = ["--create", f"{width}x{height}", "3", f"--fill:color={PAPER}", f"{width}x{height}"]
    words += text(MARGIN, MARGIN + 26, 26, sheet.title, font="DejaVuSans-Bold")
    for i, picture in enumerate(sheet.pictures):
        x = MARGIN + i % sheet.columns * (w + GAP)
        y = MARGIN + TITLE_HEIGHT + i // sheet.columns * (h + CAPTION_HEIGHT)
        words += [picture.file, "--ch", "0,1,2", "--resize:filter=box", f"{w}x{h}", "--swap", "--paste", f"+{x}+{y}"]
        words += text(x, y + h + 21, 17, picture.label, font="DejaVuSans-Bold")
        words += text(x, y + h + 40, 14, picture.note, GREY)
    run("oiiotool", *words, "-d", "uint8", "--nosoftwareattrib", "-o", file)


# --- the page ------------------------------------------------------------------------------

STYLE = """
:root { color-scheme: light dark; --paper: #fafaf8; --ink: #1a1a1e; --soft: #66666c; --line: #ddddd8; --box: #f0f0ec }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16171a; --ink: #e8e8e4; --soft: #9a9aa2; --line: #33353b; --box: #1f2126 } }
body { background: var(--paper); color: var(--ink); font: 17px/1.55 system-ui, sans-serif; margin: 0 auto;
  max-width: 76rem; padding: 2rem 1.25rem 4rem }
h1 { font-size: 1.9rem; margin: 0 } h2 { font-size: 1.3rem; margin: 3.5rem 0 .4rem }
p { max-width: 46rem; margin: .4rem 0 1rem } .soft, summary { color: var(--soft) }
nav { display: flex; flex-wrap: wrap; gap: .3rem 1.2rem; margin-top: 1rem } a { color: inherit }
img { width: 100%; height: auto; display: block; border: 1px solid var(--line); border-radius: 6px }
details { margin-top: .7rem } summary { cursor: pointer }
pre { background: var(--box); border-radius: 6px; padding: .8rem 1rem; overflow-x: auto; font-size: .82rem; line-height: 1.5 }
"""


def command_line(picture, shared):
    """What to type for this picture, in the project's folder."""
    line = shlex.join(["etendue", *map(str, picture.command)]).replace(f"{ROOT}/", "")
    if shared:
        line = line.replace(shared, "$ETENDUE_SHARED")
    outputs = {"render": f" -o {picture.file.name}"}
    if picture.command[0] == "envmap":
        outputs["envmap"] = {"--debug": f" {picture.file.name}", "--pdf": f" {picture.file.stem}.exr"}.get(
            str(picture.command[-1]), "")
    return line + outputs[picture.command[0]]


def as_jpeg(file):
    """The sheet as a data URI, so that the page is one file."""
    jpeg = file.with_suffix(".jpg")
    run("oiiotool", file, "--compression", "jpeg:90", "--nosoftwareattrib", "-o", jpeg)
    data = base64.b64encode(jpeg.read_bytes()).decode()
    jpeg.unlink()
    return f"data:image/jpeg;base64,{data}"


def section(sheet, out, shared):
    width, height = sheet_size(sheet)
    commands = html.escape("\n".join(command_line(picture, shared) for picture in sheet.pictures))
    return f"""<section id="{sheet.name}"><h2>{html.escape(sheet.title)}</h2>
<p>{html.escape(sheet.text)}</p>
<a href="{sheet.name}.png"><img src="{as_jpeg(out / f'{sheet.name}.png')}" width="{width}" height="{height}"
  alt="{html.escape(sheet.title)}"></a>
<details open><summary>The command lines</summary><pre>{commands}</pre></details></section>
"""


def write_page(sheets, out, version, quick, shared):
    links = "".join(f'<a href="#{sheet.name}">{html.escape(sheet.title)}</a>' for sheet in sheets)
    quality = ("These are the quick versions, small and noisy: <code>make figures</code> makes the good ones."
               if quick else "")
    (out / "index.html").write_text(f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Etendue: figures</title><style>{STYLE}</style></head><body>
<h1>Figures</h1>
<p class="soft">Rendered by {version} with <code>make figures</code>. Every picture has its command line below the sheet;
every number under a picture was measured on that picture. {quality}</p>
<nav>{links}</nav>
{"".join(section(sheet, out, shared) for sheet in sheets)}</body></html>
""", encoding="utf-8")


def write_numbers(sheets, file):
    numbers = {sheet.name: {"width": sheet_size(sheet)[0], "height": sheet_size(sheet)[1],
                            "pictures": {picture.label: picture.numbers for picture in sheet.pictures}}
               for sheet in sheets}
    file.write_text(json.dumps(numbers, indent=2) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--etendue", type=Path, default=ROOT / "build/release/apps/cli/etendue", help="the command to use")
    parser.add_argument("--out", type=Path, default=ROOT / "out/figures", help="the folder to write into")
    parser.add_argument("--quick", action="store_true", help="small, noisy pictures of Etendue's own scenes only")
    options = parser.parse_args()
    shared = None if options.quick else os.environ.get("ETENDUE_SHARED")

    pictures = options.out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    quality = Quality(options.quick)
    sheets = own_sheets(pictures, quality) + (course_sheets(Path(shared), quality) if shared else [])
    start = time.monotonic()
    for sheet in sheets:
        for number, picture in enumerate(sheet.pictures, 1):
            print(f"{sheet.name}: {number} of {len(sheet.pictures)}, {picture.label}", flush=True)
            render(options.etendue, picture, pictures / f"{sheet.name}-{number}")
        measure(options.etendue, sheet)
        compose(sheet, options.out / f"{sheet.name}.png")
    write_page(sheets, options.out, run(options.etendue, "--version").strip(), options.quick, shared)
    write_numbers(sheets, options.out / "figures.json")
    print(f"{len(sheets)} sheets in {time.monotonic() - start:.0f} s: {options.out / 'index.html'}")


if __name__ == "__main__":
    try:
        main()
    except FileNotFoundError as error:
        sys.exit(f"make_figures.py: {error.filename} is missing. `make figures` builds and installs what is needed.")
