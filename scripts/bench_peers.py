#!/usr/bin/python3 -B
"""Measures this renderer beside Blender's Cycles, or with one set of options beside another, on the scenes of scenes/bench/.

Two programs render each scene in turn, A B A B ..., with independent seeds, each for about the same time. The figures: processor
seconds of a picture times its mean relative variance (variance / (mean^2 + 0.01) from the seeds; once more without the worst
thousandth of pixels), and the ratio of the two, A / B: how many times less work B needs for the same noise. Time is that of
sampling; reading the scene and building its trees are left out for both. The means are compared too, so that both render one scene.
With --reference-seconds it is the mean squared error against long renders instead, which counts what is blurred or not found yet.

  bench_peers.py                                       A is Cycles (Debian: apt-get install blender), B is this renderer
  bench_peers.py --ours-only --flags-a="--integrator path" --flags-b=""     A and B are this renderer

Prints a table, writes OUT/peers.json, the mean pictures, and OUT/pairs.jpg with one render of each scene by both side by side. Needs NumPy and OpenImageIO's module (Debian: python3-numpy,
python3-openimageio), which come with the system's Python.
"""
import argparse
import json
import os
import shlex
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "peers"))

try:
    import numpy as np
    import OpenImageIO as oiio
except ImportError as error:
    sys.exit(f"bench_peers.py: Python's module {error.name} is missing; scripts/install-dependencies.sh installs it.")

from estimates import agreement, error, noise

ROOT = Path(__file__).resolve().parent.parent
TIMEOUT = 3600  # seconds, for one picture
FIRST_SAMPLES = 4  # of the render that tells how long a sample takes
PAIR_SIZE, PAIR_GAP = 240, 8  # pixels


class Failed(Exception):
    pass


@dataclass
class Render:
    pixels: np.ndarray
    seconds: float  # processor time
    notes: list = field(default_factory=list)


def run(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=TIMEOUT)
    if done.returncode:
        raise Failed(f"{shlex.join(map(str, command))}\n{(done.stderr or done.stdout)[-2000:]}")
    return done


def read_pixels(path):
    picture = oiio.ImageBuf(str(path))
    pixels = picture.get_pixels(oiio.FLOAT)
    if pixels is None:
        raise Failed(f"{path}: {picture.geterror()}")
    return pixels[..., :3].astype(np.float64)


def write_pixels(path, pixels):
    picture = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float"))
    picture.set_pixels(picture.roi, np.ascontiguousarray(pixels, np.float32))
    picture.write(str(path))


def to_screen(pixels):
    """Linear to sRGB, 8 bits."""
    linear = np.clip(pixels, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def write_pairs(path, pairs):
    """Renders of two programs side by side, the middle of each scene's, at the pictures' own pixels: two scenes a row."""
    cells = []
    for pair in pairs:
        height, width = pair[0].shape[:2]
        top, left = (height - PAIR_SIZE) // 2, (width - PAIR_SIZE) // 2
        cells.append(np.concatenate([to_screen(p[top:top + PAIR_SIZE, left:left + PAIR_SIZE]) for p in pair], axis=1))
    if len(cells) % 2:
        cells.append(np.ones_like(cells[0]))
    gap = np.ones((PAIR_SIZE, PAIR_GAP, 3))
    rows = [np.concatenate([cells[i], gap, cells[i + 1]], axis=1) for i in range(0, len(cells), 2)]
    sheet = np.concatenate([part for row in rows for part in (row, np.ones((PAIR_GAP, row.shape[1], 3)))][:-1], axis=0)
    picture = oiio.ImageBuf(oiio.ImageSpec(sheet.shape[1], sheet.shape[0], 3, "uint8"))
    picture.specmod().attribute("Compression", "jpeg:88")
    picture.set_pixels(picture.roi, np.ascontiguousarray(sheet, np.float32))
    if not picture.write(str(path)):
        raise OSError(f"{path}: {picture.geterror()}")


# --- the programs --------------------------------------------------------------------------

@dataclass
class Ours:
    etendue: Path
    flags: list
    threads: int
    name: str = "etendue"

    def render(self, scene, definitions, samples, seed, out):
        stats = out.with_suffix(".json")
        run([self.etendue, "render", scene, "-o", out, "--stats", stats, "-q", "-s", samples, "--seed", seed, "-t", self.threads,
             *(f"-D{d}" for d in definitions), *self.flags])
        return Render(read_pixels(out), json.loads(stats.read_text())["cpu_seconds"])


@dataclass
class Cycles:
    blender: Path
    threads: int
    name: str = "Cycles"

    def render(self, scene, definitions, samples, seed, out):
        done = run([self.blender, "-b", "--factory-startup", "--python-exit-code", 1,
                    "--python", ROOT / "scripts/peers/cycles_render.py", "--", scene, out, "--spp", samples, "--seed", seed, "--threads", self.threads, *(f"-D{d}" for d in definitions)])
        lines = [line.removeprefix("cycles: ") for line in done.stdout.splitlines() if line.startswith("cycles: ")]
        if not lines:
            raise Failed(f"{scene}: Cycles did not render it\n{done.stderr[-2000:]}")
        told = json.loads(lines[0])
        return Render(read_pixels(out), told["seconds_per_sample"] * samples, told["notes"])


def find_blender():
    blender = shutil.which("blender")
    if not blender:
        sys.exit("bench_peers.py: there is no blender here; on Debian, as root:\n"
                 "  apt-get install -y --no-install-recommends blender\n"
                 "Without it, --ours-only compares two sets of options.")
    return Path(blender)


# --- measuring -----------------------------------------------------------------------------

@dataclass
class Measured:
    name: str
    samples: int
    seconds: float  # median of a picture, processor time
    noise: float  # mean relative variance of a picture
    noise_trimmed: float
    cost: float  # seconds x noise
    cost_trimmed: float
    notes: list


def samples_for(program, scene, definitions, seconds, folder):
    """As many as take about `seconds` of processor time; a few samples tell too little about fast ones, which get a second try."""
    def time_of(samples):
        return max(program.render(scene, definitions, samples, 1000, folder / "first.exr").seconds, 1e-3)

    samples = FIRST_SAMPLES
    took = time_of(samples)
    if took < seconds / 4:
        samples = int(samples * min(seconds / 2 / took, 8)) + 1
        took = time_of(samples)
    return max(2, round(samples * seconds / took))


def references_of(scene, options, folder):
    """Two long renders of the scene by this renderer, made once and kept in the folder; None if none are wanted."""
    if not options.reference_seconds:
        return None
    program = Ours(options.etendue, shlex.split(options.reference_flags), options.threads)
    paths = [folder / f"reference-{k}.exr" for k in (1, 2)]
    missing = [(k, path) for k, path in enumerate(paths) if not path.is_file()]
    if missing:
        samples = samples_for(program, scene, options.define, options.reference_seconds, folder)
        for k, path in missing:
            program.render(scene, options.define, samples, 9000 + k, folder / "rendering.exr")
            (folder / "rendering.exr").rename(path)
    return [read_pixels(path) for path in paths]


def measured(program, samples, renders, references):
    pictures = np.stack([r.pixels for r in renders])
    found = error(pictures, references) if references else noise(pictures)
    seconds = float(np.median([r.seconds for r in renders]))
    return Measured(program.name, samples, seconds, found.all, found.trimmed, seconds * found.all, seconds * found.trimmed,
                    renders[0].notes)


def compare(scene, first, second, options, folder, pairs):
    folder.mkdir(parents=True, exist_ok=True)
    counts = [options.spp or samples_for(program, scene, options.define, options.seconds, folder) for program in (first, second)]
    references = references_of(scene, options, folder)
    renders = ([], [])
    for seed in range(options.seeds):
        for k, program in enumerate((first, second)):
            # Two sets of options of one program must not share their noise.
            renders[k].append(program.render(scene, options.define, counts[k], 2 * seed + k + 1, folder / f"{'ab'[k]}-{seed}.exr"))
    pixels = [np.stack([r.pixels for r in side]) for side in renders]
    for k in (0, 1):
        write_pixels(folder / f"{'ab'[k]}-mean.exr", pixels[k].mean(axis=0))
    a, b = (measured(program, counts[k], renders[k], references) for k, program in enumerate((first, second)))
    same = agreement(*pixels)
    pairs.append([side[0].pixels for side in renders])
    return {"scene": scene.stem, "a": asdict(a), "b": asdict(b), "ratio": a.cost / b.cost,
            "ratio_trimmed": a.cost_trimmed / b.cost_trimmed, "means": {**asdict(same), "same": same.is_same}}


HEADER = f"{'scene':15} {'A: spp':>7} {'CPU s':>6} {'rel var':>8} {'A cost':>8} {'B: spp':>7} {'CPU s':>6} {'rel var':>8} {'B cost':>8} " \
         f"{'A/B':>6} {'trim':>6}   {'mean A-B':>15} {'worst block':>16}  p"


def table_line(row):
    a, b, means = row["a"], row["b"], row["means"]
    sides = " ".join(f"{m['samples']:7d} {m['seconds']:6.1f} {m['noise']:8.4f} {m['cost']:8.4f}" for m in (a, b))
    return (f"{row['scene']:15} {sides} {row['ratio']:6.2f} {row['ratio_trimmed']:6.2f}   "
            f"{100 * means['mean']:+6.2f} ± {100 * means['mean_error']:4.2f} % "
            f"{100 * means['block']:+6.1f} ± {100 * means['block_error']:5.1f} %  "
            f"{min(means['mean_p'], means['block_p']):.2g}{'' if means['same'] else '  DIFFERENT'}")


def geometric_mean(values):
    return float(np.exp(np.mean(np.log(values))))


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], epilog="Exits with 1 if a scene failed.")
    parser.add_argument("--etendue", type=Path, default=ROOT / "build/release/apps/cli/etendue")
    parser.add_argument("--folder", type=Path, default=ROOT / "scenes/bench", help="where the scenes are")
    parser.add_argument("--scenes", default="", help="beginnings of names, as in a,b,d-mesh-sun (default: all)")
    parser.add_argument("--seeds", type=int, default=4, help="renders of each, at least 2 (default 4)")
    parser.add_argument("--seconds", type=float, default=10, help="processor time of a render (default 10)")
    parser.add_argument("--spp", type=int, help="samples a pixel instead of --seconds")
    parser.add_argument("--reference-seconds", type=float, default=0, metavar="S",
                        help="measure the error, blur included, against two renders of this long, kept in OUT (default 0: the variance of the seeds)")
    parser.add_argument("--reference-flags", default="", help="options of those renders, as in \"--integrator path\"")
    parser.add_argument("--ours-flags", default="", help="options of this renderer beside Cycles")
    parser.add_argument("--ours-only", action="store_true", help="compare --flags-a and --flags-b instead")
    parser.add_argument("--flags-a", default="--integrator path", help="written with an equals sign: --flags-a=\"--integrator path\"")
    parser.add_argument("--flags-b", default="")
    parser.add_argument("-D", "--define", action="append", default=[], metavar="NAME=VALUE", help="gives $NAME of the scenes this value")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out/peers")
    options = parser.parse_args()
    if options.seeds < 2:
        parser.error("--seeds needs to be 2 at least: noise is told from differences")
    if not options.etendue.is_file():
        parser.error(f"{options.etendue} is not there; make build makes it")
    return options


def main():
    options = parse_options()
    wanted = [name for name in options.scenes.split(",") if name]
    scenes = [s for s in sorted(options.folder.glob("*.xml")) if not wanted or any(s.stem.startswith(name) for name in wanted)]
    if not scenes:
        sys.exit(f"bench_peers.py: no scene of {options.folder} begins with {options.scenes or 'anything'}.")
    if options.ours_only:
        first, second = (Ours(options.etendue, shlex.split(flags), options.threads, f"etendue {flags}".strip())
                         for flags in (options.flags_a, options.flags_b))
    else:
        first = Cycles(find_blender(), options.threads)
        second = Ours(options.etendue, shlex.split(options.ours_flags), options.threads, f"etendue {options.ours_flags}".strip())
    print(f"A: {first.name}, B: {second.name}; {options.seeds} renders each, cost = CPU s x relative variance, A/B above 1: B is better")
    print(HEADER, flush=True)
    rows, pairs, failures, start = [], [], [], time.monotonic()
    for scene in scenes:
        try:
            rows.append(compare(scene, first, second, options, options.out / scene.stem, pairs))
            print(table_line(rows[-1]), flush=True)
        except (Failed, OSError, subprocess.TimeoutExpired) as error:
            failures.append(scene.stem)
            print(f"{scene.stem:15} failed: {error}", flush=True)
    for text in sorted({note for row in rows for note in row["a"]["notes"]}):
        print(f"only alike: {text}")
    result = {"a": first.name, "b": second.name, "seeds": options.seeds, "load_average": os.getloadavg()[0], "scenes": rows,
              "failed": failures}
    if rows:
        result["geometric_mean"] = geometric_mean([row["ratio"] for row in rows])
        result["geometric_mean_trimmed"] = geometric_mean([row["ratio_trimmed"] for row in rows])
        print(f"geometric mean of A/B {result['geometric_mean']:.2f}, without the worst pixels {result['geometric_mean_trimmed']:.2f}")
    options.out.mkdir(parents=True, exist_ok=True)
    if pairs:
        write_pairs(options.out / "pairs.jpg", pairs)
    (options.out / "peers.json").write_text(json.dumps(result, indent=2) + "\n")
    print(f"{time.monotonic() - start:.0f} s; wrote {options.out / 'peers.json'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
