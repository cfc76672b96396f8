#!/usr/bin/env python3
"""Reads the #include lines of src/ and apps/ and fails on each one that runs upward, or that uses a library which
belongs to another folder.

usage: include_direction_test.py ROOT            check a checkout
       include_direction_test.py --self-test     prove that each rule can fail
"""
import pathlib
import re
import sys
import tempfile

# Top to bottom: a folder includes itself and what stands before it.
ORDER = ["base", "math", "testing", "image", "denoise", "scene", "formats", "volumes", "sampling", "photons", "geometry", "materials", "lights", "media", "camera", "render",
         "apps"]

# What tests share stands high up, but only tests may lean on it.
TEST_FOLDER = "testing"

# The folders that may include `formats`: reading files and rendering meet only in the programs.
MAY_READ_FORMATS = {"formats", "apps"}

# First part of a library's include path → the one folder that uses it.
OWNER = {"tbb": "base", "oneapi": "base", "spdlog": "base", "Imath": "math", "OpenImageIO": "image",
         "OpenColorIO": "image", "pugixml.hpp": "formats", "embree3": "geometry", "embree4": "geometry", "nanovdb": "volumes",
         "openvdb": "volumes", "blosc.h": "volumes", "CLI": "apps"}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
SUFFIXES = {".h", ".hpp", ".cpp", ".cc", ".inl"}


def folder_of(path, root):
    """The room that a source file stands in."""
    parts = path.relative_to(root).parts
    return "apps" if parts[0] == "apps" else parts[1]


def included_folder(name, source, root):
    """The room that an include leads to, or None where it leads out of the project."""
    beside = (source.parent / name).resolve()
    if beside.is_file() and beside.is_relative_to(root):
        return folder_of(beside, root)
    first = name.split("/")[0]
    known = first in ORDER or (root / "src" / first).is_dir()
    return first if "/" in name and known else None


def offence(name, source, root):
    """What is wrong with `source` including `name`, or None."""
    here = folder_of(source, root)
    owner = OWNER.get(name.split("/")[0])
    if owner and owner != here:
        return f"{here} includes <{name}>; only {owner} uses that library"
    there = included_folder(name, source, root)
    if there is None or there == here:
        return None
    for folder in (here, there):
        if folder not in ORDER:
            return f"{here} includes {name}, but {folder} has no place in the order {' '.join(ORDER)}"
    if ORDER.index(there) > ORDER.index(here):
        return f"{here} includes {name}; {there} stands below {here}"
    if there == TEST_FOLDER and "tests" not in source.relative_to(root).parts:
        return f"{here} includes {name}; that is for files in a tests folder only"
    if there == "formats" and here not in MAY_READ_FORMATS:
        return f"{here} includes {name}; formats meet the renderer only in apps"
    return None


def offences(root):
    """All offences of a checkout as "file:line: what", and how many includes were read."""
    root = root.resolve()
    found, read = [], 0
    for source in sorted(p for top in ("src", "apps") for p in (root / top).rglob("*") if p.suffix in SUFFIXES):
        for number, line in enumerate(source.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            read += 1
            what = offence(match[1], source, root)
            if what:
                found.append(f"{source.relative_to(root)}:{number}: {what}")
    return found, read


def self_test():
    """Each case: a file, its text, and the offence that has to be found in line 2 (None: there is none)."""
    cases = [
        ("src/math/a.h", '#include "base/error.h"', None),
        ("src/lights/a.h", '#include "image/image.h"', None),
        ("apps/cli/a.cpp", '#include "formats/formats.h"', None),
        ("apps/cli/a.cpp", "#include <CLI/CLI.hpp>", None),
        ("src/base/a.cpp", "#include <tbb/parallel_for.h>", None),
        ("src/image/a.cpp", '// #include "render/session.h"', None),
        ("src/math/a.h", '#include "image/image.h"', "image stands below math"),
        ("src/math/tests/a.cpp", '  #  include "render/session.h"', "render stands below math"),
        ("src/math/a.h", "#include <image/image.h>", "image stands below math"),
        ("src/base/a.h", '#include "../scene/scene.h"', "scene stands below base"),
        ("src/render/a.cpp", '#include "formats/formats.h"', "only in apps"),
        ("src/sampling/a.cpp", '#include "formats/formats.h"', "only in apps"),
        ("src/lights/tests/a.cpp", '#include "testing/random.h"', None),
        ("src/lights/a.cpp", '#include "testing/random.h"', "tests folder only"),
        ("src/math/tests/a.cpp", '#include "testing/random.h"', "testing stands below math"),
        ("src/attic/a.cpp", '#include "base/error.h"', "no place in the order"),
        ("src/render/a.cpp", "#include <tbb/parallel_for.h>", "only base"),
        ("src/image/a.cpp", "#include <spdlog/spdlog.h>", "only base"),
        ("src/camera/a.cpp", "#include <Imath/ImathVec.h>", "only math"),
        ("apps/cli/a.cpp", "#include <OpenImageIO/imageio.h>", "only image"),
        ("src/scene/a.h", "#include <pugixml.hpp>", "only formats"),
        ("src/render/a.cpp", "#include <embree3/rtcore.h>", "only geometry"),
        ("src/base/a.cpp", "#include <CLI/CLI.hpp>", "only apps"),
    ]
    failures = []
    for path, text, expected in cases:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, content in [("src/scene/scene.h", ""), (path, "#pragma once\n" + text + "\n")]:
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(content, encoding="utf-8")
            found, _ = offences(root)
        right = not found if expected is None else (
            len(found) == 1 and found[0].startswith(f"{path}:2: ") and expected in found[0])
        if not right:
            failures.append(f"{path} with {text}: expected {expected}, found {found}")
    return failures, len(cases)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        found, count = self_test()
        noun = "cases"
    else:
        found, count = offences(pathlib.Path(sys.argv[1]))
        noun = "includes"
    print("\n".join(found + [f"{count} {noun}, {len(found)} offences"]))
    sys.exit(1 if found or count == 0 else 0)


if __name__ == "__main__":
    main()
