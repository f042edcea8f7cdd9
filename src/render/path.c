// SPDX-License-Identifier: MIT
#include "render/render.h"

vplResult vplRenderPath(vplJob* job)
{
    return vplFail(job->context, VPL_INVALID_ARGUMENT, "the path tracer is not built yet");
}
