// SPDX-License-Identifier: MIT
// vpl-mpi: vpl render, bake and tradeoff for many machines. All ranks parse the same words; only rank 0 complains of them.
#include "mpi/ranks.h"

#include "cli/tradeoff/tradeoff.h"

#include <mpi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char USAGE[] =
    "mpirun -n N vpl-mpi render SCENE -o FILE [options of vpl render] [options of vpl-mpi]\n"
    "mpirun -n N vpl-mpi bake SCENE -o FILE.ply [options of vpl bake]\n"
    "mpirun -n N vpl-mpi tradeoff SCENE -o DIR [options of vpl tradeoff]\n"
    "mpirun -n 2 vpl-mpi --ping-pong\n\n"
    "Renders a picture by pieces, or the frames of --frames, with the bits of vpl render for any N. For "
    "--method radiosity\n"
    "and for bake the ranks share the rows of form factors, so that N machines hold N times as many. For "
    "tradeoff each\n"
    "rank measures every N-th setting, on its own machine and from its own disk.\n"
    "  --checkpoint FILE   append finished pieces to FILE, which vpl merge reads, too; of --frames a list\n"
    "  --resume FILE       go on with it, with any N\n"
    "  --grace SECONDS     after SIGTERM what is under way may take so long; default 5\n"
    "  --shared-scene      every rank reads the scene from disk; by default rank 0 reads and sends it\n"
    "  --rank-zero-waits   rank 0 only hands out and collects\n"
    "  --bands N           divide a picture in so many bands of rows; default: by the number of ranks\n"
    "  --stats FILE        what each rank did, as JSON\n";

static bool readNumber(const char* name, const char* word, const char* value, double most, double* out)
{
    char* end = NULL;
    if (strcmp(word, name) != 0) {
        return false;
    }
    *out = value != NULL && *value >= '0' && *value <= '9' ? strtod(value, &end) : -1;
    if (end == NULL || *end != 0 || *out < 0 || *out > most) {
        complain("%s is \"%s\", must be a number in [0, %g]", name, value != NULL ? value : "", most);
        *out = -1;
    }
    return true;
}

// Takes our own options out of the words; false after complaining.
static bool takeOptions(int* count, const char** words, MpiOptions* o)
{
    int kept = 0;
    *o = (MpiOptions){.grace = 5};
    for (int i = 0; i < *count; i++) {
        double bands = 0;
        const char* value = i + 1 < *count ? words[i + 1] : NULL;
        if (strcmp(words[i], "--shared-scene") == 0) {
            o->shared = true;
        } else if (strcmp(words[i], "--rank-zero-waits") == 0) {
            o->rankZeroWaits = true;
        } else if (strcmp(words[i], "--ping-pong") == 0) {
            o->pingPong = true;
        } else if (readNumber("--grace", words[i], value, 1e6, &o->grace) ||
                   readNumber("--bands", words[i], value, VPL_MAX_IMAGE_SIZE, &bands)) {
            o->bands = bands > 0 ? (int)bands : o->bands;
            i++;
        } else {
            words[kept++] = words[i];
        }
        if (o->grace < 0 || bands < 0) {
            return false;
        }
    }
    *count = kept;
    return true;
}

// Complains of what pieces and frames do not have.
static int checkRender(const Arguments* a)
{
    static const char* const OTHERS[] = {"tile", "plan-out", "error-map", "no-partial", "checkpoint-every"};
    for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++) {
        if (isGiven(a, OTHERS[i])) {
            complain("vpl-mpi renders without --%s", OTHERS[i]);
            return EXIT_USAGE;
        }
    }
    if (a->dryRun && a->positionalCount > 0) {
        return EXIT_DONE;
    }
    if (a->positionalCount < 1 || a->output == NULL) {
        complain("render needs %s", a->output == NULL ? "-o FILE, the picture to write" : "a scene file");
        return EXIT_USAGE;
    }
    if (!checkPictureName(a)) {
        return EXIT_USAGE;
    }
    char reason[64];
    if (a->frames[1] >= 0 && a->render.sequence.coherence == VPL_COHERENCE_ON &&
        vplRenderOptions_IsUsed(&a->render, "coherence", reason, sizeof reason)) {
        complain("frames that ranks share cannot depend on the one before: --coherence must be off with this "
                 "--method");
        return EXIT_USAGE;
    }
    const bool good = (a->frames[1] >= 0 || checkOutput(a->output)) &&
                      (a->stats == NULL || checkOutput(a->stats)) &&
                      (a->checkpoint == NULL || checkOutput(a->checkpoint));
    return good ? EXIT_DONE : EXIT_COULD_NOT;
}

// --explain and --dry-run. All ranks plan, because they share what the plan needs.
static int explain(Ranks* r, const vplScene* scene)
{
    const Arguments* a = r->arguments;
    vplPlan* plan = NULL;
    int code = formTeam(r);
    if (code == EXIT_DONE && r->rank == 0) {
        code = explainPlan(a, scene);
        if (code == EXIT_DONE) {
            fprintf(a->dryRun ? stdout : stderr,
                    "%d ranks: each needs this memory, rank 0 also the finished picture\n", r->count);
        }
    } else if (code == EXIT_DONE) {
        code = exitCode(planRender(a, scene, &plan), true);
        vplPlan_Destroy(plan);
    }
    dissolveTeam(r);
    return shareNumber(r, code);
}

static int work(Ranks* r, bool bakes)
{
    vplContext* context;
    vplScene* scene = NULL;
    int code = largestNumber(r, exitCode(openContext(r->arguments, &context), true));
    r->context = context;
    code = code == EXIT_DONE ? shareScene(r, context, &scene) : code;
    if (code == EXIT_DONE && (r->arguments->explain || r->arguments->dryRun)) {
        code = explain(r, scene);
    }
    if (code == EXIT_DONE && !r->arguments->dryRun) {
        catchInterrupts();
        if (r->rank == 0) {
            warnOfDisplay(r->arguments);
        }
        code = (bakes ? bakePatches : r->arguments->frames[1] >= 0 ? renderFrames : renderPieces)(r, scene);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}

static int run(Ranks* r, int count, const char** words)
{
    static Arguments arguments;
    const bool good = takeOptions(&count, words, &r->options);
    if (good && r->options.pingPong) {
        return measureMessages(r);
    }
    const char* word = good && count > 1 ? words[1] : "";
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        fputs(r->rank == 0 ? USAGE : "", stdout);
        return EXIT_DONE;
    }
    const bool bakes = strcmp(word, "bake") == 0, measures = strcmp(word, "tradeoff") == 0;
    const bool known = bakes || measures || strcmp(word, "render") == 0;
    if (good && !known) {
        complain("no command \"%s\" for many ranks, must be render, bake or tradeoff; vpl-mpi help explains "
                 "them",
                 word);
    }
    int code = good && known && parseArguments(count, words, &arguments) ? EXIT_DONE : EXIT_USAGE;
    code = largestNumber(r, code);
    if (code == EXIT_DONE && arguments.help) {
        fputs(r->rank == 0 ? USAGE : "", stdout);
        return EXIT_DONE;
    }
    if (code == EXIT_DONE && r->rank == 0) {
        code = (bakes ? checkBake : measures ? checkTradeoff : checkRender)(&arguments);
    }
    code = shareNumber(r, code);
    if (code != EXIT_DONE) {
        return code;
    }
    r->arguments = &arguments;
    if (r->rank == 0 || arguments.verbose) {
        setSpeaker(r->speaker);
    }
    arguments.quiet = arguments.quiet || r->rank > 0; // rank 0 warns for all
    if (arguments.verbose) {
        complain("process %ld", (long)getpid());
    }
    return measures ? measureTradeoff(r) : work(r, bakes);
}

int main(int count, char** words)
{
    Ranks ranks = {.rank = 0};
    int level;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); // a file that must not grow fails in write, and is reported
    guardJson();
    MPI_Init_thread(&count, &words, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks.count);
    snprintf(ranks.speaker, sizeof ranks.speaker, ranks.rank > 0 ? "vpl-mpi: rank %d" : "vpl-mpi",
             ranks.rank);
    setSpeaker(ranks.rank == 0 ? ranks.speaker : NULL);
    int code = run(&ranks, count, (const char**)words);
    code = ranks.rank == 0 ? finishOutput(code) : code;
    free(ranks.all);
    MPI_Finalize();
    return code;
}
