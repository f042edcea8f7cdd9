// SPDX-License-Identifier: MIT
// The help and the option sections of the man page: commands and both option tables, as text.
#include "cli/options.h"
#include "cli/tradeoff/tradeoff.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { WIDTH = 110, INDENT = 6, TEXT = 2048 };

// Options that vpl help render explains first; most pictures need no others.
static const char* const ESSENTIALS[] = {
    "method",        "preset",   "size",    "antialias", "camera",    "particles", "spp",  "patches",
    "light-shadows", "pipeline", "quality", "budget",    "max-error", "seed",      "show", "aov"};

const Command COMMANDS[] = {
    {"render", RENDER, 1, runRender, "vpl render SCENE -o FILE [options]", "renders a picture",
     "Renders SCENE and writes a picture. Files appear whole or not at all. SCENE is a scene file (.json), "
     "or a model (.obj, .ply, .stl, .gltf, .glb), which gets a camera that fits it, a ground and, if nothing "
     "emits, "
     "lamps, unless a glTF file has its own. A PNG file "
     "is "
     "exposed automatically and tone mapped unless --exposure and --tonemap say otherwise. As SCENE, - is "
     "standard "
     "input; as FILE, - is a PNG on standard output, and -.pfm, -.hdr or -.exr another format.",
     NULL},
    {"bake", BAKE, 1, runBake, "vpl bake SCENE -o FILE [options]",
     "writes the patches of radiosity as a mesh",
     "Finds the light of SCENE by --method radiosity and writes its patches as a binary PLY mesh with "
     "colours at the vertices: 8-bit sRGB of radiance (after --exposure), and linear radiosity in W/m^2 as "
     "properties r, g, b.",
     " size antialias supersample show aov interpolation "},
    {"lights", LIGHTS, 1, runLights, "vpl lights SCENE [options]", "lists the virtual lights",
     "Prints the virtual lights as CSV: index,step,px,py,pz,nx,ny,nz,r,g,b,weight. The index is the K of "
     "--show light:K. r,g,b is what the particle carries after attenuation (documented lighting) or the flux "
     "in watts that the surface sends out (physical); weight is N/floor(rho^k N). Pictures also divide by N.",
     " antialias supersample show aov pipeline batch interleave cut-error passes budget max-error "},
    {"compare", COMPARE, 2, runCompare, "vpl compare A B [options]",
     "measures how far picture A is from reference B",
     "Prints rmse, relative_rmse (rmse / mean of B), relmse (mean of (a-b)^2/(b+0.01)^2), trimmed_relmse "
     "(the same without the 0.1 % of the pixels where it is largest), psnr (dB), ssim and flip (all three of "
     "values clamped to [0, 1]; psnr and ssim sRGB-encoded), energy_ratio (sum of A / sum of B) and "
     "max_difference with its pixel. --regions adds a table of blocks.",
     NULL},
    {"merge", MERGE, MAX_POSITIONALS, runMerge, "vpl merge PART... -o FILE [options]",
     "puts the parts of a picture together",
     "Reads parts that vpl render --tile I/N wrote, in any order, and writes the picture, with the bits of "
     "one render. All "
     "parts must be there, and of one scene with the same options; they need not come from the same machine.",
     NULL},
    {"info", INFO, 1, runInfo, "vpl info SCENE [options]",
     "says what is in a scene, and what rendering it requires",
     "Prints counts, bounds, mean reflectance, and the plan of a render with the same options: decisions, "
     "stages, memory and the predicted time.",
     NULL},
    {"tradeoff", TRADEOFF, 1, runTradeoff, "vpl tradeoff SCENE -o DIR [options]",
     "measures error against time",
     "Renders SCENE with many settings and several seeds, compares each picture with a reference, and writes "
     "to DIR: report.html (which settings for 5 % error, and what do they cost? What is best within a "
     "second, and "
     "how good is the planner?), tradeoff.svg (the plot), "
     "tradeoff.csv (every figure), and the reference as reference-a.pfm and reference-b.pfm. Render options "
     "given here change the base that the sweeps start from: " TRADEOFF_BASE
     ". Physical lighting only: the documented formulas have no truth to compare with.",
     NULL},
    {"bench", BENCH, 0, runBench, "vpl bench [options]", "times every stage",
     "Times the stages on the built-in room: medians of the wall clock and of processor time, counts, "
     "hashes, and what several threads gain: stages under 85 % efficiency (1.7x on two threads) are marked. "
     "With --scaling, how time grows with lights, pixels, triangles, threads and the shadow map's size: "
     "exponents fitted over all points and over the upper half, and the part of the time that does not grow. "
     "With --calibrate, the speeds by which times are predicted, which are kept in libvpl/ of "
     "$XDG_CACHE_HOME "
     "or ~/.cache; the first render or info with --budget measures them, too. They change no picture. "
     "With --extremes, the error of every method at the ends of what scenes and options may be, against "
     "closed forms and against the same scene at home, with the sentences of what is refused.",
     NULL},
};

const int COMMAND_COUNT = sizeof COMMANDS / sizeof *COMMANDS;

const Command* findCommand(const char* name)
{
    for (int i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(COMMANDS[i].name, name) == 0) {
            return &COMMANDS[i];
        }
    }
    return NULL;
}

// ---- text

// Prints words from `column` on. Breaks lines at spaces and after "|"; further lines begin at `indent`.
static void printWrapped(const char* text, int column, int indent)
{
    bool space = false;
    while (*text != 0) {
        const int length = (int)strcspn(text, " |") + (text[strcspn(text, " |")] == '|');
        if (column + space + length > WIDTH) {
            printf("\n%*s", indent, "");
            column = indent;
            space = false;
        }
        printf("%s%.*s", space ? " " : "", length, text);
        column += space + length;
        space = text[length] == ' ';
        text += length + space;
    }
    putchar('\n');
}

// Adds the words of "a|b|c" whose bits are set, with commas between, in brackets.
static void appendWords(char* text, const char* open, const char* words, int bits, const char* close)
{
    for (int bit = 1; words != NULL; bit <<= 1) {
        if ((bits & bit) != 0) {
            sprintf(text + strlen(text), "%s%.*s", open, (int)strcspn(words, "|"), words);
            open = ", ";
        }
        words = strchr(words, '|');
        words = words != NULL ? words + 1 : NULL;
    }
    strcat(text, close);
}

// Adds the names of the sweeps, each once, in the order of the table.
static void appendSweeps(char text[TEXT])
{
    for (int i = 0; i < SWEEP_COUNT; i++) {
        if (i == 0 || strcmp(SWEEPS[i].name, SWEEPS[i - 1].name) != 0) {
            sprintf(text + strlen(text), "%s%s", i > 0 ? ", " : "; they are ", SWEEPS[i].name);
        }
    }
}

// Writes the help of an option, its default, and the methods, pipelines or commands that use it if not all
// do.
static void describeOption(const Option* o, bool commands, char text[TEXT])
{
    const vplRenderOptions defaults = vplDefaultRenderOptions();
    const int users = o->render != NULL ? o->render->users : VPL_USE_ALL;
    char value[64];
    snprintf(value, sizeof value, "%s", o->default_ != NULL ? o->default_ : "");
    if (o->render != NULL) {
        vplRenderOptions_Get(&defaults, o->name, value, sizeof value);
    }
    snprintf(text, TEXT, "%s%s%s", o->help, value[0] != 0 ? "; default " : "", value);
    if (strcmp(o->name, "sweeps") == 0) {
        appendSweeps(text);
    }
    if ((users & VPL_USE_ALL) != VPL_USE_ALL) {
        appendWords(text, " [", vplFindOption("method")->value, users, "]");
    }
    if (users >> 8 != 0) {
        appendWords(text, " [--pipeline ", vplFindOption("pipeline")->value, users >> 8, "]");
    }
    if (commands && o->render == NULL && o->commands != ~0) {
        appendWords(text, " (", "render|bake|lights|info|tradeoff|compare|bench|merge", o->commands, ")");
    }
}

// Prints text of a man page, in which a plain - is a hyphen and not a dash.
static void printManual(const char* text)
{
    for (; *text != 0; text++) {
        fputs(*text == '-' ? "\\-" : (char[]){*text, 0}, stdout);
    }
}

static void printOption(const Option* o, bool manual)
{
    char text[TEXT], line[TEXT];
    const char *dashes = dashesOf(o), *space = o->value != NULL ? " " : "",
               *value = o->value != NULL ? o->value : "";
    describeOption(o, manual, text);
    if (manual) {
        snprintf(line, sizeof line, o->value != NULL ? "%s%s \"%s%s\"" : "%s%s%s%s", dashes, o->name, space,
                 value);
        printf(".TP\n.BI ");
        printManual(line);
        putchar('\n');
        printManual(text);
        putchar('\n');
        return;
    }
    snprintf(line, sizeof line, "%s%s%s%s", dashes, o->name, space, value);
    printf("  ");
    printWrapped(line, 2, INDENT + 2 + (int)strlen(o->name));
    printf("%*s", INDENT, "");
    printWrapped(text, INDENT, INDENT);
}

// Prints the program's own options that any of the commands takes.
static void printOwn(int commands, bool manual)
{
    for (const Option* o = getOptions(); o->name != NULL; o++) {
        if (o->render == NULL && (o->commands & commands) != 0) {
            printOption(o, manual);
        }
    }
}

// ---- options of rendering, by subject

static bool contains(const char* text, const char* word)
{
    for (; *text != 0; text++) {
        if (strncasecmp(text, word, strlen(word)) == 0) {
            return true;
        }
    }
    return false;
}

// Prints the option named by the subject, or the options of all groups whose heading contains it (NULL: all
// groups), under their headings. Returns their number.
static int printSubject(const char* subject, bool manual)
{
    int printed = 0;
    const vplOption* named =
        subject != NULL ? vplFindOption(subject + 2 * (strncmp(subject, "--", 2) == 0)) : NULL;
    const char* group = "";
    for (const Option* option = getOptions(); option->name != NULL; option++) {
        const vplOption* o = option->render;
        if (o == NULL || (named != NULL && o != named) ||
            (named == NULL && subject != NULL && !contains(o->group, subject))) {
            continue;
        }
        if (strcmp(group, o->group) != 0) {
            printf(manual ? ".SS %s\n" : "\n%s\n", o->group);
            group = o->group;
        }
        printOption(option, manual);
        printed++;
    }
    return printed;
}

static void printEssentials(void)
{
    for (size_t k = 0; k < sizeof ESSENTIALS / sizeof *ESSENTIALS; k++) {
        for (const Option* o = getOptions(); o->name != NULL; o++) {
            if (o->render != NULL && strcmp(o->name, ESSENTIALS[k]) == 0) {
                printOption(o, false);
            }
        }
    }
}

// Prints the names of all options under their headings.
static void printSubjects(void)
{
    puts("\nAll options of rendering; vpl help options SUBJECT (or NAME) explains them:");
    for (const Option* o = getOptions(); o->name != NULL;) {
        char text[TEXT] = "";
        const char* group = o->render != NULL ? o->render->group : NULL;
        if (group == NULL) {
            o++;
            continue;
        }
        for (; o->name != NULL && strcmp(o->render->group, group) == 0; o++) {
            sprintf(text + strlen(text), "%s--%s", text[0] != 0 ? " " : "", o->name);
        }
        printf("  %s\n%*s", group, INDENT, "");
        printWrapped(text, INDENT, INDENT);
    }
}

// ---- topics

static void printCommand(const Command* c)
{
    printf("%s\n\n", c->usage);
    printWrapped(c->text, 0, 0);
    puts("\nOptions (--name VALUE or --name=VALUE):");
    if (c->bit == RENDER) {
        printEssentials();
    }
    printOwn(c->bit, false);
    if (c->bit == BENCH) {
        puts("  --size WxH\n      pixels; default 1920x1080, with --scaling 640x360");
    }
    if ((c->bit & ON_SCENES) != 0) {
        printSubjects();
    }
}

static void printOverview(void)
{
    printf("vpl %s - indirect light with many virtual lights, on the CPU, the same bits everywhere\n\n",
           vplGetVersion());
    for (int i = 0; i < COMMAND_COUNT; i++) {
        printf("  %-36s %s\n", COMMANDS[i].usage, COMMANDS[i].summary);
    }
    printf("  %-36s %s\n", "vpl help [command]", "explains a command and its options");
    printf("  %-36s %s\n", "vpl help options [subject]", "explains the options of rendering");
    printf("  %-36s %s\n", "vpl completion bash|zsh|fish",
           "prints completions for a shell, which it reads at its start");
    printf("  %-36s %s\n", "vpl --version", "prints the version");
    printf("\nExit codes: 0 done; 1 could not (disk, memory, cancelled); 2 wrong usage or bad input.\n");
}

bool printHelp(const char* topic, const char* subject)
{
    const Command* command = topic != NULL ? findCommand(topic) : NULL;
    if (topic == NULL) {
        printOverview();
    } else if (command != NULL) {
        printCommand(command);
    } else if (strcmp(topic, "--man") == 0) { // for vpl.1.in
        puts(".SS Files and running");
        printOwn(~0, true);
        printSubject(NULL, true);
    } else if (strcmp(topic, "options") != 0) {
        complain("no command \"%s\"; vpl help lists them", topic);
        return false;
    } else if (printSubject(subject, false) == 0) {
        complain("no option and no subject \"%s\"; vpl help render lists them", subject);
        return false;
    }
    return true;
}
