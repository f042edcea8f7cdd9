// SPDX-License-Identifier: MIT
// The shortest complete program: hello SCENE PICTURE loads a scene, renders it and writes the picture.
#include <vpl/vpl.h>

#include <stdio.h>

static void printMessage(void* file, vplLogLevel level, const char* message)
{
    fprintf(file, "%s: %s\n", level == VPL_LOG_ERROR ? "error" : "note", message);
}

int main(int count, char** words)
{
    if (count != 3) {
        fprintf(stderr, "usage: hello SCENE PICTURE\n");
        return 2;
    }
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage; // every failure reaches it as one sentence
    def.logUser = stderr;
    vplRenderOptions options = vplDefaultRenderOptions();
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplImage* image = NULL;
    bool done = vplContext_Create(&def, &context) == VPL_SUCCESS &&
                vplScene_Load(context, words[1], &scene) == VPL_SUCCESS &&
                vplRender(scene, &options, &image, NULL) == VPL_SUCCESS &&
                vplImage_Write(image, words[2], NULL) == VPL_SUCCESS;
    vplImage_Destroy(image); // NULL is allowed
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return done ? 0 : 1;
}
