// SPDX-License-Identifier: MIT
// Which sides of patches light reaches (X101).
#include "patch_model.h"

#include "base/hash.h"
#include "math/vec.h"

#include <stdlib.h>

static const vplVec3 NEAR_CEILING = {2.775f, 5.4f, 2.775f};

static void TheReportsBoxHasItsFrontsAndNoOthers(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplGeometry* g = testModel(context, MODEL_METRES, 0.5f);
    vplPatches* p = patchesOf(g, 1.25f, VPL_MAX_PATCH_ROUNDS);
    vplPatchSides* s = sidesOf(p, &NEAR_CEILING);
    int backs = 0, partial = 0;
    double area = 0;
    for (int i = 0; i < s->count; i++) {
        backs += s->sides[i].back;
        partial += s->sides[i].open != 0xffff;
        area += (double)s->sides[i].area;
    }
    printf("sides %d backs %d partial %d rays %lld area %g of %g\n", s->count, backs, partial,
           (long long)s->rays, area, vplGeometry_Area(g));
    assert_int_equal(backs, 0);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    closeTestContext(context);
}

TEST_SUITE(patchSides, cmocka_unit_test(TheReportsBoxHasItsFrontsAndNoOthers));
