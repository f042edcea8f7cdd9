// SPDX-License-Identifier: MIT
// The shortest program: load, render, write.
#include <vpl/vpl.h>

int main(int count, char** words)
{
    vplContext* context;
    vplScene* scene;
    vplImage* image;
    vplRenderOptions options = vplDefaultRenderOptions();
    return count < 3 || vplContext_Create(NULL, &context) || vplScene_Load(context, words[1], &scene) ||
           vplRender(scene, &options, &image, NULL) || vplImage_Write(image, words[2], NULL);
}
