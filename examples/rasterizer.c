// SPDX-License-Identifier: MIT
// The rasterizer without scenes or lights: rasterizer [PICTURE] draws a fan of coloured blades in perspective by two shaders.
#include <vpl/stages.h>

#include <math.h>
#include <stdio.h>

static void printMessage(void* file, vplLogLevel level, const char* message)
{
    (void)level;
    fprintf(file, "%s\n", message);
}

enum { BLADES = 24, SIZE = 400 };

// Vertex shader. A blade has three vertices: the centre of the fan and two points of a circle that leans back. It writes clip
// space directly.
static void bladeVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const float* twist = uniforms;
    for (int i = 0; i < count; i++) {
        int vertex = first + i, blade = vertex / 3, corner = vertex % 3;
        float angle = 6.2831853f * ((float)blade + (corner == 2 ? *twist : 0)) / BLADES;
        float radius = corner == 0 ? 0 : 1;
        float x = radius * cosf(angle), y = radius * sinf(angle);
        float depth = 2 + 0.7f * y + 0.3f * (corner == 2 ? 1.0f : 0.0f);
        out->x[i] = 1.8f * x;
        out->y[i] = 1.8f * y;
        out->z[i] = depth - 1; // the near plane is at 1
        out->w[i] = depth;
        out->varying[0][i] = (float)blade / BLADES;
        out->varying[1][i] = radius;
    }
}

// Fragment shader: rings of two brightnesses; the hue tells the blade. It gets a block of fragments at once.
static void bladeColours(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        float hue = f->varying[0][l], rings = f->varying[1][l] * 10;
        float stripe = rings - floorf(rings) < 0.5f ? 1 : 0.6f;
        f->plane[0][l] = stripe * hue;
        f->plane[1][l] = stripe * (1 - hue);
        f->plane[2][l] = stripe * 0.5f;
    }
}

int main(int count, char** words)
{
    static float planes[3][SIZE * SIZE];
    static uint32_t indices[3 * BLADES];
    for (uint32_t i = 0; i < 3 * BLADES; i++) {
        indices[i] = i;
    }
    const float twist = 1.6f; // above 1 blades overlap, so the depth test decides
    vplMesh mesh = {indices, 3 * BLADES, BLADES};
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = bladeVertices;
    pipeline.vertexUniforms = &twist;
    pipeline.varyingCount = 2;
    pipeline.fragment = bladeColours;

    vplFramebuffer framebuffer = vplDefaultFramebuffer(SIZE, SIZE);
    framebuffer.planeCount = 3;
    for (int c = 0; c < 3; c++) {
        framebuffer.planes[c].pixels = planes[c];
        framebuffer.planes[c].clear = 0.02f;
    }
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage;
    def.logUser = stderr;
    vplContext* context;
    vplRaster* raster;
    vplImage* image;
    vplRasterStats stats;
    if (vplContext_Create(&def, &context) || vplRaster_Create(context, &framebuffer, &raster) ||
        vplRaster_Draw(raster, &mesh, &pipeline) || vplRaster_Run(raster, NULL, NULL, &stats) ||
        vplImage_Create(context, SIZE, SIZE, &image)) {
        return 1;
    }
    for (int i = 0; i < SIZE * SIZE; i++) {
        for (int c = 0; c < 3; c++) {
            image->pixels[3 * i + c] = planes[c][i];
        }
    }
    vplResult result = vplImage_Write(image, count > 1 ? words[1] : "rasterizer.png", NULL);
    printf("%lld triangles drawn, %lld fragments\n", (long long)stats.trianglesBinned,
           (long long)stats.fragments);
    vplImage_Destroy(image);
    vplRaster_Destroy(raster);
    vplContext_Destroy(context);
    return result != VPL_SUCCESS;
}
