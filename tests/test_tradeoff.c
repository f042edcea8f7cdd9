// SPDX-License-Identifier: MIT
// Tests of the arithmetic of vpl tradeoff, of what its report says and shows, and of the PNG that it embeds.
#include "test.h"

#include "cli/tradeoff/svg.h"
#include "cli/tradeoff/tradeoff.h"

#include <stdlib.h>

TEST_ALONE(MedianIsTheMiddleOrTheMeanOfTwo)
{
    const double odd[] = {9, 1, 5}, even[] = {4, 1, 3, 2}, ties[] = {7, 7, 1, 7}, one[] = {3};
    assertNear(medianOf(odd, 3), 5, 0, "odd", 0);
    assertNear(medianOf(even, 4), 2.5, 0, "even", 0);
    assertNear(medianOf(ties, 4), 7, 0, "ties", 0);
    assertNear(medianOf(one, 1), 3, 0, "one", 0);
    assert_true(isnan(medianOf(one, 0)));
    assertNear(even[0], 4, 0, "stays as it was", 0);
}

TEST_ALONE(FrontHoldsWhatNothingBeats)
{
    // on front, dominated, on front, equal, on front, costlier, not measured
    const double cost[] = {1, 2, 2, 2, 5, 6, NAN}, error[] = {9, 9, 7, 7, 1, 1, NAN};
    int numbers[7];
    assert_int_equal(numberFront(cost, error, 7, 0, numbers), 3);
    const int wanted[] = {1, 0, 2, 0, 3, 0, 0};
    assert_memory_equal(numbers, wanted, sizeof wanted);
}

// Checks the definition on random cases: a point is on the front if and only if no other point is at least as
// good in both values and better in one, or equal and before it.
TEST_ALONE(FrontFollowsItsDefinition)
{
    enum { COUNT = 12 };
    for (uint64_t seed = 0; seed < 500; seed++) {
        double cost[COUNT], error[COUNT];
        int numbers[COUNT], marked = 0;
        for (int i = 0; i < COUNT; i++) { // few values, so that there are ties
            cost[i] = floor(6 * uniformAt(seed, 2 * (uint64_t)i));
            error[i] = 1 + floor(6 * uniformAt(seed, 2 * (uint64_t)i + 1));
        }
        int count = numberFront(cost, error, COUNT, 0, numbers);
        for (int i = 0; i < COUNT; i++) {
            bool beaten = false;
            for (int j = 0; j < COUNT; j++) {
                bool as = cost[j] <= cost[i] && error[j] <= error[i];
                beaten |= as && (cost[j] < cost[i] || error[j] < error[i] || j < i);
            }
            assert_int_equal(numbers[i] > 0, !beaten);
            marked += numbers[i] > 0;
        }
        assert_int_equal(count, marked);
    }
}

TEST_ALONE(TimesAreForeseenAlongALine)
{
    const double work[] = {1, 2, 10}, ms[] = {7, 9, 25};
    assertNear(alongLine(work, ms, 1, 3), 21, 1e-12, "one point: in proportion", 0);
    assertNear(alongLine(work, ms, 3, 6), 17, 1e-12, "between", 0);
    assertNear(alongLine(work, ms, 3, 20), 45, 1e-12, "beyond", 0);
    assertNear(alongLine(work, ms, 3, 2), 9, 1e-12, "at a point", 0);
    assert_true(alongLine(work, ms, 3, 0.5) <= 7);
    const double flat[] = {7, 7, 7}; // noise may hide the growth, but more work is never free
    assert_true(alongLine(work, flat, 3, 1000) > 7 * 10);
}

TEST_ALONE(ErrorsAreForeseenAlongAPower)
{
    const double amount[] = {1, 4, 16}, noise[] = {8, 4, 2}, level[] = {8, 6, 6.5}, steep[] = {900, 30, 1};
    assertNear(alongPower(amount, noise, 3, 64), 1, 1e-12, "beyond", 0);
    assertNear(alongPower(amount, noise, 3, 2), 8 / sqrt(2), 1e-12, "between", 0);
    assertNear(alongPower(amount, noise, 1, 4), 4, 1e-12, "one point: as noise", 0);
    assertNear(alongPower(amount + 1, noise + 1, 2, 64), 1, 1e-12, "a short span: as noise", 0);
    assert_true(alongPower(amount, level, 3, 64) > 5);
    assertNear(alongPower(amount, level, 3, 0.25), 16, 1e-12, "before the first: as noise", 0);
    assertNear(alongPower(amount, steep, 3, 160), pow(10, -0.7), 1e-12, "no faster than that", 0);
}

TEST_ALONE(LeastErrorWithinACost)
{
    const double cost[] = {1, 2, 3, NAN}, error[] = {5, 7, 4, 1};
    assertNear(leastWithin(cost, error, 4, 2), 5, 0, "two", 0);
    assertNear(leastWithin(cost, error, 4, 3), 4, 0, "three", 0);
    assert_true(isinf(leastWithin(cost, error, 4, 0.5)));
}

TEST_ALONE(ThinFrontLeavesOutSmallGains)
{
    const double cost[] = {1, 2, 3, 4}, error[] = {10, 9.8, 9.6, 5};
    int numbers[4];
    assert_int_equal(numberFront(cost, error, 4, 0.03, numbers), 3); // 9.8 is not 3 % below 10, 9.6 is
    assert_true(numbers[0] == 1 && numbers[1] == 0 && numbers[2] == 2 && numbers[3] == 3);
}

TEST_ALONE(CheapestWithinALimit)
{
    const double cost[] = {5, 3, 3, 1, 0}, error[] = {1, 2, 2, 9, NAN};
    assert_int_equal(cheapestWithin(cost, error, 5, 2), 1);
    assert_int_equal(cheapestWithin(cost, error, 5, 1), 0);
    assert_int_equal(cheapestWithin(cost, error, 5, 100), 3);
    assert_int_equal(cheapestWithin(cost, error, 5, 0.5), -1);
}

TEST_ALONE(HalvingTwiceCostsHalfTheDifference)
{
    assertNear(costPerHalving(10, 0.8, 40, 0.2), 15, 1e-12, "two halvings for 30", 0);
    assertNear(costPerHalving(10, 0.4, 4, 0.2), -6, 1e-12, "less error and less time", 0);
    assert_true(isinf(costPerHalving(10, 0.2, 40, 0.2)));
    assert_true(isinf(costPerHalving(10, 0.2, 40, 0.3)));
    assertNear(costPerHalving(10, 0.2, 40, 0), 0, 0, "no error left", 0);
}

TEST_ALONE(FloorShowsWhereWorkNoLongerHelps)
{
    const double work[] = {10, 30, 100, 300}, falling[] = {40, 23, 13, 7.3}, biased[] = {40, 14, 12.5, 12.1};
    assert_true(isnan(floorOf(work, falling, 4)));
    assertNear(floorOf(work, biased, 4), 12.1, 0, "floor", 0);
    const double close[] = {10, 30, 100, 110}; // 12.1 is compared with 40, which is far above
    assert_true(isnan(floorOf(close, biased, 4)));
    assert_true(isnan(floorOf(work, biased, 1)));
}

TEST_ALONE(JointSquareIsFreeOfTheReferencesNoise)
{
    enum { COUNT = 100000 };
    static float x[COUNT], a[COUNT], b[COUNT];
    for (uint64_t i = 0; i < COUNT; i++) { // the truth is 1; the halves have noise of deviation 0.5
        double spread = 0.5 * sqrt(12);
        a[i] = (float)(1 + spread * (uniformAt(1, i) - 0.5));
        b[i] = (float)(1 + spread * (uniformAt(2, i) - 0.5));
        x[i] = i % 2 ? 1.1f : 0.9f;
    }
    double uncertainty = jointUncertainty(a, b, COUNT);
    // Each variance v is 0.25: a'b' has deviation 0.25, their mean 0.25 / sqrt(n). Uniform noise has lighter
    // tails than normal noise; its (a' - b')^4 averages 9.6 v^2.
    assertNear(uncertainty, 0.25 * sqrt(9.6 / 12) / sqrt(COUNT), 0.02 * uncertainty, "uncertainty", 0);
    assertNear(jointSquare(x, a, b, COUNT), 0.01, 3 * uncertainty, "mean squared error", 0);
    assertNear(jointSquare(a, a, b, COUNT), 0, 3 * uncertainty, "a judged by itself and b", 0);
}

TEST_ALONE(AxesHoldAllValues)
{
    double low, high, ticks[8];
    const double values[] = {0, 3, 40, NAN, -1, INFINITY};
    assert_true(logRange(values, 6, &low, &high));
    assert_true(low < 3 && high > 40 && high / low >= 10);
    const double one[] = {7};
    assert_true(logRange(one, 1, &low, &high));
    assertNear(high / low, 10, 1e-9, "one decade at least", 0);
    assert_false(logRange(values, 1, &low, &high));
    assert_int_equal(logTicks(0.9, 55, ticks, 8), 6); // 1 2 5 10 20 50
    assertNear(ticks[0] + ticks[5], 51, 1e-12, "first and last", 0);
    assert_int_equal(logTicks(0.5, 2e5, ticks, 8), 6); // 1 to 100000
}

TEST_ALONE(TimesAndSharesReadWell)
{
    static const struct {
        double ms;
        const char* text;
    } times[] = {{0.834, "0.83 ms"}, {4.26, "4.3 ms"},  {999.4, "999 ms"},
                 {1240, "1.24 s"},   {12400, "12.4 s"}, {200000, "3 min 20 s"}};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        assert_string_equal(formatTime(times[i].ms).text, times[i].text);
    }
    assert_string_equal(formatPercent(0.0083).text, "0.83 %");
    assert_string_equal(formatPercent(0.142).text, "14.2 %");
    assert_string_equal(formatPercent(0.9994).text, "99.9 %");
    assert_string_equal(formatPercent(0.9995).text, "100 %");
    assert_string_equal(formatPercent(1.3).text, "130 %");
}

// ---- the report

// Settings with given errors, each ten times as dear as the one before.
static Tradeoff* measured(Family family, const double* error, int count)
{
    static Arguments arguments = {.positionals = {"room.json"}};
    static Tradeoff t;
    memset(&t, 0, sizeof t);
    t.arguments = &arguments;
    t.settingCount = count;
    double ms = 1;
    for (int i = 0; i < count; i++, ms *= 10) {
        Setting* s = &t.settings[i];
        s->family = family;
        s->sweeps[family - FAMILY_UNSHADOWED] = true; // of the numbers of particles
        s->work = s->cpuMs = s->cpuLow = s->cpuHigh = ms;
        s->error = s->errorLow = s->errorHigh = error[i];
        s->runCount = 1;
    }
    return &t;
}

// Lights that shine through walls settle on a wrong answer; with shadows, it is the clamp and the maps that are left.
TEST_ALONE(TheReportSaysWhyMoreLightsDoNotHelp)
{
    static const struct {
        Family family;
        double error[4];
        const char* sentence;
    } rows[] = {{FAMILY_UNSHADOWED,
                 {0.5, 0.32, 0.3, 0.3},
                 "Virtual lights without shadows stop getting better at about <strong>30.0 %</strong>, "
                 "however many there are: they shine through walls"},
                {FAMILY_MAP,
                 {0.5, 0.1, 0.05, 0.05},
                 "Virtual lights with shadow maps stop getting better at about <strong>5.0 %</strong>, "
                 "however many there are: what is left is the clamp near lights and the resolution of the "
                 "shadow maps"},
                {FAMILY_RAY, {0.5, 0.15, 0.05, 0.015}, NULL}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        Text html = {0};
        addAnswers(measured(rows[i].family, rows[i].error, 4), &html);
        assert_non_null(html.bytes);
        assert_true(rows[i].sentence != NULL ? strstr(html.bytes, rows[i].sentence) != NULL
                                             : strstr(html.bytes, "stop getting better") == NULL);
        free(html.bytes);
    }
}

// Equal factors are equal distances, of errors as of times.
TEST_ALONE(ThePlotIsLogarithmicInBothDirections)
{
    static const double error[3] = {0.9, 0.09, 0.009};
    Text svg = {0};
    double x[3], y[3];
    writePlot(measured(FAMILY_MAP, error, 3), &svg);
    assert_non_null(svg.bytes);
    const char* at = svg.bytes;
    for (int i = 0; i < 3; i++) {
        at = strstr(at, "<g><title>"); // of a point
        assert_non_null(at);
        at = strstr(at, "translate(");
        assert_int_equal(sscanf(at, "translate(%lf %lf)", &x[i], &y[i]), 2);
    }
    free(svg.bytes);
    assert_true(x[1] - x[0] > 50 && y[1] - y[0] > 50);
    assertNear(x[2] - x[1], x[1] - x[0], 0.2, "times", 0);
    assertNear(y[2] - y[1], y[1] - y[0], 0.2, "errors", 0);
}

// Counts the grid lines of the panel of energies, for two settings of other clamp distances.
static int countEnergyLines(double low, double high)
{
    Run runs[2] = {{.stats = {.minDistance = 0.1}}, {.stats = {.minDistance = 0.2}}};
    Tradeoff* t = measured(FAMILY_MAP, (const double[]){0.1, 0.2}, 2);
    Text html = {0};
    int lines = 0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < SWEEP_COUNT; k++) {
            t->settings[i].sweeps[k] = strcmp(SWEEPS[k].name, "min-distance") == 0;
        }
        t->settings[i].energy = i == 0 ? low : high;
        t->settings[i].runs = &runs[i];
    }
    addClamp(t, &html);
    assert_non_null(html.bytes);
    for (const char* at = strstr(html.bytes, ">energy: "); at != NULL;
         at = strstr(at + 1, "class=\"grid\"")) {
        lines++;
    }
    free(html.bytes);
    return lines - 1;
}

// The number of lines does not depend on how much the energies differ.
TEST_ALONE(ThePlotOfTheClampHasTwoToEightGridLines)
{
    static const double energies[][2] = {{0.99, 1}, {0.9, 0.97}, {0.6, 0.95}, {0.2, 1.1}, {1, 1.5}, {0.5, 4}};
    for (size_t i = 0; i < sizeof energies / sizeof *energies; i++) {
        assert_in_range(countEnergyLines(energies[i][0], energies[i][1]), 2, 8);
    }
}

// Whole stops with which nine in ten of the lit values of the truth are at most 0.8.
TEST(PicturesOfTheReportAreAsBrightAsTheTruthAllows, 1)
{
    static const struct {
        float most, few; // values of nine lit pixels in ten, and of the others
        const char* exposure;
    } rows[] = {{0.3f, 0.3f, "exposure +1 stops"},
                {0.39f, 3, "exposure +1 stops"},
                {0.09f, 0.01f, "exposure +3 stops"},
                {3, 100, "exposure -2 stops"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        Tradeoff* t = measured(FAMILY_MAP, NULL, 0);
        Text html = {0};
        assert_int_equal(vplImage_Create(context, 10, 4, &t->reference.image), VPL_SUCCESS);
        for (int k = 0; k < 60; k++) { // the lower half is black
            t->reference.image->pixels[k] = k / 3 % 10 == 0 ? rows[i].few : rows[i].most;
        }
        addPictures(t, &html);
        assert_non_null(html.bytes);
        assert_non_null(strstr(html.bytes, rows[i].exposure));
        free(html.bytes);
        vplImage_Destroy(t->reference.image);
    }
}

TEST(EncodedPngIsTheFileThatWouldBeWritten, 1)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 5, 3, &image), VPL_SUCCESS);
    for (int i = 0; i < 45; i++) {
        image->pixels[i] = (float)i / 44;
    }
    uint8_t* bytes = NULL;
    size_t size = 0;
    const char* path = temporaryName(".png");
    assert_int_equal(vplImage_Encode(image, ".png", NULL, &bytes, &size), VPL_SUCCESS);
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    static uint8_t file[4096];
    FILE* opened = fopen(path, "rb");
    assert_non_null(opened);
    assert_int_equal(fread(file, 1, sizeof file, opened), size);
    fclose(opened);
    remove(path);
    assert_memory_equal(file, bytes, size);
    vplBytes_Free(context, bytes);
    image->pixels[7] = NAN;
    assert_int_equal(vplImage_Encode(image, ".png", NULL, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "pixel (2, 0) channel 1"));
    vplImage_Destroy(image);
}

// Three names are in a row of 20 pixels, and half a row is below.
TEST_ALONE(LegendsAreAsHighAsTheirRows)
{
    bool present[FAMILY_COUNT] = {false};
    for (int count = 1; count <= FAMILY_COUNT; count++) {
        present[count - 1] = true;
        assert_int_equal(heightOfLegend(present), (count + 2) / 3 * 20 + 10);
    }
}

TEST_ALONE(SettingsAreOfTheirSweepsOnly)
{
    const Setting none = {.sweeps = {false}};
    assert_false(isOfSweep(&none, "frontier"));
    assert_false(isOfSweep(&none, "path"));
}
