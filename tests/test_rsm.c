// SPDX-License-Identifier: MIT
// Tests of reflective shadow maps: they contain all the light, at the points where it arrives.
#include "shapes.h"

#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "render/stages/show.h"

static size_t texelsOf(const vplReflectiveMap* map)
{
    return (size_t)map->faceCount * (size_t)map->size * (size_t)map->size;
}

static double fluxOf(const vplReflectiveMap* map, const vplGeometry* g)
{
    double sum = 0;
    for (size_t i = 0; i < texelsOf(map); i++) {
        vplReflectiveTexel texel;
        sum += vplReflectiveMap_GetTexel(map, g, (int64_t)i, &texel) ? (double)texel.flux.g : 0;
    }
    return sum;
}

static vplEmitterDef emitterOf(vplEmitterType type, vplVec3 position, vplVec3 direction)
{
    vplEmitterDef e = vplDefaultEmitterDef();
    e.type = type;
    e.position = position;
    e.direction = direction;
    e.intensity = (vplRgb){1, 2, 3};
    return e;
}

// One texel per face is enough, because texels' solid angles are exact.
TEST(APointInAClosedCubeSends4PiI, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const vplEmitterDef e = emitterOf(VPL_EMITTER_POINT, vplVec(0.3f, -0.2f, 0.55f), vplVec(0, -1, 0));
    for (int size = 1; size <= 130; size += 1 + size / 2) {
        vplReflectiveMap* map = mapOf(cube, &e, size);
        assert_int_equal(map->faceCount, 6);
        assertNear(fluxOf(map, cube), 8 * VPL_PI, 1e-5, "flux", size);
        for (size_t i = 0; i < texelsOf(map); i++) { // a cube map's corner texels have the smallest angle
            vplReflectiveTexel texel;
            assert_true(vplReflectiveMap_GetTexel(map, cube, (int64_t)i, &texel));
            const double share = (double)texel.flux.g * size * size / (8 * VPL_PI / 6);
            assert_true(share > 0.36 && share < 1.92);
            assert_true(texel.albedo.b == 0.5f && texel.triangle == map->triangle[i]);
        }
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(cube);
}

// The falloff is evaluated at texel centres: the error decreases with the number of texels.
TEST(ASpotSendsItsPower, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplEmitterDef e = emitterOf(VPL_EMITTER_SPOT, vplVec(0.1f, 0.4f, -0.3f), vplVec(0.3f, -1, 0.2f));
    for (int k = 0; k < 3; k++) {
        e.innerAngle = k == 0 ? 0.2 : k == 1 ? 0.9 : 0;
        e.outerAngle = k == 0 ? 0.5 : k == 1 ? 1.3 : 0.02;
        const double wanted = 2 * vplSpot_SolidAngle(&e);
        for (int size = 16; size <= 256; size *= 4) {
            vplReflectiveMap* map = mapOf(cube, &e, size);
            assert_int_equal(map->faceCount, 1);
            assertNear(fluxOf(map, cube) / wanted, 1, 1.0 / size / size + 1e-6, "flux", size);
            vplReflectiveMap_Destroy(map);
        }
    }
    vplGeometry_Destroy(cube);
}

// The flux is E times the projected area.
TEST(TheSunSendsWhatTheFloorMeets, 2)
{
    vplGeometry* floor = floorQuad(context, vplVec(100, 3, -50), 10, 0.5f);
    for (int size = 1; size <= 256; size *= 4) {
        vplEmitterDef e = emitterOf(VPL_EMITTER_DIRECTIONAL, vplVec(0, 0, 0), vplVec(0, -2, 0));
        vplReflectiveMap* map = mapOf(floor, &e, size);
        assertNear(fluxOf(map, floor), 200, 0.01, "flux", size); // the view is 2^-16 wider on each side
        vplReflectiveMap_Destroy(map);
        e.direction = vplVec(1, -1, 1); // a rhombus in a rectangle: texels at its edges are in or out
        map = mapOf(floor, &e, size);
        if (size >= 16) {
            assertNear(fluxOf(map, floor) / (200 / sqrt(3)), 1, 1.0 / size, "slanted flux", size);
        }
        vplReflectiveMap_Destroy(map);
    }
    vplEmitterDef along = emitterOf(VPL_EMITTER_DIRECTIONAL, vplVec(0, 0, 0), vplVec(1, 0, 0));
    vplReflectiveMap* map = mapOf(floor, &along, 16); // edge-on
    assertNear(fluxOf(map, floor), 0, 0.01, "flux", 0);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(floor);
}

static vplEmitterDef someEmitter(int k)
{
    vplEmitterDef e = emitterOf((vplEmitterType)k, vplVec(0.4f, 4.1f, 1.2f), vplVec(-0.3f, -1, -0.2f));
    e.outerAngle = 1.1;
    return e;
}

// Each texel's point lies in its triangle's plane, in the direction of the texel's centre, and is the first
// hit of a ray; its normal faces the emitter.
TEST(TexelsAreWhereRaysLand, 2)
{
    enum { SIZE = 40 };
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, SIZE);
        int filled = 0, other = 0;
        for (size_t i = 0; i < texelsOf(map); i++) {
            vplHit hit, met;
            vplVec3 way;
            vplReflectiveTexel texel;
            const bool seen = vplReflectiveMap_GetHit(map, room, (int64_t)i, &hit, &way);
            assert_true(seen == vplReflectiveMap_GetTexel(map, room, (int64_t)i, &texel));
            if (!seen) {
                assert_true(map->triangle[i] == -1 && map->depth[i] == INFINITY);
                continue;
            }
            const vplVec3 at = texel.position, normal = texel.normal;
            const vplVec3 corner = vplGeometry_Corners(room, map->triangle[i]).corner[0];
            const size_t face = i / SIZE / SIZE;
            const float depth = vplDot(vplSub(at, map->origin), map->forward[face]);
            assertNear((double)vplDot(vplSub(at, corner), hit.normal), 0, 4e-6, "plane", (int)i);
            assertNear((double)(depth - map->depth[i] * map->unit), 0, 0.01, "drawn depth", (int)i);
            assert_true(vplDot(normal, way) <= 0 && fabsf(vplLength(normal) - 1) < 1e-6f);
            const bool sun = k == VPL_EMITTER_DIRECTIONAL;
            const vplRay ray = {sun ? vplSub(at, vplScale(texel.distance + 1, way)) : e.position,
                                sun ? way : vplNormalize(vplSub(at, e.position)),
                                {0, 0}};
            assert_int_equal(vplReflectiveMap_Find(map, &ray), (int64_t)i);
            filled++;
            assert_true(vplGeometry_ClosestHit(room, &ray, &met));
            other += met.object != hit.object || // quads and boxes: an edge between triangles does not count
                     fabsf(met.t - texel.distance - (sun ? 1.0f : 0.0f)) > 1e-5f;
        }
        assert_true(filled > SIZE * SIZE / 2);
        assert_true(other <= filled / 500); // texels whose centre lies on an edge
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(room);
}

// Particles from a map are those traced by rays, moved by at most a texel's footprint as seen from the
// emitter.
TEST(ParticlesMoveByATexelAtMost, 2)
{
    enum { SIZE = 64, COUNT = 3000 };
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        for (int keller = 0; keller < 2; keller++) {
            const vplEmitterDef e = someEmitter(k);
            vplReflectiveMap* map = mapOf(room, &e, SIZE);
            const vplReflectiveMap* const maps[] = {map};
            vplParticleDef def = vplDefaultParticleDef();
            vplLightSet *cast, *lookedUp;
            def.particleCount = COUNT;
            def.start = keller ? VPL_START_EMITTER : VPL_START_FIRST_HIT;
            assert_int_equal(vplSimulateParticles(room, &e, 1, &def, &cast), VPL_SUCCESS);
            def.maps = maps;
            assert_int_equal(vplSimulateParticles(room, &e, 1, &def, &lookedUp), VPL_SUCCESS);
            assert_true(lookedUp->rays < cast->rays - cast->stepCounts[keller] / 2);
            int compared = 0;
            for (int i = 0, j = 0; i < cast->lightCount && j < lookedUp->lightCount;) {
                const vplVirtualLight *a = &cast->lights[i], *b = &lookedUp->lights[j];
                if (a->step != b->step || a->particle != b->particle) {
                    *(a->step < b->step || (a->step == b->step && a->particle < b->particle) ? &i : &j) += 1;
                    continue;
                }
                i++;
                j++;
                if (a->step != keller || a->object != b->object) {
                    continue;
                }
                vplVec3 apart = vplSub(a->position, b->position);
                double most = 1.01 * 2 * hypot(map->extent[0], map->extent[1]) / SIZE / 2;
                if (k == VPL_EMITTER_DIRECTIONAL) {
                    const vplVec3 n = map->forward[0];
                    apart = vplSub(apart, vplScale(vplDot(apart, n), n));
                } else {
                    apart = vplSub(vplNormalize(vplSub(a->position, e.position)),
                                   vplNormalize(vplSub(b->position, e.position)));
                }
                assertNear((double)vplLength(apart), 0, most, "distance", a->particle);
                assert_true(a->light.r == b->light.r && a->weight == b->weight);
                compared++;
            }
            assert_true(compared > cast->lightsInStep[keller] * 9 / 10);
            vplLightSet_Destroy(cast);
            vplLightSet_Destroy(lookedUp);
            vplReflectiveMap_Destroy(map);
        }
    }
    vplGeometry_Destroy(room);
}

// On a smooth sphere, the map's normals are the sphere's, facing the emitter, and so are the particles'
// shading normals.
TEST(SmoothObjectsHaveTheirNormals, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape ball = icosphere(2);
    addShape(scene, &ball, true, NULL);
    vplGeometry* geometry = buildGeometry(scene);
    const vplEmitterDef e = emitterOf(VPL_EMITTER_POINT, vplVec(1.5f, 0.5f, 0), vplVec(0, -1, 0));
    vplReflectiveMap* map = mapOf(geometry, &e, 50);
    int seen = 0;
    for (size_t i = 0; i < texelsOf(map); i++) {
        vplReflectiveTexel texel;
        if (vplReflectiveMap_GetTexel(map, geometry, (int64_t)i, &texel)) {
            assert_true(vplDot(vplNormalize(texel.position), texel.normal) > 0.999f);
            seen++;
        }
    }
    assert_true(seen > 500);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(geometry);
    freeShape(&ball);
}

TEST(AnEmptySceneGivesAnEmptyMap, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplGeometry* nothing;
    assert_int_equal(vplGeometry_Create(scene, &nothing), VPL_SUCCESS);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(nothing, &e, 5);
        for (size_t i = 0; i < texelsOf(map); i++) {
            assert_true(map->triangle[i] == -1 && map->depth[i] == INFINITY);
        }
        assert_true(fluxOf(map, nothing) == 0);
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(nothing);
    vplScene_Destroy(scene);
}

// An emitter lies on a wall of a closed cube, or slightly in front of it: at most all and at least half of
// its power arrives, and everything is finite.
TEST(AnEmitterMayTouchASurface, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const float heights[] = {-1, -0.9999999f, -0.999f};
    for (int i = 0; i < 3; i++) {
        const vplEmitterDef e =
            emitterOf(VPL_EMITTER_POINT, vplVec(0.1f, heights[i], 0.2f), vplVec(0, -1, 0));
        vplReflectiveMap* map = mapOf(cube, &e, 32);
        const double share = fluxOf(map, cube) / (8 * VPL_PI);
        assert_true(share >= 0.5 - 1e-6 && share <= 1 + 1e-6);
        for (size_t k = 0; k < texelsOf(map); k++) {
            vplReflectiveTexel texel;
            assert_true(!vplReflectiveMap_GetTexel(map, cube, (int64_t)k, &texel) ||
                        (vplIsFiniteVec(texel.position) && vplIsFiniteVec(texel.normal) &&
                         isfinite(texel.flux.g) && texel.distance >= 0 && isfinite(texel.distance)));
            assert_true(map->depth[k] >= 0);
        }
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(cube);
}

static uint64_t folded(uint64_t hash, const void* numbers, size_t bytes)
{
    for (size_t i = 0; i < bytes; i += sizeof(uint32_t)) {
        uint32_t bits;
        memcpy(&bits, (const char*)numbers + i, sizeof bits);
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
    }
    return hash;
}

TEST_ALONE(MapsDoNotDependOnThreadsOrIsa)
{
    for (int k = 0; k < 3; k++) {
        uint64_t wanted = 0;
        for (int i = 0; i < 8; i++) {
            const int workers[] = {1, 2, 3, 7};
            vplContext* context =
                i < 4 ? openTestContext(workers[i]) : openIsaContext(2, (vplIsa)(VPL_ISA_SCALAR + i - 4));
            if (context == NULL) {
                continue;
            }
            vplGeometry* room = tableRoom(context);
            const vplEmitterDef e = someEmitter(k);
            vplReflectiveMap* map = mapOf(room, &e, 77);
            uint64_t hash = 0;
            for (size_t t = 0; t < texelsOf(map); t++) {
                vplReflectiveTexel texel = {0};
                vplReflectiveMap_GetTexel(map, room, (int64_t)t, &texel);
                hash = folded(hash, &map->depth[t], sizeof(float));
                hash = folded(hash, &map->triangle[t], sizeof(int32_t));
                hash = folded(hash, &texel, sizeof texel);
            }
            hash = folded(hash, &map->unit, sizeof map->unit);
            wanted = i == 0 ? hash : wanted;
            assert_true(hash == wanted);
            vplReflectiveMap_Destroy(map);
            vplGeometry_Destroy(room);
            closeTestContext(context);
        }
    }
}

// The picture shows four parts side by side, for a point light a cross each, with each texel in its place.
TEST(ShownMapsHaveFourParts, 2)
{
    enum { SIZE = 24 };
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, SIZE);
        vplImage* image;
        assert_int_equal(vplShowReflectiveMap(map, room, &image), VPL_SUCCESS);
        const bool cross = k == VPL_EMITTER_POINT;
        const int width = cross ? 4 * SIZE : SIZE;
        assert_int_equal(image->width, 4 * width);
        assert_int_equal(image->height, cross ? 3 * SIZE : SIZE);
        float least = 1, most = 0, brightest = 0;
        for (int i = 0; i < 3 * image->width * image->height; i++) {
            least = fminf(least, image->pixels[i]);
            most = fmaxf(most, image->pixels[i]);
            brightest = i / 3 % image->width >= 3 * width ? fmaxf(brightest, image->pixels[i]) : brightest;
        }
        assert_true(least >= 0 && most <= 1 && brightest == 1);
        vplReflectiveTexel t; // the first texel of face -y, below the centre of the cross
        int64_t texel = cross ? 3 * SIZE * SIZE : 0;
        while (!vplReflectiveMap_GetTexel(map, room, texel, &t)) {
            texel++;
        }
        const int64_t x = (cross ? SIZE : 0) + texel % SIZE, y = (cross ? 2 * SIZE : 0) + texel / SIZE % SIZE;
        const float* pixel = image->pixels + 3 * (y * image->width + x);
        assertNear((double)pixel[1],
                   (double)((t.position.y - room->boundsMin.y) / (room->boundsMax.y - room->boundsMin.y)),
                   1e-6, "position", k);
        assertNear((double)pixel[3 * width + 2], 0.5 * (1 + (double)t.normal.z), 1e-6, "normal", k);
        assertNear((double)pixel[6 * width], (double)t.albedo.r, 0, "albedo", k);
        assertNear((double)(pixel[9 * width] * t.flux.b), (double)(pixel[9 * width + 2] * t.flux.r), 1e-6,
                   "flux", k);
        vplImage_Destroy(image);
        vplReflectiveMap_Destroy(map);
    }
    const vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    vplReflectiveMap* large = mapOf(room, &e, 1025);
    vplImage* none = NULL;
    assert_int_equal(vplShowReflectiveMap(large, room, &none), VPL_LIMIT);
    assert_non_null(strstr(takeMessage(), "at most 1024"));
    assert_null(none);
    vplReflectiveMap_Destroy(large);
    vplGeometry_Destroy(room);
}

TEST(BadMapsAreRefused, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    vplReflectiveMap* map = NULL;
    def.size = 0;
    assert_int_equal(vplReflectiveMap_Create(cube, &def, NULL, NULL, &map), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "size is 0"));
    def = (vplReflectiveMapDef){.size = 4};
    assert_int_equal(vplReflectiveMap_Create(cube, &def, NULL, NULL, &map), VPL_INVALID_ARGUMENT);
    assert_null(map);
    const vplReflectiveMap* const none[] = {NULL}; // no map for the only emitter: rays are used
    vplParticleDef particles = vplDefaultParticleDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet* set = NULL;
    particles.maps = none;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &particles, &set), VPL_SUCCESS);
    assert_int_equal(set->rays, 18);
    vplLightSet_Destroy(set);
    particles.geometry = VPL_PARTICLE_GEOMETRY_OBB;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &particles, &set), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "bounding boxes"));
    vplGeometry_Destroy(cube);
}
