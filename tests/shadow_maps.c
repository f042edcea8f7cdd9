// SPDX-License-Identifier: MIT
#include "shadow_maps.h"

#include "bench/band.h"
#include "bench/rsm_band.h"

#include "base/arena.h"
#include "base/hash.h"
#include "lights/kernels.h"

#define SPOT_ANGLE 1.1 // outer angle, radians

static const vplEmitterType EMITTERS[] = {VPL_EMITTER_POINT, VPL_EMITTER_SPOT, VPL_EMITTER_DIRECTIONAL};

const char* nameOfKind(MapKind kind)
{
    static const char* const names[MAP_KINDS] = {"cube",
                                                 "soft cube",
                                                 "wide cube",
                                                 "hemi-octahedral",
                                                 "paraboloid",
                                                 "two paraboloids",
                                                 "reflective map of a point",
                                                 "reflective map of a spot",
                                                 "reflective map of a directional light"};
    return names[kind];
}

static vplResult openCube(ShadowMap* m, int size)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    vplShadowDef shadow = vplDefaultShadowDef();
    def.position = m->position;
    def.size = size;
    shadow.biasRule = VPL_BIAS_EXACT;
    shadow.pcfSamples = m->kind == MAP_CUBE ? 1 : 16;
    shadow.pcfOffset = m->kind == MAP_WIDE_CUBE ? 0.05f : -1;
    TRY(vplCubeMap_Create(m->geometry, &def, NULL, NULL, &m->cube));
    return vplShadow_Create(m->cube, &shadow, &m->shadow);
}

static vplResult openHemi(ShadowMap* m, int size)
{
    const vplHemiMapPlace place = {m->position, m->forward};
    TRY(vplHemiMaps_Create(m->geometry->context, size, 1, &m->hemi));
    return vplHemiMaps_Draw(m->hemi, m->geometry, &place, 1, NULL, NULL);
}

static vplResult openParaboloid(ShadowMap* m, int size)
{
    const int hemispheres = m->kind == MAP_PARABOLOID ? 1 : 2;
    const vplParaboloidPlace place = {m->position, m->forward, hemispheres, hemispheres == 1};
    TRY(vplParaboloidMaps_Create(m->geometry->context, size, 1, true, &m->paraboloids));
    return vplParaboloidMaps_Draw(m->paraboloids, m->geometry, &place, 1, NULL, NULL);
}

static vplResult openReflective(ShadowMap* m, int size)
{
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    def.size = size;
    def.emitter.type = EMITTERS[m->kind - MAP_REFLECTIVE_POINT];
    def.emitter.position = m->position;
    def.emitter.direction = m->forward;
    def.emitter.outerAngle = SPOT_ANGLE;
    return vplReflectiveMap_Create(m->geometry, &def, NULL, NULL, &m->reflective);
}

vplResult tryOpenMap(ShadowMap* m, MapKind kind, const vplGeometry* g, vplVec3 position, vplVec3 forward,
                     int size)
{
    *m = (ShadowMap){.kind = kind, .geometry = g, .position = position, .forward = forward};
    switch (kind) {
    case MAP_CUBE:
    case MAP_SOFT_CUBE:
    case MAP_WIDE_CUBE:
        return openCube(m, size);
    case MAP_HEMI:
        return openHemi(m, size);
    case MAP_PARABOLOID:
    case MAP_TWO_PARABOLOIDS:
        return openParaboloid(m, size);
    default:
        return openReflective(m, size);
    }
}

ShadowMap openMap(MapKind kind, const vplGeometry* g, vplVec3 position, vplVec3 forward, int size)
{
    ShadowMap m;
    if (tryOpenMap(&m, kind, g, position, forward, size) != VPL_SUCCESS) {
        fail_msg("%s: %s", nameOfKind(kind), takeMessage());
    }
    return m;
}

void closeMap(ShadowMap* m)
{
    vplCubeMap_Destroy(m->cube);
    vplHemiMaps_Destroy(m->hemi);
    vplParaboloidMaps_Destroy(m->paraboloids);
    vplReflectiveMap_Destroy(m->reflective);
}

void setPoint(vplSurface* s, int lane, vplVec3 p, vplVec3 n)
{
    s->px[lane] = p.x;
    s->py[lane] = p.y;
    s->pz[lane] = p.z;
    s->nx[lane] = n.x;
    s->ny[lane] = n.y;
    s->nz[lane] = n.z;
}

void factorBlock(const ShadowMap* m, const vplSurface* s, float factorOut[VPL_LANES])
{
    if (m->cube != NULL) {
        vplShadow_FactorBlock(&m->shadow, s, factorOut);
    } else if (m->hemi != NULL) {
        vplHemiMap_FactorBlock(&m->hemi->maps[0], s, factorOut);
    } else if (m->paraboloids != NULL) {
        vplParaboloidMap_FactorBlock(&m->paraboloids->maps[0], s, factorOut);
    } else {
        vplReflectiveMap_FactorBlock(m->reflective, s, factorOut);
    }
}

float factorAt(const ShadowMap* m, vplVec3 p, vplVec3 n)
{
    return m->cube != NULL          ? vplShadow_Factor(&m->shadow, p, n)
           : m->hemi != NULL        ? vplHemiMap_Factor(&m->hemi->maps[0], p, n)
           : m->paraboloids != NULL ? vplParaboloidMap_Factor(&m->paraboloids->maps[0], p, n)
                                    : vplReflectiveMap_Factor(m->reflective, p, n);
}

vplVec3 wayToMap(const ShadowMap* m, vplVec3 point)
{
    return m->kind == MAP_REFLECTIVE_DIRECTIONAL ? vplScale(-20, vplNormalize(m->forward))
           : m->hemi != NULL                     ? vplSub(m->hemi->maps[0].position, point)
           : m->paraboloids != NULL              ? vplSub(m->paraboloids->maps[0].position, point)
                                                 : vplSub(m->position, point);
}

bool isInView(const ShadowMap* m, vplVec3 point)
{
    const vplVec3 way = wayToMap(m, point);
    const float along = -vplDot(way, vplNormalize(m->forward)), length = vplLength(way);
    switch (m->kind) {
    case MAP_HEMI:
        return along > 0;
    case MAP_PARABOLOID: // the map is undefined beyond the rim and within a texel of it
        return along > 4 * 1.41421356f / (float)m->paraboloids->size * length;
    case MAP_REFLECTIVE_SPOT:
        return along > 0.01f + (float)cos(SPOT_ANGLE) * length;
    default:
        return true;
    }
}

bool isSureAt(const ShadowMap* m, vplVec3 p, vplVec3 n, bool dark)
{
    if (m->cube != NULL) { // off by the angle to a texel's corner and that to the disc's rim
        const vplVec3 way = wayToMap(m, p);
        const float r = vplLength(way), texel = m->shadow.texelTangent,
                    disc = m->shadow.def.pcfOffset / r + m->shadow.pcfTangent,
                    f = r * (texel + disc) / (1 - texel * disc);
        const float band = bandAt(r, f, fminf(fabsf(vplDot(way, n)) / r, 1));
        return texel * disc < 1 && isSureWithin(m->geometry, m->position, p, n, f, band, dark);
    }
    return m->hemi != NULL          ? isSure(m->geometry, &m->hemi->maps[0], p, n, dark)
           : m->paraboloids != NULL ? isSureParaboloid(m->geometry, &m->paraboloids->maps[0], p, n, dark)
                                    : isSureReflective(m->geometry, m->reflective, p, n, dark);
}

bool holdsRay(const vplGeometry* g, const vplVec3 from[3], vplVec3 d, float stored)
{
    for (int i = 0; i < 9; i++) {
        const float a = 2e-6f * (float)(i % 3 - 1), b = 2e-6f * (float)(i / 3 - 1);
        const vplVec3 beside = vplAdd(d, vplAdd(vplScale(a, from[1]), vplScale(b, from[2])));
        const vplRay ray = {from[0], i == 4 ? d : beside, {0, 0}};
        vplHit hit;
        const float wanted = vplGeometry_ClosestHit(g, &ray, &hit) ? 1 / hit.t : 0;
        if (fabsf(stored - wanted) <= 1e-4f * wanted) {
            return true;
        }
    }
    return false;
}

static size_t square(int size)
{
    return (size_t)size * (size_t)size;
}

uint64_t hashMap(const ShadowMap* m)
{
    if (m->cube != NULL) {
        return vplHashFloats(0, m->cube->texels, 6 * square(m->cube->size));
    }
    if (m->hemi != NULL) {
        return vplHashFloats(0, m->hemi->texels, square(m->hemi->size));
    }
    if (m->reflective != NULL) {
        return vplHashFloats(0, m->reflective->depth,
                             (size_t)m->reflective->faceCount * square(m->reflective->size));
    }
    const vplParaboloidMap* p = &m->paraboloids->maps[0];
    uint64_t hash = 0;
    for (int i = 0; i < p->hemispheres * p->size * p->size; i++) {
        const int hemisphere = i / (p->size * p->size), texel = i % (p->size * p->size);
        const size_t at = (size_t)hemisphere * vplParaboloidMap_Texels(p->size) +
                          vplParaboloidMap_Place(p->size, texel % p->size, texel / p->size);
        hash = vplHashFloats(hash, p->texels + at, 1);
        hash = vplHashFloats(hash, (const float*)p->triangles + at, 1);
    }
    return hash;
}

vplCubeMap* makeCubeMap(const vplGeometry* g, vplVec3 position, int size)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = position;
    def.size = size;
    vplCubeMap* map;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
    return map;
}

void makeFlatMap(FlatMap* flat, vplContext* context, vplVec3 light, float far, float stored)
{
    for (int i = 0; i < 6; i++) {
        flat->texels[i] = stored;
    }
    flat->map = (vplCubeMap){
        .position = light, .size = 1, .farPlane = far, .texels = flat->texels, .context = context};
}

vplShadow exactShadow(const vplCubeMap* map, int samples, float offset)
{
    vplShadowDef def = vplDefaultShadowDef();
    def.biasRule = VPL_BIAS_EXACT;
    def.pcfSamples = samples;
    def.pcfOffset = offset;
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(map, &def, &shadow), VPL_SUCCESS);
    return shadow;
}

vplShadow pairShadow(const vplCubeMap* map, float biasStatic, float biasDynamic)
{
    vplShadowDef def = vplDefaultShadowDef();
    def.biasRule = VPL_BIAS_PAIR;
    def.biasStatic = biasStatic;
    def.biasDynamic = biasDynamic;
    def.pcfSamples = 1;
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(map, &def, &shadow), VPL_SUCCESS);
    return shadow;
}

vplGeometry* wallOnFloor(vplContext* context, float x0)
{
    vplScene* scene;
    vplGeometry* g;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    vplScene_AddMaterial(scene, &material, NULL);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform =
        vplMat4_FromParts((vplVec3){0, 0, 0}, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){20, 20, 1});
    vplScene_AddObject(scene, &object, NULL);
    object.transform =
        vplMat4_FromParts((vplVec3){x0, 0, 0}, (double[3]){0, VPL_PI / 2, 0}, (vplVec3){20, 1, 1});
    vplScene_AddObject(scene, &object, NULL);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplScene_Destroy(scene);
    return g;
}
