// SPDX-License-Identifier: MIT
#include "cli/cli.h"
#include "cli/tradeoff.h"

#include <stdio.h>
#include <string.h>

typedef struct Topic {
    const char *name, *usage, *summary, *text;
} Topic;

static const Topic TOPICS[] = {
    {"render", "vpl render SCENE -o FILE [options]", "renders a picture",
     "Renders SCENE and writes a picture. Files appear whole or not at all. SCENE is a scene file (.json), "
     "or a\n"
     "mesh (.obj), which gets a camera that sees all of it and, if nothing emits, a light."},
    {"bake", "vpl bake SCENE -o FILE [options]", "writes the patches of radiosity as a mesh",
     "Finds the light of SCENE by --method radiosity and writes its patches as a binary PLY mesh with "
     "colours "
     "at\n"
     "the vertices: 8-bit sRGB of radiance (after --exposure), and linear radiosity as properties r, g, b."},
    {"lights", "vpl lights SCENE [options]", "lists the virtual lights",
     "Prints the virtual lights as CSV: index,step,px,py,pz,nx,ny,nz,r,g,b,weight. The index is the K of\n"
     "--show light:K. r,g,b is what the particle carries after attenuation (documented lighting) or the flux "
     "in\n"
     "watts that the surface sends out (physical); weight is N/floor(rho^k N). Pictures also divide by N."},
    {"compare", "vpl compare A B [options]", "measures how far picture A is from reference B",
     "Prints rmse, relative_rmse (rmse / mean of B), relmse (mean of (a-b)^2/(b+0.01)^2), trimmed_relmse "
     "(the\n"
     "same without the 0.1 % of the pixels where it is largest), psnr (dB), ssim and flip (all three of "
     "values\n"
     "clamped to [0, 1]; psnr and ssim sRGB-encoded), energy_ratio (sum of A / sum of B) and max_difference\n"
     "with its pixel. --regions adds a table of blocks."},
    {"info", "vpl info SCENE [options]", "says what is in a scene, and what rendering it requires",
     "Prints counts, bounds, mean reflectance, and the lights, draw calls and memory that a render with the "
     "same\n"
     "options would need."},
    {"tradeoff", "vpl tradeoff SCENE -o DIR [options]", "measures error against time",
     "Renders SCENE with many settings and several seeds, compares each picture with a reference, and "
     "writes\n"
     "to DIR: report.html (which settings for 5 % error, and what do they cost?), tradeoff.svg (the plot),\n"
     "tradeoff.csv (every figure), and the reference as reference-a.pfm and reference-b.pfm. Render options\n"
     "given here change the base that the sweeps start from: " TRADEOFF_BASE ".\n"
     "Physical lighting only: the documented formulas have no truth to compare with."},
    {"bench", "vpl bench [options]", "times every stage",
     "Times the stages on the built-in room: medians of the wall clock and of processor time, counts, "
     "hashes,\n"
     "and what several threads gain: stages under 85 % efficiency (1.7x on two threads) are marked. With\n"
     "--scaling, how time grows with lights, pixels, triangles, threads and the shadow map's size: "
     "exponents\n"
     "fitted over all points and over the upper half, and the part of the time that does not grow."},
};

// Their names, each once, in the order of the table.
static void printSweeps(void)
{
    printf("\n\nSweeps:");
    for (int i = 0, column = 7; i < SWEEP_COUNT; i++) {
        if (i > 0 && strcmp(SWEEPS[i].name, SWEEPS[i - 1].name) == 0) {
            continue;
        }
        const int length = (int)strlen(SWEEPS[i].name) + 1;
        if (column + length > 110) {
            printf("\n ");
            column = 1;
        }
        printf(" %s", SWEEPS[i].name);
        column += length;
    }
}

bool printHelp(const char* command)
{
    if (command == NULL) {
        printf("vpl %s - indirect light with many virtual lights, on the CPU, the same bits everywhere\n\n",
               vplGetVersion());
        for (size_t i = 0; i < sizeof TOPICS / sizeof *TOPICS; i++) {
            printf("  %-36s %s\n", TOPICS[i].usage, TOPICS[i].summary);
        }
        printf("  %-36s %s\n", "vpl help [command]", "explains a command and its options");
        printf("  %-36s %s\n", "vpl --version", "prints the version");
        printf("\nExit codes: 0 done; 1 could not (disk, memory, cancelled); 2 wrong usage or bad input.\n");
        return true;
    }
    for (size_t i = 0; i < sizeof TOPICS / sizeof *TOPICS; i++) {
        if (strcmp(TOPICS[i].name, command) == 0) {
            printf("%s\n\n%s", TOPICS[i].usage, TOPICS[i].text);
            if (strcmp(command, "tradeoff") == 0) {
                printSweeps();
            }
            printf("\n\nOptions (--name VALUE or --name=VALUE):\n");
            printOptions(command);
            return true;
        }
    }
    return false;
}
