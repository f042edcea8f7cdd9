#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a C file that calls every public function with every wrong argument: generate.py HEADERS... > calls.c

Each call has one wrong argument: NULL, a def without its cookie, numbers out of range, structs of NaN. The others come from
the tables below, by function and name, by type and name, or by type. A pointer gets no NULL where the comment of the
function says "must not be NULL". A type without a value in the tables is an error, so new functions need one. So is a
struct vpl...Def that lacks a cookie or a function vplDefault...Def."""
import re
import sys

# Arguments that are NULL by design, whatever the comment says: what a caller's function gets.
OPTIONAL_NAMES = {"user", "data", "progress"}

# Valid values by "function.argument", by "type argument" and by type.
BY_ARGUMENT = {
    "vplContext_CreateForAbi.major": "VPL_VERSION_MAJOR",
    "vplContext_CreateForAbi.minor": "VPL_VERSION_MINOR",
    "vplWriteFile.path": '"/dev/null"',
    "vplWriteFile.bytes": '"text"',
    "vplWriteFile.size": "4",
    "vplImage_WriteLayers.path": '"/dev/null/a.exr"',
    "vplImage_ReadLayer.path": '"/dev/null/a.exr"',
    "vplImage_Encode.name": '".pfm"',
    "vplScene_LoadModel.path": '"/dev/null/a.obj"',
    "vplRenderOptions_Get.size": "64",
    "vplRenderOptions_IsUsed.size": "64",
    "vplPlan_Describe.size": "64",
    "vplRenderOptions_Set.value": '"7"',
    "vplAssembly_Add.bytes": "f.piece",
    "vplAssembly_Add.size": "f.pieceBytes",
    "vplRaster_RunAll.rasters": "&f.raster",
    "vplPatches_Refine.count": "20",
    "vplPatchMesh_Sharpen.rounds": "1",
    "vplImage_Crop.width": "1",
    "vplImage_Crop.height": "1",
    "vplHemiMaps_Create.size": "4",
    "vplHemiMaps_Create.capacity": "1",
    "vplParaboloidMaps_Create.size": "4",
    "vplParaboloidMaps_Create.capacity": "1",
    "vplPatchSide_SampleCell.side": "f.sides->sides",
    "vplRenderOptions_Create.context": "f.context",
    "vplAccumulateLights.lights": "f.shadeLights",
    "vplAccumulateLights.count": "f.shadeLightCount",
    "vplShadePoints.points": "&f.point",
    "vplHemiMaps_Draw.places": "&f.hemiPlace",
    "vplParaboloidMaps_Draw.places": "&f.paraboloidPlace",
    "vplReflectiveMap_Destroy.map": "f.reflective",
    "vplBytes_Free.bytes": "f.piece",
    "vplScene_SetTransform.object": "0",
    "vplRasterStats_Add.stats": "&f.stats",
    "vplCubeMap_Redraw.def": "&f.cubeDef",
}
BY_TYPE = {
    "bool": "true", "int": "1", "size_t": "1", "int64_t": "1", "uint64_t": "1", "float": "0.5f", "double": "0.5",
    "int index": "0", "int x": "0", "int y": "0", "int face": "0", "int fromFace": "VPL_FACE_NONE", "int triangle": "0",
    "int patch": "0", "int k": "0", "int element": "0", "int i": "0", "int object": "0", "int material": "0",
    "vplVec3": "(vplVec3){0.1f, 0.2f, 0.9f}", "vplParaboloidTexel": "(vplParaboloidTexel){0, 8, 8}",
    "vplLightFormula": "(vplLightFormula){VPL_LIGHTING_PHYSICAL, 0.1f}",
    "const char*": '"seed"', "const char* path": '"/dev/null/a.pfm"', "const char* message": '"text"',
    "const double*": "(const double*)(const void*)ones", "const float*": "ones",
    "const double[3]": "(const double*)(const void*)zeros", "const float[4]": "ones",
    "const float (*)[4]": "(const float(*)[4])(const void*)ones",
    "const vplVec3*": "(const vplVec3*)(const void*)ones", "const vplVec3[3]": "f.meshDef.positions",
    "const vplRgb*": "(const vplRgb*)(const void*)ones",
    "vplContext*": "f.context", "vplScene*": "f.scene", "vplGeometry*": "f.geometry",
    "vplEnvironment*": "f.environment", "vplEmission*": "f.emission", "vplImage*": "f.image",
    "const vplImage* b": "f.other", "const vplLayer*": "&f.layer", "const vplPixelsDef*": "&f.pixels",
    "const vplTarget*": "&f.target", "const vplView*": "&f.view", "vplCubeMap*": "f.cube",
    "const vplShadow*": "&f.shadow", "vplReflectiveMap*": "f.reflective",
    "const vplReflectiveMap* const*": "(const vplReflectiveMap* const*)(const void*)&f.reflective",
    "vplHemiMaps*": "f.hemi", "const vplHemiMap*": "f.hemi->maps", "vplParaboloidMaps*": "f.paraboloids",
    "const vplParaboloidMap*": "f.paraboloids->maps", "vplLightSet*": "f.lights",
    "vplLightClusters*": "f.clusters", "vplPatches*": "f.patches", "vplPatchSides*": "f.sides",
    "vplFormFactors*": "f.factors", "vplLinks*": "f.links", "const vplTransport*": "&f.transport",
    "vplPatchMesh*": "f.mesh", "vplRaster*": "f.raster", "const vplFramebuffer*": "&f.framebuffer",
    "const vplPipeline*": "&f.pipeline", "const vplMesh*": "&f.drawn", "vplPlan*": "f.plan",
    "vplRenderer*": "f.renderer", "const vplPieceGrid*": "&f.grid", "vplAssembly*": "f.assembly",
    "vplHistory*": "f.history", "const vplRay*": "&f.ray", "const vplHit*": "&f.hit",
    "const vplPlacement*": "&f.placement", "const vplPlacementDef*": "&f.placementDef",
    "const vplShadeDef*": "&f.shade", "const vplEmitterDef*": "&f.emitter",
    "const vplPatchDraw*": "&f.draw", "const vplVertexGather*": "&f.gather",
    "const vplPatchPriorityDef*": "&f.priority", "const vplTextureDef*": "&f.texture",
    "const vplMeshDef*": "&f.meshDef", "const vplEnvironmentDef*": "&f.sky", "const vplCameraDef*": "&f.camera",
    "const vplCameraKey*": "&f.cameraKey", "const vplEmitterKey*": "&f.emitterKey",
    "const vplTransformKey*": "&f.transformKey",
    "const vplMemoryFile*": "&f.file", "const vplSpeeds*": "&f.speeds", "const vplMachine*": "&f.machine",
    "const vplTeam*": "&f.team",
    "const vplTile*": "&f.tile", "const vplMat4*": "&f.matrix", "const vplParticlePass*": "&f.pass",
    "vplRenderOptions*": "f.options", "vplProgressFcn*": "goOn", "vplTileFcn*": "tileTask",
    "vplLayers*": "NULL", "const void*": "zeros", "const uint8_t*": "zeros", "uint8_t*": "NULL",
}
# Lengths of a caller's array, where a larger number than the array has is outside of every contract, and amounts of work,
# where the largest takes days.
LENGTHS = {"vplPatches_Refine.count": False, "vplCountParticles.capacity": True, "vplRenderOptions_Get.size": True,
           "vplRenderOptions_IsUsed.size": True, "vplPlan_Describe.size": True, "vplMeasureUse.rayCount": False,
           "vplEstimateClampLoss.pointCount": True, "vplPatchMesh_Sharpen.rounds": True, "vplWriteFile.size": True, "vplAssembly_Add.size": True,
           "vplImage_CompareRegions.columns": False, "vplSampleAreaLights.count": True, "vplSampleSky.count": True}
# Types that lead to the context.
CONTEXT_TYPES = ("vplContext vplScene vplGeometry vplImage vplCubeMap vplReflectiveMap vplHemiMaps vplParaboloidMaps "
                 "vplLightSet vplLightClusters vplPatches vplPatchSides vplFormFactors vplLinks vplPatchMesh vplRaster "
                 "vplRenderer vplAssembly vplHistory").split()
NUMBERS = {
    "int": ["-1", "INT_MIN", "INT_MAX"], "size_t": ["0", "SIZE_MAX"], "int64_t": ["-1", "INT64_MIN", "INT64_MAX"],
    "uint64_t": ["0", "UINT64_MAX"], "float": ["NAN", "-1", "INFINITY", "3e38f"],
    "double": ["NAN", "-1", "INFINITY", "1e300"], "bool": [],
}


def read_headers(paths):
    """Returns functions as (name, result, [(type, name)], comment), and the names of structs with a cookie."""
    functions, cookies, enums = [], set(), set()
    for path in paths:
        text = open(path, encoding="utf-8").read()
        for body, name in re.findall(r"typedef struct \w+ \{(.*?)\n\} (\w+);", text, re.S):
            if "cookie;" in body:
                cookies.add(name)
            elif name.endswith("Def"):
                sys.exit(f"generate.py: {name} has no cookie")
        enums.update(re.findall(r"typedef enum (\w+)", text))
        pattern = r"^((?:const )?[a-z]\w*\**) ?(\**)(vpl\w+)\(([^;{}]*?)\);"
        for match in re.finditer(pattern, text, re.M):
            result = match[1] + match[2]
            if result.startswith(("typedef", "return")):
                continue
            functions.append((match[3], result, parse_arguments(match[4]), comment_above(text, match.start())))
    return functions, cookies, enums


def comment_above(text, position):
    """The comment of a declaration, or of the group of declarations that it stands in."""
    block = text[:position].rsplit("\n\n", 1)[-1]
    return " ".join(re.findall(r"// ?(.*)", block))


def parse_arguments(text):
    text = re.sub(r"\s+", " ", text)
    if text == "void":
        return []
    arguments = []
    for part in text.split(", "):
        match = re.fullmatch(r"(.*\(\*)(\w+)(\)\[\w+\])", part) or re.fullmatch(r"(.*?) ?(\w+)((?:\[\w+\])*)", part)
        arguments.append(((match[1] + match[3]).strip(), match[2]))
    return arguments


def is_pointer(kind):
    return "*" in kind or "[" in kind


def is_output(kind, name):
    return is_pointer(kind) and not kind.startswith("const ")


def valid(function, index, kind, name, cookies):
    if f"{function}.{name}" in BY_ARGUMENT:
        return BY_ARGUMENT[f"{function}.{name}"]
    bare = re.sub(r"^const ", "", kind)
    for key in (f"{kind} {name}", kind, bare):
        if key in BY_TYPE and not name.endswith("Out"):
            return BY_TYPE[key]
    base = bare.rstrip("*")
    if kind == f"const {base}*" and base in cookies:
        return f"&(static_{base})"
    if kind == "void*":
        return f"spaces[{index}]"
    if is_output(kind, name):
        return f"({array_pointer(kind)})(void*)spaces[{index}]"
    if base.startswith("vpl") and not is_pointer(kind):
        return f"({kind})0"
    sys.exit(f"generate.py: {function}: no value for {kind} {name}; add one to BY_ARGUMENT or BY_TYPE")


def array_pointer(kind):
    """The type of a pointer to what an array argument holds."""
    match = re.fullmatch(r"([^\[(]*)((?:\[\w+\])+)", kind)
    if match is None:
        return kind
    rest = re.findall(r"\[\w+\]", match[2])[1:]
    return f"{match[1]}(*){''.join(rest)}" if rest else f"{match[1]}*"


def wrong_values(function, kind, name, arguments, cookies, enums):
    """Yields (text for messages, C expression)."""
    base = re.sub(r"^const ", "", kind).rstrip("*")
    if is_pointer(kind):
        yield "NULL", "NULL"
        if kind == f"const {base}*" and base in cookies:
            yield "a def of zeros", f"({kind})(const void*)zeros"
        if kind == "const char*":
            yield "an empty string", '""'
            yield "bytes that are no text", '"\\xff\\xfe%s%n"'
    elif kind in NUMBERS:
        array = any(is_pointer(k) and not k.endswith("**") for k, n in arguments[:-1]) and re.search(
            r"(?i)count$|capacity|size", name)
        array = LENGTHS.get(f"{function}.{name}", array)
        for value in NUMBERS[kind]:
            if not (array and ("MAX" in value)):
                yield value, value
    elif base in enums:
        yield "-1", f"({kind})-1"
        yield "1000", f"({kind})1000"
    elif base.startswith("vpl") and not base.endswith("Fcn"):
        yield "bytes of 0xff", f"*({kind}*)memset(spaces[{len(arguments)}], 255, sizeof({kind}))"


def may_be_null(comment, name):
    """Whether a sentence about the argument, or one without a name of an argument, has the word NULL."""
    sentences = re.split(r"(?<=[.]) ", comment.replace("must not be NULL", ""))
    about = [s for s in sentences if "NULL" in s and (re.search(rf"\b{name}\b|\bboth\b", s) or "NULL is allowed" in s)]
    return name in OPTIONAL_NAMES or bool(about)


def main():
    functions, cookies, enums = read_headers(sys.argv[1:])
    names = [f[0] for f in functions]
    print('// Written by tests/nulls/generate.py.\n#include "fixture.h"\n\n#include <limits.h>\n#include <math.h>\n'
          "#include <string.h>\n")
    makers = {base: "vplDefault" + base[3:] for base in sorted(cookies)}
    for base, maker in makers.items():
        if maker not in names:
            sys.exit(f"generate.py: {base} has no {maker}")
        if base != "vplFramebuffer":
            print(f"#define static_{base} (({base}[]){{{maker}()}}[0])")
    rows, skipped, called = [], 0, 0
    for name, result, arguments, comment in functions:
        called += 1
        values = [valid(name, i, k, n, cookies) for i, (k, n) in enumerate(arguments)]
        outputs = sum(1 << i for i, (k, n) in enumerate(arguments) if k.endswith("**") and n.endswith("Out"))
        for i, (kind, argument) in enumerate(arguments):
            for text, wrong in wrong_values(name, kind, argument, arguments, cookies, enums):
                if wrong == "NULL" and "must not be NULL" in comment or f"`{argument}` must be in range" in comment:
                    skipped += 1
                    continue
                others = [k for j, (k, n) in enumerate(arguments) if j != i]
                known = any(re.sub(r"^const |\*$", "", k).strip("*") in CONTEXT_TYPES and not k.endswith("**")
                            or re.sub(r"^const ", "", k) in [c + "*" for c in CONTEXT_TYPES] for k in others)
                words = ", ".join(wrong if j == i else v for j, v in enumerate(values))
                call = f"{name}({words})" if name != "vplContext_Create" else f"(vplContext_Create)({words})"
                status = result == "vplResult"
                print(f"static vplResult call{len(rows)}(void) {{ "
                      + (f"return {call};" if status else f"(void){call}; return VPL_SUCCESS;") + " }")
                flag = lambda value: "true" if value else "false"
                quoted = text.replace("\\", "\\\\").replace('"', '\\"')
                rows.append(f'{{"{name}", "{argument}", "{quoted}", call{len(rows)}, {flag(wrong == "NULL")}, '
                            f"{flag(may_be_null(comment, argument))}, {flag(status)}, {flag(known)}, "
                            f"{outputs & ~(1 << i)}}}")
    print("const Call calls[] = {\n    " + ",\n    ".join(rows) + "};")
    print(f"const int defCount = {len(makers)};\n\nvoid findCookies(Cookie* out)\n{{")
    for i, (base, maker) in enumerate(makers.items()):
        size = "1, 1" if base == "vplFramebuffer" else ""
        print(f'    out[{i}] = (Cookie){{"{base}", {maker}({size}).cookie}};')
    print("}")
    print(f"const int callCount = {len(rows)}, functionCount = {called}, skippedCount = {skipped};")


main()
