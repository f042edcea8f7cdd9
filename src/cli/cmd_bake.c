// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

static int bake(const Arguments* a, vplContext* context, const vplScene* scene)
{
    Progress progress = beginProgress(a->quiet);
    vplRenderOptions options = a->render;
    vplRenderStats stats;
    options.progress = showProgress;
    options.progressUser = &progress;
    int code = exitCode(vplBake(scene, &options, (float)a->exposure, a->output, &stats), false);
    endProgress(&progress);
    if (code == EXIT_DONE && a->verbose) {
        complain("%d patches, %d sides that light reaches, %d sweeps", stats.patches, stats.patchSides,
                 stats.solve.iterations);
    }
    if (code == EXIT_DONE && a->stats != NULL) {
        code = exitCode(writeStats(context, a->stats, &stats), false);
    }
    return code;
}

int runBake(const Arguments* a)
{
    const size_t length = a->output != NULL ? strlen(a->output) : 0;
    if (a->output == NULL || length < 4 || strcmp(a->output + length - 4, ".ply") != 0) {
        complain("bake needs -o FILE, a name that ends in .ply");
        return EXIT_USAGE;
    }
    if (a->render.method != VPL_METHOD_RADIOSITY) {
        complain("bake writes the patches of --method radiosity alone");
        return EXIT_USAGE;
    }
    if (!checkOutput(a->output) || (a->stats != NULL && !checkOutput(a->stats))) {
        return EXIT_COULD_NOT;
    }
    return runOnScene(a, bake);
}
