// SPDX-License-Identifier: MIT
// Sides that the picture does not need: those that hardly any light reaches and that no viewpoint sees. Models of buildings
// have voids behind their walls, which small openings light a little, with as many sides as their rooms.
//
// The level of a side is the light that 64 rays from it meet, over the mean light of the sides that viewpoints see. A side
// reflects less light than it receives, so sides below a level L together add less than L to the level of any other side.
// Little is lost where all that viewpoints see is far above L.
#include "base/context.h"
#include "geometry/paint.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

enum {
    RAYS = 4,       // from each of 16 cells
    FEW = 4,        // nothing is left out unless one in FEW sides may be faint,
    GAIN = 8,       // one in GAIN sides is,
    DIM_SHARE = 50, // and at most one in DIM_SHARE of the area that viewpoints see is dim
};

// Levels of faint and dim sides, and the most that a ray meets: one particle on a small side is no spot of light.
static const float FAINT = 1 / 64.0f, DIM = 1 / 16.0f, BRIGHTEST = 4;

// Tests for a side that light reaches, but that no particle hit.
static bool mayBeFaint(const vplLitSearch* s, int side)
{
    return s->open[side] != 0 && s->hits[side] == 0;
}

// The same, once it is known what viewpoints see.
static bool isFaintIfDim(const vplLitSearch* s, int side)
{
    return mayBeFaint(s, side) && !s->isSeen[side];
}

// Tests whether a viewpoint sees one of 16 samples of an open side.
static void findSeen(const vplLitSearch* s, int side, int64_t* rays)
{
    for (int cell = 0; cell < VPL_PATCH_CELLS && s->open[side] != 0 && !s->isSeen[side]; cell++) {
        vplLitSample sample = {.side = side, .cell = cell};
        s->isSeen[side] =
            vplLitSample_Offset(s, &sample, rays) && vplLitSample_SeesViewpoint(s, &sample, rays) >= 0;
    }
}

// Particles per square metre of a side.
static float densityOf(const vplLitSearch* s, int side)
{
    return (float)s->hits[side] / (float)vplPatches_Area(s->patches, side / 2);
}

// Finds the level of a side. If no viewpoint sees the side, the sample whose rays meet most light becomes its lit point, because
// the lit point so far may be in a void.
static void findLevel(const vplLitSearch* s, int side, int64_t* rays)
{
    if (!mayBeFaint(s, side) && !s->isSeen[side]) {
        return;
    }
    float sum = 0, most = 0;
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        vplLitSample sample = {.side = side, .cell = cell};
        float met = 0;
        vplVec3 from = vplVec(0, 0, 0);
        for (int ray = 0; ray < RAYS && (ray > 0 || vplLitSample_Offset(s, &sample, rays)); ray++) {
            vplLitHit hit;
            if (vplLitSample_Trace(s, &sample, ray, rays, &hit)) {
                const vplRgb rho = vplReflectanceOfTriangle(s->geometry, hit.triangle);
                const float light = densityOf(s, hit.side) / s->seenDensity;
                met += vplMinf(light, BRIGHTEST) * (float)vplRgbMean(rho);
                from = light > 0 ? hit.point : from;
            }
        }
        sum += met;
        if (met > most && !s->isSeen[side]) {
            most = met;
            s->nextLitPoint[side] = vplLitSearch_MoveTowards(s, side / 2, sample.point, from);
        }
    }
    s->level[side] = sum / (RAYS * VPL_PATCH_CELLS);
}

// Particles per square metre of what viewpoints see; 0: they see nothing.
static float meanDensity(const vplLitSearch* s)
{
    double hits = 0, area = 0;
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        if (s->isSeen[side]) {
            hits += s->hits[side];
            area += vplPatches_Area(s->patches, side / 2);
        }
    }
    return area > 0 ? (float)hits / (float)area : 0;
}

static bool seesDimSides(const vplLitSearch* s)
{
    double dim = 0, all = 0;
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        const double area = s->isSeen[side] ? vplPatches_Area(s->patches, side / 2) : 0;
        dim += s->level[side] < DIM ? area : 0;
        all += area;
    }
    return dim * DIM_SHARE > all;
}

static bool isFaint(const vplLitSearch* s, int side)
{
    return isFaintIfDim(s, side) && s->level[side] < FAINT;
}

// Closes faint sides if there are enough of them.
static void closeFaint(vplLitSearch* s, int open)
{
    const int sides = 2 * s->patches->patchCount;
    int faint = 0;
    for (int side = 0; side < sides; side++) {
        faint += isFaint(s, side);
    }
    if ((int64_t)faint * GAIN < open) {
        return;
    }
    for (int side = 0; side < sides; side++) {
        if (isFaint(s, side)) {
            s->open[side] = 0;
        } else if (isFaintIfDim(s, side)) {
            s->litPoint[side] = s->nextLitPoint[side];
        }
        s->nextOpen[side] = s->open[side];
    }
    s->faintCount = faint;
}

vplResult vplLitSearch_LeaveFaint(vplLitSearch* s)
{
    const size_t sides = 2 * (size_t)s->patches->patchCount;
    const int pass = s->pass;
    int open = 0, may = 0, added;
    for (int side = 0; side < (int)sides; side++) {
        open += s->open[side] != 0;
        may += mayBeFaint(s, side);
    }
    if ((int64_t)may * FEW < open || s->emission->sourceCount == 0 || s->def->viewpointCount == 0) {
        return VPL_SUCCESS;
    }
    s->isSeen = vplArena_AllocZero(s->scratch, sides, sizeof *s->isSeen);
    s->level = vplArena_AllocZero(s->scratch, sides, sizeof *s->level);
    TRY(vplArena_Check(s->scratch));
    TRY(vplLitSearch_ForAllSides(s, findSeen, (const double[2]){0.7, 0.7}, &added));
    s->seenDensity = meanDensity(s);
    if (s->seenDensity > 0) {
        TRY(vplLitSearch_ForAllSides(s, findLevel, (const double[2]){0.7, 0.7}, &added));
    }
    if (s->seenDensity > 0 && !seesDimSides(s)) {
        closeFaint(s, open);
    }
    s->pass = pass; // later steps draw the same random numbers
    return VPL_SUCCESS;
}
