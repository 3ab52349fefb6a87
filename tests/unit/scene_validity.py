"""All scenes against scenarios/scene.schema.json, with Debian's python3-jsonschema: scenes of tandem's own solvers and of
others are valid, and what is wrong in them is not. usage: scene_validity.py SOURCE_DIR"""
# SPDX-License-Identifier: GPL-3.0-or-later
import copy
import glob
import json
import sys

import jsonschema

FOLDERS = ["scenarios/**/*.json", "tests/healthy/scenes/**/*.json", "dem/foreign/*/scenes/*.json"]


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def changed(scene, section, key, value):
    other = copy.deepcopy(scene)
    other.setdefault(section, {})[key] = value
    return other


def main(source):
    validator = jsonschema.Draft7Validator(load(source + "/scenarios/scene.schema.json"))
    files = sorted(path for pattern in FOLDERS for path in glob.glob(source + "/" + pattern, recursive=True))
    own = foreign = 0
    for path in files:
        scene = load(path)
        if not isinstance(scene, dict) or "time" not in scene:
            continue  # no scene: a study, a list of cases, the schema
        error = jsonschema.exceptions.best_match(validator.iter_errors(scene))
        if error:
            sys.exit("%s: %s: %s" % (path, "/".join(map(str, error.absolute_path)), error.message[:300]))
        for section in ("dem", "mbd"):
            if section not in scene:
                continue
            is_foreign = isinstance(scene[section].get("solver"), str)
            foreign, own = foreign + is_foreign, own + (not is_foreign)
            if validator.is_valid(changed(scene, section, "no_such_key", 1)) != is_foreign:
                sys.exit("%s: a key of %s that is not there is %s" % (path, section, "wrong" if is_foreign else "taken"))
        if validator.is_valid(changed(scene, "time", "no_such_key", 1)):
            sys.exit("%s: a key of time that is not there is taken" % path)
    if own < 50 or foreign < 5:
        sys.exit("only %d sections of own solvers and %d of others in %s" % (own, foreign, source))
    print("scene validity: good; %d sections of tandem's own solvers, %d of others" % (own, foreign))


main(sys.argv[1])
