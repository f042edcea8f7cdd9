// SPDX-License-Identifier: MIT
// Compares two pictures: compare_pictures A B. Exit code 0 if they differ by less than 10 %.
#include <vpl/vpl.h>

#include <stdio.h>

int main(int count, char** words)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplContext* context = NULL;
    vplImage *a = NULL, *b = NULL;
    vplComparison c = {0};
    const bool failed = count < 3 || vplContext_Create(&def, &context) ||
                        vplImage_Read(context, words[1], &a) || vplImage_Read(context, words[2], &b) ||
                        vplImage_Compare(a, b, &c);
    printf("rmse %g (%g %%), psnr %g dB\n", c.rmse, 100 * c.relativeRmse, c.psnr);
    vplImage_Destroy(a);
    vplImage_Destroy(b);
    vplContext_Destroy(context);
    return failed || c.relativeRmse > 0.1 ? 1 : 0;
}
