#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a hall of 259,308 triangles, as many as Sponza has, whose six bumpy sides have textures of 256 to 2,048 texels a side:
    tests/bench/textured_scene.py FOLDER
makes textured.json and plain.json, which is the same without textures."""
import json
import math
import os
import random
import sys

SIDE = 148  # vertices along an edge
SIZES = [256, 512, 512, 1024, 1024, 2048]
# corner and two edges of each side, metres; their cross product points inwards
FACES = [((-6, 0, 4), (12, 0, 0), (0, 0, -8)), ((-6, 5, -4), (12, 0, 0), (0, 0, 8)),
         ((-6, 0, -4), (12, 0, 0), (0, 5, 0)), ((6, 0, 4), (-12, 0, 0), (0, 5, 0)),
         ((-6, 0, 4), (0, 0, -8), (0, 5, 0)), ((6, 0, -4), (0, 0, 8), (0, 5, 0))]


def write_texture(path, size, seed):
    """Bricks of random greys and hues, as TGA."""
    rng = random.Random(seed)
    bricks = [bytes(rng.randrange(60, 220) for _ in range(3)) for _ in range(64)]
    header = bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, size & 255, size >> 8, size & 255, size >> 8, 24, 0])
    step = size // 8
    with open(path, "wb") as file:
        file.write(header)
        for y in range(size):
            row = [bricks[8 * (y // step) + x] * (step - step // 16) + bytes([90, 90, 90]) * (step // 16) for x in range(8)]
            file.write(b"".join(row))


def write_mesh(path, textured):
    with open(path, "w", encoding="ascii") as file:
        file.write("mtllib %s\n" % ("textured.mtl" if textured else "plain.mtl"))
        for index, (corner, along, up) in enumerate(FACES):
            normal = [along[(k + 1) % 3] * up[(k + 2) % 3] - along[(k + 2) % 3] * up[(k + 1) % 3] for k in range(3)]
            length = math.sqrt(sum(n * n for n in normal))
            for j in range(SIDE):
                for i in range(SIDE):
                    u, v = i / (SIDE - 1), j / (SIDE - 1)
                    bump = 0.03 * (1 - math.cos(60 * u)) * (1 - math.cos(40 * v))
                    p = [corner[k] + u * along[k] + v * up[k] + bump * normal[k] / length for k in range(3)]
                    file.write("v %.5f %.5f %.5f\nvt %.5f %.5f\n" % (*p, 3 * u, 3 * v))
            file.write("usemtl side%d\n" % index)
            for j in range(SIDE - 1):
                for i in range(SIDE - 1):
                    a = index * SIDE * SIDE + j * SIDE + i + 1
                    b, c, d = a + 1, a + 1 + SIDE, a + SIDE
                    file.write("f {0}/{0} {1}/{1} {2}/{2}\nf {0}/{0} {2}/{2} {3}/{3}\n".format(a, b, c, d))


def main(folder):
    os.makedirs(folder, exist_ok=True)
    for name in ("textured", "plain"):
        write_mesh(os.path.join(folder, name + ".obj"), name == "textured")
        with open(os.path.join(folder, name + ".mtl"), "w", encoding="ascii") as file:
            for index in range(len(FACES)):
                file.write("newmtl side%d\nKd 0.8 0.8 0.8\n" % index if name == "textured" else
                           "newmtl side%d\nKd 0.27 0.27 0.27\n" % index)
                if name == "textured":
                    file.write("map_Kd side%d.tga\n" % index)
        scene = {"camera": {"eye": [-5, 1.7, 0], "target": [0, 1.9, 0], "up": [0, 1, 0], "fov_y": 60, "near": 0.1, "far": 50},
                 "objects": [{"type": "mesh", "file": name + ".obj", "name": "hall"}],
                 "lights": [{"type": "point", "position": [1, 4, 0.5], "intensity": [40, 38, 35]}]}
        with open(os.path.join(folder, name + ".json"), "w", encoding="ascii") as file:
            json.dump(scene, file)
    for index, size in enumerate(SIZES):
        write_texture(os.path.join(folder, "side%d.tga" % index), size, index)


main(sys.argv[1])
