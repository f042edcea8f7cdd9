// SPDX-License-Identifier: MIT
// Every stage of a render by itself, and all that <vpl/vpl.h> declares. For programs that build a renderer of their own from
// particles, shadow maps, clusters, patches or the rasterizer, or that show what is inside of a scene or a plan.
#ifndef VPL_STAGES_H
#define VPL_STAGES_H

#include <vpl/vpl.h>

// Contexts, pictures, scenes, options, plans and renders from the inside.
#include <vpl/machine.h>
#include <vpl/imagetools.h>
#include <vpl/scenetools.h>
#include <vpl/optiontools.h>
#include <vpl/plantools.h>
#include <vpl/rendertools.h>
#include <vpl/pieces.h>

// Stages, in the order in which a picture needs them.
#include <vpl/geometry.h>
#include <vpl/raster.h>
#include <vpl/visibility.h>
#include <vpl/formulas.h>
#include <vpl/lights.h>
#include <vpl/shading.h>
#include <vpl/radiosity.h>

#endif
