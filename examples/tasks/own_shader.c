// SPDX-License-Identifier: MIT
// A triangle by shaders of the program's own: own_shader.
#include <vpl/stages.h>

#include <stdio.h>

static void place(const void* uniforms, int first, int count, const vplVertices* out)
{
    static const float corners[3][2] = {{-1, -1}, {1, -1}, {-1, 1}};
    (void)uniforms;
    for (int i = 0; i < count; i++) {
        out->x[i] = corners[first + i][0];
        out->y[i] = corners[first + i][1];
        out->z[i] = 0;
        out->w[i] = 1;
        out->varying[0][i] = (float)(first + i);
    }
}

static void colour(const void* uniforms, vplFragments* f)
{
    const float* brightness = uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->plane[0][l] = *brightness * f->varying[0][l];
    }
}

int main(void)
{
    static float pixels[32 * 32];
    const uint32_t indices[] = {0, 1, 2};
    const float brightness = 0.5f;
    const vplMesh mesh = {indices, 3, 1};
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = place;
    pipeline.varyingCount = 1;
    pipeline.fragment = colour;
    pipeline.fragmentUniforms = &brightness;
    vplFramebuffer framebuffer = vplDefaultFramebuffer(32, 32);
    framebuffer.planeCount = 1;
    framebuffer.planes[0].pixels = pixels;
    vplContext* context = NULL;
    vplRaster* raster = NULL;
    vplRasterStats stats = {0};
    const bool failed = vplContext_Create(&def, &context) ||
                        vplRaster_Create(context, &framebuffer, &raster) ||
                        vplRaster_Draw(raster, &mesh, &pipeline) || vplRaster_Run(raster, NULL, NULL, &stats);
    printf("%lld fragments, the last one of row 31 is %g\n", (long long)stats.fragments,
           (double)pixels[31 * 32 + 30]);
    vplRaster_Destroy(raster);
    vplContext_Destroy(context);
    return failed || stats.fragments < 480 || !(pixels[31 * 32 + 30] > 0.4f) ? 1 : 0;
}
