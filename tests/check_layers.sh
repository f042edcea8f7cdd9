#!/bin/sh
# Each folder of src may include only the layers below it. Names file, line and both folders.
# Public headers <vpl/x.h> count as the folder that implements them.
# A folder may have sub-folders: each may include itself, files of the folder and the sub-folders listed before it.
cd "${1:-.}" || exit 2
awk '
BEGIN {
    split("base math image scene geometry raster visibility lights shading radiosity reference render cli mpi", names, " ")
    allowed["base"] = "base"
    allowed["math"] = "math base"
    allowed["image"] = "image base math"
    allowed["scene"] = "scene base math image"
    allowed["geometry"] = "geometry base math scene"
    allowed["raster"] = "raster base math image"
    allowed["visibility"] = "visibility base math geometry raster"
    allowed["lights"] = "lights base math image scene geometry raster visibility"
    allowed["shading"] = "shading base math image scene geometry raster visibility lights"
    allowed["radiosity"] = "radiosity base math image scene geometry raster visibility"
    allowed["reference"] = "reference base math image scene geometry"
    allowed["render"] = "render base math image scene geometry raster visibility lights shading radiosity reference"
    allowed["cli"] = "cli public"
    allowed["mpi"] = "mpi cli public"
    layer["vecmath"] = "math"
    layer["formulas"] = "visibility"
    layer["machine"] = layer["choices"] = "base"
    layer["imagetools"] = "image"
    layer["scenetools"] = "scene"
    layer["options"] = layer["plan"] = layer["pieces"] = "render"
    layer["stages"] = layer["optiontools"] = layer["plantools"] = layer["rendertools"] = "render"
    inner["radiosity"] = "sides factors links solve mesh draw"
}
{
    split(FILENAME, path, "/")
    folder = path[2]
    if (match($0, /^#include "[a-z]+\//)) {
        target = substr($0, 11, RLENGTH - 11)
        split(substr($0, 11), part, "/")
        if (target == folder && (folder in inner) && path[4] != "" && part[3] != "" &&
            index(inner[folder], part[2]) > index(inner[folder], path[3])) {
            printf "%s:%d: %s/%s must not include %s/%s\n", FILENAME, FNR, folder, path[3], target, part[2]
            bad++
        }
    } else if (match($0, /^#include <vpl\/[a-z]+\.h>/)) {
        target = substr($0, 15, RLENGTH - 17)
        target = target in layer ? layer[target] : target
        if (folder == "cli" || folder == "mpi") { target = "public" }
    } else {
        next
    }
    if (index(" " allowed[folder] " ", " " target " ") == 0) {
        printf "%s:%d: %s must not include %s\n", FILENAME, FNR, folder, target
        bad++
    }
}
END { exit bad > 0 }
' $(find src -name "*.[ch]")
