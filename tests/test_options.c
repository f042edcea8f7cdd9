// SPDX-License-Identifier: MIT
// Tests of the option table (vpl/options.def): defaults, checks, conversion from and to text, and the methods
// that use an option.
#include "test.h"

#include "render/options.h"

enum {
    OPTIONS_SIZE = offsetof(vplRenderOptions, problem)
}; // bytes of all fields but the problem and the cookie

typedef vplRenderOptions Options;

// Writes the i-th test value of an option, where neither of the first two is the default. Returns false if
// there are no more.
static bool sampleOf(const vplOption* option, int i, char text[64])
{
    static const char* const wide[] = {"0.25", "0.5", "0.1", "1e-05", "auto", "exact"};
    const char* choice = option->value;
    text[0] = 0;
    switch (option->kind) {
    case VPL_OPTION_INT:
        snprintf(text, 64, "%.0f",
                 i < 2 ? (i ? option->high : option->low) : option->low + (option->high > 1));
        return i < 3;
    case VPL_OPTION_SEED:
        snprintf(text, 64, "%s", i ? "18446744073709551615" : "1");
        return i < 2;
    case VPL_OPTION_SIZE:
        snprintf(text, 64, "%s", i ? "16384x1" : "3x5");
        return i < 2;
    case VPL_OPTION_FLOAT:
    case VPL_OPTION_DOUBLE:
        snprintf(text, 64, "%s", wide[i % 4]);
        return i < 4;
    case VPL_OPTION_INT_AUTO:
        snprintf(text, 64, i < 2 ? "%.0f" : "auto", i ? option->high : option->low);
        return i < 3;
    case VPL_OPTION_FLOAT_AUTO:
    case VPL_OPTION_BELOW_AUTO:
        snprintf(text, 64, "%s", wide[i % 5]);
        return i < 5;
    case VPL_OPTION_BIAS:
        snprintf(text, 64, "%s", wide[i % 6]);
        return i < 6;
    case VPL_OPTION_PART:
        return false;
    default:
        for (; i > 0 && choice != NULL; i--) {
            choice = strchr(choice, '|');
            choice = choice != NULL ? choice + 1 : NULL;
        }
        if (choice != NULL) {
            const int length = (int)strcspn(choice, "|:");
            snprintf(text, 64, "%.*s%s", length, choice, choice[length] == ':' ? ":7" : "");
        }
        return choice != NULL;
    }
}

static bool isAutomatic(const vplOption* option)
{
    return option->kind == VPL_OPTION_INT_AUTO || option->kind == VPL_OPTION_FLOAT_AUTO ||
           option->kind == VPL_OPTION_BELOW_AUTO || option->kind == VPL_OPTION_BIAS;
}

TEST_ALONE(EveryDefaultIsInItsRange)
{
    const Options options = vplDefaultRenderOptions();
    int count;
    const vplOption* table = vplGetOptions(&count);
    assert_true(count > 60);
    for (int i = 0; i < count; i++) {
        const double value = vplOption_GetNumber(&table[i], &options);
        if (!(value >= (double)(float)table[i].low && value <= table[i].high) &&
            !(isAutomatic(&table[i]) && value == (table[i].kind == VPL_OPTION_BELOW_AUTO ? -2 : -1))) {
            fail_msg("%s: %g is not in [%g, %g]", table[i].name, value, table[i].low, table[i].high);
        }
    }
}

TEST_ALONE(EveryRowHasItsOwnNameAndSaysWhatItIs)
{
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        assert_ptr_equal(vplFindOption(table[i].name), &table[i]); // finds the first option of that name
        assert_true(strlen(table[i].help) > 5 && strlen(table[i].group) > 2 && strlen(table[i].field) > 2);
        assert_true(table[i].kind == VPL_OPTION_PART || table[i].value[0] != 0);
        assert_true(table[i].users != 0);
    }
    assert_null(vplFindOption("particle"));
    assert_null(vplFindOption("--particles"));
}

TEST_ALONE(EveryValueThatIsSetIsReadBack)
{
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char wanted[64], text[64];
        for (int k = 0; sampleOf(&table[i], k, wanted); k++) {
            Options options = vplDefaultRenderOptions(), again = options;
            if (vplRenderOptions_Set(&options, table[i].name, wanted) != VPL_SUCCESS) {
                fail_msg("%s %s: %s", table[i].name, wanted, options.problem);
            }
            assert_int_equal(vplRenderOptions_Get(&options, table[i].name, text, sizeof text), VPL_SUCCESS);
            assert_string_equal(text, wanted);
            assert_int_equal(vplRenderOptions_Set(&again, table[i].name, text), VPL_SUCCESS);
            assert_memory_equal(&again, &options, OPTIONS_SIZE);
        }
    }
}

TEST_ALONE(EveryDefaultIsReadBack)
{
    const Options options = vplDefaultRenderOptions();
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char text[64];
        Options again = options;
        if (table[i].kind != VPL_OPTION_PART) {
            assert_int_equal(vplRenderOptions_Get(&options, table[i].name, text, sizeof text), VPL_SUCCESS);
            assert_int_equal(vplRenderOptions_Set(&again, table[i].name, text), VPL_SUCCESS);
            assert_memory_equal(&again, &options, OPTIONS_SIZE);
        }
    }
}

static bool isOther(const Options* options, size_t offset, size_t size)
{
    const Options usual = vplDefaultRenderOptions();
    return memcmp((const char*)options + offset, (const char*)&usual + offset, size) != 0;
}

// The first test values of each option change the field that the row names, and no other, but for presets.
TEST_ALONE(EveryOptionSetsItsOwnField)
{
#define VPL_OPTION_ROW(group, prefix, kind, type, member, default_, low, high, option, ...)                  \
    {option, #prefix #member, offsetof(Options, prefix member), sizeof(type)},
    static const struct {
        const char *name, *field;
        size_t offset, size;
    } rows[] = {
#include <vpl/options.def>
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const vplOption* option = vplFindOption(rows[i].name);
        char text[64];
        assert_non_null(option);
        assert_true(option->offset == rows[i].offset && strcmp(option->field, rows[i].field) == 0);
        for (int k = 0; k < 2 && sampleOf(option, k, text); k++) {
            Options options = vplDefaultRenderOptions();
            assert_int_equal(vplRenderOptions_Set(&options, option->name, text), VPL_SUCCESS);
            for (size_t j = 0; j < sizeof rows / sizeof *rows; j++) {
                const bool part =
                    rows[j].offset == offsetof(Options, output.height) && option->kind == VPL_OPTION_SIZE;
                if (j != i && !part && option->kind != VPL_OPTION_PRESET &&
                    isOther(&options, rows[j].offset, rows[j].size)) {
                    fail_msg("%s %s changes %s", option->name, text, rows[j].field);
                }
            }
        }
        bool changed = option->kind == VPL_OPTION_PART;
        for (int k = 0; !changed && sampleOf(option, k, text); k++) {
            Options options = vplDefaultRenderOptions();
            assert_int_equal(vplRenderOptions_Set(&options, option->name, text), VPL_SUCCESS);
            changed = isOther(&options, rows[i].offset, rows[i].size);
        }
        if (!changed) {
            fail_msg("%s does not change %s", option->name, rows[i].field);
        }
    }
}

// A few fields are checked by hand, so that the test does not depend on the table that it tests.
TEST_ALONE(NamesOfTheCommandLineMeanTheseFields)
{
    Options o = vplDefaultRenderOptions();
    static const char* const settings[][2] = {
        {"method", "keller"}, {"size", "640x360"},     {"particles", "200"},    {"reflectivity", "auto"},
        {"clusters", "5"},    {"light-map", "64"},     {"shadow-map", "32"},    {"bias", "exact"},
        {"spp", "9"},         {"patches", "77"},       {"budget", "12.5"},      {"show", "light:3"},
        {"seed", "42"},       {"pipeline", "batched"}, {"min-distance", "0.5"}, {"coherence", "off"}};
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        assert_int_equal(vplRenderOptions_Set(&o, settings[i][0], settings[i][1]), VPL_SUCCESS);
    }
    assert_true(o.method == VPL_METHOD_KELLER && o.output.width == 640 && o.output.height == 360);
    assert_true(o.particles.count == 200 && o.particles.reflectivity == -1 && o.ssvp.clusters == 5);
    assert_true(o.lights.mapSize == 64 && o.shadow.mapSize == 32 && o.shadow.bias == VPL_BIAS_OPTION_EXACT);
    assert_true(o.path.samples == 9 && o.radiosity.patches == 77 && o.stop.budgetMs == 12.5);
    assert_true(o.output.show == VPL_SHOW_LIGHT && o.output.showIndex == 3 && o.seed == 42);
    assert_true(o.pipeline.kind == VPL_ACCUMULATE_BATCHED && o.lights.minDistance == 0.5f);
    assert_true(o.sequence.coherence == VPL_COHERENCE_OFF);
}

// ---- bad values

static void assertOptionRefused(const char* name, const char* value)
{
    const Options before = vplDefaultRenderOptions();
    Options options = before;
    char quoted[80];
    snprintf(quoted, sizeof quoted, "%s is \"%.60s\"", name, value);
    const vplResult result = vplRenderOptions_Set(&options, name, value);
    assert_memory_equal(&options, &before, OPTIONS_SIZE);
    assert_true(options.cookie == before.cookie);
    if (result != VPL_INVALID_ARGUMENT || strstr(options.problem, quoted) != options.problem ||
        strlen(options.problem) < strlen(quoted) + 10) {
        fail_msg("%s \"%s\": %s", name, value, options.problem);
    }
    assert_int_equal(vplRenderOptions_Set(&options, "seed", "1"), VPL_SUCCESS); // valid: clears the problem
    assert_true(options.problem[0] == 0);
}

TEST_ALONE(NoOptionTakesNonsense)
{
    static const char* const nonsense[] = {"",    " ",    "x",     " 1",  "1 ", "1x",
                                           "nan", "-nan", "1e999", "--1", "|"};
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        for (size_t k = 0; k < sizeof nonsense / sizeof *nonsense && table[i].kind != VPL_OPTION_PART; k++) {
            assertOptionRefused(table[i].name, nonsense[k]);
        }
    }
}

TEST_ALONE(NoNumberBeyondItsRangeIsTaken)
{
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char text[64];
        const vplOptionKind kind = table[i].kind;
        const bool whole = kind == VPL_OPTION_INT;
        if (!whole && !isAutomatic(&table[i]) && kind != VPL_OPTION_FLOAT && kind != VPL_OPTION_DOUBLE) {
            continue;
        }
        snprintf(text, sizeof text, "%.17g",
                 whole ? table[i].low - 1 : table[i].low - 1e-9 * (1 + fabs(table[i].low)));
        assertOptionRefused(table[i].name, text);
        snprintf(text, sizeof text, "%.17g",
                 whole                           ? table[i].high + 1
                 : kind == VPL_OPTION_BELOW_AUTO ? table[i].high
                                                 : table[i].high * (1 + 1e-9));
        assertOptionRefused(table[i].name, text);
        assertOptionRefused(table[i].name, "99999999999999999999");
        assertOptionRefused(table[i].name, whole ? "1.5" : "inf");
    }
}

TEST_ALONE(BadValuesOfEachKindAreRefused)
{
    static const char* const bad[][2] = {{"seed", "-1"},
                                         {"seed", "18446744073709551616"},
                                         {"seed", "0x10"},
                                         {"size", "640"},
                                         {"size", "640x"},
                                         {"size", "0x480"},
                                         {"size", "640x16385"},
                                         {"size", "640x480x2"},
                                         {"size", "640x 480"},
                                         {"size", "640x+480"},
                                         {"size", "-640x480"},
                                         {"size", "640X480"},
                                         {"size", "99999999999x1"},
                                         {"method", "Keller"},
                                         {"method", "kelle"},
                                         {"method", "keller|ssvp"},
                                         {"method", "0"},
                                         {"show", "light"},
                                         {"show", "light:"},
                                         {"show", "light:-1"},
                                         {"show", "light:1x"},
                                         {"show", "light:99999999999"},
                                         {"show", "depth:1"},
                                         {"reflectivity", "1"},
                                         {"reflectivity", "-0.5"},
                                         {"reflectivity", "exact"},
                                         {"bias", "Auto"},
                                         {"min-distance", "-1"},
                                         {"w1", "auto"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assertOptionRefused(bad[i][0], bad[i][1]);
    }
}

TEST_ALONE(OptionsThatThereAreNotAreNamed)
{
    static const char* const names[] = {"", "particle", "Particles", "--particles", "height", "show-index"};
    const Options before = vplDefaultRenderOptions();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        Options options = before;
        char wanted[80], text[64] = "kept";
        snprintf(wanted, sizeof wanted, "there is no option \"%s\"", names[i]);
        assert_int_equal(vplRenderOptions_Set(&options, names[i], "1"), VPL_INVALID_ARGUMENT);
        assert_string_equal(options.problem, wanted);
        assert_memory_equal(&options, &before, OPTIONS_SIZE);
        assert_int_equal(vplRenderOptions_Get(&options, names[i], text, sizeof text), VPL_INVALID_ARGUMENT);
    }
}

TEST_ALONE(TextThatDoesNotFitIsRefused)
{
    Options options = plainOptions();
    options.path.samples = 64;
    char text[8];
    assert_int_equal(vplRenderOptions_Get(&options, "method", text, sizeof text), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplRenderOptions_Get(&options, "size", text, sizeof text), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplRenderOptions_Get(&options, "spp", text, 3), VPL_SUCCESS);
    assert_string_equal(text, "64");
}

// The check names every numeric field that is set below its range by hand.
TEST(FieldsOutOfTheirRangeAreNamedByTheCheck, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    int count;
    const vplOption* table = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        Options options = vplDefaultRenderOptions();
        char* field = (char*)&options + table[i].offset;
        const int whole = table[i].low > INT_MIN ? (int)table[i].low - 1 : 0;
        const float single = NAN;
        const double wide = NAN;
        char wanted[80];
        snprintf(wanted, sizeof wanted, "vplRenderOptions.%s is ", table[i].field);
        if (table[i].kind == VPL_OPTION_SEED) {
            continue;
        }
        if (table[i].kind == VPL_OPTION_DOUBLE || table[i].kind == VPL_OPTION_BELOW_AUTO) {
            memcpy(field, &wide, sizeof wide);
        } else if (table[i].kind == VPL_OPTION_INT_AUTO) {
            memcpy(field, &(int){-2}, sizeof(int));
        } else if (isAutomatic(&table[i]) || table[i].kind == VPL_OPTION_FLOAT) {
            memcpy(field, &single, sizeof single);
        } else {
            memcpy(field, &whole, sizeof whole);
        }
        assert_int_equal(vplCheckOptions(scene, &options), VPL_INVALID_ARGUMENT);
        const char* message = takeMessage();
        if (strstr(message, wanted) != message || strstr(message, "must be in [") == NULL) {
            fail_msg("%s: %s", table[i].name, message);
        }
    }
    const Options usual = vplDefaultRenderOptions();
    assert_int_equal(vplCheckOptions(scene, &usual), VPL_SUCCESS);
    Options other = usual; // a camera that the scene does not have
    other.output.camera = 1;
    assert_int_equal(vplCheckOptions(scene, &other), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "output.camera is 1, must be in [0, 0]"));
    vplImage* image = NULL;
    other = usual;
    other.cookie = 0;
    assert_int_equal(vplRender(scene, &other, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultRenderOptions"));
    other = usual;
    other.output.width = 0;
    assert_int_equal(vplRender(scene, &other, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "output.width is 0, must be in [1, 16384]"));
    assert_null(image);
    vplScene_Destroy(scene);
}

// ---- presets

// Each preset names a document's method, and all that it sets can be changed afterwards.
TEST_ALONE(PresetsAreTheDocumentsSettings)
{
    static const struct {
        const char* name;
        vplMethod method;
        vplAccumulation pipeline;
    } rows[] = {{"franchi-ferrante", VPL_METHOD_INSTANT_RADIOSITY, VPL_ACCUMULATE_MULTIPASS},
                {"keller-1997", VPL_METHOD_KELLER, VPL_ACCUMULATE_MULTIPASS},
                {"hemgren", VPL_METHOD_RADIOSITY, VPL_ACCUMULATE_USUAL},
                {"ssvp-2020", VPL_METHOD_SSVP, VPL_ACCUMULATE_INTERLEAVED}};
    for (int i = 0; i < 4; i++) {
        Options o = vplDefaultRenderOptions();
        char text[32];
        assert_int_equal(vplRenderOptions_Set(&o, "preset", rows[i].name), VPL_SUCCESS);
        assert_true(o.method == rows[i].method && o.pipeline.kind == rows[i].pipeline);
        assert_int_equal(o.output.antialias, 1);
        assert_int_equal(vplRenderOptions_Get(&o, "preset", text, sizeof text), VPL_SUCCESS);
        assert_string_equal(text, rows[i].name);
    }
    Options o = vplDefaultRenderOptions(), before = o;
    assert_int_equal(vplRenderOptions_Set(&o, "preset", "none"), VPL_SUCCESS);
    assert_memory_equal(&o, &before, OPTIONS_SIZE);
    assert_int_equal(vplRenderOptions_SetAll(&o, "--preset hemgren --patches 30 --seed x"),
                     VPL_INVALID_ARGUMENT);
    assert_true(o.radiosity.patches == 30 && o.radiosity.iterations == 100 &&
                strstr(o.problem, "seed is") != NULL);
}

// ---- the default

TEST(TheDefaultIsKellerSharedAndSmooth, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    static const struct {
        int width, particles, interleave;
    } rows[] = {{1280, -1, 16}, {256, -1, 8}, {1280, 1000, 8}, {1280, 2000, 16}};
    for (int i = 0; i < 4; i++) {
        Options o = vplDefaultRenderOptions();
        o.output.width = rows[i].width;
        o.output.height = rows[i].width * 9 / 16;
        o.particles.count = rows[i].particles;
        vplPlan* plan;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        const Options* p = &plan->options;
        assert_true(p->method == VPL_METHOD_KELLER && p->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED);
        assert_int_equal(p->particles.count, rows[i].particles < 0 ? 4000 : rows[i].particles);
        assert_int_equal(p->pipeline.interleave, rows[i].interleave);
        assert_int_equal(p->output.antialias, 8);
        assert_true(p->lights.compensation == VPL_COMPENSATION_RAYS && p->particles.reflectivity > 0.3);
        vplPlan_Destroy(plan);
    }
    Options documented = vplDefaultRenderOptions();
    documented.method = VPL_METHOD_INSTANT_RADIOSITY;
    vplPlan* plan;
    assert_int_equal(vplPlan_Create(scene, &documented, NULL, &plan), VPL_SUCCESS);
    assert_true(plan->options.particles.count == 10 && plan->options.particles.reflectivity == 0.5);
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
}

// ---- use

TEST_ALONE(MethodsUseTheseOptions)
{
    enum { IR = 1, DIRECT = 2, PATH = 4, KELLER = 8, SSVP = 16, RADIOSITY = 32, ALL = 63 };
    static const struct {
        const char* name;
        int users; // bits in the order of vplMethod
    } rows[] = {{"method", ALL},
                {"size", ALL},
                {"seed", ALL},
                {"camera", ALL},
                {"particles", IR | KELLER},
                {"placement", IR | KELLER},
                {"light-map", IR | KELLER | SSVP},
                {"compensation", IR | KELLER | SSVP},
                {"clusters", SSVP},
                {"paraboloid", SSVP},
                {"spp", PATH},
                {"pixel", PATH},
                {"patches", RADIOSITY},
                {"solver", RADIOSITY},
                {"coherence", SSVP | RADIOSITY},
                {"antialias", ALL & ~PATH},
                {"shadow-map", IR | DIRECT | KELLER | RADIOSITY},
                {"max-bounces", PATH | SSVP},
                {"passes", IR | KELLER | SSVP},
                {"grow-from", IR | KELLER},
                {"budget", ALL},
                {"max-error", ALL}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        for (int method = 0; method <= VPL_METHOD_RADIOSITY; method++) {
            Options options = vplDefaultRenderOptions();
            char reason[64] = "", value[32], wanted[64];
            options.method = (vplMethod)method;
            vplRenderOptions_Get(&options, "method", value, sizeof value);
            snprintf(wanted, sizeof wanted, "--method %s", value);
            const bool used = vplRenderOptions_IsUsed(&options, rows[i].name, reason, sizeof reason);
            if (used != ((rows[i].users >> method & 1) != 0) || (!used && strcmp(reason, wanted) != 0)) {
                fail_msg("%s with %s: %s", rows[i].name, wanted, used ? "used" : reason);
            }
        }
    }
}

TEST_ALONE(PipelinesUseTheseOptions)
{
    static const char* const names[] = {"batch", "interleave", "cut-error"};
    static const vplAccumulation users[] = {VPL_ACCUMULATE_BATCHED, VPL_ACCUMULATE_INTERLEAVED,
                                            VPL_ACCUMULATE_LIGHTCUTS};
    for (int i = 0; i < 3; i++) {
        for (int kind = 0; kind <= VPL_ACCUMULATE_USUAL; kind++) {
            Options options = plainOptions();
            char reason[64] = "";
            options.pipeline.kind = (vplAccumulation)kind;
            const bool used = vplRenderOptions_IsUsed(&options, names[i], reason, sizeof reason);
            assert_true(used == (kind == (int)users[i]));
            assert_true(used || strncmp(reason, "--pipeline ", 11) == 0);
        }
    }
    for (int i = 0; i < 3;
         i++) { // the usual pipeline is interleaved for ssvp, and for keller with many lights
        Options usual = vplDefaultRenderOptions();
        usual.method = i == 0 ? VPL_METHOD_SSVP : VPL_METHOD_KELLER;
        usual.particles.count = i == 2 ? 999 : -1;
        assert_true(vplRenderOptions_IsUsed(&usual, "interleave", NULL, 0) == (i < 2));
        assert_false(vplRenderOptions_IsUsed(&usual, "batch", NULL, 0));
    }
}
