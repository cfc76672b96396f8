"""The program as its users meet it: exit codes, messages, files. usage: cli_test.py ETENDUE [unittest options]"""
import json
import math
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

from pictures import read_exr, read_png, write_hdr

ETENDUE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "etendue"

QUAD = """<geometry id="{0}"><mesh>
  <source id="{0}-p"><float_array id="{0}-a" count="12">{1}</float_array><technique_common>
    <accessor source="#{0}-a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
    <param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="{0}-v"><input semantic="POSITION" source="#{0}-p"/></vertices>
  <polylist material="m" count="1"><input semantic="VERTEX" source="#{0}-v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p>
  </polylist></mesh></geometry>"""
NODE = """<node><instance_geometry url="#{0}"><bind_material><technique_common>
  <instance_material symbol="m" target="#{1}"/></technique_common></bind_material></instance_geometry></node>"""


def scene(lamp="4 4 4 1"):
    """A floor under a lamp of this radiance, seen from the front, slightly above."""
    effect = """<effect id="{0}-e"><profile_COMMON><technique sid="t"><lambert><emission><color>{1}</color></emission>
      <diffuse><color>{2}</color></diffuse></lambert></technique></profile_COMMON></effect>"""
    material = '<material id="{0}"><instance_effect url="#{0}-e"/></material>'
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="camera"><optics><technique_common><perspective><xfov>50</xfov>
  <aspect_ratio>1.3333333</aspect_ratio><znear>0.01</znear><zfar>100</zfar></perspective></technique_common></optics>
  </camera></library_cameras>
<library_effects>{effect.format("grey", "0 0 0 1", "0.6 0.5 0.4 1")}{effect.format("lamp", lamp, "0 0 0 1")}
</library_effects>
<library_materials>{material.format("grey")}{material.format("lamp")}</library_materials>
<library_geometries>{QUAD.format("floor", "-2 0 -2 -2 0 2 2 0 2 2 0 -2")}
  {QUAD.format("light", "-0.5 1.5 -0.5 0.5 1.5 -0.5 0.5 1.5 0.5 -0.5 1.5 0.5")}</library_geometries>
<library_visual_scenes><visual_scene id="scene">
  <node><translate>0 1 5</translate><instance_camera url="#camera"/></node>
  {NODE.format("floor", "grey")}{NODE.format("light", "lamp")}
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>
"""


class CliTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="etendue-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scene = self.write("scene.dae", scene())
        self.dark_scene = self.write("dark.dae", scene(lamp="0 0 0 1"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w") as f:
            f.write(text)
        return self.path(name)

    def run_program(self, *args, expect=0, **options):
        result = subprocess.run([ETENDUE, *map(str, args)], capture_output=True, text=True, timeout=120, cwd=self.folder,
                                **options)
        self.assertEqual(result.returncode, expect, f"etendue {args}: {result.stderr}")
        return result

    def render(self, *args, expect=0, size=(24, 18), spp=4):
        return self.run_program("render", self.scene, "-r", *size, "-s", spp, *args, expect=expect)

    def stats(self, *args, **options):
        self.render("-o", "s.png", "--stats", "s.json", *args, **options)
        with open(self.path("s.json")) as f:
            return json.load(f)


class CommandLine(CliTest):
    def test_help_and_version_go_to_standard_output(self):
        for words in (["--help"], ["render", "--help"], ["info", "-h"], ["convert", "--help"], ["envmap", "--help"],
                      ["diff", "--help"]):
            result = self.run_program(*words)
            self.assertIn("Usage: etendue", result.stdout)
            self.assertIn("Exit codes:", result.stdout)
            self.assertEqual(result.stderr, "")
        self.assertRegex(self.run_program("--version").stdout, r"^etendue \d+\.\d+\.\d+\n$")

    def test_help_and_version_are_commands_too(self):
        for words, flags in [(["help"], ["--help"]), (["help", "render"], ["render", "--help"]),
                             (["help", "help"], ["help", "--help"]), (["version"], ["--version"])]:
            self.assertEqual(self.run_program(*words).stdout, self.run_program(*flags).stdout)
        for command in ("render", "info", "convert", "envmap", "diff", "help", "version"):
            self.assertRegex(self.run_program("help").stdout, rf"(?m)^  {command} ")

    def test_numbers_as_people_write_them(self):
        for words in (["-r", "9x7"], ["--resolution", "9X7"], ["--resolution=9x7"], ["-r", "9", "7"]):
            self.run_program("render", self.scene, *words, "-s", 1, "-o", "o.png")
            self.assertEqual(read_png(self.path("o.png"))[:2], (9, 7), words)
        for noise in ("50%", "0.5"):
            result = self.run_program("render", self.scene, "-r", 24, 18, "--noise", noise, "-s", 4096, "-o", "o.png")
            self.assertIn("noise reached: 24 x 18, 16 samples", result.stderr)
        for time in ("1h30m", "90s", "1m30s", "2m", "1.5h", "1h2m3s4ms", "90"):
            self.render("-o", "o.png", "--time-limit", time)
        self.assertLess(self.stats("-a", 4, "30%", spp=64)["samples_per_pixel"], 64)

    def test_one_is_singular(self):
        result = self.render("-o", "o.png", spp=1)
        self.assertIn("1 light,", result.stderr)
        self.assertIn(" 1 sample a pixel,", result.stderr)
        self.assertIn("; 1 of them emits light", self.run_program("info", self.scene).stdout)

    def test_mistakes_are_named_with_their_remedy(self):
        for words, message in [
                ("", "no command given"),
                ("scene.dae", "etendue render scene.dae"),
                ("-t 2 scene.dae -f o.png", "etendue render scene.dae"),
                ("rendr scene.dae", 'unknown command "rendr"; did you mean render?'),
                ("--versoin", "unknown option --versoin; did you mean --version?"),
                ("render scene.dae --resolutoin 4 4 -o o.png", "unknown option --resolutoin; did you mean --resolution?"),
                ("render --sceen scene.dae", "unknown option --sceen"),
                ("render scene.dae -z -o o.png", "unknown option -z; see etendue render --help"),
                ("-z", "unknown option -z; see etendue --help"),
                ("help rendr", 'unknown command "rendr"; did you mean render?'),
                ("help everything", 'unknown command "everything"; see etendue --help'),
                ("help info diff", '"diff" is one argument too many'),
                ("-q render scene.dae -o o.png", "-q stands before the command; options stand behind it"),
                ("--seed 3 render scene.dae -o o.png", "--seed stands before the command"),
                ("render", "render needs a scene"),
                ("render scene.dae", "add -o FILE"),
                ("render scene.dae other.dae -o o.png", '"other.dae" is one argument too many'),
                ("render scene.dae -o", "--output needs FILE"),
                ("render -o o.png -r 480", "--resolution needs W H"),
                ("render scene.dae -o o.png -r 480 -s 4", "--resolution"),
                ("render scene.dae -o o.png -s abc", '--spp needs a whole number from 1 to 1048576, not "abc"'),
                ("render scene.dae -o o.png -s 0", "--spp"),
                ("render scene.dae -o o.png -s 4.5", "--spp"),
                ("render scene.dae -o o.png -s 99999999999999999999", "--spp"),
                ("render scene.dae -o o.png -t -1", "--threads"),
                ("render scene.dae -o o.png -m -1", "--max-depth"),
                ("render scene.dae -o o.png -a 32 -0.1", "--adaptive"),
                ("render scene.dae -o o.png -b -1", "--lens-radius"),
                ("render scene.dae -o o.png -b nan", "--lens-radius"),
                ("render scene.dae -o o.png --exposure inf", "--exposure"),
                ("render scene.dae -o o.png -r 0 10", "--resolution"),
                ("render scene.dae -o o.png -r 70000 10", "--resolution"),
                ("render scene.dae -o o.png -r 65536 65536", "too large"),
                ("render scene.dae -o o.png -r 8 8 -p 4 4 5 4", "--crop 4 4 5 4 reaches outside the picture of 8 x 8"),
                ("render scene.dae -o o.png -p 0 0 0 4", "--crop"),
                ("render -r 640x scene.dae -o o.png", '--resolution needs a whole number from 1 to 65536, not "640x"'),
                ("render scene.dae -o o.jpg -r 65501x8", "65501 x 8 pixels, and a .jpg at most 65500 a side"),
                ("render scene.dae -o o.png --noise 200%", '--noise needs a number from 1e-06 to 1, such as 0.02 or 2%'),
                ("render scene.dae -o o.png --noise %", "--noise"),
                ("render scene.dae -o o.png --time-limit soon", "--time-limit needs a time such as 90s, 2m or 1h30m"),
                ("render scene.dae -o o.png --time-limit 30m1h", "--time-limit"),
                ("render scene.dae -o o.png --time-limit 1h30", "--time-limit"),
                ("render scene.dae -o o.png --time-limit 0s", "--time-limit"),
                ("render scene.dae -o o.png --time-limit 1mm", "--time-limit"),
                ("render scene.dae -o o.png --integrator pth", "did you mean path?"),
                ("render scene.dae -o o.png -H --integrator path", "--hemisphere and --integrator"),
                ("render scene.dae -o o.png --env-rotation 9", "--env FILE"),
                ("render scene.dae -o o.png --blades 2", "--blades"),
                ("render scene.dae -o o.png --focus-at 3", "--focus-at"),
                ("render scene.dae -o o.png --focus-at 1,2 -d 3", "--focus-at and --focal-distance"),
                ("render scene.dae -o o.png --focus-at 800,2", "outside"),
                ("render scene.dae -o o.png -q -v", "--quiet and --verbose"),
                ("render scene.dae -o o.png --preview", "--preview needs a terminal"),
                ("render scene.dae -q --preview", "--quiet and --preview contradict each other"),
                ("render scene.dae -o o.bmpp", "o.bmpp"),
                ("info", "info needs a scene"),
                ("envmap", "envmap needs a map"),
                ("diff a.png", "diff needs two pictures"),
        ]:
            with self.subTest(words):
                result = self.run_program(*words.split(), expect=2)
                self.assertIn(message, result.stderr)
                self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                self.assertEqual(result.stdout, "")
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "scene.dae"], "nothing was written")

    def test_the_teaching_renderers_flags(self):
        result = self.run_program(*"render -t 2 -s 3 -l 4 -m 5 -r 48 36 -f out.png scene.dae".split())
        self.assertEqual(read_png(self.path("out.png"))[:2], (48, 36))
        self.assertIn("3 samples a pixel", result.stderr)
        self.run_program(*"render -t 1 -s 2 -H -a 32 0 -b 0.1 -d 5 -p 4 3 12 10 -r 48 36 -f cell.png scene.dae".split())
        self.assertEqual(read_png(self.path("cell.png"))[:2], (12, 10))

    def test_the_later_of_two_counts(self):
        self.assertEqual(self.stats("-s", 2, "-r", 9, 7)["width"], 9)


class Inputs(CliTest):
    def test_missing_and_broken_files(self):
        self.write("broken.dae", scene()[:1500])
        self.write("garbage.exr", "no picture")
        self.write("camera.txt", "50 40 1.3\n0.1 far")
        for words, message in [
                ("render absent.dae -o o.png", "absent.dae"),
                ("render broken.dae -o o.png", "broken.dae:"),
                ("render scene.dae -o o.png -e absent.exr", "absent.exr"),
                ("render scene.dae -o o.png -e garbage.exr", "garbage.exr"),
                ("render scene.dae -o o.png -c absent.txt", "absent.txt"),
                ("render scene.dae -o o.png -c camera.txt", "camera.txt:2:5: error: \"far\""),
                ("info broken.dae", "broken.dae:"),
                ("envmap garbage.exr", "garbage.exr"),
                ("diff garbage.exr garbage.exr", "garbage.exr"),
        ]:
            with self.subTest(words):
                self.assertIn(message, self.run_program(*words.split(), expect=3).stderr)
                self.assertFalse(os.path.exists(self.path("o.png")))

    def test_a_scene_without_light_is_black_and_says_so(self):
        result = self.run_program(*"render dark.dae -r 24 18 -s 2 -o dark.png".split())
        self.assertIn("--env FILE or --headlight", result.stderr)
        self.assertEqual({p for row in read_png(self.path("dark.png"))[2] for p in row}, {(0, 0, 0)})
        result = self.run_program(*"render dark.dae -r 24 18 -s 2 --headlight -o lit.png".split())
        self.assertNotIn("--headlight", result.stderr)
        rows = read_png(self.path("lit.png"))[2]
        self.assertTrue(60 < max(max(p) for row in rows for p in row), "the floor is seen by the light at the camera")

    def test_an_environment_map_lights_it(self):
        write_hdr(self.path("sky.hdr"), [[(128, 128, 128, 129)] * 4] * 2)  # radiance 1 everywhere
        result = self.run_program(*"render dark.dae -r 24 18 -s 2 -m 0 -e sky.hdr -o sky.png".split())
        self.assertNotIn("black", result.stderr)
        self.assertEqual(read_png(self.path("sky.png"))[2][0][0], (255, 255, 255))
        self.run_program(*"render dark.dae -r 24 18 -s 2 -m 0 -e sky.hdr --env-intensity 0.25 -o dim.png".split())
        self.assertEqual(read_png(self.path("dim.png"))[2][0][0], (137, 137, 137))  # sRGB of 0.25


    def test_hemisphere_sampling_does_not_meet_points(self):
        self.assertNotIn("black", self.render("-o", "o.png", "-H").stderr)
        result = self.run_program(*"render dark.dae -r 24 18 -s 2 -H --headlight -o o.png".split())
        self.assertEqual(result.stderr.count("use --integrator direct"), 1)
        self.assertEqual({p for row in read_png(self.path("o.png"))[2] for p in row}, {(0, 0, 0)})


class Techniques(CliTest):
    def test_all_can_be_chosen(self):
        for flag in ("--photons", "--reuse", "--cache", "--airlight", "--splitting"):
            for value in ("auto", "on", "off"):
                self.render("-o", "o.png", flag, value)
        for value in ("on", "off"):
            self.render("-o", "o.png", "--light-tree", value)
        self.render("-o", "o.png", "--splitting", "on", "--integrator", "path")
        self.assertIn("the estimate is biased: lone bright samples", self.render("-o", "o.png", "--outliers").stderr)
        self.render("-o", "o.png", "--clamp", "2.5")
        for size in ("1M", "1048576", "2048K", "1.5G", "2T"):
            self.render("-o", "o.png", "--memory-limit", size)
        result = self.render("-o", "o.png", "--denoise", spp=16)
        self.assertIn("the picture is biased", result.stderr)

    def test_mistakes_are_named(self):
        for words, message in [
                ("--photons yes", "--photons"), ("--photons", "--photons needs"),
                ("--reuse maybe", "--reuse"), ("--reuse onn", "did you mean on?"),
                ("--cache 1", "--cache"), ("--cache of", "one of auto, on, off"), ("--cache=", "--cache"),
                ("--airlight true", "--airlight"), ("--airlihgt on", "did you mean --airlight?"),
                ("--splitting maybe", "one of auto, on, off"), ("--splitting", "--splitting needs"),
                ("--light-tree auto", '--light-tree needs one of on, off, not "auto"'), ("--light-tree", "--light-tree"),
                ("--outliers=maybe", "--outliers"), ("--outliers off", "off"), ("--outlier", "--outliers"),
                ("--outliers --denoise", "--outliers and --denoise both deal with bright dots; give one of them"),
                ("--clamp 0", "--clamp needs a number"), ("--clamp -1", "--clamp"), ("--clamp nan", "--clamp"),
                ("--clamp bright", '--clamp needs a number from 1e-06 to 1e+30, not "bright"'),
                ("--memory-limit 1023K", '--memory-limit needs an amount of at least 1M, such as 512M or 2G, not "1023K"'),
                ("--memory-limit 512", "--memory-limit needs"), ("--memory-limit lots", "--memory-limit needs"),
                ("--memory-limit -2G", "--memory-limit needs"), ("--memory-limit 2GB", "--memory-limit needs"),
                ("--memory-limit nanM", "--memory-limit needs"), ("--memory-limit", "--memory-limit needs SIZE"),
                ("--memory-limit=", "--memory-limit needs"), ("--memory-limit 1e9T", "--memory-limit needs"),
                ("--clamp", "--clamp needs X"), ("--denoise=maybe", "--denoise"), ("--denoise off", "off"),
        ]:
            with self.subTest(words):
                result = self.run_program(*f"render scene.dae -o o.png {words}".split(), expect=2)
                self.assertRegex(result.stderr, "^error: ")
                self.assertIn(message, result.stderr)
                self.assertEqual(len(result.stderr.splitlines()), 1)
                self.assertEqual(result.stdout, "")
                self.assertFalse(os.path.exists(self.path("o.png")))

    def test_what_the_estimate_is(self):
        def estimator(*words):
            value = self.stats("-o", "o.exr", *words)["estimator"]
            self.assertEqual(read_exr(self.path("o.exr"))[3]["etendue:estimator"], value.encode())
            return value

        for words in ("--integrator path", "--integrator direct", "--integrator path --reuse on",
                      "--cache off --photons off", "--cache off --reuse on", "-m 2"):
            self.assertEqual(estimator(*words.split()), "unbiased", words)
        for words in ("", "--cache on", "--integrator path --cache on", "-m 3"):
            self.assertRegex(estimator(*words.split()), "^consistent: cells ", words)
        for words in ("--clamp 3", "--clamp 3 --integrator path"):
            self.assertRegex(estimator(*words.split()), "^biased: no sample is brighter than 3$", words)
        lone = "lone bright samples count for less, fewer with more samples$"
        self.assertRegex(estimator("--outliers"), "^biased: " + lone)
        self.assertRegex(estimator("--outliers", "--clamp", "3"), "^biased: no sample is brighter than 3, " + lone)


class Outputs(CliTest):
    def test_nothing_read_is_overwritten_and_nothing_written_twice(self):
        write_hdr(self.path("sky.hdr"), [[(128, 128, 128, 129)] * 4] * 2)
        self.render("-o", "a.png", "--save-camera", "camera.txt")
        os.symlink("sky.hdr", self.path("link.hdr"))
        before = {name: os.stat(self.path(name)).st_mtime_ns for name in os.listdir(self.folder)}
        for words, file, problem in [
                ("render scene.dae -r 8 6 -o a.png --save-camera scene.dae", "scene.dae", "is an input"),
                ("render scene.dae -r 8 6 -o a.png --stats ./scene.dae", "./scene.dae", "is an input"),
                ("render scene.dae -r 8 6 -e sky.hdr -o sky.hdr", "sky.hdr", "is an input"),
                ("render scene.dae -r 8 6 -e link.hdr -o sky.hdr", "sky.hdr", "is an input"),
                ("render scene.dae -r 8 6 -c camera.txt -o a.png --save-camera camera.txt", "camera.txt", "is an input"),
                ("render scene.dae -r 8 6 -o a.png -o ./a.png", "./a.png", "written twice"),
                ("render scene.dae -r 8 6 -a 4 0.1 -o b.exr -o b_rate.png", "b_rate.png", "written twice"),
                ("render scene.dae -r 8 6 -o a.png --stats a.json --save-camera a.json", "a.json", "written twice"),
                ("envmap sky.hdr --debug sky.hdr", "sky.hdr", "is an input"),
                ("envmap link.hdr --pdf ./sky.hdr", "./sky.hdr", "is an input"),
                ("envmap sky.hdr --debug d.png --pdf ./d.png", "./d.png", "written twice"),
                ("diff a.png a.png --heatmap a.png", "a.png", "is an input"),
        ]:
            with self.subTest(words):
                message = self.run_program(*words.split(), expect=2).stderr
                self.assertTrue(message.startswith(f"error: {file} would be "), message)
                self.assertIn(problem, message)
                self.assertEqual(len(message.splitlines()), 1)
        self.assertEqual({name: os.stat(self.path(name)).st_mtime_ns for name in os.listdir(self.folder)}, before)

    def test_textures_are_inputs_too(self):
        self.render("-o", "tiles.png")
        surface = "<diffuse><color>0.6 0.5 0.4 1</color></diffuse>"
        sampler = ('<newparam sid="surface"><surface type="2D"><init_from>tiles</init_from></surface></newparam>'
                   '<newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>')
        textured = scene().replace(surface, '<diffuse><texture texture="sampler" texcoord="UV"/></diffuse>')
        textured = textured.replace('<effect id="grey-e"><profile_COMMON>', f'<effect id="grey-e"><profile_COMMON>{sampler}')
        textured = textured.replace("<library_effects>", '<library_images><image id="tiles"><init_from>tiles.png</init_from>'
                                    "</image></library_images><library_effects>")
        self.write("textured.dae", textured)
        result = self.run_program(*"render textured.dae -r 8 6 -o tiles.png".split(), expect=2)
        self.assertIn("tiles.png would be overwritten, but it is an input", result.stderr)

    def test_unwritable_outputs_are_noticed_before_the_work(self):
        os.mkdir(self.path("folder.png"))
        for words in ("-o nowhere/o.png", "-o folder.png", "-o o.png --stats nowhere/s.json",
                      "-o o.png --save-camera nowhere/c.txt"):
            with self.subTest(words):
                result = self.render(*words.split(), expect=4)
                self.assertNotIn("rendering", result.stderr)

    def test_several_formats_from_one_render(self):
        self.render("-o", "a.png", "-o", "b.exr", "--output", "c.hdr", "-f", "d.jpg")
        for name in ("a.png", "b.exr", "c.hdr", "d.jpg"):
            self.assertGreater(os.path.getsize(self.path(name)), 100)

    def test_exr_says_what_made_it(self):
        self.render("-o", "o.exr", "--seed", 7)
        width, height, channels, attributes = read_exr(self.path("o.exr"))
        self.assertEqual((width, height), (24, 18))
        for name in ("R", "G", "B", "albedo.R", "normal.X", "depth.Z", "samples.N", "variance.B"):
            self.assertIn(name, channels)
        self.assertEqual(struct.unpack("<f", channels["samples.N"][3][5])[0], 4)
        self.assertEqual(attributes["etendue:scene"], self.scene.encode())
        self.assertEqual(attributes["etendue:seed"], b"7")
        self.assertIn(b"--seed 7", attributes["etendue:settings"])
        self.assertRegex(attributes["etendue:version"], rb"^\d+\.\d+\.\d+$")
        self.assertRegex(attributes["etendue:time"], rb"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertGreaterEqual(float(attributes["etendue:render_seconds"]), 0)
        self.assertEqual(attributes["etendue:samples_per_pixel"], b"4")

    def test_a_full_disk_is_an_error_and_leaves_nothing_behind(self):
        disk = self.path("disk")
        os.mkdir(disk)
        if os.getuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk],
                                              capture_output=True).returncode:
            self.skipTest("needs to mount a small file system")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        result = self.render("-o", "disk/o.exr", "-o", "o.png", size=(200, 150), spp=1, expect=4)
        self.assertIn("disk/o.exr", result.stderr)
        self.assertEqual(os.listdir(disk), [])
        self.assertEqual(read_png(self.path("o.png"))[:2], (200, 150), "the other output is written all the same")

    def test_a_file_that_cannot_grow_is_an_error_too(self):
        self.write("o.exr", "older")
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        result = subprocess.run([ETENDUE, "render", self.scene, "-r", "200", "150", "-s", "1", "-o", "o.exr"],
                                capture_output=True, text=True, cwd=self.folder, timeout=60, preexec_fn=limit)
        self.assertEqual(result.returncode, 4, result.stderr)
        with open(self.path("o.exr")) as f:
            self.assertEqual(f.read(), "older")
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "o.exr", "scene.dae"])

    def test_results_that_cannot_be_printed(self):
        with open("/dev/full", "w") as full:
            result = subprocess.run([ETENDUE, "info", self.scene], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 4, result.stderr)
        reader, writer = os.pipe()
        os.close(reader)
        result = subprocess.run([ETENDUE, "info", self.scene], stdout=writer, stderr=subprocess.PIPE, text=True)
        os.close(writer)
        self.assertEqual((result.returncode, result.stderr), (0, ""), "a reader that has gone away is harmless")

    def test_quiet_is_silent(self):
        result = self.render("-o", "o.png", "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))
        result = self.run_program("render", self.dark_scene, "-q", "-r", 8, 6, "-s", 1, "-o", "o.png")
        self.assertEqual(result.stderr, "", "warnings neither")
        self.assertNotEqual(self.run_program("render", "absent.dae", "-q", "-o", "o.png", expect=3).stderr, "")

    def test_verbose_says_more(self):
        self.assertIn("of processor time", self.render("-o", "o.png", "--verbose").stderr)

    def test_without_terminal_there_is_a_line_at_the_start_and_at_the_end(self):
        result = self.render("-o", "o.png")
        self.assertEqual(result.stdout, "")
        self.assertNotIn("\x1b", result.stderr)
        lines = result.stderr.splitlines()
        self.assertRegex(lines[0], r"^rendering .*scene\.dae: 4 triangles, 0 spheres, 1 light, 24 x 18")
        self.assertRegex(lines[1], r"^complete: 24 x 18, 4 samples a pixel, noise .* %, in .* \(.*rays/s\)$")
        self.assertRegex(lines[2], "^the estimate is consistent: ")
        self.assertEqual(lines[3:], ["wrote o.png"])

    def test_stats(self):
        stats = self.stats("--threads", 2, "--seed", 5)
        for key in ("load_seconds", "build_seconds", "render_seconds", "cpu_seconds", "rays", "rays_per_second",
                    "samples_per_pixel", "peak_memory_bytes", "invalid_samples", "triangles", "threads", "width", "height",
                    "noise", "seed"):
            self.assertIn(type(stats[key]), (int, float), key)
        self.assertEqual((stats["width"], stats["height"], stats["threads"], stats["seed"]), (24, 18, 2, 5))
        self.assertEqual((stats["samples_per_pixel"], stats["triangles"], stats["invalid_samples"]), (4, 4, 0))
        self.assertGreaterEqual(stats["rays"], 24 * 18 * 4)
        self.assertGreater(stats["peak_memory_bytes"], 1 << 20)
        self.assertGreater(stats["cpu_seconds"], 0)
        self.assertAlmostEqual(stats["rays_per_second"] * stats["render_seconds"], stats["rays"], delta=1)
        self.assertEqual(stats["scene"], self.scene)
        self.assertEqual(type(stats["version"]), str)

    def test_stats_on_standard_output(self):
        result = self.render("-o", "o.png", "--stats", "-")
        self.assertEqual(json.loads(result.stdout)["samples_per_pixel"], 4)
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "o.png", "scene.dae"])
        with open("/dev/full", "w") as full:
            result = subprocess.run([ETENDUE, "render", self.scene, "-r", "8", "6", "-s", "1", "-o", "o.png", "--stats", "-"],
                                    stdout=full, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.assertEqual(result.returncode, 4, result.stderr)

    def test_adaptive_sampling_writes_where_the_samples_went(self):
        stats = self.stats("-a", 4, 0.3, spp=64)
        self.assertLess(stats["samples_per_pixel"], 64)
        self.assertEqual(read_png(self.path("s_rate.png"))[:2], (24, 18))
        os.remove(self.path("s_rate.png"))
        self.assertEqual(self.stats("-a", 4, 0, spp=8)["samples_per_pixel"], 8, "tolerance 0: off")
        self.assertFalse(os.path.exists(self.path("s_rate.png")))

    def test_exposure_doubles_a_stop(self):
        self.render("-o", "a.png", "--integrator", "albedo")
        self.render("-o", "b.png", "--integrator", "albedo", "--exposure", -1)
        linear = lambda byte: ((byte / 255 + 0.055) / 1.055)**2.4
        a, b = (read_png(self.path(name))[2][16][12][0] for name in ("a.png", "b.png"))
        self.assertAlmostEqual(linear(a), 0.6, delta=0.01)
        self.assertAlmostEqual(linear(b), 0.3, delta=0.01)


class Pictures(CliTest):
    def pixels(self, name):
        return read_exr(self.path(name))[2]

    def test_a_crop_is_the_crop_of_the_whole_picture(self):
        self.render("-o", "whole.exr", spp=5)
        self.render("-o", "crop.exr", "-p", 7, 3, 9, 11, spp=5)
        whole, crop = self.pixels("whole.exr"), self.pixels("crop.exr")
        self.assertEqual(set(whole), set(crop))
        for name in whole:
            self.assertEqual(crop[name], [row[7:16] for row in whole[name][3:14]], name)
        self.assertGreater(len({p for row in crop["R"] for p in row}), 10, "there is something to see")

    def test_threads_tiles_and_repetition_change_no_bit(self):
        self.render("-o", "first.exr", "-t", 1, spp=20)
        first = self.pixels("first.exr")
        for flags in (["-t", 2], ["-t", 7], ["-t", 3, "--tile-size", 1], ["-t", 2, "--tile-size", 5], ["--tile-size", 512]):
            self.render("-o", "other.exr", *flags, spp=20)
            self.assertEqual(self.pixels("other.exr"), first, flags)
        self.render("-o", "other.exr", "--seed", 1, spp=20)
        self.assertNotEqual(self.pixels("other.exr")["R"], first["R"], "another seed is another picture")

    def test_saved_camera_takes_the_same_picture(self):
        self.render("-o", "a.exr", "--save-camera", "camera.txt", "--integrator", "normals", "-b", 0.05, "-d", 4)
        self.render("-o", "b.exr", "-c", "camera.txt", "--integrator", "normals")
        result = self.run_program("diff", "a.exr", "b.exr")
        self.assertLess(float(re.search(r"relative MSE +(\S+)", result.stdout)[1]), 1e-4)
        self.render("-o", "c.exr", "--camera-placement", "fit", "--integrator", "normals")
        self.run_program("diff", "a.exr", "c.exr", "--fail-above", 0.01, expect=5)

    def test_focus(self):
        result = self.render("-o", "o.png", "-b", 0.1)
        self.assertIn("focus: 5, the scene's centre", result.stderr)
        result = self.render("-o", "o.png", "-b", 0.1, "--focus-at", "12,16")
        self.assertRegex(result.stderr, r"focus: 3\.\d+, what pixel 12,16 shows")
        result = self.render("-o", "o.png", "-b", 0.1, "--focus-at", "0,0", expect=2)
        self.assertIn("--focus-at 0,0 shows no surface", result.stderr)
        self.assertIn("--lens-radius", self.render("-o", "o.png", "-d", 3).stderr, "focus without a lens is pointed out")

    def test_depth_zero_shows_lights_only(self):
        self.render("-o", "o.png", "-m", 0)
        rows = read_png(self.path("o.png"))[2]
        self.assertEqual(rows[16][12], (0, 0, 0))
        self.render("-o", "o.png", "-m", "unlimited")
        self.assertNotEqual(read_png(self.path("o.png"))[2][16][12], (0, 0, 0))


class Endings(CliTest):
    def start_long_render(self, *flags):
        """Returns the process once it renders; SIGINT reaches it even if this test runs in the background of a script."""
        default = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
        process = subprocess.Popen([ETENDUE, "render", self.scene, "-r", "64", "48", "-s", "1000000", *flags],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder,
                                   preexec_fn=default)
        self.addCleanup(process.kill)
        self.assertIn("rendering", process.stderr.readline())
        return process

    def test_interrupting_writes_the_picture(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = self.start_long_render("-o", "o.png", "-o", "o.exr", "--stats", "s.json")
            threading.Event().wait(0.5)
            process.send_signal(number)
            out, err = process.communicate(timeout=30)
            self.assertEqual((process.returncode, out), (130, ""), err)
            self.assertRegex(err, r"interrupted at \S+ of 1000000 samples; picture written")
            self.assertGreater(max(max(p) for row in read_png(self.path("o.png"))[2] for p in row), 100)
            samples = {struct.unpack("<f", p)[0] for row in read_exr(self.path("o.exr"))[2]["samples.N"] for p in row}
            self.assertTrue(0 < max(samples) < 1000000)
            with open(self.path("s.json")) as f:
                self.assertEqual(json.load(f)["ending"], "interrupted")
            for name in ("o.png", "o.exr", "s.json"):
                os.remove(self.path(name))

    def test_interrupting_again_and_again_writes_the_picture_too(self):
        process = self.start_long_render("-r", "640", "480", "-o", "o.exr")
        threading.Event().wait(0.5)
        while process.poll() is None:
            process.send_signal(signal.SIGINT)
            threading.Event().wait(0.005)
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, err)
        self.assertEqual(read_exr(self.path("o.exr"))[:2], (640, 480))
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "o.exr", "scene.dae"])

    def test_what_was_ignored_stays_ignored(self):
        ignore = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = subprocess.Popen([ETENDUE, "render", self.scene, "-r", "24", "18", "-o", "o.png", "--time-limit", "1s"],
                                   stderr=subprocess.PIPE, text=True, cwd=self.folder, preexec_fn=ignore)
        self.assertIn("rendering", process.stderr.readline())
        threading.Event().wait(0.3)
        process.send_signal(signal.SIGHUP)
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, err)
        self.assertIn("time limit:", err)

    def test_stopping_before_every_pixel_had_a_sample(self):
        result = self.run_program("render", self.scene, "-r", 3000, 2000, "-t", 1, "--time-limit", "1ms", "-o", "o.hdr")
        self.assertRegex(result.stderr, r"warning: stopped before every pixel had a sample: \S+ % of the picture is black")

    def test_time_limit(self):
        stats = self.stats("--time-limit", "500ms", size=(64, 48), spp=1000000)
        self.assertEqual(stats["ending"], "time limit")
        self.assertTrue(0.4 < stats["render_seconds"] < 5, stats)
        result = self.run_program("render", self.scene, "-r", 24, 18, "-o", "o.png", "--time-limit", "0.5s", "--stats",
                                  "s.json")
        self.assertRegex(result.stderr, r"time limit: 24 x 18, \S+ samples a pixel, noise \S+ %")
        with open(self.path("s.json")) as f:
            self.assertGreater(json.load(f)["samples_per_pixel"], 64, "without --spp there is no other end")

    def test_noise_target(self):
        result = self.run_program("render", self.scene, "-r", 24, 18, "-o", "o.png", "--noise", 0.02, "--stats", "s.json")
        with open(self.path("s.json")) as f:
            stats = json.load(f)
        self.assertEqual(stats["ending"], "noise reached")
        self.assertLessEqual(stats["noise"], 0.02)
        self.assertGreaterEqual(stats["samples_per_pixel"], 16)
        self.assertIn("noise reached", result.stderr)


class Terminal(CliTest):
    def on_terminal(self, *flags, **environment):
        """What the program shows on a terminal."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen([ETENDUE, "render", self.scene, "-r", "64", "48", "--time-limit", "1s", *flags],
                                   stdout=theirs, stderr=theirs, cwd=self.folder,
                                   env=os.environ | {"TERM": "xterm"} | environment)
        os.close(theirs)
        shown = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the other side is closed
                break
            if not piece:
                break
            shown += piece
        os.close(ours)
        self.assertEqual(process.wait(timeout=30), 0, shown)
        return shown.decode()

    def test_progress(self):
        shown = self.on_terminal("-o", "o.png")
        self.assertRegex(shown, r" %.*left.*rays/s.*noise")
        self.assertNotIn("▀", shown)
        self.assertIn("wrote o.png", shown)
        self.assertEqual(self.on_terminal("-o", "o.png", "--quiet"), "")

    def test_colours_only_where_they_are_wanted(self):
        colour = "\x1b[33m"
        self.scene = self.dark_scene
        self.assertIn(colour, self.on_terminal("-o", "o.png", NO_COLOR=""))
        self.assertNotIn(colour, self.on_terminal("-o", "o.png", NO_COLOR="1"))
        self.assertNotIn("\x1b", self.on_terminal("-o", "o.png", TERM="dumb"))

    def test_preview(self):
        shown = self.on_terminal("--preview")
        self.assertRegex(shown, r"\x1b\[38;2;\d+;\d+;\d+;48;2;\d+;\d+;\d+m▀")
        self.assertIn("\x1b[22A", shown, "it is repainted in place")  # 44 rows of pixels in a terminal of 24 lines
        self.assertRegex(shown, r" %.*rays/s")


class Conversion(CliTest):
    """A converted scene gives the same picture."""

    def difference(self, a, b):
        text = self.run_program("diff", a, b, "--variance").stdout
        sigmas = [abs(float(x)) for x in re.search(r"difference of means (.+) sigma", text)[1].split()]
        relative_mse, agreeing = (float(re.search(name + r" +(\S+)", text)[1]) for name in ("relative MSE", "agreeing"))
        return relative_mse, agreeing, max(sigmas)

    def test_a_collada_scene(self):
        self.run_program("convert", self.scene, "out.xml", "-r", 24, 18)
        self.assertEqual(sorted(os.listdir(self.path("out_files"))), ["floor.ply", "light.ply"])
        self.render("-o", "a.exr", spp=16)
        result = self.run_program("render", "out.xml", "-s", 16, "-o", "b.exr")
        self.assertNotIn("warning", result.stderr)
        self.assertLess(self.difference("a.exr", "b.exr")[0], 1e-6)

    def test_the_box_with_spheres(self):
        box = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../scenes/cornell-spheres.dae")
        for placement in ("file", "fit"):
            camera = ["-r", 100, 75] if placement == "file" else ["-r", 200, 150]
            spp = 64 if placement == "file" else 16
            told = self.run_program("convert", box, "out.xml", "--camera-placement", placement, *camera).stderr
            self.assertIn("no approximation of glass by Schlick", told)
            self.run_program("render", box, "--camera-placement", placement, *camera, "-s", spp, "--fresnel", "exact",
                             "--integrator", "path", "-o", "a.exr")  # whose pixels are independent
            self.run_program("render", "out.xml", "-s", spp, "--seed", 1, "--integrator", "path", "-o", "b.exr")
            _, agreeing, sigmas = self.difference("a.exr", "b.exr")
            self.assertEqual(agreeing, 100)
            self.assertLess(sigmas, 4)

    def test_interrupting_leaves_nothing(self):
        os.mkdir(self.path("meshes"))
        names = [f"meshes/{i}.obj" for i in range(1000)]
        for name in names:
            self.write(name, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        shapes = "".join(f'<shape type="obj"><string name="filename" value="{name}"/></shape>' for name in names)
        self.write("many.xml", f'<scene version="3.0.0">{shapes}</scene>')
        default = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
        process = subprocess.Popen([ETENDUE, "convert", "many.xml", "out.xml"], stderr=subprocess.PIPE, text=True,
                                   cwd=self.folder, preexec_fn=default)
        self.addCleanup(process.kill)
        while process.poll() is None and not any("_files.partial" in name for name in os.listdir(self.folder)):
            threading.Event().wait(0.001)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("interrupted; nothing was written", err)
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "many.xml", "meshes", "scene.dae"])

    def test_skies_are_seen_where_they_were(self):
        texels = [[(20 * x + y, 100 + 5 * x, 255 - 9 * x - 60 * y, 128) for x in range(8)] for y in range(3)]
        write_hdr(self.path("map.hdr"), texels)
        for mapping in ("standard", "cgl"):
            sky = ["-e", "map.hdr", "--env-mapping", mapping, "--env-rotation", 40, "--env-intensity", 3]
            self.render("-o", "a.exr", "-m", 0, *sky)
            self.run_program("convert", self.scene, "out.xml", "-r", 24, 18, *sky)
            self.run_program("render", "out.xml", "-m", 0, "-s", 4, "-o", "b.exr")
            self.assertLess(self.difference("a.exr", "b.exr")[0], 1e-8, mapping)

    def test_a_film_keeps_its_size_and_definitions_count(self):
        xml = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm">
          <integer name="width" value="$wide"/><integer name="height" value="20"/></film></sensor>
          <shape type="sphere"><point name="center" x="0" y="0" z="3"/></shape><emitter type="constant"/></scene>"""
        self.write("in.xml", xml)
        self.run_program("convert", "in.xml", "out.xml", "-D", "wide=30")
        with open(self.path("out.xml")) as f:
            self.assertIn('name="width" value="30"', f.read())
        self.run_program("render", "in.xml", "-D", "wide=30", "-s", 4, "-o", "a.exr")
        self.run_program("render", "out.xml", "-s", 4, "-o", "b.exr")
        self.assertEqual(self.difference("a.exr", "b.exr")[0], 0)

    def test_mistakes(self):
        os.mkdir(self.path("taken_files"))
        for words, code, message in [
                ("convert", 2, "etendue convert SCENE OUT.xml"),
                ("convert scene.dae", 2, "etendue convert SCENE OUT.xml"),
                ("convert scene.dae out.dae", 2, "out.dae: scenes are written as .xml (Mitsuba)"),
                ("convert scene.dae out", 2, "out: scenes are written as .xml (Mitsuba)"),
                ("convert scene.dae none/out.xml", 4, "cannot write none/out.xml"),
                ("convert none.dae out.xml", 3, "none.dae: there is no such file"),
                ("convert scene.dae taken.xml", 4, "taken_files, which is there already"),
                ("convert scene.dae out.xml --env-rotation 3", 2, "--env-rotation needs a map"),
                ("convert scene.dae out.xml -s 3", 2, "unknown option -s")]:
            self.assertIn(message, self.run_program(*words.split(), expect=code).stderr)
        self.run_program("convert", self.scene, "out.xml")
        self.assertIn("would be overwritten", self.run_program("convert", "out.xml", "./out.xml", expect=2).stderr)
        self.run_program("convert", self.scene, "out.xml")  # again is no mistake
        self.assertEqual(sorted(os.listdir(self.folder)), ["dark.dae", "out.xml", "out_files", "scene.dae", "taken_files"])


class OtherCommands(CliTest):
    def test_info(self):
        table = self.run_program("info", self.scene).stdout
        self.assertIn("2 (4 triangles, 0 spheres)", table)
        self.assertIn("(-2, 0, -2) to (2, 1.5, 2)", table)
        info = json.loads(self.run_program("info", "--json", self.scene).stdout)
        self.assertEqual((info["triangles_placed"], info["cameras"], info["emissive_materials"]), (4, 1, 1))
        self.assertEqual(info["camera_placement"], "file")
        self.assertRegex(table, r"(?m)^lights +1 mesh$")
        self.assertEqual(info["lights"], {"mesh": 1})
        self.assertRegex(self.run_program("info", self.dark_scene).stdout, r"(?m)^lights +none$")
        self.assertEqual(info["bounds"], {"min": [-2, 0, -2], "max": [2, 1.5, 2]})

    def test_envmap(self):
        black, white = (0, 0, 0, 0), (128, 128, 128, 129)
        write_hdr(self.path("map.hdr"), [[white, black, black, white], [black, white, black, black]])
        result = self.run_program("envmap", "map.hdr", "--debug", "debug.png", "--pdf", "pdf.exr")
        self.assertIn("4 x 2", result.stdout)
        self.assertRegex(result.stdout, r"mean radiance +0\.375 0\.375 0\.375")
        self.assertRegex(result.stdout, r"integral of the density +1\.000")
        _, _, rows = read_png(self.path("debug.png"))
        self.assertEqual([[p[0] for p in row] for row in rows], [[170] * 4, [255] * 4])  # 2/3 and all of the light
        self.assertEqual([[p[1] for p in row] for row in rows], [[128, 128, 128, 255], [0, 255, 255, 255]])
        density = [[struct.unpack("<f", p)[0] for p in row] for row in read_exr(self.path("pdf.exr"))[2]["R"]]
        # A row between the map's two, with what a lookup finds there on average: 1/8, 3/4, 1/8 of each row's neighbours.
        means = [(3 / 4 + 1 / 8 + 1 / 8) / 2, (1 / 8 + 3 / 4) / 2, (1 / 8 + 1 / 8) / 2, (3 / 4 + 1 / 8) / 2]
        self.assertEqual(len(density), 1)
        for found, mean in zip(density[0], means):
            self.assertAlmostEqual(found, mean / sum(means) * 4 / (2 * math.pi**2), places=5)

    def test_diff(self):
        self.render("-o", "a.exr", "-o", "a.png", spp=16)
        self.render("-o", "b.exr", "--seed", 1, spp=16)
        self.render("-o", "c.exr", "-r", 12, 9)
        same = self.run_program("diff", "a.exr", "a.exr").stdout
        self.assertRegex(same, r"(?m)^MSE +0$")
        other = self.run_program("diff", "a.exr", "b.exr", "--variance", "--heatmap", "heat.png").stdout
        self.assertRegex(other, r"relative MSE +0\.\d+")
        self.assertGreater(float(re.search(r"agreeing +(\S+) %", other)[1]), 99)
        self.assertEqual(read_png(self.path("heat.png"))[:2], (24, 18))
        self.run_program("diff", "a.exr", "b.exr", "--fail-above", 1e-9, expect=5)
        self.run_program("diff", "a.exr", "a.exr", "--fail-above", 1e-9)
        self.run_program("diff", "a.exr", "c.exr", expect=2)
        self.run_program("diff", "a.png", "a.png", "--variance", expect=2)


if __name__ == "__main__":
    unittest.main()
