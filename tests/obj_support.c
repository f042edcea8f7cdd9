// SPDX-License-Identifier: MIT
#include "obj_support.h"

#include <stdlib.h>
#include <unistd.h>

static void keepAll(void* user, vplLogLevel level, const char* message)
{
    static const char* const levels[] = {"error", "warning", "info"};
    Desk* d = user;
    size_t used = strlen(d->said);
    snprintf(d->said + used, sizeof d->said - used, "%s: %s\n", levels[level], message);
}

void openDesk(Desk* d)
{
    *d = (Desk){.folder = "/tmp/vpl-obj-XXXXXX"};
    assert_non_null(mkdtemp(d->folder));
    snprintf(d->obj, sizeof d->obj, "%s/a.obj", d->folder);
    snprintf(d->mtl, sizeof d->mtl, "%s/a.mtl", d->folder);
    vplContextDef def = vplDefaultContextDef();
    def.workerCount = 1;
    def.log = keepAll;
    def.logUser = d;
    assert_int_equal(vplContext_Create(&def, &d->context), VPL_SUCCESS);
    assert_int_equal(vplScene_Create(d->context, &d->scene), VPL_SUCCESS);
}

void closeDesk(Desk* d)
{
    vplScene_Destroy(d->scene);
    closeTestContext(d->context);
    unlink(d->obj);
    unlink(d->mtl);
    assert_int_equal(rmdir(d->folder), 0);
}

void writeText(const char* path, const char* text)
{
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    fclose(file);
}

const vplMeshDef* readText(Desk* d, const char* text)
{
    int mesh = -1;
    d->said[0] = 0;
    writeText(d->obj, text);
    if (vplScene_LoadObj(d->scene, d->obj, &mesh) != VPL_SUCCESS) {
        fail_msg("%s%s", text, d->said);
    }
    return vplScene_GetMesh(d->scene, mesh);
}

int countOf(const char* text, const char* part)
{
    int count = 0;
    for (const char* p = strstr(text, part); p != NULL; p = strstr(p + 1, part)) {
        count++;
    }
    return count;
}

vplVec3 meshCorner(const vplMeshDef* mesh, int triangle, int corner)
{
    return mesh->positions[mesh->indices[3 * triangle + corner]];
}

void assertPoint(vplVec3 p, double x, double y, double z)
{
    if (p.x != (float)x || p.y != (float)y || p.z != (float)z) {
        fail_msg("(%g, %g, %g), wanted (%g, %g, %g)", (double)p.x, (double)p.y, (double)p.z, x, y, z);
    }
}

void assertColour(vplRgb c, double r, double g, double b)
{
    assertPoint((vplVec3){c.r, c.g, c.b}, r, g, b);
}
