// SPDX-License-Identifier: MIT
// A picture that gets better until the program cancels it, in the program's own memory: progressive SCENE.
#include <vpl/vpl.h>

#include <stdio.h>

static bool goesOn(void* user, double fraction)
{
    (void)user;
    return fraction < 0.5; // other programs ask a clock or a window
}

int main(int count, char** words)
{
    static unsigned char pixels[36][64][4];
    int passes = 0;
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplRenderOptions options = vplDefaultRenderOptions();
    vplRenderOptions_SetAll(&options, "--method keller --particles 200 --passes 20 --size 64x36");
    options.progress = goesOn;
    vplTarget target = {0, vplDefaultPixelsDef()};
    target.pixels.first = pixels;
    target.pixels.format = VPL_PIXELS_RGBA_SRGB8;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    const bool cancelled =
        vplContext_Create(&def, &context) == VPL_SUCCESS &&
        vplScene_Load(context, count > 1 ? words[1] : "room.json", &scene) == VPL_SUCCESS &&
        vplRenderTo(scene, &options, &target, 1, &passes, NULL) == VPL_CANCELLED;
    printf("%d passes; the pixel in the middle is %d\n", passes, pixels[18][32][0]);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return cancelled && passes > 0 && pixels[18][32][0] > 0 ? 0 : 1;
}
