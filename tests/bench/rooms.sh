#!/bin/sh
# Radiosity against paths: tests/bench/rooms.sh BUILD SIZE SPP "OPTIONS" SCENE... prints processor time, patches that light reaches, the
# most memory, energy and relmse of indirect light for each scene and setting, seen through pixel centres. The truth is two pictures a
# and b of SPP paths per pixel each, whose noise cancels in relmse: the mean of (x - a) (x - b) / (m + 0.01)^2, m = (a + b) / 2.
# All renders get OPTIONS. SETTINGS in the environment replaces the settings below, one a line.
build=$1 size=$2 spp=$3 options=$4
shift 4
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
settings=${SETTINGS:-"--patches 2000
--patches 2000 --patch-placement adaptive
--patches 8000
--patches 8000 --patch-placement adaptive"}
printf '%-16s %-42s %8s %8s %8s %8s %8s\n' scene setting "cpu s" patches MiB energy relmse
for scene; do
    for half in 1 2; do
        # shellcheck disable=SC2086
        "$build/vpl" render "$scene" --method path --spp "$spp" --pixel centre --seed $half --size "$size" --show indirect --quiet \
            $options -o "$scratch/$half.pfm" || exit 1
    done
    echo "$settings" | while read -r setting; do
        # shellcheck disable=SC2086
        /usr/bin/time -f "%U %M" -o "$scratch/time" "$build/vpl" render "$scene" --method radiosity $setting --antialias 1 --size "$size" \
            --show indirect --quiet $options --stats "$scratch/stats.json" -o "$scratch/x.pfm" || exit 1
        /usr/bin/python3 - "$scene" "$setting" "$scratch" <<'END'
import json, os, sys
import numpy as np

scene, setting, folder = sys.argv[1:]

def read(name):
    with open(os.path.join(folder, name), "rb") as f:
        f.readline(), f.readline(), f.readline()
        return np.frombuffer(f.read(), "<f4").astype(float)

x, a, b = read("x.pfm"), read("1.pfm"), read("2.pfm")
m = 0.5 * (a + b)
seconds, kib = open(os.path.join(folder, "time")).read().split()
patches = json.load(open(os.path.join(folder, "stats.json")))["lit_patches"]
print("%-16s %-42s %8.1f %8d %8.0f %8.3f %8.4f" % (os.path.basename(scene).replace(".json", ""), setting, float(seconds), patches,
      int(kib) / 1024, x.sum() / m.sum(), np.mean((x - a) * (x - b) / (m + 0.01) ** 2)), flush=True)
END
    done || exit 1
done
