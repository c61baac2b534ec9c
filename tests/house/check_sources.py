#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_sources.py ROOT: the rules of the house that a compiler does not know.

Includes point down the layers, files, functions and folders are short enough to be read, every source
names its licence, no file knows the machine that it was written on, and no layer reads the wall clock.
"""
import collections
import pathlib
import re
import sys

MAX_FILE_LINES = 300
MAX_FOLDER_FILES = 12
MAX_FUNCTION_LINES = 40
MAX_TEST_FUNCTION_LINES = 60  # Arrange, act and assert of one behaviour stand together.
SOURCES = (".cpp", ".hpp")
SCRIPTS = (".sh", ".py")

# What each part may include besides itself. Stages do not know each other: only `pipeline` names
# two. SHARED_DATA names the one header of another that a stage may know: the data they share.
LAYERS = {
    "lib": {"lib"},
    "hal": {"lib", "hal"},
    "rt": {"lib", "hal", "rt"},
}
TOPICS = {
    "base": set(),
    "geometry": {"base"},
    "depth": {"base", "geometry", "cloud"},
    "search": {"base", "geometry", "cloud"},
    "cloud": {"base", "geometry", "depth", "search"},
    "markers": {"base", "geometry", "depth"},
    "splice": {"base", "geometry", "depth", "cloud", "search"},
    "calibration": {"base", "geometry"},
    "seam": {"base", "geometry", "depth", "cloud", "search", "splice"},
    "torch": {"base", "geometry", "seam"},
    "trajectory": {"base", "geometry", "torch"},
    "link": {"base", "geometry", "trajectory"},
}
SHARED_DATA = {
    ("seam", "splice"): {"dseam/splice/spliced_view.hpp"},
    ("torch", "seam"): {"dseam/seam/seam_curve.hpp"},
    ("trajectory", "torch"): {"dseam/torch/torch_path.hpp"},
    ("link", "trajectory"): {"dseam/trajectory/set_point.hpp"},
    ("depth", "cloud"): {"dseam/cloud/cloud.hpp"},
    ("search", "cloud"): {"dseam/cloud/cloud.hpp"},
}
INCLUDE = re.compile(r'#include [<"]([^>"]+)[>"]')
TYPE = re.compile(r"(namespace|class|struct|enum|union|extern)\b")
ENDS_STATEMENT = re.compile(r"[;{}]( *//.*)?$")
BESIDE_CODE = re.compile(r"^\s*(//|#|(public|private|protected):)")
MACHINE = re.compile(r"(?<![\w.])/(?:home|root|work|Users)/")
# A step of the wall clock (NTP, summer time, suspend) must not be felt: all time is monotonic.
WALL_CLOCK = re.compile(r"CLOCK_REALTIME|system_clock|gettimeofday|[^\w]time\(nullptr\)")
# Aravis stamps frames by the wall clock; only the age of a frame is taken from it.
READS_WALL_CLOCK = {"hal/aravis/src/session/session_frames.cpp"}


TOPS = ("lib", "hal", "rt", "examples", "tests", "cmake")


def files_of(root):
    for top in TOPS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCES + SCRIPTS and "__pycache__" not in path.parts:
                yield path


def crowded_folders(root):
    files = (path for top in TOPS for path in (root / top).rglob("*")
             if path.is_file() and "__pycache__" not in path.parts)
    for folder, count in collections.Counter(path.parent for path in files).items():
        if count > MAX_FOLDER_FILES:
            yield folder.relative_to(root), count


def layer_of(included):
    parts = included.split("/")
    if parts[0] != "dseam" or len(parts) < 2:
        return None
    return parts[1] if parts[1] in ("hal", "rt") else "lib"


def topic_of(path):
    parts = path.parts
    for marker in ("include", "src"):
        if parts[0] == "lib" and marker in parts:
            rest = parts[parts.index(marker) + 1:]
            return rest[1] if marker == "include" else rest[0]
    return None


def include_faults(path, line, included):
    layer = path.parts[0]
    wanted = layer_of(included)
    if layer in LAYERS and wanted and wanted not in LAYERS[layer]:
        yield f"{layer}/ includes {included}: includes point down the layers only"
    topic, parts = topic_of(path), included.split("/")
    if topic in TOPICS and wanted == "lib":
        other = parts[1]
        if other != topic and other not in TOPICS[topic]:
            yield f"topic {topic} includes {included}: it must not know {other}"
        shared = SHARED_DATA.get((topic, other))
        if shared and included not in shared:
            yield f"topic {topic} includes {included}: of {other} it may know {sorted(shared)} only"


def function_faults(lines, most):
    """Of clang-formatted text: a body ends where a brace closes at its statement's indent."""
    statement, start, indent = 0, None, 0
    for number, line in enumerate(lines):
        if start is not None:
            if line.startswith(" " * indent + "}"):
                length = number - start - 1
                if length > most and not is_table:
                    yield start + 1, f"a function of {length} lines; {most} at most"
                start, statement = None, number + 1
            continue
        head = lines[statement].lstrip() if statement <= number else ""
        if line.endswith("{") and "(" in "".join(lines[statement:number + 1]) and not TYPE.match(head):
            start, indent = number, len(lines[statement]) - len(head)
            is_table = line.endswith(("{{", "= {")) or lines[number + 1].endswith(" = {")
        elif not line.strip() or ENDS_STATEMENT.search(line) or BESIDE_CODE.match(line):
            statement = number + 1


def faults_of(path, name):
    lines = path.read_text(encoding="utf-8").splitlines()
    if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:3]):
        yield 1, "no SPDX line on top"
    if len(lines) > MAX_FILE_LINES:
        yield len(lines), f"{len(lines)} lines; {MAX_FILE_LINES} at most"
    for number, line in enumerate(lines, 1):
        if MACHINE.search(line) and name.name != "check_sources.py":
            yield number, "a path of one machine"
        if (name.parts[0] in LAYERS and WALL_CLOCK.search(line)
                and name.as_posix() not in READS_WALL_CLOCK):
            yield number, "the wall clock"
        included = INCLUDE.match(line)
        if included:
            yield from ((number, fault) for fault in include_faults(name, line, included.group(1)))
    if path.suffix in SOURCES:
        is_test = name.parts[0] == "tests"
        yield from function_faults(
            lines, MAX_TEST_FUNCTION_LINES if is_test else MAX_FUNCTION_LINES)


def main():
    root = pathlib.Path(sys.argv[1])
    seen, bad = 0, 0
    for path in files_of(root):
        name = path.relative_to(root)
        seen += 1
        for number, fault in faults_of(path, name):
            print(f"{name}:{number}: {fault}")
            bad += 1
    for folder, count in crowded_folders(root):
        print(f"{folder}: {count} files; {MAX_FOLDER_FILES} at most")
        bad += 1
    print(f"{seen} files, {bad} faults")
    return 1 if bad or seen < 400 else 0


if __name__ == "__main__":
    sys.exit(main())
