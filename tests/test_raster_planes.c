// SPDX-License-Identifier: MIT
// Values of fragments are those of the triangle's plane, also where snapping covers a pixel whose centre is
// outside of the triangle, so that surfaces of triangles smaller than texels do not shadow themselves.
#include "raster_support.h"
#include "shadow_maps.h"

#include "math/vec.h"

#include <stdlib.h>

enum { SIDE_PIXELS = 64, SMALL = 400 };

// A corner of a triangle on a picture of SIDE_PIXELS: pixels and distance along the axis.
typedef struct Corner {
    double x, y, w;
} Corner;

// Twice the area of the triangle, and of those that a point makes with its edges.
static double areas(const Corner c[3], double x, double y, double part[3])
{
    for (int i = 0; i < 3; i++) {
        const Corner *p = &c[(i + 1) % 3], *q = &c[(i + 2) % 3];
        part[i] = (q->x - p->x) * (y - p->y) - (q->y - p->y) * (x - p->x);
    }
    return part[0] + part[1] + part[2];
}

// The height of a triangle over its longest side.
static double heightOf(const Corner c[3])
{
    double part[3], longest = 0;
    for (int i = 0; i < 3; i++) {
        longest = fmax(longest, hypot(c[i].x - c[(i + 1) % 3].x, c[i].y - c[(i + 1) % 3].y));
    }
    return fabs(areas(c, 0, 0, part)) / longest;
}

// Makes SMALL triangles of 0.3 to 6 pixels with an edge beside a pixel's centre. `equal`: the corners of each
// are at one distance.
static ClipVertex* makeSmall(uint64_t seed, bool equal)
{
    ClipVertex* v = malloc(3 * SMALL * sizeof *v);
    for (int i = 0; i < SMALL; i++) {
        const uint64_t at = (uint64_t)i * 32;
        const double size = 0.3 * pow(20, uniformAt(seed, at)), along = uniformAt(seed, at + 1),
                     first = pow(10, 4 * uniformAt(seed, at + 2) - 2);
        Corner c[3];
        for (int j = 0; j < 3; j++) {
            const uint64_t own = at + 8 + 8 * (uint64_t)j;
            c[j] = (Corner){size * uniformAt(seed, own), size * uniformAt(seed, own + 1),
                            equal ? first : first * (1 + 2 * uniformAt(seed, own + 2))};
        }
        const double x = rint(56 * uniformAt(seed, at + 3)) + 4.5 + 0.004 * (uniformAt(seed, at + 4) - 0.5),
                     y = rint(56 * uniformAt(seed, at + 5)) + 4.5 + 0.004 * (uniformAt(seed, at + 6) - 0.5);
        const double edgeX = c[0].x + along * (c[1].x - c[0].x), edgeY = c[0].y + along * (c[1].y - c[0].y);
        for (int j = 0; j < 3; j++) {
            v[3 * i + j] =
                (ClipVertex){(float)(c[j].w * (2 * (c[j].x + x - edgeX) / SIDE_PIXELS - 1)),
                             (float)(c[j].w * (1 - 2 * (c[j].y + y - edgeY) / SIDE_PIXELS)),
                             0,
                             (float)c[j].w,
                             {(float)uniformAt(seed, at + 8 + 8 * (uint64_t)j + 3), (float)j, 7.3f}};
        }
    }
    return v;
}

// Compares the covered pixels of one triangle with its plane; returns how many have their centre outside.
static int checkTriangle(const Canvas* c, const ClipVertex v[3], int triangle)
{
    Corner corners[3];
    int outside = 0;
    for (int i = 0; i < 3; i++) {
        corners[i] = (Corner){((double)v[i].x / (double)v[i].w + 1) / 2 * SIDE_PIXELS,
                              (1 - (double)v[i].y / (double)v[i].w) / 2 * SIDE_PIXELS, (double)v[i].w};
    }
    for (int at = 0; at < SIDE_PIXELS * SIDE_PIXELS && heightOf(corners) > 0.2; at++) {
        double part[3], inverse = 0, value[2] = {0, 0}, spread = 0;
        if (c->planes[0][at] != 1 || c->planes[1][at] != (float)triangle) {
            continue;
        }
        const double area = areas(corners, at % SIDE_PIXELS + 0.5, at / SIDE_PIXELS + 0.5, part);
        for (int i = 0; i < 3; i++) {
            outside += part[i] / area < 0;
            inverse += part[i] / area / corners[i].w;
            spread = fmax(spread, fabs((double)v[i].varying[0] - (double)v[0].varying[0]));
        }
        for (int i = 0; i < 3; i++) {
            value[0] += part[i] / area / corners[i].w / inverse * (double)v[i].varying[0];
            value[1] += part[i] / area / corners[i].w / inverse * (double)v[i].varying[1];
        }
        // Corners in floats are off by 2e-7 of the picture, which is 1e-5 pixels.
        const double off = 3e-5 / heightOf(corners);
        assertNear((double)c->planes[2][at], value[0], off * (spread + 1), "varying", triangle);
        assertNear((double)c->planes[3][at], value[1], off * 3, "corner", triangle);
        assertNear((double)c->planes[4][at], (double)7.3f, 0, "constant", triangle);
        assertNear((double)c->planes[5][at] * inverse, 1, off, "w", triangle);
        if (corners[0].w == corners[1].w && corners[0].w == corners[2].w) {
            assertNear((double)c->planes[5][at], corners[0].w, 0, "equal w", triangle);
        }
    }
    return outside;
}

TEST(FragmentsLieOnThePlaneWhereverSnappingCoversThem, 1)
{
    int outside = 0;
    for (uint64_t seed = 0; seed < 40; seed++) {
        ClipVertex* v = makeSmall(4200 + seed, seed % 2 == 0);
        Canvas c = makeCanvas(SIDE_PIXELS, SIDE_PIXELS, 0);
        const vplPipeline p = showPipeline(v);
        drawList(context, &c, &p, NULL, 3 * SMALL, SMALL);
        for (int i = 0; i < SMALL; i++) {
            outside += checkTriangle(&c, v + 3 * i, i);
        }
        freeCanvas(&c);
        free(v);
    }
    assert_true(outside > 200);
}

// The direction of a texel's centre in a map of `size` texels a side.
static vplVec3 directionOf(int texel, int size)
{
    const vplCubeFrame f = vplCube_GetFrame(texel / (size * size));
    const float s = 2 * ((float)(texel % size) + 0.5f) / (float)size - 1,
                t = 1 - 2 * ((float)(texel / size % size) + 0.5f) / (float)size;
    return vplNormalize(vplAdd(f.forward, vplAdd(vplScale(s, f.right), vplScale(t, f.up))));
}

// A sphere of triangles as small as texels, or half as small, around the light.
TEST(ASphereLitFromItsCentreHasItsDistanceAndNoShadow, 2, SLOW)
{
    static const int sizes[] = {64, 128, 200};
    vplScene* scene = sceneOf(context, 0.5f);
    Shape sphere = icosphere(6);
    const double rotate[3] = {0.3, 1.1, 0.7};
    placeShape(&sphere, 3, rotate, vplVec(0.1f, -0.2f, 0.4f));
    addShape(scene, &sphere, false, NULL);
    freeShape(&sphere);
    vplGeometry* g = buildGeometry(scene);
    for (int k = 0; k < 3; k++) {
        const int size = sizes[k];
        vplCubeMapDef def = vplDefaultCubeMapDef();
        vplShadowDef soft = vplDefaultShadowDef();
        def.position = vplVec(0.1f, -0.2f, 0.4f);
        def.size = size;
        soft.pcfSamples = 1;
        vplCubeMap* map;
        vplShadow shadow;
        assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
        assert_int_equal(vplShadow_Create(map, &soft, &shadow), VPL_SUCCESS);
        for (int i = 0; i < 6 * size * size; i++) {
            vplHit hit;
            const vplRay ray = {def.position, directionOf(i, size), {0, 0}};
            assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
            assertNear((double)(map->texels[i] * map->farPlane), (double)hit.t, 1e-6 * (double)hit.t,
                       "distance", i);
            assertNear((double)vplShadow_Factor(&shadow, hit.position, vplNegate(g->normals[hit.triangle])),
                       0, 0, "shadow", i);
        }
        vplCubeMap_Destroy(map);
    }
    vplGeometry_Destroy(g);
}

// Makes a wall of 2 m around `middle`, in 512^2 squares that are smaller than a texel as seen from 3 m.
static vplGeometry* squares(vplContext* context, double turn, vplVec3 middle)
{
    enum { CELLS = 512 };
    vplScene* scene = sceneOf(context, 0.5f);
    Shape wall = {0};
    for (int i = 0; i < CELLS * CELLS; i++) {
        const float x = (float)(i % CELLS), y = (float)(i / CELLS), h = CELLS / 2, z = 0;
        const vplVec3 a = {x - h, y - h, z}, b = {x + 1 - h, y - h, z}, c = {x + 1 - h, y + 1 - h, z};
        addTriangle(&wall, a, b, c);
        addTriangle(&wall, a, c, vplVec(x - h, y + 1 - h, z));
    }
    const double rotate[3] = {0.31 * turn, 0.7 * turn, 1.3 * turn};
    placeShape(&wall, 2.0f / CELLS, rotate, middle);
    addShape(scene, &wall, false, NULL);
    freeShape(&wall);
    return buildGeometry(scene);
}

TEST(AWallOfSquaresSmallerThanTexelsDoesNotShadowItself, 2, SLOW)
{
    static const int sizes[] = {48, 100, 256};
    const vplVec3 middle = {0.1f, -0.2f, 0.4f};
    for (int turn = 0; turn < 2; turn++) {
        vplGeometry* g = squares(context, turn, middle);
        const vplVec3 n = g->normals[0],
                      from = vplAdd(vplAdd(middle, vplScale(3, n)), vplVec(0.013f, 0.021f, 0));
        for (int k = 0; k < 3; k++) {
            const int size = sizes[k];
            vplCubeMap* map = makeCubeMap(g, from, size);
            const vplShadow hard = exactShadow(map, 1, 0), soft = exactShadow(map, 16, -1);
            int hits = 0;
            for (int i = 0; i < 6 * size * size; i++) {
                vplHit hit;
                const vplRay ray = {from, directionOf(i, size), {0, 0}};
                if (vplGeometry_ClosestHit(g, &ray, &hit)) {
                    assertNear((double)vplShadow_Factor(&hard, hit.position, n), 0, 0, "hard shadow", i);
                    assertNear((double)vplShadow_Factor(&soft, hit.position, n), 0, 0, "soft shadow", i);
                    hits++;
                }
            }
            assert_true(hits > size * size / 12);
            vplCubeMap_Destroy(map);
        }
        vplGeometry_Destroy(g);
    }
}
